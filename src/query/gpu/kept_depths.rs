//! Depths of earlier frames, for late questions.

use std::collections::VecDeque;

use wgpu::{
    CommandEncoder, Device, Texture, TextureAspect, TextureDescriptor, TextureDimension, TextureUsages,
    TextureView, TextureViewDescriptor,
};

use super::targets::FrameTargets;
use crate::geom::View;

/// Copies of the depths of the last frames, the newest last.
#[derive(Debug, Default)]
pub(super) struct KeptDepths {
    kept: VecDeque<KeptDepth>,
}

/// A frame's finished depth, and how it was seen.
#[derive(Debug)]
pub(super) struct KeptDepth {
    pub(super) view: View,
    texture: Texture,
    pub(super) readable: TextureView,
}

impl KeptDepths {
    /// The depth of so many frames ago, 1 being the last one, if it can be asked about in a frame of this
    /// view and these targets. Older ones are let go of; all are, if they are of another kind.
    pub(super) fn ago(&mut self, frames: usize, view: &View, targets: &FrameTargets) -> Option<&KeptDepth> {
        self.kept.drain(..self.kept.len().saturating_sub(frames));
        let alike = |kept: &KeptDepth| {
            let then = &kept.view;
            then.viewport() == view.viewport()
                && then.depth() == view.depth()
                && are_alike(&kept.texture, targets.depth.view.texture())
        };
        if !self.kept.iter().all(alike) {
            self.clear();
        }
        self.kept.get(self.kept.len().checked_sub(frames)?)
    }

    /// Copies a finished depth; at most so many are kept.
    pub(super) fn keep(
        &mut self,
        device: &Device,
        encoder: &mut CommandEncoder,
        (view, depth): (&View, &Texture),
        most: usize,
    ) {
        let mut spare = None;
        while self.kept.len() >= most.max(1) {
            spare = self.kept.pop_front();
        }
        let spare = spare.filter(|spare| are_alike(&spare.texture, depth));
        let kept = match spare {
            Some(spare) => KeptDepth { view: view.clone(), ..spare },
            None => KeptDepth::new(device, view, depth),
        };
        encoder.copy_texture_to_texture(depth.as_image_copy(), kept.texture.as_image_copy(), depth.size());
        self.kept.push_back(kept);
    }

    /// Lets go of all.
    pub(super) fn clear(&mut self) {
        self.kept.clear();
    }
}

impl KeptDepth {
    fn new(device: &Device, view: &View, like: &Texture) -> Self {
        let texture = device.create_texture(&TextureDescriptor {
            label: Some("tercet kept depth"),
            size: like.size(),
            mip_level_count: 1,
            sample_count: like.sample_count(),
            dimension: TextureDimension::D2,
            format: like.format(),
            // The first is asked of whatever has several samples.
            usage: TextureUsages::RENDER_ATTACHMENT
                | TextureUsages::TEXTURE_BINDING
                | TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let readable = texture.create_view(&TextureViewDescriptor {
            aspect: TextureAspect::DepthOnly,
            ..TextureViewDescriptor::default()
        });
        Self { view: view.clone(), texture, readable }
    }
}

/// Whether a depth can be copied: the app must allow it, and a view does not tell which layer it is of.
pub(super) fn can_be_kept(depth: &Texture) -> bool {
    depth.usage().contains(TextureUsages::COPY_SRC)
        && depth.depth_or_array_layers() == 1
        && depth.mip_level_count() == 1
}

fn are_alike(a: &Texture, b: &Texture) -> bool {
    a.size() == b.size() && a.format() == b.format() && a.sample_count() == b.sample_count()
}
