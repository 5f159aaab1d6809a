//! What is compared.

use plotters::style::RGBColor;

use crate::algorithm::Algorithm;

/// Indices into [`ALGORITHMS`].
pub const VFC: usize = 0;
/// See [`VFC`].
pub const CHC: usize = 1;
/// See [`VFC`].
pub const NOHC: usize = 2;
/// See [`VFC`].
pub const PLUS_PLUS: usize = 7;
/// See [`VFC`].
pub const DUAL: usize = 8;
/// See [`VFC`].
pub const OPT: usize = 9;

/// Those of all algorithms: `--set` reaches their dials, but for what an algorithm is made of.
pub const POLICIES: [&str; 4] = ["chc", "nohc", "chc++", "dual-query"];

/// In the order of the page. From +B to CHC++, each has one optimisation more.
pub const ALGORITHMS: [Algorithm; 10] = [
    Algorithm { name: "VFC", color: RGBColor(150, 158, 168), policy: "frustum", dials: &[] },
    Algorithm { name: "CHC", color: RGBColor(214, 84, 62), policy: "chc", dials: &[] },
    Algorithm { name: "NOHC", color: RGBColor(60, 60, 70), policy: "nohc", dials: &[] },
    Algorithm {
        name: "+B",
        color: RGBColor(240, 150, 40),
        policy: "chc++",
        dials: &[
            ("randomised", "false"),
            ("tight", "false"),
            ("multiqueries", "false"),
            ("regroup", "false"),
            ("guess", "false"),
        ],
    },
    Algorithm {
        name: "+B+R",
        color: RGBColor(200, 180, 40),
        policy: "chc++",
        dials: &[("tight", "false"), ("multiqueries", "false"), ("regroup", "false"), ("guess", "false")],
    },
    Algorithm {
        name: "+B+R+TB",
        color: RGBColor(110, 190, 200),
        policy: "chc++",
        dials: &[("multiqueries", "false"), ("regroup", "false"), ("guess", "false")],
    },
    Algorithm {
        name: "+B+R+TB+MQ",
        color: RGBColor(90, 130, 220),
        policy: "chc++",
        dials: &[("regroup", "false"), ("guess", "false")],
    },
    Algorithm { name: "CHC++ (+G)", color: RGBColor(31, 80, 160), policy: "chc++", dials: &[] },
    Algorithm { name: "dual-query (ours)", color: RGBColor(150, 100, 180), policy: "dual-query", dials: &[] },
    Algorithm { name: "OPT", color: RGBColor(44, 160, 90), policy: "opt", dials: &[] },
];
