//! What an import made of a file, and what it did not.

use std::fmt;

/// Figures of an import, and what it left out or changed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ImportReport {
    /// Nodes of the scene, with and without meshes.
    pub nodes: usize,
    /// Objects: one for each primitive of each node's mesh, and each place of an instanced node.
    pub objects: usize,
    /// Distinct meshes, which the objects share.
    pub meshes: usize,
    /// Triangles of all objects.
    pub triangles: u64,
    /// Triangles of all meshes: what is kept in memory.
    pub mesh_triangles: u64,
    /// What is not among the objects.
    pub skipped: Vec<Remark>,
    /// What is among the objects, but does not look as the file means it.
    pub altered: Vec<Remark>,
}

/// One element of a file, and what there is to say about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Remark {
    /// Such as `mesh 3 'Wall', primitive 0`.
    pub element: String,
    /// A sentence.
    pub reason: String,
}

impl ImportReport {
    pub(super) fn skip(&mut self, element: String, reason: impl Into<String>) {
        self.skipped.push(Remark { element, reason: reason.into() });
    }

    pub(super) fn alter(&mut self, element: String, reason: impl Into<String>) {
        self.altered.push(Remark { element, reason: reason.into() });
    }
}

impl fmt::Display for ImportReport {
    /// A line of figures, and one for each kind of remark with the first few.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { nodes, objects, meshes, triangles, .. } = self;
        write!(f, "{objects} objects of {meshes} meshes, {triangles} triangles, {nodes} nodes")?;
        remarks(f, "left out", &self.skipped)?;
        remarks(f, "changed", &self.altered)
    }
}

fn remarks(f: &mut fmt::Formatter<'_>, title: &str, all: &[Remark]) -> fmt::Result {
    const SHOWN: usize = 4;
    if all.is_empty() {
        return Ok(());
    }
    let shown: Vec<_> = all.iter().take(SHOWN).map(|r| format!("{} ({})", r.element, r.reason)).collect();
    write!(f, "\n{title}: {}", shown.join("; "))?;
    match all.len().saturating_sub(SHOWN) {
        0 => Ok(()),
        more => write!(f, "; and {more} more"),
    }
}

/// How messages call an element: by its number, and its name if it has one.
pub(super) fn named(kind: &str, number: usize, name: Option<&str>) -> String {
    match name {
        Some(name) => format!("{kind} {number} '{name}'"),
        None => format!("{kind} {number}"),
    }
}
