//! What surfaces and overlays look like.

use glam::{Affine3A, Mat4, Vec2, Vec3};
use hecs::World;
use tercet::draw::{Detail, Drawable, Drawn, Lines, Renderer, Shading};
use tercet::geom::{Aabb, ScreenOutline, View};
use tercet::query::QueryBackend;
use tercet::query::gpu::GpuQueries;
use tercet::scene::Bounds;
use tercet::scene::mesh::Mesh;
use wgpu::TextureFormat;

use crate::pixels::{Target, objects, shoot};
use crate::support::gpus;
use crate::uploads::{flat_view, tile};

const SIDE: u32 = 16;

fn put(world: &mut World, mesh: &Mesh, world_from_object: Affine3A, color: [u8; 3]) {
    let bounds = Bounds(mesh.bounds_under(&world_from_object));
    world.spawn((bounds, Drawable { mesh: mesh.clone(), world_from_object, color }));
}

/// A square that fills the view.
fn wall(world: &mut World, z: f32, color: [u8; 3]) {
    let scale = Affine3A::from_scale(Vec3::new(SIDE as f32, SIDE as f32, 1.0));
    put(world, &tile("wall"), Affine3A::from_translation(Vec3::Z * z) * scale, color);
}

#[test]
fn colours_arrive_to_the_byte_and_tints_lie_over_them() {
    let (view, mesh) = (flat_view(SIDE), tile("tile"));
    let mut world = World::new();
    for i in 0..SIDE * SIDE {
        let place = Vec3::new((i % SIDE) as f32, (SIDE - 1 - i / SIDE) as f32, 0.0);
        put(&mut world, &mesh, Affine3A::from_translation(place), [i as u8, 255 - i as u8, 7]);
    }
    for gpu in gpus() {
        let all = objects(&world);
        for (alpha, mixed) in [(0, [0, 255, 7]), (255, [50, 60, 70]), (128, [25, 157, 39])] {
            let shot = shoot(&gpu, &view, Shading::Unlit, |renderer, pass| {
                let tint = |&object: &_| (object, [50, 60, 70, alpha]);
                renderer.draw_tinted(pass, &world, all.iter().map(tint));
            });
            let [r, g, b, a] = shot.colors[0].to_le_bytes();
            assert_eq!(([r, g, b], a), (mixed, 255), "alpha {alpha}");
            if alpha == 0 {
                for (i, color) in shot.colors.iter().enumerate() {
                    assert_eq!(color.to_le_bytes(), [i as u8, 255 - i as u8, 7, 255]);
                }
            }
        }
    }
}

/// A target that encodes colours itself gets linear ones; read back, they are linear.
#[test]
fn srgb_targets_take_linear_colours() {
    let view = flat_view(SIDE);
    let mut world = World::new();
    wall(&mut world, 0.0, [255, 188, 0]);
    for gpu in gpus() {
        let format = TextureFormat::Rgba8UnormSrgb;
        let mut queries = GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend");
        let mut renderer = Renderer::new(&gpu.device, &gpu.queue, Some(format)).expect("a renderer");
        let target = Target::with_format(&gpu, &view, format);
        queries.target(&target.frame_targets());
        renderer.begin(&view, Detail::FULL, Shading::Unlit);
        queries.begin(&view).expect("begin");
        let mut drawn = Drawn::default();
        queries.draw(|pass| drawn = renderer.draw(pass, &world, &objects(&world))).expect("draw");
        assert_eq!(drawn.triangles, 2);
        queries.end().expect("end");
        let [r, g, b, _] = target.shot(&gpu, &view).colors[0].to_le_bytes();
        // The byte 188 stands for half of the light.
        assert!(r == 255 && g.abs_diff(128) <= 1 && b == 0, "{r} {g} {b}");
    }
}

