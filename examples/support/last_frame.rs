//! `last_frame.png`: gathers what each pixel of a frame shows, for [`picture`] to shade.

use std::path::Path;

use glam::{DVec4, Mat4, Vec3, camera};
use hecs::World;
use rayon::prelude::*;
use tercet::draw::Drawable;
use tercet::geom::{Aabb, View, Viewport, projection};
use tercet::query::QueryBackend;
use tercet::query::oracle::{self, Oracle};
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Scene, SceneObject};

use super::painter::Painter;
use super::picture::{self, Surface};

/// Texels a side of the sun's shadow map.
const SHADOW_SIDE: u32 = 8192;
/// Half the side of the square of texels that soften a shadow's edge.
const SOFTNESS: i32 = 2;

/// Draws the frame once more, whole and larger, and saves it into a folder that exists. Of a world that
/// is empty it shows the sky.
pub fn write(out: &Path, scene: &Scene, world: &World, view: &View, painter: &Painter) -> anyhow::Result<()> {
    let view = larger(view)?;
    let mut oracle = Oracle::new();
    oracle.look(scene, &view, |pass, objects| {
        painter.draw(world, &view, pass, objects);
    })?;
    let bounds = scene.objects().filter_map(|o| o.bounds).fold(Aabb::EMPTY, |all, b| all.union(&b));
    // Without a box in the scene, nothing says how wide the shadow map must be; and hardly a shadow falls.
    let sun = if bounds.is_empty() { None } else { Some(Sun::new(scene, world, &bounds, painter)?) };
    let (width, height) = (view.viewport().width, view.viewport().height);
    let mut colors = vec![None; scene.slot_bound()];
    for SceneObject { object, .. } in scene.objects() {
        colors[object.id.slot()] = world.get::<&Drawable>(object.entity()).ok().map(|d| d.color);
    }
    let surfaces: Vec<Option<Surface>> = (0..width * height)
        .into_par_iter()
        .map(|at| {
            let (x, y) = (at % width, at / width);
            let hit = oracle.surface(x, y)?;
            let color = colors[hit.object.id.slot()]?;
            Some(surface(&view, sun.as_ref(), (x, y), &hit, color))
        })
        .collect();
    let haze = 5.0 * bounds.size().length();
    picture::save(&out.join("last_frame.png"), &view, &surfaces, haze)
}

/// The same view with twice the pixels, as far as they fit: the picture is shrunk to smooth it.
fn larger(view: &View) -> anyhow::Result<View> {
    let side = |pixels: u32| (2 * pixels).min(Viewport::MAX_SIDE);
    let viewport = Viewport::new(side(view.viewport().width), side(view.viewport().height));
    let view = View::new(view.view_from_world(), view.clip_from_view(), viewport)?.with_target(
        view.depth(),
        view.format(),
        1,
    );
    Ok(view)
}

fn surface(
    view: &View,
    sun: Option<&Sun>,
    (x, y): (u32, u32),
    hit: &oracle::Surface,
    color: [u8; 3],
) -> Surface {
    let viewport = view.viewport();
    let ndc = DVec4::new(
        (f64::from(x) + 0.5) / f64::from(viewport.width) * 2.0 - 1.0,
        1.0 - (f64::from(y) + 0.5) / f64::from(viewport.height) * 2.0,
        // The way from nearness back to depth is the same negation.
        f64::from(view.depth().nearness(hit.nearness)),
        1.0,
    );
    let point = view.world_from_clip() * ndc;
    let position = (point.truncate() / point.w).as_vec3();
    let toward_eye = (view.eye().truncate() - position * view.eye().w).normalize_or_zero();
    let normal = hit.normal();
    let normal = if normal.dot(toward_eye) < 0.0 { -normal } else { normal };
    let sunlit = sun.map_or(1.0, |sun| sun.reaches(position, normal));
    Surface { position, normal, color, sunlit }
}

/// What the sun sees.
struct Sun {
    clip_from_world: Mat4,
    /// The side of a texel, metres.
    texel: f32,
    queries: SoftwareQueries,
}

impl Sun {
    /// A shadow map of everything in the scene.
    fn new(scene: &Scene, world: &World, bounds: &Aabb, painter: &Painter) -> anyhow::Result<Self> {
        let (center, radius) = (bounds.center(), 0.5 * bounds.size().length().max(1e-3));
        let toward = picture::toward_sun();
        let view_from_world =
            camera::rh::view::look_at_mat4(center + toward * (2.0 * radius), center, Vec3::Y);
        let clip_from_view = projection::orthographic(2.0 * radius, 2.0 * radius, 0.5 * radius, 3.5 * radius);
        let view = View::new(view_from_world, clip_from_view, Viewport::new(SHADOW_SIDE, SHADOW_SIDE))?;
        let mut queries = SoftwareQueries::new();
        let everything: Vec<_> = scene.objects().map(|o| o.object).collect();
        queries.begin(&view)?;
        queries.draw(|pass| {
            painter.draw(world, &view, pass, &everything);
        })?;
        queries.end()?;
        let clip_from_world = view.clip_from_world().as_mat4();
        Ok(Self { clip_from_world, texel: 2.0 * radius / SHADOW_SIDE as f32, queries })
    }

    /// How much of the sunlight arrives at a surface, 0 to 1.
    fn reaches(&self, position: Vec3, normal: Vec3) -> f32 {
        // Away from the surface by some texels, or it would shade itself.
        let lifted = position + normal * (2.5 * self.texel);
        let p = self.clip_from_world.project_point3(lifted);
        let bias = 1.5 * self.texel * self.clip_from_world.z_axis.z.abs();
        let depth = self.queries.depth();
        let last = SHADOW_SIDE as i32 - 1;
        let at = |ndc: f32| ((ndc * 0.5 + 0.5) * SHADOW_SIDE as f32) as i32;
        let (x, y) = (at(p.x), at(-p.y));
        let mut lit = 0;
        for dy in -SOFTNESS..=SOFTNESS {
            let row = (y + dy).clamp(0, last) as u32;
            for dx in -SOFTNESS..=SOFTNESS {
                let column = (x + dx).clamp(0, last) as u32;
                lit += i32::from(depth.at(column, row) <= p.z + bias);
            }
        }
        let side = 2 * SOFTNESS + 1;
        lit as f32 / (side * side) as f32
    }
}

#[cfg(test)]
mod tests {
    use tercet::draw::Detail;
    use tercet::scene::SceneConfig;

    use super::*;

    #[test]
    fn an_empty_world_shows_the_sky() {
        let folder = tempfile::tempdir().expect("a folder");
        let view = View::look_at(Vec3::ZERO, Vec3::NEG_Z, 60.0, 0.1, Viewport::new(32, 18)).expect("a view");
        let (scene, world) = (Scene::new(SceneConfig::default()), World::new());
        write(folder.path(), &scene, &world, &view, &Painter { detail: Detail::FULL }).expect("a picture");
        let picture = image::open(folder.path().join("last_frame.png")).expect("it was written").into_rgb8();
        assert_eq!(picture.dimensions(), (32, 18));
        let [top, bottom] = [0, 17].map(|y| picture.get_pixel(16, y).0);
        assert!(top[2] > top[0] && bottom[0] > top[0], "blue above, paler below: {top:?}, {bottom:?}");
    }
}
