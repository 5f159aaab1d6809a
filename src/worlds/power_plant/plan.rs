//! The floor plan: which bay belongs to which room, and the way that the camera takes.
//!
//! ```text
//!   row 0 ┌──────────────────────────────────────────┐
//!         │ rooms │     turbine hall      │   rooms   │   hall: several storeys high
//!         │       │                       │           │
//!         ├──┬──┬─┴──┬───┬───┬──┬──┬──┬───┴─┬──┬──┬───┤
//!  aisle ══▶    corridor, a door every few bays       │   every storey
//!         ├──┬──┬────┬───┬───┬──┬──┬──┬──┬─┴──────┬───┤
//!         │  rooms of one to three bays  │  boiler  │   │   boiler house: open from the ground
//!         └──────────────────────────────┴──────────┴───┘   to the sky
//! ```

use glam::Vec3;

use super::super::dice::Dice;
use super::{BAY, STOREY};
use crate::geom::Aabb;

/// How many bays along x and z, and how many storeys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Size {
    pub(super) nx: usize,
    pub(super) nz: usize,
    pub(super) ny: usize,
}

/// A bay of one storey. Signed: −1 and the size itself lie outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Bay {
    pub(super) i: i32,
    pub(super) j: i32,
    pub(super) k: i32,
}

/// What a room is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Use {
    Outside,
    Corridor,
    Hall,
    Boiler,
    Exchangers,
    Pumps,
    Vessels,
    Electrical,
    Store,
    Air,
}

/// A room: bays of one number belong together, and no wall or floor parts them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Room {
    number: u32,
    pub(super) used: Use,
}

const OUTSIDE: Room = Room { number: 0, used: Use::Outside };
const HALL: Room = Room { number: 1, used: Use::Hall };
const BOILER: Room = Room { number: 2, used: Use::Boiler };

impl Size {
    /// 16 × 8 bays of 6 storeys at scale 1; each direction grows with the cube root.
    pub(super) fn of(scale: f32) -> Self {
        let edge = libm::cbrt(f64::from(scale));
        let count = |at_one: f64, least: usize| (libm::round(at_one * edge) as usize).max(least);
        Self { nx: count(16.0, 4), nz: count(8.0, 3), ny: count(6.0, 2) }
    }

    /// The row that the corridors run along.
    pub(super) fn aisle(&self) -> i32 {
        (self.nz / 2) as i32
    }

    /// The corner of a bay with the least coordinates, on its floor.
    pub(super) fn corner(&self, i: i32, j: i32, k: i32) -> Vec3 {
        let x = (i as f32 - 0.5 * self.nx as f32) * BAY;
        let z = (j as f32 - 0.5 * self.nz as f32) * BAY;
        Vec3::new(x, k as f32 * STOREY, z)
    }

    /// The centre of a bay's floor.
    pub(super) fn center(&self, bay: Bay) -> Vec3 {
        self.corner(bay.i, bay.j, bay.k) + Vec3::new(0.5 * BAY, 0.0, 0.5 * BAY)
    }

    /// The building from the ground to its roof.
    pub(super) fn building(&self) -> Aabb {
        let (nx, ny, nz) = (self.nx as i32, self.ny as i32, self.nz as i32);
        Aabb::new(self.corner(0, 0, 0), self.corner(nx, nz, ny))
    }

    fn holds(&self, bay: Bay) -> bool {
        let within = |n: i32, size: usize| (0..size as i32).contains(&n);
        // The western wing is lower by a third.
        let high = if bay.i < self.nx as i32 / 4 { self.ny - self.ny / 3 } else { self.ny };
        within(bay.i, self.nx) && within(bay.j, self.nz) && within(bay.k, high)
    }

    fn in_hall(&self, bay: Bay) -> bool {
        let (last, high) = ((self.nx as i32 / 2).max(2), (self.ny as i32 / 2).max(1));
        (1..=last).contains(&bay.i) && bay.j < (self.aisle() - 1).max(1) && bay.k < high
    }

    fn in_boiler(&self, bay: Bay) -> bool {
        let (from, to) = self.boiler_columns();
        (from..=to).contains(&bay.i) && (self.aisle() + 1..=self.aisle() + 2).contains(&bay.j)
    }

    fn boiler_columns(&self) -> (i32, i32) {
        let nx = self.nx as i32;
        if nx >= 6 { (nx - 3, nx - 2) } else { (nx - 2, nx - 2) }
    }

    /// The bays that the camera passes, in order, each beside, above or below the one before.
    pub(super) fn route(&self) -> Vec<Bay> {
        let aisle = self.aisle();
        let (nx, ny) = (self.nx as i32, self.ny as i32);
        let hall_row = ((aisle - 1).max(1) - 1) / 2;
        let (hall_in, hall_out) = ((nx / 4).max(1), (nx / 2).max(2));
        let (shaft, middle, room) = (self.boiler_columns().0, ny / 2, (nx / 3).max(1));
        let at = |i, j, k| Bay { i, j, k };
        let turns = [
            at(0, aisle, 0),
            at(hall_in, aisle, 0),
            at(hall_in, hall_row, 0),
            at(hall_out, hall_row, 0),
            at(hall_out, aisle, 0),
            at(shaft, aisle, 0),
            at(shaft, aisle + 1, 0),
            at(shaft, aisle + 1, middle),
            at(shaft, aisle, middle),
            at(room, aisle, middle),
            at(room, aisle + 1, middle),
            at(room + 1, aisle + 1, middle),
            at(room + 1, aisle, middle),
            at(shaft, aisle, middle),
            at(shaft, aisle + 1, middle),
            at(shaft, aisle + 1, ny),
        ];
        let mut bays = vec![turns[0]];
        for turn in turns {
            while let Some(next) = step(bays[bays.len() - 1], turn) {
                bays.push(next);
            }
        }
        bays
    }
}

