//! Which blocks have objects with new boxes.

use std::ops::Range;

use super::blocks::grow;

/// Blocks that are skipped at once where nothing has moved.
const REGION: usize = 64;

/// A byte for each block, so that marking one is a store: 1 if any object of it has a new box.
#[derive(Clone, Debug, Default)]
pub(super) struct Stale {
    regions: Vec<[u8; REGION]>,
    /// Whether there may be any such block.
    any: bool,
}

impl Stale {
    /// The blocks' bytes, of which any may be set.
    #[inline(always)]
    pub(super) fn bytes_mut(&mut self) -> &mut [u8] {
        self.any = true;
        self.regions.as_flattened_mut()
    }

    /// Marks a block.
    pub(super) fn mark(&mut self, block: usize) {
        self.regions.as_flattened_mut()[block] = 1;
        self.any = true;
    }

    /// What a block's objects have still to be refreshed by goes with them to another.
    pub(super) fn follow(&mut self, from: usize, to: usize) {
        let flags = self.regions.as_flattened_mut();
        flags[to] |= flags[from];
    }

    /// Nothing is to be refreshed there.
    pub(super) fn clear(&mut self, blocks: Range<usize>) {
        self.regions.as_flattened_mut()[blocks].fill(0);
    }

    /// Makes room for more blocks in advance.
    pub(super) fn reserve(&mut self, more: usize) {
        self.regions.reserve_exact(more.div_ceil(REGION));
    }

    /// There are so many blocks now.
    pub(super) fn set_len(&mut self, blocks: usize) {
        grow(&mut self.regions, blocks.div_ceil(REGION), [0; REGION]);
    }

    /// Lists the marked blocks, in order, and unmarks them. A look at every byte, unless there are none.
    pub(super) fn take(&mut self, list: &mut Vec<u32>) {
        if !std::mem::take(&mut self.any) {
            return;
        }
        for (first, region) in (0..).step_by(REGION).zip(&mut self.regions) {
            if region.iter().fold(0, |any, &stale| any | stale) == 0 {
                continue;
            }
            // As bits: which blocks are stale is hard to foretell, how many of a region is easier.
            let mut bits = bits_of(region);
            *region = [0; REGION];
            while bits != 0 {
                list.push(first + bits.trailing_zeros());
                bits &= bits - 1;
            }
        }
    }

    /// Memory held, in bytes.
    pub(super) fn bytes(&self) -> usize {
        self.regions.capacity() * REGION
    }
}

/// A bit for each byte, which is 0 or 1.
fn bits_of(region: &[u8; REGION]) -> u64 {
    region.as_chunks::<8>().0.iter().enumerate().fold(0, |bits, (i, &eight)| {
        // Byte k goes to bit k of the highest byte, where no two products meet.
        let gathered = u64::from_le_bytes(eight).wrapping_mul(0x0102_0408_1020_4080) >> 56;
        bits | gathered << (8 * i)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_marked_is_listed_once_and_in_order() {
        let mut stale = Stale::default();
        stale.set_len(1000);
        let marked: Vec<u32> = (0..1000).filter(|block| block * block % 7 == 2 || *block == 999).collect();
        marked.iter().rev().for_each(|&block| stale.mark(block as usize));
        let mut list = Vec::new();
        stale.take(&mut list);
        assert_eq!(list, marked);
        stale.set_len(1100);
        list.clear();
        stale.take(&mut list);
        assert!(list.is_empty());
        stale.mark(3);
        stale.follow(3, 1099);
        stale.clear(0..64);
        stale.take(&mut list);
        assert_eq!(list, [1099]);
    }
}
