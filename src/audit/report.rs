//! What a checked frame lost.

use std::fmt;

use super::Blame;
use crate::Why;
use crate::geom::Aabb;
use crate::policy::Samples;
use crate::scene::ObjectRef;

/// A frame that was checked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Audit {
    /// Which one, as the auditor counts: the first one that it was shown is 1.
    pub frame: u64,
    /// Samples of the picture: one a pixel.
    pub pixels: u64,
    /// Samples whose depth is not that of the frame with everything in it.
    pub wrong_pixels: u64,
    /// Objects that own a sample of the frame with everything in it, lost ones included.
    pub visible: u32,
    /// Objects that were drawn.
    pub drawn: u32,
    /// Objects in the frustum that were not drawn, lost ones included.
    pub culled: u32,
    /// Objects that own a sample and were not drawn; by slot.
    pub lost: Vec<FalseCull>,
}

/// An object that owns a sample of the finished frame, and was not drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FalseCull {
    /// Which one.
    pub object: ObjectRef,
    /// Its box, metres, relative to the scene's origin; None for an object that is to be drawn always.
    pub bounds: Option<Aabb>,
    /// Samples at which the finished frame shows it. 0 if it is only seen at the very depth of another
    /// object, or hides nothing and something nearer that hides nothing is seen with it.
    pub samples: u32,
    /// Those over the samples of the picture, 0 to 1.
    pub share: f64,
    /// Why it was culled.
    pub why: Why,
    /// The box that decided (that of [`Why::node`], else its own), asked about again in this frame,
    /// against the depth of all that was drawn and hides. None if it need not be asked about: it crosses
    /// the near plane, or lies between the samples.
    pub recount: Option<Samples>,
    /// What is to blame.
    pub blame: Blame,
}

impl Audit {
    /// The share of the picture that is wrong, 0 to 1.
    pub fn wrong_share(&self) -> f64 {
        self.wrong_pixels as f64 / self.pixels.max(1) as f64
    }
}

impl FalseCull {
    /// The dial of [`Tradeoff`](crate::Tradeoff) to blame; None if there is none.
    pub const fn dial(&self) -> Option<&'static str> {
        self.blame.dial()
    }
}

impl fmt::Display for FalseCull {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "object {:?}", self.object.entity())?;
        if let Some(bounds) = self.bounds {
            let size = bounds.size();
            write!(f, " ({:.2} × {:.2} × {:.2} m)", size.x, size.y, size.z)?;
        }
        let samples = if self.samples == 1 { "sample" } else { "samples" };
        write!(f, " owns {} {samples} ({:.4} %) and was not drawn", self.samples, 100.0 * self.share)?;
        write!(f, "; {}", self.why)?;
        if let Some(samples) = self.recount {
            write!(f, "; asked again, now that all is drawn, {samples}")?;
        }
        write!(f, "; to blame: {}", self.blame)
    }
}
