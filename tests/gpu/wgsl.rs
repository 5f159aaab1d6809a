//! Every shader by itself, without a device: it is valid WGSL that needs no optional capability,
//! and it can be written as the GLSL that OpenGL takes. That of subgroups needs theirs, which OpenGL
//! has not.

use tercet::query::gpu::{Counting, Shaders};
use wgpu::naga::back::glsl;
use wgpu::naga::front::wgsl;
use wgpu::naga::proc::BoundsCheckPolicies;
use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};
use wgpu::naga::{Module, ShaderStage};

/// All sources, and what each needs.
fn sources() -> Vec<(String, Capabilities)> {
    let shaders = Shaders::default();
    let mut all = Vec::new();
    for several in [false, true] {
        all.extend(Counting::ALL.map(|counting| {
            let subgroups = counting == Counting::Subgroups;
            let needs = if subgroups { Capabilities::SUBGROUP } else { Capabilities::empty() };
            (shaders.source(counting, several).to_owned(), needs)
        }));
        all.push((shaders.gather_blocks_source(several).to_owned(), Capabilities::empty()));
        let Shaders { sweep_raster, sweep_rays, sweep_owners, build_pyramid, sweep_hi_z, prune, .. } =
            &shaders;
        let sweeps = [sweep_raster, sweep_rays, sweep_owners, build_pyramid, sweep_hi_z, prune];
        for shader in sweeps {
            all.push((shader.source(several).to_owned(), Capabilities::empty()));
        }
    }
    let Shaders { ask_natively, project, enclose, enlist, .. } = shaders;
    let Shaders { mark, extract, spread, select, filter, compact, .. } = Shaders::default();
    for source in [ask_natively, project, enclose, enlist, mark, extract, spread, select, filter, compact] {
        all.push((source.into_owned(), Capabilities::empty()));
    }
    all
}

fn parse(source: &str) -> Module {
    wgsl::parse_str(source).unwrap_or_else(|error| panic!("{}", error.emit_to_string(source)))
}

#[test]
fn shaders_are_valid_and_portable() {
    let mut entries = 0;
    for (source, needs) in sources() {
        let module = parse(&source);
        let info = Validator::new(ValidationFlags::all(), needs)
            .validate(&module)
            .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)));
        for entry in &module.entry_points {
            entries += 1;
            if !needs.is_empty() {
                continue;
            }
            let options = glsl::Options {
                version: glsl::Version::Embedded { version: 310, is_webgl: false },
                ..glsl::Options::default()
            };
            let pipeline = glsl::PipelineOptions {
                shader_stage: entry.stage,
                entry_point: entry.name.clone(),
                multiview: None,
            };
            let mut out = String::new();
            let policies = BoundsCheckPolicies::default();
            let writer = glsl::Writer::new(&mut out, &module, &info, &options, &pipeline, policies);
            let written = writer.and_then(|mut writer| writer.write());
            written.unwrap_or_else(|error| panic!("{} of {:?}: {error}", entry.name, entry.stage));
            assert!(out.contains("void main()"));
        }
    }
    assert_eq!(
        entries, 51,
        "twice each: four vertex, three fragment and eleven compute stages; two of native queries, and \
         thirteen more that read no depth"
    );
}

/// The Rust side starts stages by these names and sizes.
#[test]
fn entry_points_are_what_the_passes_start() {
    let native = parse(&Shaders::default().ask_natively).entry_points;
    let stages: Vec<_> = native.iter().map(|e| (e.name.as_str(), e.stage)).collect();
    assert_eq!(stages, [("rectangle", ShaderStage::Vertex), ("sight", ShaderStage::Fragment)]);
    let of = |counting, several| parse(Shaders::default().source(counting, several)).entry_points;
    for several in [false, true] {
        let fragments = of(Counting::Fragments, several);
        let stages: Vec<_> = fragments.iter().map(|e| (e.name.as_str(), e.stage)).collect();
        assert_eq!(stages, [("rectangle", ShaderStage::Vertex), ("count", ShaderStage::Fragment)]);
        for counting in [Counting::Workgroups, Counting::Subgroups, Counting::Blocks] {
            let count = &of(counting, several)[0];
            assert_eq!((count.name.as_str(), count.workgroup_size), ("count", [8, 8, 1]));
        }
        let gather = &parse(Shaders::default().gather_blocks_source(several)).entry_points[0];
        assert_eq!((gather.name.as_str(), gather.workgroup_size), ("gather", [8, 8, 1]));
    }
}
