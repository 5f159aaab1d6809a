//! The box around boxes, so kept that uniting two takes a single operation.

use glam::Vec4;

use crate::geom::Aabb;

/// The least coordinates, and the greatest ones negated: to unite two is one minimum.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub(super) struct Hull([Vec4; 2]);

impl Hull {
    /// Around nothing: neutral under [`Hull::unite`].
    pub(super) const EMPTY: Self = Self([Vec4::INFINITY; 2]);

    #[inline(always)]
    pub(super) fn around(aabb: &Aabb) -> Self {
        let ([a, b, c], [d, e, f]) = (aabb.min.to_array(), aabb.max.to_array());
        Self([Vec4::new(a, b, c, -d), Vec4::new(-e, -f, f32::INFINITY, f32::INFINITY)])
    }

    #[inline(always)]
    pub(super) fn unite(&mut self, other: &Self) {
        for (mine, other) in self.0.iter_mut().zip(other.0) {
            *mine = mine.min(other);
        }
    }

    /// Whether it reaches nowhere beyond another.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) fn is_within(&self, other: &Self) -> bool {
        (self.0[0].cmpge(other.0[0]) & self.0[1].cmpge(other.0[1])).all()
    }

    #[inline(always)]
    pub(super) fn aabb(&self) -> Aabb {
        let ([a, b, c, d], [e, f, ..]) = (self.0[0].to_array(), self.0[1].to_array());
        Aabb::new([a, b, c].into(), [-d, -e, -f].into())
    }
}
