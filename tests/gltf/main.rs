//! Whole scenes from glTF files: what is in the file is in the scene, and where it belongs.

#![cfg(feature = "gltf")]

mod looks;
mod malformed;
mod places;
#[path = "../support/scenes.rs"]
mod scenes;
mod shapes;
#[path = "../support/writer.rs"]
mod writer;

use glam::Vec3;
use tempfile::TempDir;
use tercet::geom::Aabb;
use tercet::scene::import::{self, Imported};

use writer::Writer;

fn folder() -> TempDir {
    tempfile::tempdir().expect("there is a folder for temporary files")
}

fn read(file: &Writer) -> Imported {
    let folder = folder();
    import::load(file.write_glb(folder.path())).expect("the file is well formed")
}

/// The property that culling rests on: whatever is drawn lies in the box.
fn check_bounds(imported: &Imported) {
    let model = &imported.model;
    let mut all = Aabb::EMPTY;
    for (o, object) in model.objects.iter().enumerate() {
        let m = object.world_from_object;
        for &p in model.meshes[object.mesh].levels().iter().flat_map(|level| &level.positions) {
            let plain = m.transform_point3(p);
            // Another order of the same sums, with fused products.
            let (x, y, z) = (Vec3::from(m.matrix3.x_axis), Vec3::from(m.matrix3.y_axis), m.matrix3.z_axis);
            let fused =
                [0, 1, 2].map(|i| p.x.mul_add(x[i], p.y.mul_add(y[i], p.z.mul_add(z[i], m.translation[i]))));
            for drawn in [plain, Vec3::from(fused)] {
                assert!(
                    object.bounds.contains_point(drawn),
                    "object {o}: {drawn} is not in {:?}",
                    object.bounds
                );
            }
        }
        all = all.union(&object.bounds);
    }
    assert_eq!(all, model.bounds);
}
