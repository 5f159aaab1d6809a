//! How finely a mesh is drawn: levels of detail by projected error.

use glam::{Affine3A, DVec3, DVec4, Vec3A};

use crate::geom::View;
use crate::scene::mesh::Mesh;

/// The accuracy that a frame is drawn with. The level follows from the object and the view
/// alone, never from history: every algorithm draws the same triangles for the same frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// How far a drawn surface may lie from the true one, in pixels along either axis of the
    /// screen. Zero, a negative number or NaN: always the finest level.
    pub max_error_px: f32,
}

impl Default for Detail {
    /// One pixel.
    fn default() -> Self {
        Self { max_error_px: 1.0 }
    }
}

impl Detail {
    /// Always the finest level.
    pub const FULL: Self = Self { max_error_px: 0.0 };

    /// The coarsest level whose error stays within [`Detail::max_error_px`] at the object's
    /// point that is nearest to the eye; level 0 when none does, when the object reaches behind
    /// the eye's plane, or when a number is not finite. O(levels).
    pub fn level(&self, mesh: &Mesh, world_from_object: &Affine3A, view: &View) -> usize {
        let levels = mesh.levels();
        if levels.len() == 1 || self.max_error_px.is_nan() || self.max_error_px <= 0.0 {
            return 0;
        }
        let px_per_metre = pixels_per_metre(mesh, world_from_object, view) * largest_scale(world_from_object);
        // A NaN fails the comparison, and so does infinity.
        let fits = |error: f32| f64::from(error) * px_per_metre <= f64::from(self.max_error_px);
        levels.iter().rposition(|level| fits(level.error)).unwrap_or(0)
    }
}

/// How many pixels a world-space displacement of one metre can move a point of the object on the
/// screen, along x or along y; infinite when the object reaches behind the eye's plane.
///
/// With clip coordinates `x(p)` and `w(p)`, both affine in p, the screen's abscissa is
/// `W/2 · x/w`, and its gradient `W/2 · (∇x − u·∇w) / w` with `u = x/w`. A point on the screen
/// has |u| ≤ 1, and the length of the bracket is convex in u: its greatest value lies at u = ±1.
/// An orthographic view has ∇w = 0 and w = 1, and needs no case of its own.
fn pixels_per_metre(mesh: &Mesh, world_from_object: &Affine3A, view: &View) -> f64 {
    let clip = view.clip_from_world();
    let (x, y, w) = (clip.row(0), clip.row(1), clip.row(3));
    let nearest_w = least(w, mesh, world_from_object);
    if nearest_w.is_nan() || nearest_w <= 0.0 {
        return f64::INFINITY;
    }
    let slope = |row: DVec4| {
        let (row, w) = (row.truncate(), w.truncate());
        (row - w).length().max((row + w).length())
    };
    let viewport = view.viewport();
    let pixels = (slope(x) * f64::from(viewport.width)).max(slope(y) * f64::from(viewport.height));
    0.5 * pixels / nearest_w
}

/// The least value of an affine function over the object's world box.
fn least(row: DVec4, mesh: &Mesh, world_from_object: &Affine3A) -> f64 {
    let bounds = mesh.bounds().transformed(world_from_object);
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let slope = row.truncate();
    let corner = DVec3::select(slope.cmpge(DVec3::ZERO), min, max);
    slope.dot(corner) + row.w
}

