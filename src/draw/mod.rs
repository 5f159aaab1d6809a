//! What the app sees: drawable things, how finely they are drawn, and a renderer for them.

mod detail;
mod drawable;
#[cfg(feature = "gpu")]
pub mod renderer;

pub use detail::Detail;
pub use drawable::Drawable;
#[cfg(feature = "gpu")]
pub use renderer::{BySlot, Drawn, Lines, Renderer, RendererStats, Shading};
