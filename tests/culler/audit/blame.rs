//! Which dial is to blame for what was lost.

use std::collections::HashMap;

use tercet::audit::{Blame, FalseCull};
use tercet::policy;
use tercet::query::software::SoftwareQueries;
use tercet::scene::ObjectId;
use tercet::{Holder, Latency, Tradeoff, Why};

use super::watch::{Shown, Watch};
use crate::SCREEN;

/// Runs with dials that each lose something, and returns how much each is blamed for. The names of what is
/// lost are compared with what should be.
fn blamed(
    name: &str,
    tradeoff: Tradeoff,
    coarse: u32,
    each: impl Fn(&Watch<SoftwareQueries>, &FalseCull),
) -> HashMap<Blame, u64> {
    let mut all = HashMap::new();
    for seed in 0..6 {
        let auditor = Watch::new(name, seed, tradeoff, SoftwareQueries::new()).run(|watch, audit| {
            assert_eq!(watch.queries.shown().depth().width(), SCREEN.width / coarse);
            let (lost, wrong) = watch.expected();
            let reported: HashMap<ObjectId, u32> =
                audit.lost.iter().map(|lost| (lost.object.id, lost.samples)).collect();
            assert_eq!((reported, audit.wrong_pixels), (lost, wrong), "{name}, seed {seed}");
            audit.lost.iter().for_each(|lost| each(watch, lost));
        });
        auditor.blamed().for_each(|(blame, lost)| *all.entry(blame).or_default() += lost);
    }
    all
}

#[test]
fn a_coarse_depth_is_blamed() {
    for name in ["dual-query", "chc++", "roc", "hroc"] {
        let tradeoff = Tradeoff { resolution_divisor: 4, ..Tradeoff::EXACT };
        let blamed = blamed(name, tradeoff, 4, |_, _| {});
        assert!(blamed[&Blame::Dial("resolution_divisor")] > 10 && blamed.len() == 1, "{name}: {blamed:?}");
    }
}

#[test]
fn late_questions_are_blamed() {
    for name in ["dual-query", "chc", "statistical"] {
        let tradeoff = Tradeoff { latency: Latency::Late(2), ..Tradeoff::EXACT };
        let blamed = blamed(name, tradeoff, 1, |_, _| {});
        assert!(blamed[&Blame::Dial("latency")] > 10 && blamed.len() == 1, "{name}: {blamed:?}");
    }
}

#[test]
fn of_several_dials_each_gets_its_share() {
    let (latency, visible_pixels) = (Latency::Late(2), 12);
    let tradeoff = Tradeoff { latency, visible_pixels, resolution_divisor: 2, ..Tradeoff::EXACT };
    let blamed = blamed("dual-query", tradeoff, 2, |watch, lost| {
        let Why::Hidden(Holder { bounds: node, .. }) = lost.why else { return };
        let (full, coarse) = (watch.in_sight(&node, 1), watch.in_sight(&node, 2));
        assert_eq!(lost.recount.map_or(u32::MAX, |samples| samples.visible), full);
        // Twelve pixels are three samples of a depth of half as many columns and rows.
        let dial = match (full <= 12, coarse <= 3) {
            (_, false) => "latency",
            (true, true) => "visible_pixels",
            (false, true) => "resolution_divisor",
        };
        assert_eq!(lost.dial(), Some(dial), "{full}, {coarse}: {lost}");
    });
    for key in ["visible_pixels", "resolution_divisor", "latency"] {
        assert!(blamed.get(&Blame::Dial(key)).is_some_and(|&lost| lost > 5), "{key}: {blamed:?}");
    }
    assert_eq!(blamed.len(), 3, "{blamed:?}");
}

/// Whatever a policy asks about, and in whichever way: what a dial explains is no defect.
#[test]
fn no_policys_loss_is_called_a_defect() {
    let finds_out = |name: &str| policy::by_name(name).is_ok_and(|policy| policy.wants_recorded().is_none());
    for name in policy::NAMES.iter().copied().filter(|name| finds_out(name)) {
        let late = Tradeoff { latency: Latency::Late(2), ..Tradeoff::FAST };
        let coarse = Tradeoff { resolution_divisor: 4, ..Tradeoff::FAST };
        let mut all = 0;
        for (seed, tradeoff) in [coarse, late, Tradeoff { swept: true, ..late }].into_iter().enumerate() {
            Watch::new(name, seed as u64, tradeoff, SoftwareQueries::new()).run(|_, audit| {
                audit.lost.iter().for_each(|lost| assert_ne!(lost.dial(), None, "{name}: {lost}"));
                all += audit.lost.len();
            });
        }
        assert_eq!(all == 0, matches!(name, "none" | "frustum"), "{name} lost {all}");
    }
}