/// An upper bound on how much a transform can stretch a length: the largest singular value is
/// at most the root of the largest absolute row sum of the Gram matrix, and equals it for a
/// rotation with uniform scale.
fn largest_scale(world_from_object: &Affine3A) -> f64 {
    let m = &world_from_object.matrix3;
    let columns = [m.x_axis, m.y_axis, m.z_axis].map(|c: Vec3A| c.as_dvec3());
    let row_sum = |a: DVec3| columns.iter().map(|&b| a.dot(b).abs()).sum::<f64>();
    let gram = columns.map(row_sum);
    // `fold` with a comparison that keeps NaN: an object that is nowhere is drawn in full.
    gram.into_iter().fold(0.0, |most: f64, g| if g <= most { most } else { g }).sqrt()
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Quat, Vec3};

    use super::*;
    use crate::geom::{Viewport, projection};
    use crate::scene::mesh::Level;

    const ERRORS: [f32; 6] = [0.0, 0.01, 0.02, 0.04, 0.08, 0.16];

    /// A triangle of side 1 whose levels claim growing errors.
    fn mesh() -> Mesh {
        let level =
            |error| Level { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], indices: vec![0, 1, 2], error };
        Mesh::with_levels("triangle", ERRORS.map(level).to_vec()).unwrap()
    }

    fn view(eye: Vec3) -> View {
        View::look_at(eye, eye + Vec3::NEG_Z, 70.0, 0.1, Viewport::new(640, 480)).unwrap()
    }

    fn orthographic(metres: f32) -> View {
        let view = glam::camera::rh::view::look_at_mat4(Vec3::Z * 50.0, Vec3::ZERO, Vec3::Y);
        View::new(view, projection::orthographic(metres, metres, 0.1, 100.0), Viewport::new(500, 500))
            .unwrap()
    }

    fn at(translation: Vec3) -> Affine3A {
        Affine3A::from_translation(translation)
    }

    fn pixel(view: &View, p: DVec3) -> DVec3 {
        let clip = *view.clip_from_world() * p.extend(1.0);
        let ndc = clip.truncate() / clip.w;
        let size = DVec3::new(f64::from(view.viewport().width), f64::from(view.viewport().height), 0.0);
        ndc * size * 0.5
    }

    /// Moves points of the object by the error of the chosen level, in many directions: on the
    /// screen none moves farther than allowed, and some move nearly as far.
    #[test]
    fn the_error_stays_within_the_limit_and_comes_near_it() {
        let mesh = mesh();
        let mut nearest_to_limit = 0.0f64;
        for n in 1..400 {
            let turn = Quat::from_euler(glam::EulerRot::XYZ, n as f32, n as f32 * 0.7, n as f32 * 0.3);
            let place = Vec3::new((n % 7) as f32 - 3.0, (n % 5) as f32 - 2.0, -2.0 - n as f32 * 0.3);
            let size = 0.2 + (n % 9) as f32 * 0.2;
            let object = Affine3A::from_scale_rotation_translation(Vec3::splat(size), turn, place);
            for view in [view(Vec3::ZERO), orthographic(10.0)] {
                let detail = Detail { max_error_px: 1.5 };
                let metres = f64::from(ERRORS[detail.level(&mesh, &object, &view)] * size);
                for p in &mesh.levels()[0].positions {
                    let p = object.transform_point3(*p).as_dvec3();
                    let ndc = view.clip_from_world().project_point3(p);
                    if ndc.x.abs() > 1.0 || ndc.y.abs() > 1.0 {
                        continue;
                    }
                    for k in 0..64 {
                        let angle = f64::from(k) * 0.7;
                        let direction = DVec3::new(angle.cos(), angle.sin(), (angle * 1.3).sin()).normalize();
                        // Differential, as the bound is: a thousandth of the way, times a thousand.
                        let way = pixel(&view, p + direction * metres * 1e-3) - pixel(&view, p);
                        let way = way.x.abs().max(way.y.abs()) * 1e3;
                        assert!(way <= 1.5 * 1.001, "{way} px at {p}, error {metres}");
                        nearest_to_limit = nearest_to_limit.max(way);
                    }
                }
            }
        }
        assert!(nearest_to_limit > 1.0, "never more than {nearest_to_limit} px: the bound is too careful");
    }

    #[test]
    fn detail_falls_with_distance_and_size() {
        let (mesh, view) = (mesh(), view(Vec3::ZERO));
        let level = |z: f32| Detail::default().level(&mesh, &at(Vec3::new(0.0, 0.0, z)), &view);
        assert_eq!(level(-1.0), 0);
        assert_eq!(level(-1000.0), ERRORS.len() - 1);
        assert!((1..200).all(|z| level(-(z as f32)) <= level(-(z as f32) - 1.0)));
        let double = Affine3A::from_scale(Vec3::splat(2.0));
        let far = at(Vec3::NEG_Z * 20.0);
        assert!(
            Detail::default().level(&mesh, &(far * double), &view)
                < Detail::default().level(&mesh, &far, &view)
        );
    }

    #[test]
    fn an_orthographic_view_looks_the_same_at_every_depth() {
        let mesh = mesh();
        let level = |z: f32, metres| Detail::default().level(&mesh, &at(Vec3::Z * z), &orthographic(metres));
        assert_eq!(level(40.0, 20.0), level(-40.0, 20.0));
        assert_eq!((level(0.0, 1.0), level(0.0, 20.0), level(0.0, 1e4)), (0, 3, ERRORS.len() - 1));
    }

    #[test]
    fn whatever_cannot_be_judged_is_drawn_in_full() {
        let (mesh, far) = (mesh(), at(Vec3::NEG_Z * 1000.0));
        let ask = |detail: Detail, object: &Affine3A, eye: Vec3| detail.level(&mesh, object, &view(eye));
        let one = Detail::default();
        assert_ne!(ask(one, &far, Vec3::ZERO), 0, "the object itself can be judged");
        for px in [0.0, -1.0, f32::NAN] {
            assert_eq!(ask(Detail { max_error_px: px }, &far, Vec3::ZERO), 0);
        }
        assert_eq!(ask(Detail::FULL, &far, Vec3::ZERO), 0);
        assert_eq!(ask(one, &Affine3A::IDENTITY, Vec3::new(0.3, 0.3, 0.0)), 0, "the eye is in the box");
        assert_eq!(ask(one, &at(Vec3::Z * 5.0), Vec3::ZERO), 0, "behind the eye");
        for bad in [f32::NAN, f32::INFINITY] {
            assert_eq!(ask(one, &at(Vec3::new(0.0, bad, -1000.0)), Vec3::ZERO), 0);
            assert_eq!(
                ask(
                    one,
                    &(far * Affine3A::from_mat4(Mat4::from_scale(Vec3::new(bad, 1.0, 1.0)))),
                    Vec3::ZERO
                ),
                0
            );
        }
        let infinite = Detail { max_error_px: f32::INFINITY };
        assert_eq!(ask(infinite, &far, Vec3::ZERO), ERRORS.len() - 1);
    }
}
