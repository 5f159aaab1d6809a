//! Questions as the shaders read them: the twins of the structs in `shaders/shared/`.
//!
//! # Rounding differences err toward visible
//!
//! A GPU may fuse `(a·dx + b·dy) + c`, round it in any direction, and flush denormal numbers. The
//! proxy's own constants allow for that (`geom/proxy.rs`), so answers stay right. But they should
//! also never be *less* visible than the answers of the software backend. Over a proxy of W × H
//! pixels, with M = |a|W + |b|H + |c|, four operations rounded to nearest err by less than
//! 3·2⁻²⁴·M, and rounded in any direction by less than twice that; what is flushed is below 4 of
//! the least normal number. So each `c` is raised by **ε = 12·2⁻²⁴·M** and 8 such numbers. Then
//! every sample that the software backend counts is counted here, and one that only the GPU counts
//! has an edge or plane within 2ε of its threshold.
//!
//! On OpenGL the depth range [0, 1] is emulated: clip space is stretched to [−1, 1] and the result
//! brought back. That rounds depth absolutely, not in proportion: `2z − w` by half a unit of w, the
//! division and the way back by one and a half; clipping and interpolation add no more than
//! elsewhere, but now to numbers up to 1. All of it is below 8·2⁻²⁴ of depth, which is added to
//! planes and nearest point ([`EMULATED_RANGE`]).

use std::mem::offset_of;

use bytemuck::{Pod, Zeroable};
use wgpu::{VertexAttribute, VertexBufferLayout, VertexFormat, VertexStepMode};

use crate::geom::{DepthDirection, PixelRect, Proxy, View, Viewport};

/// How much nearer than elsewhere geometry may be stored where the depth range is emulated.
pub(super) const EMULATED_RANGE: f32 = 8.0 / 16_777_216.0;

/// The side of a tile in pixels: what a workgroup looks at.
const TILE: u32 = 64;
/// The side of a block in pixels: what is decided at once, if it can be. Blocks lie on a grid that
/// starts at the viewport's corner, and tiles on that of blocks.
pub(super) const BLOCK: u32 = 8;

/// The same for a whole pass.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct PackedFrame {
    origin: [u32; 2],
    size: [u32; 2],
    sign: f32,
    samples: u32,
    unused: [u32; 2],
}

impl PackedFrame {
    pub(super) fn new(view: &View) -> Self {
        let Viewport { x, y, width, height } = view.viewport();
        let sign = match view.depth() {
            DepthDirection::Reversed => 1.0,
            DepthDirection::Standard => -1.0,
        };
        Self { origin: [x, y], size: [width, height], sign, samples: view.samples(), unused: [0; 2] }
    }
}

/// A proxy with its constants raised.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct PackedProxy {
    pub(super) rect: [u32; 4],
    edges: [[f32; 4]; 6],
    planes: [[f32; 4]; 3],
    pub(super) nearest: f32,
    any: u32,
    /// Filled in by the device.
    part: [u32; 2],
}

/// Slopes and constants beyond these are not evaluated: sums of products could overflow. Offsets
/// stay below 2¹⁵, so two products stay below a tenth of the greatest constant.
const STEEPEST: f32 = 1e32;
const GREATEST: f32 = 1e38;

