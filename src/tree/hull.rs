//! The box around boxes, so kept that uniting two takes a single operation.

use crate::geom::Aabb;

/// The least coordinates, and the greatest ones negated: to unite two is one minimum.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(32))]
pub(super) struct Hull([f32; 8]);

impl Hull {
    /// Around nothing: neutral under [`Hull::unite`].
    pub(super) const EMPTY: Self = Self([f32::INFINITY; 8]);

    #[inline(always)]
    pub(super) fn around(aabb: &Aabb) -> Self {
        let ([a, b, c], [d, e, f]) = (aabb.min.to_array(), aabb.max.to_array());
        Self([a, b, c, -d, -e, -f, f32::INFINITY, f32::INFINITY])
    }

    #[inline(always)]
    pub(super) fn unite(&mut self, other: &Self) {
        for (mine, &other) in self.0.iter_mut().zip(&other.0) {
            *mine = lesser(*mine, other);
        }
    }

    /// Whether it reaches nowhere beyond another.
    #[inline(always)]
    pub(super) fn is_within(&self, other: &Self) -> bool {
        self.0.iter().zip(&other.0).fold(true, |within, (mine, other)| within & (mine >= other))
    }

    #[inline(always)]
    pub(super) fn aabb(&self) -> Aabb {
        let [a, b, c, d, e, f, ..] = self.0;
        Aabb::new([a, b, c].into(), [-d, -e, -f].into())
    }
}

/// One instruction, unlike `f32::min`, which must also sort out NaN: the tree holds none.
#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}
