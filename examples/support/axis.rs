//! How axes look, and where they end.

use plotters::chart::MeshStyle;
use plotters::prelude::*;

use super::canvas::{FAINT, GRID, INK, px, text};

/// The house's style of axes and grid.
pub fn plain<'a, 'b, 'm, X, Y>(
    mesh: &'m mut MeshStyle<'a, 'b, X, Y, BitMapBackend<'a>>,
) -> &'m mut MeshStyle<'a, 'b, X, Y, BitMapBackend<'a>>
where
    X: Ranged,
    Y: Ranged,
{
    mesh.light_line_style(TRANSPARENT)
        .bold_line_style(GRID.stroke_width(px(1) as u32))
        .axis_style(FAINT.stroke_width(px(1) as u32))
        .label_style(text(13, FAINT))
        .axis_desc_style(text(14, INK))
}

/// A round number to end an axis at: the least of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten
/// that is not below `x`.
pub fn nice_top(x: f64) -> f64 {
    let x = x.max(1e-3);
    let power = 10f64.powf(x.log10().floor());
    [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0]
        .into_iter()
        .map(|step| step * power)
        .find(|&top| top >= x)
        .unwrap_or(10.0 * power)
}
