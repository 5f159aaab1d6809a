//! What Lee et al. 2021 measured: 1080p, RTX 2080 Ti.

use super::algorithms::{FILTERED, HROC, PLUS_PLUS, REF, ROC, VFC};

/// The figures of one scene.
pub struct Published {
    /// As the paper abbreviates it.
    pub scene: &'static str,
    /// Everything drawn, view-frustum culling, CHC++, ROC, HROC with filtering, REF.
    milliseconds: [f64; 6],
    /// VFC, CHC++ and ROC, HROC without filtering, HROC with it.
    culled: [f64; 4],
}

/// Few complex objects.
pub const FANTASY: Published =
    Published { scene: "FN", milliseconds: [4.8, 3.9, 8.8, 1.3, 1.2, 0.8], culled: [0.65, 0.97, 0.83, 0.97] };
/// Wide and detailed.
pub const FACTORY: Published =
    Published { scene: "FC", milliseconds: [25.5, 25.7, 9.1, 3.9, 2.2, 0.5], culled: [0.41, 1.0, 0.92, 1.0] };
/// Many objects of few triangles.
pub const CITY: Published = Published {
    scene: "RC",
    milliseconds: [44.3, 21.0, 32.6, 5.9, 3.3, 0.9],
    culled: [0.85, 0.99, 0.98, 0.99],
};
/// The same with a fast camera.
pub const CITY_FAST: Published = Published {
    scene: "RC′",
    milliseconds: [45.1, 20.6, 39.6, 6.0, 3.3, 0.7],
    culled: [0.86, 0.98, 0.98, 0.99],
};
/// Detailed and many.
pub const SATELLITES: Published = Published {
    scene: "ST",
    milliseconds: [66.6, 37.1, 88.1, 14.6, 11.7, 6.7],
    culled: [0.81, 0.98, 0.96, 0.98],
};

impl Published {
    /// An algorithm's time over REF's.
    pub fn time_over_ref(&self, algorithm: usize) -> Option<f64> {
        let [noc, vfc, plus_plus, roc, filtered, reference] = self.milliseconds;
        let time = match algorithm {
            0 => noc,
            VFC => vfc,
            PLUS_PLUS => plus_plus,
            ROC => roc,
            FILTERED => filtered,
            REF => reference,
            _ => return None,
        };
        Some(time / reference)
    }

    /// Objects culled over those that REF culls.
    pub fn culled(&self, algorithm: usize) -> Option<f64> {
        let [vfc, queries, unfiltered, filtered] = self.culled;
        match algorithm {
            VFC => Some(vfc),
            PLUS_PLUS | ROC => Some(queries),
            HROC => Some(unfiltered),
            FILTERED => Some(filtered),
            REF => Some(1.0),
            _ => None,
        }
    }
}
