//! Depths of earlier frames, for late questions.

use std::collections::VecDeque;

use super::depth::Depth;
use super::hi_z::HiZ;
use super::level::SimdLevel;
use crate::geom::View;

/// A frame's finished depth, and how it was seen.
#[derive(Debug, Default)]
pub(super) struct KeptFrame {
    pub(super) view: Option<View>,
    pub(super) depth: Depth,
    pub(super) hi_z: HiZ,
}

/// As many of the last frames as are asked for, the newest last. Nothing is copied: a frame's buffers
/// become the next one's when nobody asks about it any more.
#[derive(Debug, Default)]
pub(super) struct KeptFrames {
    frames: VecDeque<KeptFrame>,
}

impl KeptFrames {
    /// Keeps a finished frame, of which `most` are kept; returns buffers for the next one.
    pub(super) fn keep(&mut self, mut last: KeptFrame, most: usize, simd: SimdLevel) -> KeptFrame {
        // Questions come from many threads, and change nothing.
        last.depth.settle();
        last.hi_z.refresh(simd, &last.depth);
        self.frames.push_back(last);
        let mut spare = KeptFrame::default();
        while self.frames.len() > most {
            spare = self.frames.pop_front().unwrap_or_default();
        }
        spare
    }

    /// The frame of so many frames ago: 1 is the last one.
    pub(super) fn ago(&self, frames: usize) -> Option<&KeptFrame> {
        self.frames.get(self.frames.len().checked_sub(frames)?)
    }

    /// Lets go of all.
    pub(super) fn clear(&mut self) {
        self.frames.clear();
    }

    /// In bytes.
    pub(super) fn bytes(&self) -> usize {
        self.frames.iter().map(|frame| frame.depth.bytes() + frame.hi_z.bytes()).sum()
    }
}
