//! Parts of a mesh: neighbouring triangles with few vertices, so that what is hidden of a mesh can
//! be left out part by part.
//!
//! Triangles are sorted along a Morton curve and cut into runs. Each part has its own copy of
//! its vertices, in struct-of-arrays, and small indices into it: what one kernel works on stays in
//! registers and the first-level cache. About 14 bytes a triangle.

use glam::Vec3;

use super::mesh::Level;
use crate::geom::Aabb;

/// Vertices and triangles come in whole registers of so many.
const REGISTER: usize = 16;
/// The most vertices of a part.
pub(crate) const MOST_VERTICES: usize = 64;
/// The most triangles of a part.
pub(crate) const MOST_TRIANGLES: usize = 128;

/// One part.
#[derive(Clone, Copy, Debug)]
struct Meshlet {
    vertices: u8,
    triangles: u8,
    /// Registers before those of its vertices, and of its triangles.
    first_vertex: u32,
    first_triangle: u32,
}

/// All parts of a level.
#[derive(Debug, Default)]
pub(crate) struct Meshlets {
    parts: Vec<Meshlet>,
    boxes: Vec<Boxes>,
    positions: [Vec<[f32; REGISTER]>; 3],
    corners: [Vec<[u8; REGISTER]>; 3],
    triangles: Vec<[u32; REGISTER]>,
    single: Option<Single>,
}

/// A level so small that its vertices fill one register at most, and its triangles another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Single {
    /// Coordinates, an axis after the other; those beyond the last vertex are copies of the first.
    pub(crate) positions: [[f32; REGISTER]; 3],
    /// First, second and third corners of each triangle: vertices.
    pub(crate) corners: [[i32; REGISTER]; 3],
    /// Which triangle of the level it is.
    pub(crate) triangles: [u32; REGISTER],
    /// How many triangles there are.
    pub(crate) count: usize,
}

/// The boxes around sixteen parts, in object space. Those beyond the last part are copies of it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Boxes {
    pub(crate) centre: [[f32; REGISTER]; 3],
    /// Half sizes, rounded up.
    pub(crate) half: [[f32; REGISTER]; 3],
}

/// A part's vertices and triangles, in registers; the last ones are filled up with copies of the
/// first vertex and with triangles without area.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part<'a> {
    /// Coordinates, an axis after the other.
    pub(crate) positions: [&'a [[f32; REGISTER]]; 3],
    /// First, second and third corners: vertices of the part.
    pub(crate) corners: [&'a [[u8; REGISTER]]; 3],
    /// Which triangle of the level it is.
    pub(crate) triangles: &'a [[u32; REGISTER]],
    /// Triangles, without those that fill up.
    pub(crate) count: usize,
}

impl Meshlets {
    /// Cuts a level. O(n log n) for n triangles.
    pub(crate) fn new(level: &Level) -> Self {
        let mut builder = Builder { used: vec![(u32::MAX, 0); level.positions.len()], ..Builder::default() };
        let order = along_a_curve(level);
        for &triangle in &order {
            let at = 3 * triangle as usize;
            builder.add(level, triangle, [level.indices[at], level.indices[at + 1], level.indices[at + 2]]);
        }
        builder.finish(level);
        let mut made = builder.made;
        made.single = made.find_single();
        made
    }

    /// The whole level, where it is small enough.
    #[inline]
    pub(crate) fn single(&self) -> Option<&Single> {
        self.single.as_ref()
    }

    /// How many parts there are.
    pub(crate) fn len(&self) -> usize {
        self.parts.len()
    }

    /// The parts' boxes, sixteen by sixteen.
    pub(crate) fn boxes(&self) -> &[Boxes] {
        &self.boxes
    }

    /// What one part consists of.
    pub(crate) fn part(&self, index: usize) -> Part<'_> {
        let part = &self.parts[index];
        let vertices = part.first_vertex as usize..;
        let triangles = part.first_triangle as usize..;
        let (v, t) =
            (usize::from(part.vertices).div_ceil(REGISTER), usize::from(part.triangles).div_ceil(REGISTER));
        Part {
            positions: self.positions.each_ref().map(|axis| &axis[vertices.clone()][..v]),
            corners: self.corners.each_ref().map(|corner| &corner[triangles.clone()][..t]),
            triangles: &self.triangles[triangles][..t],
            count: usize::from(part.triangles),
        }
    }

    fn find_single(&self) -> Option<Single> {
        let axes = self.positions.each_ref().map(Vec::as_slice);
        let corners = self.corners.each_ref().map(Vec::as_slice);
        let ([[x], [y], [z]], [[a], [b], [c]]) = (axes, corners) else { return None };
        (self.parts.len() == 1).then_some(Single {
            positions: [*x, *y, *z],
            corners: [*a, *b, *c].map(|corners| corners.map(i32::from)),
            triangles: self.triangles[0],
            count: usize::from(self.parts[0].triangles),
        })
    }

    /// Stores the box of the part to come.
    fn note_box(&mut self, bounds: &Aabb) {
        let lane = self.parts.len() % REGISTER;
        if lane == 0 {
            self.boxes.push(Boxes::default());
        }
        let Some(boxes) = self.boxes.last_mut() else { return };
        let centre = bounds.min * 0.5 + bounds.max * 0.5;
        let half = (bounds.max - centre).max(centre - bounds.min);
        for axis in 0..3 {
            boxes.centre[axis][lane..].fill(centre[axis]);
            boxes.half[axis][lane..].fill(half[axis].next_up());
        }
    }
}

