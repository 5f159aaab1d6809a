//! What is compared.

use plotters::style::RGBColor;
use tercet::query::SweepTest;

use crate::algorithm::Algorithm;

/// Indices into [`ALGORITHMS`].
pub const VFC: usize = 1;
/// See [`VFC`].
pub const PLUS_PLUS: usize = 2;
/// See [`VFC`].
pub const ROC: usize = 3;
/// See [`VFC`].
pub const HI_Z: usize = 4;
/// See [`VFC`].
pub const HROC: usize = 5;
/// See [`VFC`].
pub const FILTERED: usize = 6;
/// See [`VFC`].
pub const HYBRID: usize = 7;
/// See [`VFC`].
pub const AUTO: usize = 8;
/// See [`VFC`].
pub const REF: usize = 10;

/// As published: by boxes alone.
const UNFILTERED: &[(&str, &str)] = &[("occluder_filtering", "false"), ("by_geometry", "false")];
const WITH_FILTER: &[(&str, &str)] = &[("occluder_filtering", "true")];

/// In the order of the page: the paper's names, and ours.
pub const ALGORITHMS: [Algorithm; 11] = [
    of("NOC", RGBColor(196, 200, 206), "none", &[]),
    of("VFC", RGBColor(150, 158, 168), "frustum", &[]),
    of("CHC++", RGBColor(31, 119, 180), "chc++", &[]),
    of("ROC", RGBColor(214, 84, 62), "roc", &[]),
    of("Hi-Z", RGBColor(240, 150, 40), "hi-z", &[]),
    of("HROC", RGBColor(200, 180, 40), "hroc", UNFILTERED),
    of("HROC OF", RGBColor(110, 190, 200), "hroc", WITH_FILTER),
    of("hybrid (ours)", RGBColor(190, 100, 150), "hybrid", &[]),
    of("auto (ours)", RGBColor(90, 90, 100), "auto", &[]),
    of("dual-query (ours)", RGBColor(150, 100, 180), "dual-query", &[]),
    of("REF", RGBColor(44, 160, 90), "exact", &[]),
];

/// Those that the device runs by itself, with how it tests; on the GPU they come after the others.
pub const GPU_DRIVEN: [(Algorithm, SweepTest); 3] = [
    (of("ROC, GPU-driven", RGBColor(140, 50, 35), "roc", &[]), SweepTest::Raster),
    (of("Hi-Z, GPU-driven", RGBColor(160, 95, 15), "hi-z", &[]), SweepTest::HiZ),
    (of("HROC, GPU-driven", RGBColor(60, 120, 130), "hroc", &[]), SweepTest::Rays),
];

/// All of them, in the order of the page.
pub fn all() -> impl Iterator<Item = &'static Algorithm> {
    const { &ALGORITHMS }.iter().chain(const { &GPU_DRIVEN }.iter().map(|(algorithm, _)| algorithm))
}

const fn of(
    name: &'static str,
    color: RGBColor,
    policy: &'static str,
    dials: &'static [(&'static str, &'static str)],
) -> Algorithm {
    Algorithm { name, color, policy, dials }
}