impl PackedProxy {
    /// Proxies as the instances of a draw: all that their vertices need is the rectangle.
    pub(super) const LAYOUT: VertexBufferLayout<'static> = VertexBufferLayout {
        array_stride: size_of::<Self>() as u64,
        step_mode: VertexStepMode::Instance,
        attributes: &[VertexAttribute {
            format: VertexFormat::Uint32x4,
            offset: offset_of!(Self, rect) as u64,
            shader_location: 0,
        }],
    };

    /// None if the proxy cannot be evaluated, and so must be taken as visible. `slack` is added to
    /// its nearness.
    pub(super) fn new(proxy: &Proxy, viewport: Viewport, slack: f32, any: bool) -> Option<Self> {
        let PixelRect { x0, y0, x1, y1 } = proxy.rect;
        let rect = [x0, y0, x1.min(viewport.width), y1.min(viewport.height)];
        if rect[0] >= rect[2] || rect[1] >= rect[3] {
            return None;
        }
        let size = [(x1 - x0) as f32, (y1 - y0) as f32];
        let mut packed = Self { rect, any: u32::from(any), ..Self::zeroed() };
        for (to, from) in packed.edges.iter_mut().zip(&proxy.edges) {
            *to = raised(from, size, 0.0)?;
        }
        for (to, from) in packed.planes.iter_mut().zip(&proxy.planes) {
            *to = raised(from, size, slack)?;
        }
        packed.nearest = if slack > 0.0 { (proxy.nearest + slack).next_up() } else { proxy.nearest };
        (!packed.nearest.is_nan()).then_some(packed)
    }

    /// As it is evaluated.
    pub(super) fn unpacked(&self) -> Proxy {
        let [x0, y0, x1, y1] = self.rect;
        let three = |&[a, b, c, _]: &[f32; 4]| [a, b, c];
        let (edges, planes) = (self.edges.each_ref().map(three), self.planes.each_ref().map(three));
        Proxy { rect: PixelRect { x0, y0, x1, y1 }, edges, planes, nearest: self.nearest }
    }

    /// How many pixels the rectangle has.
    pub(super) fn pixels(&self) -> u64 {
        let [x0, y0, x1, y1] = self.rect;
        u64::from(x1 - x0) * u64::from(y1 - y0)
    }

    /// How many tiles the rectangle has.
    pub(super) fn tile_count(&self) -> u64 {
        let [columns, rows] = self.tile_grid();
        u64::from(columns) * u64::from(rows)
    }

    /// The rectangle's tiles, for the proxy at an index.
    pub(super) fn tiles(&self, proxy: u32) -> impl Iterator<Item = PackedTile> {
        let [columns, rows] = self.tile_grid();
        (0..rows)
            .flat_map(move |row| (0..columns).map(move |column| PackedTile { proxy, column, row, unused: 0 }))
    }

    fn tile_grid(&self) -> [u32; 2] {
        let [x0, y0, x1, y1] = self.rect;
        let tiles = |first: u32, end: u32| (end - first / BLOCK * BLOCK).div_ceil(TILE);
        [tiles(x0, x1), tiles(y0, y1)]
    }
}

/// A tile of a proxy's rectangle: what one workgroup looks at.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct PackedTile {
    proxy: u32,
    column: u32,
    row: u32,
    unused: u32,
}

/// What comes back for a proxy.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub(super) struct PackedCount {
    pub(super) visible: u32,
    pub(super) total: u32,
}

/// A function with its constant raised by ε, and by `slack`; see the module.
fn raised(&[a, b, c]: &[f32; 3], [width, height]: [f32; 2], slack: f32) -> Option<[f32; 4]> {
    const EPSILON: f64 = 12.0 / 16_777_216.0;
    let (a64, b64, c64) = (f64::from(a), f64::from(b), f64::from(c));
    let magnitude = a64.abs() * f64::from(width) + b64.abs() * f64::from(height) + c64.abs();
    let up = EPSILON * magnitude + 8.0 * f64::from(f32::MIN_POSITIVE) + f64::from(slack);
    // Beyond this bound a constant outweighs the rest by far: lowering it changes no answer.
    let c = ((c64 + up) as f32).next_up().clamp(-GREATEST, GREATEST);
    (a.abs() <= STEEPEST && b.abs() <= STEEPEST && !c.is_nan()).then_some([a, b, c, 0.0])
}

#[cfg(test)]
pub(super) mod tests {
    use wgpu::naga::front::wgsl;
    use wgpu::naga::{Module, TypeInner};

    use super::super::{Counting, Shaders};
    use super::*;