/// The next bay on the way to `goal`; None once there. Only one coordinate differs.
fn step(from: Bay, goal: Bay) -> Option<Bay> {
    let toward = |a: i32, b: i32| a + (b - a).signum();
    let next = Bay { i: toward(from.i, goal.i), j: toward(from.j, goal.j), k: toward(from.k, goal.k) };
    (next != from).then_some(next)
}

/// The rooms of every storey.
pub(super) struct Plan {
    pub(super) size: Size,
    rooms: Vec<Room>,
    /// Pairs of neighbouring bays that the route joins.
    joined: Vec<[Bay; 2]>,
}

impl Plan {
    pub(super) fn new(size: Size, dice: &mut Dice) -> Self {
        let route = size.route();
        let joined = route.windows(2).map(|w| [w[0], w[1]]).collect();
        let mut plan = Self { size, rooms: vec![OUTSIDE; size.nx * size.nz * size.ny], joined };
        let mut number = BOILER.number;
        let mut uses = Vec::new();
        for k in 0..size.ny as i32 {
            for (first, last) in plan.bands() {
                let mut i = 0;
                while i < size.nx as i32 {
                    let corridor = first == size.aisle();
                    let wide = if corridor { 8 } else { 2 + dice.below(3) as i32 };
                    number += 1;
                    let used = if corridor { Use::Corridor } else { deal(&mut uses, dice) };
                    plan.fill(Room { number, used }, [i, first, k], [i + wide, last + 1]);
                    i += wide;
                }
            }
        }
        plan
    }

    /// Rows of bays that rooms stretch over: pairs on either side of the corridor.
    fn bands(&self) -> Vec<(i32, i32)> {
        let (aisle, last) = (self.size.aisle(), self.size.nz as i32 - 1);
        let mut bands = vec![(aisle, aisle)];
        let mut j = aisle - 1;
        // The row next to the corridor stays by itself: it separates the hall from it.
        while j >= 0 {
            let first = if j == aisle - 1 { j } else { (j - 1).max(0) };
            bands.push((first, j));
            j = first - 1;
        }
        let mut j = aisle + 1;
        while j <= last {
            bands.push((j, (j + 1).min(last)));
            j += 2;
        }
        bands
    }

    fn fill(&mut self, room: Room, [i0, j0, k]: [i32; 3], [i1, j1]: [i32; 2]) {
        for j in j0..j1 {
            for i in i0..i1.min(self.size.nx as i32) {
                let bay = Bay { i, j, k };
                let index = self.index(bay);
                self.rooms[index] = if !self.size.holds(bay) {
                    OUTSIDE
                } else if self.size.in_hall(bay) {
                    HALL
                } else if self.size.in_boiler(bay) {
                    BOILER
                } else {
                    room
                };
            }
        }
    }

    fn index(&self, bay: Bay) -> usize {
        ((bay.k as usize * self.size.nz) + bay.j as usize) * self.size.nx + bay.i as usize
    }

    /// The room that a bay belongs to; bays beyond the building are outside.
    pub(super) fn room(&self, bay: Bay) -> Room {
        if self.size.holds(bay) { self.rooms[self.index(bay)] } else { OUTSIDE }
    }

    /// Whether the camera goes from one of two neighbouring bays to the other.
    pub(super) fn is_joined(&self, a: Bay, b: Bay) -> bool {
        let entrance = Bay { i: 0, j: self.size.aisle(), k: 0 };
        let entering = a == entrance && b.i < 0 || b == entrance && a.i < 0;
        entering || self.joined.contains(&[a, b]) || self.joined.contains(&[b, a])
    }

    /// All bays of the building's box, storey by storey; those above a lower wing are outside.
    pub(super) fn bays(&self) -> impl Iterator<Item = Bay> + use<> {
        let Size { nx, nz, ny } = self.size;
        (0..ny * nz * nx).map(move |n| Bay {
            i: (n % nx) as i32,
            j: (n / nx % nz) as i32,
            k: (n / nx / nz) as i32,
        })
    }
}

/// The next use of a room, dealt from a shuffled pack: every seed has the same share of each.
fn deal(pack: &mut Vec<Use>, dice: &mut Dice) -> Use {
    if pack.is_empty() {
        const SHARES: [(Use, usize); 6] = [
            (Use::Exchangers, 6),
            (Use::Pumps, 4),
            (Use::Vessels, 3),
            (Use::Electrical, 3),
            (Use::Store, 2),
            (Use::Air, 2),
        ];
        pack.extend(SHARES.iter().flat_map(|&(used, share)| std::iter::repeat_n(used, share)));
        dice.shuffle(pack);
    }
    pack.pop().unwrap_or(Use::Store)
}
