//! One frame of the window: input, engine, picture, panels.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use eframe::egui::{
    Align2, Area, CentralPanel, Color32, Frame, Id, Image, Key, Panel, Response, Sense, Ui,
    load::SizedTexture,
};
use tercet::draw::Drawable;
use tercet::geom::{Aabb, View, Viewport};

use super::display::{Display, Layers};
use super::engine::Engine;
use super::fly::Fly;
use super::pyramid::PyramidView;
use super::screenshot::Screenshots;
use super::{PANELS, frozen, panel, pick, plots};
use crate::flags::Flags;
use crate::stage::{Picture, Stage};

const LAYER_KEYS: [Key; 6] = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6];

/// How long a message stands.
const READING_TIME: Duration = Duration::from_secs(8);

/// The window.
pub struct App {
    engine: Engine,
    fly: Fly,
    /// The part of the flight that a frame takes.
    stride: f32,
    display: Display,
    layers: Layers,
    pyramid: PyramidView,
    screenshots: Screenshots,
    /// Where screenshots go.
    out: PathBuf,
    /// What the user should know, and since when.
    message: Option<(String, Instant)>,
    /// Under the cursor: whether it is drawn, and why.
    picked: Vec<(bool, String)>,
    marked: Option<Aabb>,
}

impl App {
    /// The window of an engine.
    pub fn new(flags: &Flags, mut engine: Engine, display: Display) -> anyhow::Result<Self> {
        engine.scene.sync(&engine.scenario.world);
        // Across the scene in half a minute.
        let speed = engine.bounds().size().length() / 30.0;
        Ok(Self {
            fly: Fly::new(
                &engine.scenario.flight,
                flags.flight_end()?,
                if speed > 0.0 { speed } else { 1.0 },
            ),
            stride: 1.0 / flags.frames as f32,
            engine,
            display,
            layers: Layers::default(),
            pyramid: PyramidView::default(),
            screenshots: Screenshots::default(),
            out: flags.out(),
            message: None,
            picked: Vec::new(),
            marked: None,
        })
    }

    fn say(&mut self, message: String) {
        self.message = Some((message, Instant::now()));
    }

    fn keys(&mut self, ui: &Ui) {
        let ctx = ui.ctx();
        let pressed = |key| ctx.input(|input| input.key_pressed(key));
        if pressed(Key::F12) {
            self.screenshots.take(ctx);
        }
        if let Some(saved) = self.screenshots.save(&self.out) {
            self.say(match saved {
                Ok(file) => format!("saved {}", file.display()),
                Err(error) => format!("{error:#}"),
            });
        }
        if ctx.egui_wants_keyboard_input() {
            return;
        }
        if pressed(Key::F) {
            self.engine.freeze(self.fly.pose());
            self.fly.follows &= self.engine.frozen.is_none();
        }
        if pressed(Key::P) {
            self.fly.follows = !self.fly.follows;
        }
        if pressed(Key::Space) {
            self.engine.paused = !self.engine.paused;
        }
        for ((on, _), key) in self.layers.each().into_iter().zip(LAYER_KEYS) {
            *on ^= pressed(key);
        }
    }

    /// The frame itself.
    fn picture(&mut self, ui: &mut Ui, frame: &eframe::Frame) -> anyhow::Result<()> {
        let size = ui.available_size();
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        let ctx = ui.ctx().clone();
        self.fly.steer(&response);
        let part = if self.engine.paused { 0.0 } else { self.stride };
        self.fly.follow(&self.engine.scenario.flight, part);
        let most = self.engine.gpu().most_pixels_a_side().min(Viewport::MAX_SIDE);
        let side = |points: f32| ((points * ctx.pixels_per_point()) as u32).clamp(1, most);
        let viewport = Viewport::new(side(size.x), side(size.y));
        let view = self.engine.scenario.look(self.fly.pose(), viewport)?;
        self.engine.stage.keep_questions(self.layers.proxies);
        self.engine.stage.keep_pyramid(self.layers.pyramid > 0);
        self.engine.watches_movers = self.layers.awake;
        let done = self.engine.frame(self.fly.pose(), viewport);
        self.look_under(&response, &view);
        let picture = self.display.draw(&self.engine, &view, &self.layers, self.marked)?;
        self.paint(ui, frame, &response, &picture);
        let levels = self.engine.stage.pyramid();
        if let Some(level) = self.layers.pyramid.checked_sub(1).and_then(|n| levels.get(n as usize)) {
            let (number, pixels) = (self.layers.pyramid, [viewport.width, viewport.height]);
            self.pyramid.paint(ui, rect, level, number, pixels);
        }
        if let (Some(_), Some(culled)) = (self.engine.frozen, &self.engine.culled) {
            let reach = f64::from(self.engine.bounds().size().length()) * 0.4;
            frozen::draw(ui.painter(), rect, &view, culled, reach);
        }
        done
    }

