//! For how long what was visible goes unasked.

use tercet::policy::{Chc, ChcPlusPlus, Policy};

use super::script::Script;

const ALL: &[&str] = &["0123", "01", "23", "0", "1", "2", "3"];

/// The frames after the first in which a leaf is asked about, of so many.
fn asked(policy: &mut dyn Policy, leaf: &str, frames: usize) -> Vec<usize> {
    let mut script = Script::row(4);
    let first = script.frame(policy, ALL);
    assert!(first.contains(&format!("draw {leaf}")), "{first}");
    let question = format!("ask {leaf}");
    (1..=frames).filter(|_| script.frame(policy, ALL).split(", ").any(|step| step == question)).collect()
}

#[test]
fn chc_assumes_for_n_av_frames_and_asks_in_the_next() {
    for (n_av, expected) in [(0, vec![1, 2, 3, 4, 5, 6, 7, 8]), (1, vec![2, 4, 6, 8]), (3, vec![4, 8])] {
        let mut chc = Chc::default();
        chc.n_av = n_av;
        assert_eq!(asked(&mut chc, "0", 8), expected, "n_av = {n_av}");
    }
}

#[test]
fn chc_plus_plus_asks_every_n_av_frames() {
    for (n_av, expected) in
        [(0, vec![1, 2, 3, 4, 5, 6, 7, 8]), (1, vec![1, 2, 3, 4, 5, 6, 7, 8]), (4, vec![4, 8])]
    {
        let mut policy = ChcPlusPlus::default();
        (policy.n_av, policy.randomised, policy.tight) = (n_av, false, false);
        assert_eq!(asked(&mut policy, "0", 8), expected, "n_av = {n_av}");
    }
}

/// Leaves that turned visible together are not asked about together for ever.
#[test]
fn the_first_question_comes_after_a_random_time_and_the_others_regularly() {
    let mut firsts = Vec::new();
    for leaves in [4, 8, 16] {
        let mut script = Script::row(leaves);
        let mut policy = ChcPlusPlus::default();
        (policy.tight, policy.multiqueries) = (false, false);
        let names: Vec<String> = (0..leaves).map(|leaf| leaf.to_string()).collect();
        // Whatever is asked about is visible.
        let groups: Vec<String> = (0..leaves)
            .flat_map(|from| (from + 1..=leaves).map(move |to| (from..to).map(|i| i.to_string()).collect()))
            .collect();
        let all: Vec<&str> = groups.iter().map(String::as_str).collect();
        let frames: Vec<String> = (0..31).map(|_| script.frame(&mut policy, &all)).collect();
        assert!(names.iter().all(|leaf| frames[0].split(", ").any(|step| step == format!("draw {leaf}"))));
        for leaf in names {
            let question = format!("ask {leaf}");
            let asked = |frame: &usize| frames[*frame].split(", ").any(|step| step == question);
            let asked: Vec<usize> = (1..31).filter(asked).collect();
            assert!((1..10).contains(&asked[0]), "0 < r < n_av: {asked:?}");
            assert!(asked.windows(2).all(|pair| pair[1] - pair[0] == 10), "{asked:?}");
            firsts.push(asked[0]);
        }
    }
    firsts.sort_unstable();
    firsts.dedup();
    assert!(firsts.len() >= 7, "they are spread: {firsts:?}");
}
