//! Whole scenes from glTF 2.0 files.
//!
//! ```text
//! file ──▶ nodes ──▶ places ┐
//!      └─▶ primitives ──▶ meshes ──▶ Model: objects that share meshes
//!      └─▶ materials ─▶ looks ┘
//! ```
//!
//! Every primitive of every node's mesh becomes an object of its own, so that parts of one mesh
//! can hide each other. Nothing in a file is trusted: each index, range and number is checked
//! before it is used, and a bounding box that a file states is not read at all.
//!
//! | file | |
//! |---|---|
//! | `file` | JSON, GLB chunks, buffers |
//! | `accessor` | checked reading, dense and sparse |
//! | `primitive` | triangles of one primitive |
//! | `nodes`, `instancing` | where things stand |
//! | `material` | colour, and what is see-through |
//! | `levels` | coarser levels, behind the feature `lod` |

mod accessor;
mod file;
mod instancing;
#[cfg(feature = "lod")]
mod levels;
mod material;
mod nodes;
mod primitive;
mod report;

use std::collections::HashMap;
use std::path::Path;

use rayon::prelude::*;

use crate::Error;
use crate::scene::mesh::Mesh;
use crate::worlds::{Model, Placed};
use file::File;
pub(super) use file::read_uri;
use material::Look;
use nodes::Place;
use primitive::{Reason, Shape};
use report::named;
pub use report::{ImportReport, Remark};

/// More objects than this are refused: with instancing, a small file can claim any number.
const MOST_OBJECTS: usize = 1 << 24;

/// A scene as it was read.
#[derive(Clone, Debug)]
pub struct Imported {
    /// Its objects and meshes, named after the file.
    pub model: Model,
    /// What there is to know about the reading.
    pub report: ImportReport,
}

impl Imported {
    /// Spawns every object with [`Bounds`](super::Bounds), [`Drawable`](crate::draw::Drawable)
    /// and, if it is see-through, [`NotOccluder`](super::NotOccluder).
    pub fn spawn(&self, world: &mut hecs::World) {
        self.model.spawn(world);
    }
}

/// Reads the default scene of a `.gltf` or `.glb` file.
///
/// Read are: node transforms (multiplied in f64), lists, strips and fans of triangles, indexed or
/// not, dense, sparse and quantised accessors, buffers in the file, beside it or in data URIs, and
/// `EXT_mesh_gpu_instancing`. Colour is the base colour factor; textures, vertex colours, skins,
/// morph targets and animations are not read. Both sides of every triangle are drawn.
///
/// Points, lines, primitives without positions or triangles, and objects whose transform is not
/// finite in f32 are left out and reported. An object that a singular transform makes flat stays.
///
/// Meshes are read in parallel; memory is the file's and the meshes'. O(file + objects).
///
/// # Errors
/// [`Error::File`], naming the file and the element: when it cannot be read, is not glTF 2, needs
/// an extension that is not read, or contradicts itself (an index or a range that reaches beyond
/// what there is, a node that is its own ancestor, a position that is not finite).
pub fn load(path: impl AsRef<Path>) -> Result<Imported, Error> {
    let path = path.as_ref();
    import(path).map_err(|why| Error::File { path: path.display().to_string(), why })
}

fn import(path: &Path) -> Result<Imported, String> {
    let file = File::open(path)?;
    let mut report = ImportReport::default();
    let places = nodes::places(&file, &mut report)?;
    let mut catalogue = Catalogue::new(&file, &places, &mut report)?;
    let mut model = Model::new(path.file_stem().map_or_else(Default::default, |s| s.to_string_lossy()));
    model.meshes = catalogue.read_meshes(&file, &mut report)?;
    place(&file, &places, &catalogue, &mut model, &mut report)?;
    report.objects = model.objects.len();
    report.meshes = model.meshes.len();
    report.triangles = model.triangles();
    report.mesh_triangles = model.meshes.iter().map(|m| m.triangle_count() as u64).sum();
    Ok(Imported { model, report })
}

/// A primitive that becomes an object wherever its mesh is used.
struct Part {
    primitive: usize,
    /// Index into [`Catalogue::shapes`]; after reading, into the model's meshes.
    mesh: usize,
    look: Look,
}

