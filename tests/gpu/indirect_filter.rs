//! Occluder filtering in frames that the device culls by itself: what is drawn first are those who owned a sample.

use glam::Vec3;
use tercet::geom::{Aabb, View, Viewport};
use tercet::query::SweepTest;
use tercet::query::gpu::{BatchMesh, IndirectConfig, IndirectCuller, Shaders};
use tercet::scene::{Batch, Scene, Traits};
use wgpu::util::DeviceExt;

use crate::support::{Gpu, depth_state, depth_texture, gpus, read_depth, read_texels, targets, texture};

const SCREEN: Viewport = Viewport::new(96, 54);
const IDS: wgpu::TextureFormat = wgpu::TextureFormat::Rg16Uint;
const FRAMES: usize = 8;

/// Tiles that face the eye, with who they are in the item buffer.
const SHADER: &str = "
    @group(0) @binding(0) var<uniform> clip_from_world: mat4x4<f32>;
    // Centers, and half sides.
    @group(0) @binding(1) var<storage, read> tiles: array<vec4<f32>>;
    struct Corner { @builtin(position) at: vec4<f32>, @location(0) @interpolate(flat) id: u32 }
    @vertex fn corner(@builtin(vertex_index) v: u32, @location(0) slot: u32) -> Corner {
        let tile = tiles[slot];
        let side = vec2<f32>(f32(v & 1u), f32(v >> 1u)) * 2.0 - 1.0;
        return Corner(clip_from_world * vec4<f32>(tile.xyz + vec3<f32>(side * tile.w, 0.0), 1.0), slot + 1u);
    }
    @fragment fn name(corner: Corner) -> @location(0) vec2<u32> {
        return vec2<u32>(corner.id & 0xffffu, corner.id >> 16u);
    }";

/// A wall over the left half, and tiles behind all of the screen whose boxes are larger than they are.
fn tiles() -> Vec<[f32; 4]> {
    let wall = [-12.0, 0.0, 0.0, 12.0];
    let behind = (0..200).map(|i| [(i % 20) as f32 - 9.6, (i / 20) as f32 - 4.6, -1.0, 0.2]);
    std::iter::once(wall).chain(behind).collect()
}

/// Draws the same view some times; how many were drawn first in the last frame of which that is known, how many
/// own a sample, and the depth.
fn run(gpu: &Gpu, samples: u32, shaders: Shaders, filters: bool) -> (u32, usize, Vec<f32>) {
    let view = View::look_at(Vec3::Z * 12.0, Vec3::ZERO, 50.0, 0.1, SCREEN).expect("a view");
    let view = view.clone().with_target(view.depth(), view.format(), samples);
    let tiles = tiles();
    let mut scene = Scene::new(Default::default());
    for &[x, y, z, half] in &tiles {
        let room = if half < 1.0 { 1.2 } else { half };
        let aabb = Aabb::from_center(Vec3::new(x, y, z), Vec3::new(room, room, 0.1));
        scene.insert(aabb, Traits { batch: Some(Batch(0)), ..Traits::default() });
    }
    scene.update();
    let buffer = |contents: &[u8], usage| {
        let descriptor = wgpu::util::BufferInitDescriptor { label: None, contents, usage };
        gpu.device.create_buffer_init(&descriptor)
    };
    let clip: [[f32; 4]; 4] = view.clip_from_world().as_mat4().to_cols_array_2d();
    let uniform = buffer(bytemuck::bytes_of(&clip), wgpu::BufferUsages::UNIFORM);
    let places = buffer(bytemuck::cast_slice(&tiles), wgpu::BufferUsages::STORAGE);
    let indices = buffer(bytemuck::cast_slice(&[0u32, 1, 2, 2, 1, 3]), wgpu::BufferUsages::INDEX);
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: None,
        source: wgpu::ShaderSource::Wgsl(SHADER.into()),
    });
    let slot = wgpu::VertexBufferLayout {
        array_stride: 4,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![0 => Uint32],
    };
    let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("corner"),
            compilation_options: Default::default(),
            buffers: &[Some(slot)],
        },
        primitive: Default::default(),
        depth_stencil: Some(depth_state(&view, true)),
        multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("name"),
            compilation_options: Default::default(),
            targets: &[Some(IDS.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let entries = [(0, &uniform), (1, &places)]
        .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
    let bindings = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    });
    let config = IndirectConfig { test: SweepTest::Raster, counters: true, shaders, ..Default::default() };
    let mut eye = IndirectCuller::new(&gpu.device, &gpu.queue, config).expect("a view");
    let depth = depth_texture(gpu, &view);
    let ids = texture(gpu, IDS, [depth.width(), depth.height()], samples);
    let named = ids.create_view(&Default::default());
    eye.target_ids(filters.then_some(&named));
    let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
    let targets = targets(&depth, false).with_color(named, clear);
    let mesh = BatchMesh { index_count: 6, ..BatchMesh::default() };
    let mut first = 0;
    for _ in 0..FRAMES {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let stats = eye
            .frame(&scene, &view, &targets, &[mesh], &mut encoder, |pass, batches| {
                pass.set_pipeline(&pipeline);
                pass.set_bind_group(0, &bindings, &[]);
                pass.set_index_buffer(indices.slice(..), wgpu::IndexFormat::Uint32);
                batches.iter().for_each(|batch| batch.draw(pass, 0));
            })
            .expect("a frame");
        gpu.queue.submit([encoder.finish()]);
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).expect("a poll");
        first = stats.drawn.map_or(first, |[first, ..]| first);
    }
    let mut owners = read_texels(gpu, &ids, &view, "texel.x | (texel.y << 16u)");
    owners.sort_unstable();
    owners.dedup();
    (first, owners.iter().filter(|&&id| id != 0).count(), read_depth(gpu, &depth, &view).values)
}

#[test]
fn who_owns_no_sample_is_not_drawn_first_again() {
    for gpu in gpus() {
        for &samples in gpu.sample_counts() {
            let (by_boxes, owners, whole) = run(&gpu, samples, Shaders::default(), false);
            let (filtered, same, shown) = run(&gpu, samples, Shaders::default(), true);
            println!("{:?}, {samples} samples: {by_boxes} by boxes, {filtered} of {owners}", gpu.backend);
            assert!(owners > 50 && by_boxes as usize > owners + 5, "{by_boxes} by boxes, {owners} owners");
            assert_eq!((filtered as usize, same), (owners, owners));
            assert!(shown == whole, "nothing is lost");
        }
    }
}

#[test]
fn wrong_filters_are_found_out() {
    let Some(gpu) = gpus().into_iter().next() else { return };
    for (from, to) in [
        ("owned[slot] != SEEN", "owned[slot] == SEEN"),
        ("remembered[slot] &= ~VISIBLE", "remembered[slot] |= VISIBLE"),
        ("slot < arrayLength(&owned)", "slot + 100u < arrayLength(&owned)"),
    ] {
        let mut shaders = Shaders::default();
        assert!(shaders.filter.contains(from), "{from:?} occurs nowhere");
        shaders.filter = shaders.filter.replace(from, to).into();
        let (filtered, owners, _) = run(&gpu, 1, shaders, true);
        assert_ne!(filtered as usize, owners, "{from:?} was not found out");
    }
}
