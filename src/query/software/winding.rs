//! Which triangles of a draw call show the side that is drawn.

use super::isa::{ALL, Mask};
use super::pass::{DrawCall, Faces};
use super::vertex::Screen;

/// Which triangles are drawn, by the way in which their corners run on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Winding {
    clockwise: Mask,
    counter_clockwise: Mask,
}

impl Winding {
    const ANY: Self = Self { clockwise: ALL, counter_clockwise: ALL };

    /// What a draw call wants. A transform that mirrors turns the corners of all fronts round, and
    /// two of them leave them as they are.
    pub(crate) fn new(screen: &Screen, call: &DrawCall) -> Self {
        if call.faces == Faces::Both {
            return Self::ANY;
        }
        let matrix = call.world_from_object.matrix3;
        let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|axis| axis.as_dvec3());
        let clockwise = screen.mirrors != (x.cross(y).dot(z) < 0.0);
        Self {
            clockwise: if clockwise { ALL } else { 0 },
            counter_clockwise: if clockwise { 0 } else { ALL },
        }
    }

    /// Those of sixteen triangles that are drawn, given those that run counter-clockwise.
    #[inline(always)]
    pub(crate) fn drawn(self, counter_clockwise: Mask) -> Mask {
        (counter_clockwise & self.counter_clockwise) | (!counter_clockwise & self.clockwise)
    }

    /// Whether a single triangle is drawn.
    pub(crate) fn draws(self, counter_clockwise: bool) -> bool {
        self.drawn(Mask::from(counter_clockwise)) & 1 != 0
    }
}