    fn paint(&mut self, ui: &Ui, frame: &eframe::Frame, response: &Response, picture: &Picture) {
        let Some(state) = frame.wgpu_render_state() else { return };
        let texture = self.display.texture(state, picture);
        Image::from_texture(SizedTexture::new(texture, response.rect.size())).paint_at(ui, response.rect);
    }

    /// Finds out what is under the cursor, and why it is drawn or not.
    fn look_under(&mut self, response: &Response, view: &View) {
        self.picked.clear();
        self.marked = None;
        let (Some(at), Some(culled)) = (response.hover_pos(), &self.engine.culled) else { return };
        let at = (at - response.rect.min) / response.rect.size();
        let Engine { scene, eye, scenario, .. } = &self.engine;
        for (metres, object) in pick::along(scene, view, (at.x, at.y)) {
            let name = scenario.world.get::<&Drawable>(object.object.entity());
            let name = name.map_or_else(|_| "object".to_owned(), |drawable| drawable.mesh.name().to_owned());
            let why = eye.why(scene, culled, object.object.id);
            let size = object.bounds.as_ref().map(pick::size).unwrap_or_default();
            self.picked.push((why.is_drawn(), format!("{name} ({size}), at {metres:.1} m: {why}")));
            self.marked = self.marked.or(object.bounds);
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        self.keys(ui);
        Panel::bottom("plots")
            .default_size(PANELS.1)
            .resizable(true)
            .show(ui, |ui| plots::show(ui, &self.engine.records));
        let panel = Panel::left("controls")
            .exact_size(PANELS.0)
            .show(ui, |ui| panel::show(ui, &mut self.engine, &mut self.fly, &mut self.layers));
        if let Err(error) = panel.inner {
            self.say(format!("{error:#}"));
        }
        let done = CentralPanel::no_frame().show(ui, |ui| self.picture(ui, frame));
        if let Err(error) = done.inner {
            // If the device fails in culling, the CPU can still cull for as long as it draws.
            let device = matches!(error.downcast_ref(), Some(tercet::Error::Device { .. }));
            let next = match device && matches!(self.engine.stage, Stage::Wgpu(_)) {
                true => self.engine.use_gpu(false).map(|()| ": going on in software"),
                false => Ok(""),
            };
            self.say(match next {
                Ok(next) => format!("{error:#}{next}"),
                Err(also) => format!("{error:#}: {also:#}"),
            });
        }
        let place = done.response.rect;
        if !self.picked.is_empty() {
            let corner = place.left_bottom() + eframe::egui::vec2(8.0, -8.0);
            Area::new(Id::unique("why"))
                .fixed_pos(corner)
                .pivot(Align2::LEFT_BOTTOM)
                .interactable(false)
                .show(ui.ctx(), |ui| Frame::popup(ui.style()).show(ui, |ui| panel::why(ui, &self.picked)));
        }
        self.message = self.message.take().filter(|(_, since)| since.elapsed() < READING_TIME);
        if let Some((message, _)) = &self.message {
            let corner = place.left_top() + eframe::egui::vec2(8.0, 8.0);
            Area::new(Id::unique("message")).fixed_pos(corner).interactable(false).show(ui.ctx(), |ui| {
                Frame::popup(ui.style()).show(ui, |ui| ui.colored_label(Color32::YELLOW, message))
            });
        }
        ui.ctx().request_repaint();
    }
}
