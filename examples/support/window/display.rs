//! The picture in the window: the engine's own, or one of what it left to draw; and what is drawn
//! over it.

use eframe::egui::TextureId;
use eframe::egui_wgpu::RenderState;
use tercet::draw::{Lines, Renderer, Shading};
use tercet::geom::{Aabb, View, Viewport};
use tercet::query::gpu::wgpu::{self, TextureView};
use tercet::scene::ObjectRef;

use super::engine::Engine;
use super::states;
use crate::stage::{Asked, Gpu, Picture, Stage};

/// What is to be seen.
#[derive(Clone, Copy, Debug, Default)]
pub struct Layers {
    /// How often each pixel is drawn, instead of what is there.
    pub overdraw: bool,
    /// All objects, not only those that culling left: to compare.
    pub everything: bool,
    /// The boxes of nodes, coloured by state.
    pub nodes: bool,
    /// The boxes of objects that were culled inside the frustum.
    pub culled: bool,
    /// The boxes of objects that are awake: that have moved.
    pub awake: bool,
    /// What the questions of the frame rasterised.
    pub proxies: bool,
    /// A level of the culling depth's pyramid, from 1 on, over everything; 0 for none.
    pub pyramid: u32,
}

impl Layers {
    /// Each of them, with what it shows, in the order of its keys.
    pub fn each(&mut self) -> [(&mut bool, &'static str); 6] {
        [
            (&mut self.overdraw, "overdraw: how often a pixel is drawn"),
            (&mut self.everything, "everything, culled or not"),
            (&mut self.nodes, "boxes of nodes"),
            (&mut self.culled, "boxes of what was culled in the frustum"),
            (&mut self.awake, "boxes of objects that are awake"),
            (&mut self.proxies, "proxies, unless the camera is frozen"),
        ]
    }
}

/// Draws the picture.
pub struct Display {
    renderer: Renderer,
    /// The window's own attachments; those of the engine serve where they show the same.
    own: Picture,
    /// What the user interface shows, and its name there.
    shown: Option<(TextureView, TextureId)>,
    /// Reused by each frame.
    boxes: Vec<(Aabb, [u8; 4])>,
}

impl Display {
    /// Draws with the window's device.
    pub fn new(gpu: &Gpu) -> anyhow::Result<Self> {
        Ok(Self {
            renderer: Renderer::new(&gpu.device, &gpu.queue, Some(Picture::COLOR))?,
            own: Picture::new(gpu, Viewport::new(1, 1))?,
            shown: None,
            boxes: Vec::new(),
        })
    }

    /// Draws what `view` shows of the engine's last frame. The box of `marked` is drawn over all.
    pub fn draw(
        &mut self,
        engine: &Engine,
        view: &View,
        layers: &Layers,
        marked: Option<Aabb>,
    ) -> anyhow::Result<Picture> {
        let gpu = engine.gpu();
        if !self.own.fits(view.viewport()) {
            self.own = Picture::new(gpu, view.viewport())?;
        }
        // Drawn by the engine, from where the user looks?
        let ready = match &engine.stage {
            Stage::Wgpu(stage) if engine.frozen.is_none() && !layers.overdraw && !layers.everything => {
                Some(stage.picture())
            }
            _ => None,
        };
        let picture = ready.unwrap_or(&self.own).clone();
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = picture.pass(&mut encoder, ready.is_none(), layers.overdraw);
        let shading = if layers.overdraw { Shading::Overdraw } else { Shading::Lit };
        self.renderer.begin(view, engine.detail, shading);
        if ready.is_none() {
            let all: Vec<ObjectRef>;
            let objects = match layers.everything {
                true => {
                    all = engine.scene.objects().map(|o| o.object).collect();
                    &all
                }
                false => engine.eye.visible(),
            };
            self.renderer.draw(&mut pass, &engine.scenario.world, objects);
        }
        self.boxes.clear();
        states::boxes(engine, layers, &mut self.boxes);
        self.renderer.draw_boxes(&mut pass, &self.boxes, Lines::DepthTested);
        // What is hidden is to be seen, too: faintly.
        self.boxes.iter_mut().for_each(|(_, color)| color[3] /= 4);
        self.renderer.draw_boxes(&mut pass, &self.boxes, Lines::XRay);
        let marked = marked.map(|bounds| (bounds, states::MARKED));
        self.renderer.draw_boxes(&mut pass, marked.as_slice(), Lines::XRay);
        // Seen from elsewhere, rectangles on the culling camera's screen mean nothing.
        if layers.proxies && engine.frozen.is_none() {
            let outline = |asked: &Asked| (asked.proxy.outline(), states::of_answer(asked.visible));
            let outlines: Vec<_> = engine.stage.asked().iter().map(outline).collect();
            self.renderer.draw_outlines(&mut pass, &outlines);
        }
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        Ok(picture)
    }

    /// The picture as the user interface knows it.
    pub fn texture(&mut self, state: &RenderState, picture: &Picture) -> TextureId {
        let view = &picture.color;
        if let Some((shown, id)) = &self.shown
            && shown == view
        {
            return *id;
        }
        let (mut renderer, nearest) = (state.renderer.write(), wgpu::FilterMode::Nearest);
        let id = match &self.shown {
            Some((_, id)) => {
                renderer.update_egui_texture_from_wgpu_texture(&state.device, view, nearest, *id);
                *id
            }
            None => renderer.register_native_texture(&state.device, view, nearest),
        };
        self.shown = Some((view.clone(), id));
        id
    }
}