    /// The offsets of a struct's members and its size, as the shader has them.
    pub(in super::super) fn layout(module: &Module, name: &str) -> (Vec<(String, u32)>, u32) {
        let found = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name));
        match found.map(|(_, t)| &t.inner) {
            Some(TypeInner::Struct { members, span }) => {
                (members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset)).collect(), *span)
            }
            other => panic!("{name} is {other:?}"),
        }
    }

    macro_rules! assert_same_layout {
        ($module:expr, $name:literal, $packed:ty, [$($field:ident),*]) => {
            let want = vec![$((stringify!($field).to_owned(), offset_of!($packed, $field) as u32)),*];
            let layout = $crate::query::gpu::pack::tests::layout;
            assert_eq!(layout($module, $name), (want, size_of::<$packed>() as u32));
        };
    }

    pub(in super::super) use assert_same_layout;

    #[test]
    fn structs_lie_in_memory_as_the_shaders_think() {
        let shaders = Shaders::default();
        for multisampled in [false, true] {
            let source = shaders.source(Counting::Workgroups, multisampled);
            let module = wgsl::parse_str(source).expect("it parses");
            assert_same_layout!(&module, "Frame", PackedFrame, [origin, size, sign, samples, unused]);
            assert_same_layout!(&module, "Proxy", PackedProxy, [rect, edges, planes, nearest, any, part]);
            assert_same_layout!(&module, "Tile", PackedTile, [proxy, column, row, unused]);
            assert_same_layout!(&module, "Count", PackedCount, [visible, total]);
            for (name, value) in [("TILE", TILE), ("BLOCK", BLOCK)] {
                assert!(source.contains(&format!("const {name}: u32 = {value}u;")));
            }
            let gather = shaders.gather_blocks_source(multisampled);
            assert!(gather.contains(&format!("const BLOCK: u32 = {BLOCK}u;")));
        }
    }

    fn flat(nearest: f32) -> Proxy {
        let rect = PixelRect { x0: 3, y0: 2, x1: 130, y1: 66 };
        Proxy { rect, edges: [[0.0; 3]; 6], planes: [[0.0, 0.0, f32::MAX]; 3], nearest }
    }

    #[test]
    fn what_cannot_be_evaluated_is_not_packed() {
        let viewport = Viewport::new(200, 100);
        let pack = |proxy: &Proxy| PackedProxy::new(proxy, viewport, 0.0, false);
        assert!(pack(&flat(0.5)).is_some());
        assert!(pack(&flat(f32::NAN)).is_none());
        for bad in [[f32::NAN, 0.0, 0.0], [f32::INFINITY, 0.0, 0.0], [0.0, 1e33, 0.0], [0.0, 0.0, f32::NAN]] {
            let (mut edge, mut plane) = (flat(0.5), flat(0.5));
            (edge.edges[3], plane.planes[2]) = (bad, bad);
            assert!(pack(&edge).is_none() && pack(&plane).is_none(), "{bad:?}");
        }
        let beside = Proxy { rect: PixelRect { x0: 200, y0: 0, x1: 210, y1: 5 }, ..flat(0.5) };
        assert!(pack(&beside).is_none());
    }

    #[test]
    fn constants_rise_by_a_little() {
        let mut proxy = flat(0.5);
        (proxy.edges[0], proxy.planes[0]) = ([1.0, -0.5, -40.0], [1e-3, 0.0, 0.25]);
        let packed = PackedProxy::new(&proxy, Viewport::new(200, 100), 0.0, false).expect("usable");
        let rise = packed.edges[0][2] + 40.0;
        assert!(rise > 0.0 && rise < 3e-4, "{rise}");
        let rise = packed.planes[0][2] - 0.25;
        assert!(rise > 0.0 && rise < 1e-6, "{rise}");
        assert_eq!(packed.nearest, 0.5, "no arithmetic is done on it");
        let slack = PackedProxy::new(&proxy, Viewport::new(200, 100), EMULATED_RANGE, false).expect("usable");
        assert!(slack.nearest >= 0.5 + EMULATED_RANGE);
        assert!(slack.planes[0][2] >= packed.planes[0][2] + 0.9 * EMULATED_RANGE);
        assert_eq!(slack.edges, packed.edges);
    }

    #[test]
    fn tiles_cover_the_rectangle() {
        let packed = PackedProxy::new(&flat(0.5), Viewport::new(200, 100), 0.0, true).expect("usable");
        let tiles: Vec<_> = packed.tiles(7).map(|t| (t.proxy, t.column, t.row)).collect();
        // Columns 3 to 129 and rows 2 to 65, from the grid of blocks on.
        assert_eq!(tiles, [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)].map(|(x, y)| (7, x, y)));
        assert_eq!((packed.tile_count(), packed.pixels()), (6, 127 * 64));
    }
}