/// A part in the making.
#[derive(Default)]
struct Builder {
    made: Meshlets,
    vertices: Vec<u32>,
    corners: Vec<[u8; 3]>,
    triangles: Vec<u32>,
    /// Of each vertex of the level: the part that used it last, and which vertex it is there.
    used: Vec<(u32, u8)>,
}

impl Builder {
    fn add(&mut self, level: &Level, triangle: u32, corners: [u32; 3]) {
        let part = self.made.parts.len() as u32;
        let mut new = corners.map(|v| self.used[v as usize].0 != part);
        // Corners may be the same vertex.
        new[1] &= corners[1] != corners[0];
        new[2] &= corners[2] != corners[0] && corners[2] != corners[1];
        let count = self.vertices.len() + new.iter().filter(|&&new| new).count();
        if count > MOST_VERTICES || self.triangles.len() == MOST_TRIANGLES {
            self.finish(level);
            return self.add(level, triangle, corners);
        }
        let local = corners.map(|v| {
            let used = &mut self.used[v as usize];
            if used.0 != part {
                *used = (part, self.vertices.len() as u8);
                self.vertices.push(v);
            }
            used.1
        });
        self.corners.push(local);
        self.triangles.push(triangle);
    }

    /// Closes the part, if there is anything in it.
    fn finish(&mut self, level: &Level) {
        if self.triangles.is_empty() {
            return;
        }
        let made = &mut self.made;
        let position = |&v: &u32| level.positions[v as usize];
        made.note_box(&Aabb::from_points(self.vertices.iter().map(position)));
        made.parts.push(Meshlet {
            vertices: self.vertices.len() as u8,
            triangles: self.triangles.len() as u8,
            first_vertex: made.positions[0].len() as u32,
            first_triangle: made.triangles.len() as u32,
        });
        for run in self.vertices.chunks(REGISTER) {
            let at = |i: usize| position(run.get(i).unwrap_or(&self.vertices[0]));
            for axis in 0..3 {
                made.positions[axis].push(std::array::from_fn(|i| at(i)[axis]));
            }
        }
        for (corners, triangles) in self.corners.chunks(REGISTER).zip(self.triangles.chunks(REGISTER)) {
            for k in 0..3 {
                made.corners[k].push(std::array::from_fn(|i| corners.get(i).map_or(0, |c| c[k])));
            }
            made.triangles.push(std::array::from_fn(|i| triangles.get(i).copied().unwrap_or(0)));
        }
        self.vertices.clear();
        self.corners.clear();
        self.triangles.clear();
    }
}

