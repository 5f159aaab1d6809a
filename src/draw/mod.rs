//! What the app sees: drawable things and how finely they are drawn.

mod detail;
mod drawable;

pub use detail::Detail;
pub use drawable::Drawable;
