//! What happens to one view of a scene, frame after frame: what is drawn, what is said of it, what is
//! remembered, and what may be given up.

mod audit;
#[path = "../support/boxes.rs"]
mod boxes;
mod driver;
#[path = "../support/painter.rs"]
mod painter;
#[cfg(feature = "record")]
mod record;
#[path = "../support/stage.rs"]
mod stage;
mod stale;
mod tradeoff;
mod unused;
mod why;

use glam::Vec3;
use tercet::geom::Viewport;
use tercet::scene::mesh::Mesh;

/// Small: a frame is mostly culling.
const SCREEN: Viewport = Viewport::new(160, 90);

/// A square of side 2 about the origin that faces the camera.
fn square() -> Mesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let corners = corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec();
    Mesh::new("square", corners, vec![0, 1, 2, 0, 2, 3]).expect("a sound mesh")
}
