//! Every shader by itself, without a device: it is valid WGSL that needs no optional capability,
//! and it can be written as the GLSL that OpenGL takes.

use tercet::query::gpu::{Counting, Shaders};
use wgpu::naga::back::glsl;
use wgpu::naga::front::wgsl;
use wgpu::naga::proc::BoundsCheckPolicies;
use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};
use wgpu::naga::{Module, ShaderStage};

fn sources() -> Vec<String> {
    let all = Counting::ALL.into_iter().flat_map(|counting| [(counting, false), (counting, true)]);
    all.map(|(counting, several)| Shaders::default().source(counting, several).to_owned()).collect()
}

fn parse(source: &str) -> Module {
    wgsl::parse_str(source).unwrap_or_else(|error| panic!("{}", error.emit_to_string(source)))
}

#[test]
fn shaders_are_valid_and_portable() {
    let mut entries = 0;
    for source in sources() {
        let module = parse(&source);
        let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&module)
            .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)));
        for entry in &module.entry_points {
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
            entries += 1;
        }
    }
    assert_eq!(entries, 6, "two stages that count fragments, one that counts in workgroups, each twice");
}

/// The Rust side starts stages by these names and sizes.
#[test]
fn entry_points_are_what_the_passes_start() {
    let of = |counting, several| parse(Shaders::default().source(counting, several)).entry_points;
    for several in [false, true] {
        let fragments = of(Counting::Fragments, several);
        let stages: Vec<_> = fragments.iter().map(|e| (e.name.as_str(), e.stage)).collect();
        assert_eq!(stages, [("rectangle", ShaderStage::Vertex), ("count", ShaderStage::Fragment)]);
        let workgroups = of(Counting::Workgroups, several);
        assert_eq!((workgroups[0].name.as_str(), workgroups[0].workgroup_size), ("count", [8, 8, 1]));
    }
}
