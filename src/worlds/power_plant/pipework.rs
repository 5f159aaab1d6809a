//! Pipes and what sits on them: shared meshes with levels of detail. Pipes run along x about the
//! origin. Metres.

use glam::Vec3;

use super::super::shape::{Coarseness, Shape, Stand, mesh, sagitta, turn};
use super::parts::v;
use crate::scene::mesh::Mesh;

/// A pipe along x about the origin, flanged at both ends and in the middle.
pub(super) fn pipe(name: &str, radius: f32, long: f32) -> Mesh {
    mesh(name, 4, |s, c| {
        let start = v(-0.5 * long, 0.0, 0.0);
        s.cylinder(Stand::x(start), radius, long, c.segments(32));
        for x in [0.0, 0.5 * long - 0.06, long - 0.12] {
            flange(s, c, start + Vec3::X * x, radius, 0.12);
        }
    })
}

/// A bolted collar around a pipe along x.
fn flange(s: &mut Shape, c: Coarseness, at: Vec3, pipe: f32, thick: f32) {
    let radius = pipe * 1.35 + 0.03;
    s.cylinder(Stand::x(at), radius, thick, c.segments(32));
    let bolt = 0.08 * radius;
    if c.finer_than(2) {
        for k in 0..12 {
            let (cos, sin) = turn(k, 12);
            let center = at + v(-bolt, cos * (radius - 1.3 * bolt), sin * (radius - 1.3 * bolt));
            s.cylinder(Stand::x(center), bolt, thick + 2.0 * bolt, c.segments(8));
        }
    } else {
        // Bolts stand out from the collar, which has receded itself.
        s.off_by(bolt + sagitta(radius, c.segments(32)));
    }
}

/// A quarter bend: enters along +x, leaves along +z, about the corner of its bay.
pub(super) fn elbow(name: &str, radius: f32) -> Mesh {
    mesh(name, 4, |s, c| {
        let wide = 3.0 * radius;
        s.bend(v(0.0, 0.0, wide), wide, radius, [c.segments(16), c.segments(32)]);
        flange(s, c, v(-0.12, 0.0, 0.0), radius, 0.12);
    })
}

/// A gate valve on a pipe along x, with bonnet, stem and hand wheel.
pub(super) fn valve(name: &str, pipe: f32) -> Mesh {
    mesh(name, 4, |s, c| {
        let long = 3.2 * pipe;
        flange(s, c, v(-long, 0.0, 0.0), pipe, 0.4 * pipe);
        flange(s, c, v(long - 0.4 * pipe, 0.0, 0.0), pipe, 0.4 * pipe);
        s.cylinder(Stand::x(v(-long, 0.0, 0.0)), 1.05 * pipe, 2.0 * long, c.segments(32));
        s.vessel(Stand::y(v(0.0, -1.6 * pipe, 0.0)), 1.5 * pipe, 3.2 * pipe, c.segments(24));
        s.cylinder(Stand::y(v(0.0, 1.5 * pipe, 0.0)), 0.8 * pipe, 1.8 * pipe, c.segments(24));
        s.cylinder(Stand::y(v(0.0, 3.2 * pipe, 0.0)), 0.2 * pipe, 2.2 * pipe, c.segments(12));
        hand_wheel(s, c, v(0.0, 5.0 * pipe, 0.0), 1.8 * pipe);
    })
}

fn hand_wheel(s: &mut Shape, c: Coarseness, at: Vec3, radius: f32) {
    s.torus(Stand::y(at), radius, 0.09 * radius, [c.segments(32), c.segments(12)]);
    let spoke = 0.06 * radius;
    s.cuboid(at - v(radius, spoke, spoke), at + v(radius, spoke, spoke));
    s.cuboid(at - v(spoke, spoke, radius), at + v(spoke, spoke, radius));
}

/// A small instrument on a stalk.
pub(super) fn gauge() -> Mesh {
    mesh("gauge", 3, |s, c| {
        s.cylinder(Stand::y(v(0.0, 0.0, 0.0)), 0.03, 1.1, c.segments(12));
        s.cylinder(Stand::z(v(0.0, 1.25, -0.06)), 0.18, 0.12, c.segments(32));
        s.torus(Stand::z(v(0.0, 1.25, 0.06)), 0.17, 0.02, [c.segments(32), c.segments(8)]);
        s.cuboid(v(-0.12, 0.0, -0.12), v(0.12, 0.04, 0.12));
    })
}
