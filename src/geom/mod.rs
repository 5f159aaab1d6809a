//! Boxes, views, frustums and what a box looks like on the screen.
//!
//! Every bound in this folder rounds **outward**: a box may be found a little larger, nearer or
//! more visible than it is, never the opposite.

mod aabb;
mod coefficients;
mod frustum;
mod group;
mod outline;
mod pixel_rect;
mod project;
pub mod projection;
mod proxy;
mod silhouette;
mod support;
mod view;

pub use aabb::Aabb;
pub use frustum::{Frustum, PlaneMask};
pub use outline::ScreenOutline;
pub use pixel_rect::PixelRect;
pub(crate) use project::uncertainty;
pub use project::{Projected, ScreenRect, project};
pub use proxy::{Proxy, Question};
#[cfg(feature = "gpu")]
pub(crate) use silhouette::SILHOUETTES;
pub(crate) use support::Support;
pub use view::{DepthDirection, DepthFormat, View, Viewport};