/// The triangles of a level, near ones near each other; as they are where one part holds them all.
fn along_a_curve(level: &Level) -> Vec<u32> {
    let count = (level.indices.len() / 3) as u32;
    if count as usize <= MOST_TRIANGLES && level.positions.len() <= MOST_VERTICES {
        return (0..count).collect();
    }
    let bounds = Aabb::from_points(level.positions.iter().copied());
    let scale = 1023.0 / bounds.size().max_element().max(f32::MIN_POSITIVE);
    let code = |triangle: u32| {
        let at = 3 * triangle as usize;
        let corners: [Vec3; 3] = [0, 1, 2].map(|k| level.positions[level.indices[at + k] as usize]);
        let centre = corners.iter().map(|p| (*p - bounds.min) * scale / 3.0).sum::<Vec3>();
        spread(centre.x as u32) | spread(centre.y as u32) << 1 | spread(centre.z as u32) << 2
    };
    let mut order: Vec<(u32, u32)> = (0..count).map(|t| (code(t), t)).collect();
    order.sort_unstable();
    order.into_iter().map(|(_, triangle)| triangle).collect()
}

/// Ten bits, two zeros between each.
fn spread(v: u32) -> u32 {
    let v = v.min(1023);
    let v = (v | v << 16) & 0x0300_00FF;
    let v = (v | v << 8) & 0x0300_F00F;
    let v = (v | v << 4) & 0x030C_30C3;
    (v | v << 2) & 0x0924_9249
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    fn random_level(dice: &mut ChaCha8Rng, vertices: u32, triangles: usize) -> Level {
        let mut coordinate = || dice.random_range(-3.0..5.0_f32);
        let positions = (0..vertices).map(|_| Vec3::new(coordinate(), coordinate(), coordinate())).collect();
        let indices = (0..3 * triangles).map(|_| dice.random_range(0..vertices)).collect();
        Level { positions, indices, error: 0.0 }
    }

    #[test]
    fn every_triangle_is_in_one_part_with_its_own_corners() {
        let mut dice = ChaCha8Rng::seed_from_u64(1);
        for (vertices, triangles) in [(1, 1), (3, 0), (64, 128), (64, 129), (65, 20), (500, 3000), (9, 700)] {
            let level = random_level(&mut dice, vertices, triangles);
            let meshlets = Meshlets::new(&level);
            let mut times = vec![0; triangles];
            for index in 0..meshlets.len() {
                let boxes = &meshlets.boxes()[index / REGISTER];
                let part = meshlets.part(index);
                assert!(part.count > 0 && part.count <= MOST_TRIANGLES);
                assert!(part.positions[0].len() * REGISTER <= MOST_VERTICES);
                for t in 0..part.count {
                    let (register, lane) = (t / REGISTER, t % REGISTER);
                    let triangle = part.triangles[register][lane] as usize;
                    times[triangle] += 1;
                    for k in 0..3 {
                        let v = usize::from(part.corners[k][register][lane]);
                        let p = Vec3::from_array(std::array::from_fn(|axis| {
                            part.positions[axis][v / REGISTER][v % REGISTER]
                        }));
                        assert_eq!(p, level.positions[level.indices[3 * triangle + k] as usize]);
                        for axis in 0..3 {
                            let lane = index % REGISTER;
                            let away = f64::from(p[axis]) - f64::from(boxes.centre[axis][lane]);
                            assert!(away.abs() <= f64::from(boxes.half[axis][lane]));
                        }
                    }
                }
            }
            assert!(times.iter().all(|&times| times == 1), "{vertices} vertices, {triangles} triangles");
        }
    }

    #[test]
    fn parts_of_a_grid_are_small() {
        let side = 60;
        let positions =
            (0..side * side).map(|i| Vec3::new((i % side) as f32, (i / side) as f32, 0.0)).collect();
        let quad = |i: u32| [i, i + 1, i + side, i + 1, i + side + 1, i + side];
        let corners = (0..side * (side - 1)).filter(|i| i % side < side - 1);
        let level = Level { positions, indices: corners.flat_map(quad).collect(), error: 0.0 };
        let meshlets = Meshlets::new(&level);
        let area = |part: usize| {
            let (half, lane) = (&meshlets.boxes()[part / REGISTER].half, part % REGISTER);
            4.0 * half[0][lane] * half[1][lane]
        };
        let area: f32 = (0..meshlets.len()).map(area).sum();
        let whole = ((side - 1) * (side - 1)) as f32;
        assert!(area < 3.0 * whole, "{area} for {whole}");
    }
}
