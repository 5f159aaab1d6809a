//! What the app draws into, and the passes on it.

use wgpu::{
    Backend, Color, LoadOp, Operations, RenderPass, RenderPassColorAttachment,
    RenderPassDepthStencilAttachment, RenderPassDescriptor, StoreOp, TextureFormat, TextureUsages,
    TextureView,
};

use super::clock::{Purpose, Tape};
use crate::Error;
use crate::geom::{DepthFormat, View, Viewport};

/// The attachments of a frame. The first pass of a frame clears or loads them as it says here;
/// later ones load. Colours are resolved once, at the frame's end.
#[derive(Clone, Debug)]
pub struct FrameTargets {
    /// Colour attachments, in the order of the app's pipelines.
    pub colors: Vec<Option<ColorTarget>>,
    /// What the questions are put to.
    pub depth: DepthTarget,
}

/// A colour attachment.
#[derive(Clone, Debug)]
pub struct ColorTarget {
    /// What is drawn into.
    pub view: TextureView,
    /// What it is resolved to, if it has several samples a pixel.
    pub resolve: Option<TextureView>,
    /// What the first pass begins with.
    pub load: LoadOp<Color>,
}

/// The depth attachment: Depth32Float or Depth24Plus, with or without stencil, usable both as an
/// attachment and as a texture binding.
#[derive(Clone, Debug)]
pub struct DepthTarget {
    /// What is drawn into.
    pub view: TextureView,
    /// The same with the depth aspect alone; needed for a format with stencil.
    pub depth_only: Option<TextureView>,
    /// Whether a frame starts with the depth that is there (terrain that the app has drawn before,
    /// say, which then hides what is behind it) instead of clearing it.
    pub keep: bool,
}

impl FrameTargets {
    /// Depth alone, cleared by each frame.
    pub fn new(depth: TextureView) -> Self {
        Self { colors: Vec::new(), depth: DepthTarget { view: depth, depth_only: None, keep: false } }
    }

    /// The same with one more colour attachment, without resolve.
    #[must_use]
    pub fn with_color(mut self, view: TextureView, load: LoadOp<Color>) -> Self {
        self.colors.push(Some(ColorTarget { view, resolve: None, load }));
        self
    }

    /// The depth as the questions read it.
    pub(super) fn readable_depth(&self) -> &TextureView {
        self.depth.depth_only.as_ref().unwrap_or(&self.depth.view)
    }

    /// Whether a view can be drawn and asked about with these.
    pub(super) fn check(&self, view: &View, backend: Backend) -> Result<(), Error> {
        let texture = self.depth.view.texture();
        let format = match texture.format() {
            TextureFormat::Depth32Float | TextureFormat::Depth32FloatStencil8 => DepthFormat::Depth32Float,
            TextureFormat::Depth24Plus | TextureFormat::Depth24PlusStencil8 => DepthFormat::Depth24Plus,
            TextureFormat::Depth16Unorm => {
                return unusable("Depth16Unorm is too coarse to answer exactly: use Depth32Float".into());
            }
            other => return unusable(format!("{other:?} is no depth format: use Depth32Float")),
        };
        if format != view.format() {
            return unusable(format!(
                "the depth is {:?} and the view says {:?}: see View::with_target",
                texture.format(),
                view.format()
            ));
        }
        if texture.sample_count() != view.samples() {
            return unusable(format!(
                "the depth has {} samples a pixel and the view says {}: see View::with_target",
                texture.sample_count(),
                view.samples()
            ));
        }
        // wgpu 30 makes them with the wrong target; nothing is drawn, and nothing reports it.
        if texture.sample_count() > 1 && backend == Backend::Gl {
            return unusable("wgpu's OpenGL has no multisampled textures: use one sample a pixel".into());
        }
        if !texture.usage().contains(TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING) {
            return unusable("the depth needs the usages RENDER_ATTACHMENT and TEXTURE_BINDING".into());
        }
        if texture.format().has_stencil_aspect() && self.depth.depth_only.is_none() {
            return unusable("a format with stencil needs DepthTarget::depth_only to be read".into());
        }
        let Viewport { x, y, width, height } = view.viewport();
        let fits = |first: u32, length: u32, side: u32| u64::from(first) + u64::from(length) <= side.into();
        if !(fits(x, width, texture.width()) && fits(y, height, texture.height())) {
            return unusable(format!(
                "a viewport of {width} × {height} at ({x}, {y}) does not fit {} × {} pixels",
                texture.width(),
                texture.height()
            ));
        }
        Ok(())
    }

    /// Whether some colour is to be resolved.
    pub(super) fn resolves(&self) -> bool {
        self.colors.iter().flatten().any(|color| color.resolve.is_some())
    }

    /// Opens a pass on all attachments.
    pub(super) fn pass(&self, tape: &mut Tape<'_>, view: &View, kind: Kind) -> RenderPass<'static> {
        let colors: Vec<_> =
            self.colors.iter().map(|color| color.as_ref().map(|c| c.attachment(kind))).collect();
        let descriptor = RenderPassDescriptor {
            label: Some("tercet draw"),
            color_attachments: &colors,
            depth_stencil_attachment: Some(self.depth.attachment(view, kind)),
            ..RenderPassDescriptor::default()
        };
        let mut pass = tape.render_pass(Purpose::Draw, descriptor).forget_lifetime();
        let Viewport { x, y, width, height } = view.viewport();
        pass.set_viewport(x as f32, y as f32, width as f32, height as f32, 0.0, 1.0);
        pass
    }
}

/// Which of a frame's passes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kind {
    /// Clears, or loads what the app left.
    pub(super) first: bool,
    /// Resolves.
    pub(super) last: bool,
}

impl ColorTarget {
    fn attachment(&self, kind: Kind) -> RenderPassColorAttachment<'_> {
        RenderPassColorAttachment {
            view: &self.view,
            depth_slice: None,
            resolve_target: self.resolve.as_ref().filter(|_| kind.last),
            ops: Operations {
                load: if kind.first { self.load } else { LoadOp::Load },
                store: StoreOp::Store,
            },
        }
    }
}

impl DepthTarget {
    fn attachment(&self, view: &View, kind: Kind) -> RenderPassDepthStencilAttachment<'_> {
        let clears = kind.first && !self.keep;
        // The cleared nearness is depth 0 under reversed z and minus depth 1 under standard z.
        let far = view.depth().cleared().abs();
        let has_stencil = self.view.texture().format().has_stencil_aspect();
        RenderPassDepthStencilAttachment {
            view: &self.view,
            depth_ops: Some(operations(clears, far)),
            stencil_ops: has_stencil.then(|| operations(clears, 0)),
        }
    }
}

fn operations<T: Default>(clears: bool, value: T) -> Operations<T> {
    Operations { load: if clears { LoadOp::Clear(value) } else { LoadOp::Load }, store: StoreOp::Store }
}

fn unusable(why: String) -> Result<(), Error> {
    Err(Error::Target { why })
}
