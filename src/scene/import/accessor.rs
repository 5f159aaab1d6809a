//! Reading accessors, dense and sparse. Every range is checked before the first element is read.

use std::array;

use gltf::json::accessor::{Accessor, ComponentType, Type};
use gltf::json::buffer::View;
use gltf::json::validation::{Checked, USize64};
use gltf::json::{Index, accessor};

use super::file::{File, get};

/// Elements without a buffer view are zeros, and cost a file nothing: more than this many in one
/// accessor are refused, lest a small file fill the memory.
const MOST_VIRTUAL: u64 = 1 << 24;

/// What an accessor must hold for its use.
pub(super) struct Wanted {
    /// In words, for messages.
    pub(super) what: &'static str,
    pub(super) shape: Type,
    pub(super) components: &'static [ComponentType],
}

/// The quantised kinds are `KHR_mesh_quantization`'s.
pub(super) const POSITIONS: Wanted = Wanted {
    what: "positions",
    shape: Type::Vec3,
    components: &[
        ComponentType::F32,
        ComponentType::I8,
        ComponentType::U8,
        ComponentType::I16,
        ComponentType::U16,
    ],
};

pub(super) const INDICES: Wanted = Wanted {
    what: "indices",
    shape: Type::Scalar,
    components: &[ComponentType::U8, ComponentType::U16, ComponentType::U32],
};

/// An accessor all of whose elements are known to lie inside their buffers.
pub(super) struct Elements<'a> {
    count: usize,
    component: ComponentType,
    normalized: bool,
    /// None: zeros.
    base: Option<Strided<'a>>,
    /// Which elements are replaced, ascending, and by what.
    replaced: Vec<u32>,
    values: Option<Strided<'a>>,
}

struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl<'a> Elements<'a> {
    /// Checks an accessor; the message of an error names it.
    pub(super) fn new(file: &'a File, index: Index<Accessor>, wanted: &Wanted) -> Result<Self, String> {
        let accessor = get(&file.root.accessors, index, "accessor")?;
        Self::checked(file, accessor, wanted).map_err(|why| format!("accessor {} {why}", index.value()))
    }

    fn checked(file: &'a File, accessor: &Accessor, wanted: &Wanted) -> Result<Self, String> {
        let component = match accessor.component_type {
            Checked::Valid(c) if wanted.components.contains(&c.0) => c.0,
            Checked::Valid(c) => return Err(format!("holds {:?}, which {} cannot be", c.0, wanted.what)),
            Checked::Invalid => return Err("has a componentType that glTF does not know".into()),
        };
        match accessor.type_ {
            Checked::Valid(shape) if shape == wanted.shape => {}
            Checked::Valid(shape) => {
                return Err(format!("holds {shape:?}; {} need {:?}", wanted.what, wanted.shape));
            }
            Checked::Invalid => return Err("has a type that glTF does not know".into()),
        }
        let count = match usize::try_from(accessor.count.0) {
            Ok(count) if count <= u32::MAX as usize => count,
            _ => return Err(format!("claims {} elements: too many", accessor.count.0)),
        };
        let size = component.size() * wanted.shape.multiplicity();
        let offset = accessor.byte_offset.unwrap_or_default();
        let base = match accessor.buffer_view {
            Some(view) => Some(Strided::new(file, view, offset, count, size)?),
            None if accessor.count.0 > MOST_VIRTUAL => {
                return Err(format!("claims {count} elements and has no buffer view"));
            }
            None => None,
        };
        let (mut replaced, mut values) = (Vec::new(), None);
        if let Some(sparse) = &accessor.sparse {
            let read = || -> Result<_, String> {
                let replaced = sparse_indices(file, sparse, count)?;
                let v = &sparse.values;
                let values = Strided::new(file, v.buffer_view, v.byte_offset, replaced.len(), size)?;
                Ok((replaced, Some(values)))
            };
            (replaced, values) = read().map_err(|why| format!("is sparse, and {why}"))?;
        }
        Ok(Self { count, component, normalized: accessor.normalized, base, replaced, values })
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Whether the file holds anything for it: neither a buffer view nor sparse values mean that
    /// an extension that is not read has the data.
    pub(super) fn has_data(&self) -> bool {
        self.base.is_some() || self.values.is_some()
    }

    /// All elements, as unsigned integers.
    pub(super) fn integers(&self) -> Vec<u32> {
        let all = 0..self.count;
        match self.component {
            ComponentType::U8 => self.read(all, |b| b[0].into()).collect(),
            ComponentType::U16 => self.read(all, |b| u16::from_le_bytes([b[0], b[1]]).into()).collect(),
            _ => self.read(all, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect(),
        }
    }

    /// Some elements, as vectors of `N` numbers. O(elements · log replaced).
    pub(super) fn floats<const N: usize>(
        &self,
        which: impl Iterator<Item = usize>,
    ) -> impl Iterator<Item = [f32; N]> {
        let (component, normalized, size) = (self.component, self.normalized, self.component.size());
        self.read(which, move |b| array::from_fn(|i| number(&b[i * size..], component, normalized)))
    }

    fn read<T>(
        &self,
        which: impl Iterator<Item = usize>,
        decode: impl Fn(&[u8]) -> T,
    ) -> impl Iterator<Item = T> {
        /// As many as the largest element has.
        const ZEROS: [u8; 16] = [0; 16];
        which.map(move |i| {
            let replaced = self
                .values
                .as_ref()
                .and_then(|values| Some(values.element(self.replaced.binary_search(&(i as u32)).ok()?)));
            let base = || self.base.as_ref().map(|base| base.element(i));
            decode(replaced.or_else(base).unwrap_or(&ZEROS))
        })
    }
}

impl<'a> Strided<'a> {
    fn new(
        file: &'a File,
        view: Index<View>,
        offset: USize64,
        count: usize,
        size: usize,
    ) -> Result<Self, String> {
        let (v, of) = (view.value(), file.view(view).map_err(|why| format!("cannot be read: {why}"))?);
        let stride = of.stride.unwrap_or(size);
        if stride < size {
            return Err(format!("has elements of {size} bytes in buffer view {v} of stride {stride}"));
        }
        // In u128 nothing overflows.
        let length = if count == 0 { 0 } else { (count as u128 - 1) * stride as u128 + size as u128 };
        if u128::from(offset.0) + length > of.bytes.len() as u128 {
            let (start, all) = (offset.0, of.bytes.len());
            return Err(format!(
                "reads past its buffer view {v}: {length} bytes from byte {start}, of {all} bytes"
            ));
        }
        Ok(Self { bytes: &of.bytes[offset.0 as usize..], stride, size })
    }

    fn element(&self, i: usize) -> &'a [u8] {
        &self.bytes[i * self.stride..][..self.size]
    }
}

/// The elements that a sparse accessor replaces, ascending.
fn sparse_indices(file: &File, sparse: &accessor::sparse::Sparse, count: usize) -> Result<Vec<u32>, String> {
    let Checked::Valid(component) = sparse.indices.component_type else {
        return Err("the componentType of its indices is not one of unsigned integers".into());
    };
    let replaced = usize::try_from(sparse.count.0).ok().filter(|&n| n <= count);
    let replaced = replaced
        .ok_or_else(|| format!("replaces {} elements of {count}: more than there are", sparse.count.0))?;
    let component = component.0;
    let (view, offset) = (sparse.indices.buffer_view, sparse.indices.byte_offset);
    let base = Some(Strided::new(file, view, offset, replaced, component.size())?);
    let elements =
        Elements { count: replaced, component, normalized: false, base, replaced: Vec::new(), values: None };
    let indices = elements.integers();
    if let Some(pair) = indices.windows(2).find(|pair| pair[0] >= pair[1]) {
        return Err(format!("replaces element {} after element {}: out of order", pair[1], pair[0]));
    }
    match indices.last() {
        Some(&i) if i as usize >= count => Err(format!("replaces element {i} of {count}")),
        _ => Ok(indices),
    }
}

/// One component; normalised integers map to −1 to 1, or 0 to 1 (glTF 2.0, §3.11).
fn number(bytes: &[u8], component: ComponentType, normalized: bool) -> f32 {
    let (value, most) = match component {
        ComponentType::F32 => return f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        ComponentType::I8 => (f32::from(bytes[0].cast_signed()), 127.0),
        ComponentType::U8 => (f32::from(bytes[0]), 255.0),
        ComponentType::I16 => (f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32_767.0),
        ComponentType::U16 => (f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65_535.0),
        ComponentType::U32 => {
            (u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as f32, u32::MAX as f32)
        }
    };
    if normalized { (value / most).max(-1.0) } else { value }
}
