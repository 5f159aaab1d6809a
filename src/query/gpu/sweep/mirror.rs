//! Arrays of the host that the device has a copy of, uploaded by what has changed.

use bytemuck::{Pod, cast_slice};
use wgpu::{BufferBinding, BufferUsages, Device, Queue};

use super::array::DeviceArray;
use crate::Error;

/// A storage buffer that follows an array: what the device has is kept beside it and compared, chunk
/// by chunk. So nothing has to be reported by whoever changes the array, and nothing can be missed.
/// An array that stays as it is costs a comparison at the speed of memory, and no upload.
#[derive(Debug)]
pub(crate) struct Mirrored<T> {
    known: Vec<T>,
    array: DeviceArray<T>,
}

/// Elements that are compared, and uploaded, together.
const CHUNK: usize = 32;

impl<T: Pod> Mirrored<T> {
    pub(crate) fn new(device: &Device, label: &'static str) -> Self {
        let usage = BufferUsages::STORAGE | BufferUsages::VERTEX | BufferUsages::COPY_DST;
        Self { known: Vec::new(), array: DeviceArray::new(device, label, usage) }
    }

    /// Uploads what has changed, and takes the array for known; what comes back in exchange is for
    /// its memory. Returns the bytes uploaded.
    ///
    /// # Errors
    /// [`Error::Device`] if the device cannot bind so many.
    pub(crate) fn follow(&mut self, device: &Device, queue: &Queue, now: &mut Vec<T>) -> Result<u64, Error> {
        if self.array.resize(device, now.len())? {
            self.known.clear();
        }
        let uploaded = changes(&self.known, now).map(|range| {
            let changed = cast_slice::<T, u8>(&now[range.clone()]);
            queue.write_buffer(self.array.buffer(), (range.start * size_of::<T>()) as u64, changed);
            changed.len() as u64
        });
        let uploaded = uploaded.sum();
        std::mem::swap(&mut self.known, now);
        Ok(uploaded)
    }

    /// The array as the device has it.
    pub(crate) fn known(&self) -> &[T] {
        &self.known
    }

    /// How many elements there are.
    pub(crate) fn len(&self) -> usize {
        self.known.len()
    }

    /// All elements, and no more; one if there is none.
    pub(crate) fn binding(&self) -> BufferBinding<'_> {
        self.array.all()
    }
}

/// The ranges in which two arrays differ, in whole chunks, none of them next to another.
fn changes<T: Pod>(known: &[T], now: &[T]) -> impl Iterator<Item = std::ops::Range<usize>> {
    let differs = |at: usize| {
        let (first, end) = (at * CHUNK, ((at + 1) * CHUNK).min(now.len()));
        known.get(first..end).map(cast_slice::<T, u8>) != Some(cast_slice(&now[first..end]))
    };
    let (chunks, count) = (now.len().div_ceil(CHUNK), now.len());
    let mut at = 0;
    std::iter::from_fn(move || {
        let first = (at..chunks).find(|&chunk| differs(chunk))?;
        let end = (first + 1..chunks).find(|&chunk| !differs(chunk)).unwrap_or(chunks);
        at = end;
        Some(first * CHUNK..(end * CHUNK).min(count))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn changed(known: &[u32], now: &[u32]) -> Vec<std::ops::Range<usize>> {
        changes(known, now).collect()
    }

    #[test]
    fn what_differs_is_found_and_no_more() {
        let known: Vec<u32> = (0..1000).collect();
        assert_eq!(changed(&known, &known), []);
        assert_eq!(changed(&[], &known), vec![0..1000; 1]);
        assert_eq!(changed(&known, &known[..500]), [], "what is gone needs no upload");
        let mut now = known.clone();
        (now[0], now[70], now[95], now[999]) = (7, 7, 7, 7);
        assert_eq!(changed(&known, &now), [0..32, 64..96, 992..1000]);
        (now[96], now[127]) = (7, 7);
        assert_eq!(changed(&known, &now), [0..32, 64..128, 992..1000]);
        now.push(1);
        assert_eq!(changed(&known, &now).last(), Some(&(992..1001)));
        assert_eq!(changed(&known, &[]), []);
    }

    #[test]
    fn bits_are_compared_and_not_numbers() {
        assert_eq!(changes(&[0.0f32], &[-0.0]).count(), 1);
        assert_eq!(changes(&[f32::NAN], &[f32::NAN]).count(), 0);
    }
}
