//! What is compared.

use plotters::style::RGBColor;

use crate::algorithm::Algorithm;

/// Indices into [`ALGORITHMS`].
pub const VFC: usize = 0;
/// See [`VFC`].
pub const CHC: usize = 1;
/// See [`VFC`].
pub const PLUS_PLUS: usize = 5;
/// See [`VFC`].
pub const DUAL: usize = 6;
/// See [`VFC`].
pub const OPT: usize = 7;

/// In the order of the page. From CHC to CHC++, each has one optimisation more.
pub const ALGORITHMS: [Algorithm; 8] = [
    Algorithm { name: "VFC", color: RGBColor(150, 158, 168), policy: "frustum", dials: &[] },
    Algorithm { name: "CHC", color: RGBColor(214, 84, 62), policy: "chc", dials: &[] },
    Algorithm {
        name: "+B",
        color: RGBColor(240, 150, 40),
        policy: "chc++",
        dials: &[("randomised", "false"), ("tight", "false"), ("multiqueries", "false")],
    },
    Algorithm {
        name: "+B+R",
        color: RGBColor(200, 180, 40),
        policy: "chc++",
        dials: &[("tight", "false"), ("multiqueries", "false")],
    },
    Algorithm {
        name: "+B+R+TB",
        color: RGBColor(110, 190, 200),
        policy: "chc++",
        dials: &[("multiqueries", "false")],
    },
    Algorithm { name: "CHC++ (+MQ)", color: RGBColor(31, 119, 180), policy: "chc++", dials: &[] },
    Algorithm { name: "dual-query (ours)", color: RGBColor(150, 100, 180), policy: "dual-query", dials: &[] },
    Algorithm { name: "OPT", color: RGBColor(44, 160, 90), policy: "opt", dials: &[] },
];