/// Winding, mirroring transforms and mirroring views do not matter: what faces the same way is lit
/// the same way.
#[test]
fn both_sides_are_lit_alike() {
    let corners = tile("tile").levels()[0].positions.clone();
    let other_way = Mesh::new("other way", corners, vec![0, 2, 1, 0, 3, 2]).expect("a mesh");
    let middle = 0.5 * SIDE as f32;
    let big = Affine3A::from_scale(Vec3::splat(4.0 * SIDE as f32))
        * Affine3A::from_translation(Vec3::new(-0.5, -0.5, 0.0));
    let at = Affine3A::from_translation(Vec3::new(middle, middle, 0.0));
    let tilt = Affine3A::from_rotation_x(-0.7) * big;
    let mirrored = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let plain = flat_view(SIDE);
    let flip = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let seen_mirrored = View::new(flip * plain.view_from_world(), plain.clip_from_view(), plain.viewport());
    let seen_mirrored = seen_mirrored.expect("a view");
    for gpu in gpus() {
        let color = |mesh: &Mesh, place: Affine3A, view: &View| {
            let mut world = World::new();
            put(&mut world, mesh, place, [200, 180, 160]);
            let shot = shoot(&gpu, view, Shading::Lit, |renderer, pass| {
                renderer.draw(pass, &world, &objects(&world));
            });
            shot.colors[shot.colors.len() / 2 + SIDE as usize / 2]
        };
        let want = color(&tile("tile"), at * tilt, &plain);
        let steep = color(&tile("tile"), at * Affine3A::from_rotation_x(0.7) * big, &plain);
        assert!(want != 0 && want != steep, "what faces up is lit otherwise: {want:x}, {steep:x}");
        for mesh in [&tile("tile"), &other_way] {
            for place in [at * tilt, at * mirrored * tilt] {
                for view in [&plain, &seen_mirrored] {
                    assert_eq!(color(mesh, place, view), want, "{} at {place:?}", mesh.name());
                }
            }
        }
    }
}

/// More look-ups, other colours; none, the same as ever. The depth knows nothing of them.
#[test]
fn look_ups_mottle_what_is_lit() {
    let view = flat_view(SIDE);
    let mut world = World::new();
    wall(&mut world, 0.0, [200, 180, 160]);
    for gpu in gpus() {
        let looked = |look_ups| {
            shoot(&gpu, &view, Shading::Lit, |renderer, pass| {
                renderer.set_look_ups(look_ups);
                renderer.draw(pass, &world, &objects(&world));
            })
        };
        let different = |mut colors: Vec<u32>| {
            colors.sort_unstable();
            colors.dedup();
            colors.len()
        };
        let [none, one, forty] = [0, 1, 40].map(looked);
        assert_eq!(different(none.colors), 1);
        assert!(different(one.colors.clone()) > 8 && different(forty.colors.clone()) > 8);
        assert_ne!(one.colors, forty.colors);
        assert_eq!(forty.colors, looked(40).colors);
        assert!(none.nearness == one.nearness && one.nearness == forty.nearness);
    }
}

#[test]
fn overdraw_counts_every_layer_and_keeps_the_nearest_depth() {
    let view = flat_view(SIDE);
    for gpu in gpus() {
        for order in [[0.0, 5.0, 10.0], [10.0, 5.0, 0.0], [5.0, 10.0, 0.0]] {
            let mut world = World::new();
            order.iter().for_each(|&z| wall(&mut world, z, [9; 3]));
            let layers = shoot(&gpu, &view, Shading::Overdraw, |renderer, pass| {
                let drawn = renderer.draw(pass, &world, &objects(&world));
                assert_eq!((drawn.triangles, drawn.instances, drawn.draws), (6, 3, 6));
            });
            let lit = shoot(&gpu, &view, Shading::Lit, |renderer, pass| {
                renderer.draw(pass, &world, &objects(&world));
            });
            assert_eq!(layers.nearness, lit.nearness);
            let three = [3 * 24, 3 * 10, 3 * 4, 0];
            assert!(layers.colors.iter().all(|color| color.to_le_bytes() == three));
        }
    }
}

