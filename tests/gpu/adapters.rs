//! Which adapters the other tests have run on.

use tercet::Error;
use tercet::query::gpu::{Counting, GpuConfig, GpuQueries, Shader, Shaders};

use crate::support::{gpus, skip};

/// Vulkan and OpenGL differ in what they can do, and only both together run all of the backend.
#[test]
fn both_apis_are_there_unless_one_was_chosen() {
    if cfg!(not(target_os = "linux")) || wgpu::Backends::from_env().is_some() {
        return;
    }
    let there = gpus();
    for needed in [wgpu::Backend::Vulkan, wgpu::Backend::Gl] {
        if there.iter().all(|gpu| gpu.backend != needed) {
            skip(&format!("there is no adapter for {needed:?}"));
        }
    }
}

/// The default takes what a device has: subgroups, or else workgroups without.
#[test]
fn the_best_way_of_counting_is_chosen() {
    for gpu in gpus() {
        let has_subgroups = Counting::Subgroups.is_supported(&gpu.device);
        let refused = |broken: fn(&mut Shaders) -> &mut Shader| {
            let mut shaders = Shaders::default();
            broken(&mut shaders).single = "no WGSL".into();
            let config = GpuConfig { shaders, ..GpuConfig::default() };
            let queries = GpuQueries::with_config(&gpu.device, &gpu.queue, config);
            matches!(queries, Err(Error::Device { .. }))
        };
        assert_eq!(refused(|shaders| &mut shaders.count_subgroups), has_subgroups, "{:?}", gpu.backend);
        assert_eq!(refused(|shaders| &mut shaders.count_workgroups), !has_subgroups, "{:?}", gpu.backend);
        assert!(refused(|shaders| &mut shaders.count_blocks), "{:?}", gpu.backend);
        assert!(!refused(|shaders| &mut shaders.count_fragments), "{:?}", gpu.backend);
    }
}