/// The meshes of the file that are used, and the distinct shapes that must be read for them.
struct Catalogue {
    /// By mesh of the file.
    parts: Vec<Vec<Part>>,
    /// Each with the name of the first primitive that has it.
    shapes: Vec<(Shape, String)>,
}

impl Catalogue {
    fn new(file: &File, places: &[Place], report: &mut ImportReport) -> Result<Self, String> {
        let mut used = vec![false; file.root.meshes.len()];
        places.iter().for_each(|place| used[place.mesh] = true);
        let mut numbers: HashMap<Shape, usize> = HashMap::new();
        let mut catalogue = Self { parts: used.iter().map(|_| Vec::new()).collect(), shapes: Vec::new() };
        for (m, mesh) in file.root.meshes.iter().enumerate().filter(|&(m, _)| used[m]) {
            for (p, primitive) in mesh.primitives.iter().enumerate() {
                let name = part_name(file, m, p);
                let in_part = |why: String| format!("{name}: {why}");
                let look = material::look(file, primitive.material).map_err(in_part)?;
                let shape = match primitive::shape(primitive).map_err(in_part)? {
                    Ok(shape) => shape,
                    Err(reason) => {
                        report.skip(name, reason);
                        continue;
                    }
                };
                if primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty()) {
                    report.alter(name.clone(), "its morph targets are not applied");
                }
                let shapes = &mut catalogue.shapes;
                let mesh = *numbers.entry(shape).or_insert_with(|| {
                    shapes.push((shape, name));
                    shapes.len() - 1
                });
                catalogue.parts[m].push(Part { primitive: p, mesh, look });
            }
        }
        Ok(catalogue)
    }

    /// Reads all shapes. Parts whose shape has no triangle are dropped.
    fn read_meshes(&mut self, file: &File, report: &mut ImportReport) -> Result<Vec<Mesh>, String> {
        let read: Vec<Result<Result<Mesh, Reason>, String>> = self
            .shapes
            .par_iter()
            .map(|(shape, name)| primitive::read(file, *shape, name).map_err(|why| format!("{name}: {why}")))
            .collect();
        let mut meshes = Vec::new();
        let mut numbers: Vec<Result<usize, Reason>> = Vec::new();
        for mesh in read {
            // The first error in the file's order, whichever thread was first.
            numbers.push(mesh?.map(|mesh| {
                meshes.push(mesh);
                meshes.len() - 1
            }));
        }
        for (m, parts) in self.parts.iter_mut().enumerate() {
            parts.retain_mut(|part| match &numbers[part.mesh] {
                Ok(number) => {
                    part.mesh = *number;
                    true
                }
                Err(reason) => {
                    report.skip(part_name(file, m, part.primitive), reason);
                    false
                }
            });
        }
        Ok(meshes)
    }
}

/// Puts an object wherever a mesh's part is used.
fn place(
    file: &File,
    places: &[Place],
    catalogue: &Catalogue,
    model: &mut Model,
    report: &mut ImportReport,
) -> Result<(), String> {
    let count: usize = places.iter().map(|place| catalogue.parts[place.mesh].len()).sum();
    if count > MOST_OBJECTS {
        return Err(format!("{count} objects are more than {MOST_OBJECTS}"));
    }
    model.objects.reserve_exact(count);
    for place in places {
        let world_from_object = place.world_from_mesh.as_affine3a();
        for part in &catalogue.parts[place.mesh] {
            let bounds = model.meshes[part.mesh].bounds().transformed(&world_from_object);
            if !(world_from_object.is_finite() && bounds.is_valid()) {
                let element = nodes::name(&file.root, place.node);
                report.skip(element, "its transform takes it beyond the range of f32");
                continue;
            }
            model.bounds = model.bounds.union(&bounds);
            let Look { color, see_through } = part.look;
            let not_occluder = see_through;
            model.objects.push(Placed { mesh: part.mesh, world_from_object, bounds, color, not_occluder });
        }
    }
    Ok(())
}

fn part_name(file: &File, mesh: usize, primitive: usize) -> String {
    let name = file.root.meshes[mesh].name.as_deref();
    format!("{}, primitive {primitive}", named("mesh", mesh, name))
}
