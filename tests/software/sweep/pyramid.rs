//! The pyramid holds the farthest of its pixels, whatever the size.

use glam::{Mat4, Vec3};
use tercet::geom::{DepthDirection, DepthFormat, Frustum, View, Viewport, projection};
use tercet::query::software::SoftwareQueries;
use tercet::query::{QueryBackend, Sweep, SweepTest, Ticket};
use tercet::scene::{Scene, SceneConfig};
use tercet::worlds;

const SIZES: [(u32, u32); 9] =
    [(1, 1), (1, 33), (33, 1), (2, 2), (3, 5), (17, 9), (65, 3), (160, 90), (421, 317)];

fn view(direction: DepthDirection, (width, height): (u32, u32)) -> View {
    let aspect = width as f32 / height as f32;
    let clip = match direction {
        DepthDirection::Reversed => projection::perspective(1.0, aspect, 0.1),
        DepthDirection::Standard => projection::perspective_standard(1.0, aspect, 0.1, 100.0),
    };
    let from_world: Mat4 =
        glam::camera::rh::view::look_at_mat4(Vec3::new(3.0, 4.0, 30.0), Vec3::ZERO, Vec3::Y);
    let view = View::new(from_world, clip, Viewport::new(width, height)).expect("a view");
    view.with_target(direction, DepthFormat::Depth32Float, 1)
}

#[test]
fn each_texel_is_the_farthest_of_its_pixels() {
    let model = worlds::random(4, 200);
    for direction in [DepthDirection::Reversed, DepthDirection::Standard] {
        for size in SIZES {
            let view = view(direction, size);
            let mut queries = SoftwareQueries::new();
            queries.begin(&view).expect("a frame");
            let draw = |pass: &mut tercet::query::software::SoftwarePass| {
                let placed = model.objects.iter();
                placed.for_each(|p| pass.draw_mesh(&model.meshes[p.mesh], &p.world_from_object));
            };
            queries.draw(draw).expect("draws");
            let (scene, frustum) = (Scene::new(SceneConfig::default()), Frustum::new(&view));
            let (scene, view, test) = (&scene, &view, SweepTest::HiZ);
            let sweep = Sweep { scene, view, frustum: &frustum, groups: &[], loose: &[], test };
            queries.sweep(Ticket(0), &sweep).expect("a sweep");
            let (depth, (width, height)) = (queries.depth(), size);
            let mut several = std::collections::BTreeSet::new();
            for (l, level) in queries.pyramid().levels().iter().enumerate() {
                let side = 2 << l;
                assert_eq!((level.width, level.height), (width.div_ceil(side), height.div_ceil(side)));
                for y in 0..level.height {
                    for x in 0..level.width {
                        let rows = y * side..((y + 1) * side).min(height);
                        let pixels =
                            rows.flat_map(|y| (x * side..((x + 1) * side).min(width)).map(move |x| (x, y)));
                        let farthest = pixels.map(|(x, y)| depth.at(x, y)).fold(f32::INFINITY, f32::min);
                        assert_eq!(level.at(x, y), farthest, "level {l} of {size:?} at ({x}, {y})");
                        several.insert(farthest.to_bits());
                    }
                }
            }
            let last = queries.pyramid().levels().last().map(|level| (level.width, level.height));
            assert_eq!(last, (size != (1, 1)).then_some((1, 1)));
            assert!(several.len() > 10 || width * height < 1000, "{size:?} shows nothing");
        }
    }
}