/// Shadow maps have the depth that pictures have.
#[test]
fn depth_alone_is_the_same_depth() {
    let view =
        View::look_at(Vec3::new(3.0, 4.0, 9.0), Vec3::splat(0.5), 20.0, 0.1, flat_view(SIDE).viewport());
    let view = view.expect("a view");
    let mut world = World::new();
    for n in 0..20 {
        let turn = Affine3A::from_rotation_y(n as f32) * Affine3A::from_rotation_x(0.3 * n as f32);
        put(&mut world, &tile("tile"), turn, [255; 3]);
    }
    for gpu in gpus() {
        let mut queries = GpuQueries::new(&gpu.device, &gpu.queue).expect("a backend");
        let mut renderer = Renderer::new(&gpu.device, &gpu.queue, None).expect("a renderer");
        let target = Target::new(&gpu, &view);
        queries.target(&target.depth_targets());
        renderer.begin(&view, Detail::FULL, Shading::Lit);
        queries.begin(&view).expect("begin");
        let record = |pass: &mut _| {
            let drawn = renderer.draw(pass, &world, &objects(&world));
            assert_eq!(drawn.instances, 20);
            // Without a colour there is nothing to see of these.
            renderer.draw_boxes(pass, &[(Aabb::new(Vec3::ZERO, Vec3::ONE), [255; 4])], Lines::XRay);
        };
        queries.draw(record).expect("draw");
        queries.end().expect("end");
        let lit = shoot(&gpu, &view, Shading::Lit, |renderer, pass| {
            renderer.draw(pass, &world, &objects(&world));
        });
        assert_eq!(target.shot(&gpu, &view).nearness, lit.nearness);
        assert!(lit.nearness.iter().any(|&nearness| nearness > 0.0));
    }
}

#[test]
fn boxes_are_hidden_or_shine_through() {
    let view = flat_view(SIDE);
    let mut world = World::new();
    wall(&mut world, 0.0, [0; 3]);
    let red = [255, 0, 0, 255];
    let aabb = |z: f32| Aabb::new(Vec3::new(2.5, 3.5, z - 1.0), Vec3::new(9.5, 12.5, z));
    for gpu in gpus() {
        for (z, lines, want) in
            [(-5.0, Lines::DepthTested, 0), (5.0, Lines::DepthTested, 32), (-5.0, Lines::XRay, 32)]
        {
            let shot = shoot(&gpu, &view, Shading::Unlit, |renderer, pass| {
                renderer.draw(pass, &world, &objects(&world));
                let nowhere = Aabb::new(Vec3::NAN, Vec3::ONE);
                renderer.draw_boxes(pass, &[(nowhere, red), (aabb(z), red)], lines);
                renderer.draw_boxes(pass, &[], lines);
            });
            let seen = shot.colors.iter().filter(|color| color.to_le_bytes() == red).count();
            // A frame of 8 × 10 pixels, of which rasterisers may leave out some ends.
            assert!(seen.abs_diff(want) <= 4, "{z} {lines:?}: {seen} pixels");
        }
    }
}

#[test]
fn outlines_lie_over_everything() {
    let view = flat_view(SIDE);
    let mut world = World::new();
    wall(&mut world, 40.0, [0; 3]);
    let points = [[2.0, 3.0], [10.0, 3.0], [10.0, 9.0], [2.0, 9.0]].map(Vec2::from_array).to_vec();
    for gpu in gpus() {
        let shot = shoot(&gpu, &view, Shading::Unlit, |renderer, pass| {
            renderer.draw(pass, &world, &objects(&world));
            let nothing = ScreenOutline::default();
            let outline = ScreenOutline { points: points.clone() };
            renderer.draw_outlines(pass, &[(nothing, [1; 4]), (outline, [0, 200, 0, 102])]);
        });
        let pixel = |x: usize, y: usize| shot.colors[y * SIDE as usize + x].to_le_bytes();
        // Two fifths of 200.
        assert_eq!(pixel(6, 6)[..3], [0, 80, 0]);
        assert_eq!(pixel(12, 6)[..3], [0, 0, 0]);
        assert_eq!(pixel(6, 12)[..3], [0, 0, 0], "y goes down");
        let border = shot.colors.iter().filter(|color| color.to_le_bytes()[1] == 200).count();
        assert!((20..=36).contains(&border), "{border}");
    }
}

#[test]
fn formats_that_cannot_be_drawn_to_are_refused() {
    for gpu in gpus() {
        let formats = [TextureFormat::Depth32Float, TextureFormat::R8Unorm, TextureFormat::Rgba8Uint];
        for format in formats {
            let error = Renderer::new(&gpu.device, &gpu.queue, Some(format)).expect_err("unusable");
            assert!(error.to_string().contains(&format!("{format:?}")), "{error}");
        }
    }
}
