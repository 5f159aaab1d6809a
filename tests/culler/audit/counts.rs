//! What was lost, to the object and to the sample.

use std::collections::{HashMap, HashSet};

use tercet::audit::{Auditor, Blame};
use tercet::query::software::SoftwareQueries;
use tercet::scene::ObjectId;
use tercet::{Tradeoff, Why};

use super::lying::Lying;
use super::watch::{FRAMES, Watch};
use crate::painter::draw;
use crate::stage::Stage;

#[test]
fn what_is_exact_loses_nothing() {
    for name in ["dual-query", "chc++", "hroc", "hierarchy-b"] {
        let mut culled = 0;
        for seed in 0..4 {
            let auditor = Watch::new(name, seed, Tradeoff::EXACT, SoftwareQueries::new()).run(|_, audit| {
                assert_eq!((audit.lost.len(), audit.wrong_pixels), (0, 0), "{name}");
                assert!(audit.visible <= audit.drawn);
                culled += audit.culled;
            });
            let estimate = auditor.estimate();
            assert_eq!((estimate.frames, estimate.lost, estimate.wrong_share.mean), (FRAMES, 0, 0.0));
            assert!((estimate.lossy_frames.high - (1.0 - 0.05f64.powf(1.0 / 14.0))).abs() < 1e-9);
            assert!(estimate.to_string().starts_with("14 frames checked, nothing lost"), "{estimate}");
            assert_eq!(auditor.blamed().count(), 0);
        }
        assert!(culled > 500, "{name} culled {culled}");
    }
}

#[test]
fn what_a_threshold_loses_is_reported_to_the_sample() {
    for name in ["dual-query", "chc", "nohc"] {
        let (mut all, mut owned, mut frames_with) = (0, 0, 0);
        for seed in 0..4 {
            let tradeoff = Tradeoff { visible_pixels: 60, ..Tradeoff::EXACT };
            let (mut sum, mut wrong_shares) = (0, Vec::new());
            let auditor = Watch::new(name, seed, tradeoff, SoftwareQueries::new()).run(|watch, audit| {
                let (lost, wrong) = watch.expected();
                let reported: HashMap<ObjectId, u32> =
                    audit.lost.iter().map(|lost| (lost.object.id, lost.samples)).collect();
                assert_eq!(reported, lost, "{name}, seed {seed}");
                assert_eq!((audit.lost.len(), audit.wrong_pixels), (lost.len(), wrong));
                for lost in &audit.lost {
                    assert_eq!(lost.dial(), Some("visible_pixels"), "{lost}");
                    assert_eq!(lost.share, f64::from(lost.samples) / 14_400.0);
                    assert_eq!(lost.bounds, watch.scene.object(lost.object.id).and_then(|o| o.bounds));
                    assert!(matches!(lost.why, Why::Hidden(_)) && !lost.why.is_drawn());
                    let recount = lost.recount.expect("a box that was asked about");
                    assert!((lost.samples.max(1)..=60).contains(&recount.visible), "{lost}");
                    owned += lost.samples;
                }
                sum += audit.lost.len() as u64;
                frames_with += u32::from(sum > 0);
                wrong_shares.push(wrong as f64 / 14_400.0);
            });
            let estimate = auditor.estimate();
            assert_eq!(estimate.lost, sum);
            assert!((estimate.wrong_share.mean - wrong_shares.iter().sum::<f64>() / 14.0).abs() < 1e-12);
            assert_eq!(estimate.worst_wrong_share, wrong_shares.into_iter().fold(0.0, f64::max));
            let blamed: Vec<_> = auditor.blamed().collect();
            assert_eq!(blamed, if sum > 0 { vec![(Blame::Dial("visible_pixels"), sum)] } else { vec![] });
            all += sum;
        }
        assert!(all > 100 && owned > 500 && frames_with > 20, "{name}: {all} lost, {owned} samples");
    }
}

/// What is said to be hidden although it is in sight.
#[test]
fn lies_are_defects() {
    for (threshold, expected) in [(0, &["A DEFECT"] as &[_]), (8, &["A DEFECT", "visible_pixels"])] {
        let mut found = HashSet::new();
        for seed in 0..4 {
            let tradeoff = Tradeoff { visible_pixels: threshold, ..Tradeoff::EXACT };
            let liar = Lying(SoftwareQueries::new());
            Watch::new("dual-query", seed, tradeoff, liar).run(|watch, audit| {
                assert_eq!(audit.lost.len(), watch.expected().0.len());
                for lost in &audit.lost {
                    // It lies about fewer than 20 samples; the box had no more when it was asked about.
                    let visible = lost.recount.expect("it was asked about").visible;
                    assert!((1..20).contains(&visible), "{lost}");
                    let is_within = visible <= threshold;
                    assert_eq!(lost.dial(), is_within.then_some("visible_pixels"), "{lost}");
                    assert_eq!(lost.blame == Blame::Defect, !is_within);
                    let text = lost.to_string();
                    found.extend(
                        ["A DEFECT", "visible_pixels"].into_iter().filter(|word| text.contains(word)),
                    );
                }
            });
        }
        assert_eq!(found, expected.iter().copied().collect(), "threshold {threshold}");
    }
}

#[test]
fn frames_that_are_not_due_are_left_alone() {
    let mut watch = Watch::new("dual-query", 1, Tradeoff::EXACT, SoftwareQueries::new());
    let mut auditor = Auditor::new(4);
    assert!(auditor.last().is_none());
    let mut checked = Vec::new();
    for number in 0..10 {
        watch.frame(number);
        let Watch { stage: Stage { world, detail, .. }, scene, eye, view, .. } = &watch;
        let mut calls = 0;
        let audit = auditor.check(scene, view, eye, |pass, objects| {
            calls += 1;
            draw(world, view, *detail, pass, objects);
        });
        match audit.expect("it looks") {
            None => assert_eq!(calls, 0),
            Some(audit) => {
                assert_eq!(calls, scene.len() + 2, "each object, and what was drawn");
                checked.push(audit.frame);
            }
        }
    }
    assert_eq!(checked, [4, 8]);
    assert_eq!((auditor.estimate().frames, auditor.last().map(|audit| audit.frame)), (2, Some(8)));
}
