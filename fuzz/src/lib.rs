//! What the fuzz targets do with their bytes: a function each, which never panics if the engine is
//! right. `tests/fuzz_bodies.rs` drives the same functions on stable, with seeds, regressions and
//! random bytes.

pub mod frame;
pub mod geometry;
#[cfg(feature = "gltf")]
pub mod gltf;
pub mod numbers;
#[cfg(feature = "record")]
pub mod replay;
pub mod tree;

/// Runs the body of a target; false if there is no target of that name.
pub fn run(target: &str, bytes: &[u8]) -> bool {
    match target {
        "frame" => frame::run(bytes),
        "geometry" => geometry::run(bytes),
        #[cfg(feature = "gltf")]
        "gltf" => gltf::run(bytes),
        #[cfg(feature = "record")]
        "replay" => replay::run(bytes),
        "tree" => tree::run(bytes),
        _ => return false,
    }
    true
}
