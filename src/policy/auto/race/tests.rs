//! Races of ways whose times are made up.

use super::*;

/// All but one are admitted.
struct But(usize);

impl Ways for But {
    fn admits(&self, way: usize) -> bool {
        way != self.0
    }

    fn learns(&self, way: usize) -> [u32; 2] {
        if way.is_multiple_of(2) { [0, 0] } else { [3, 1] }
    }
}

const ALL: But = But(usize::MAX);

/// Runs a race in which each way takes a time a frame, and returns who ran how often.
fn run(race: &mut Race, frames: usize, time: impl Fn(usize, usize) -> f32) -> Vec<usize> {
    let mut ran = vec![0; race.ways.len()];
    let mut last = None;
    for frame in 0..frames {
        let way = race.next(last, &ALL);
        ran[way] += 1;
        last = Some((time(way, frame), 1));
    }
    ran
}

#[test]
fn the_fastest_wins_and_the_others_seldom_run() {
    let mut race = Race::new(4);
    let ran = run(&mut race, 1000, |way, _| [4.0, 3.0, 2.0, 2.5][way]);
    assert_eq!(race.champion(), 2);
    assert!(ran[2] > 850, "{ran:?}");
    let ratios: Vec<_> = race.records().iter().map(|record| record.ratio).collect();
    assert_eq!(ratios[2], None);
    assert!(ratios[3].is_some_and(|ratio| (ratio - 1.25).abs() < 0.01), "{ratios:?}");
}

#[test]
fn what_grows_dearer_for_all_is_no_ones_merit() {
    // The view wanders into a dearer place, and out of it: a tenth a frame, and one in three differs.
    for growth in [1.1f32, 0.91] {
        let mut race = Race::new(2);
        run(&mut race, 100, |_, frame| growth.powi(frame as i32) * if frame % 3 == 0 { 1.04 } else { 1.0 });
        assert_eq!(race.champion(), 0);
    }
}

#[test]
fn a_ruinous_challenger_runs_once() {
    let mut race = Race::new(3);
    let ran = run(&mut race, 60, |way, _| [1.0, 1.0, 10.0][way]);
    assert_eq!(ran[2], 1, "{ran:?}");
}

#[test]
fn trials_take_no_more_than_their_share() {
    let times = [1.0, 1.5, 1.6, 1.5, 1.7, 1.5];
    for frames in [60, 600, 6000] {
        let mut race = Race::new(times.len());
        let ran = run(&mut race, frames, |way, _| times[way]);
        let all: f32 = ran.iter().zip(times).map(|(&frames, time)| frames as f32 * time).sum();
        // One duel may begin while there is still something left.
        let most = frames as f32 * 1.03 + 1.5 + 6.0 * 0.7;
        assert!(all < most && ran[1] > 0, "{all} of {frames}: {ran:?}");
    }
}

/// Who ran where a device tells some frames later what a frame took; now and then it tells nothing.
fn run_late(race: &mut Race, times: &[f32], ago: usize, tells: impl Fn(usize) -> bool) -> Vec<usize> {
    let mut ran = Vec::new();
    for frame in 0..300 {
        let known = ran.len().checked_sub(ago).filter(|_| tells(frame));
        let told = known.map(|first| (times[ran[first]], ago as u32));
        ran.push(race.next(told, &ALL));
    }
    ran
}

#[test]
fn what_a_device_tells_late_is_held_against_its_frame() {
    for ago in 1..KEPT {
        let mut race = Race::new(3);
        let ran = run_late(&mut race, &[3.0, 2.0, 20.0], ago, |_| true);
        assert_eq!(race.champion(), 1, "{ago}: {ran:?}");
        let late = ran[50..].iter().filter(|&&way| way == 1).count();
        assert!(late > 225, "{ago}: {ran:?}");
        // It runs until its first time is known, and no longer.
        let hopeless = ran.iter().filter(|&&way| way == 2).count();
        assert!(hopeless <= 3 * ago.div_ceil(2), "{ago}, in three duels at most: {ran:?}");
    }
}

#[test]
fn times_that_are_lost_are_not_waited_for() {
    for ago in [1, 2, 3] {
        let wins = (0..9).filter(|seed| {
            let mut race = Race::new(2);
            // A quarter of them, as good as at random.
            let tells = |frame: usize| !(((frame + 97 * seed) * 40_503) >> 5).is_multiple_of(4);
            run_late(&mut race, &[3.0, 2.0], ago, tells);
            race.champion() == 1
        });
        assert!(wins.count() >= 8, "{ago}");
        // Of the challenger nothing is ever told: it runs seldom.
        let mut race = Race::new(2);
        let mut ran = Vec::new();
        for _ in 0..1000 {
            let last = ran.last().filter(|&&way| way == 0).map(|_| (1.0, 1));
            ran.push(race.next(last, &ALL));
        }
        let tried = ran.iter().filter(|&&way| way == 1).count();
        assert!(tried > 0 && tried < 100, "{tried}");
        let mut race = Race::new(2);
        let ran = run_late(&mut race, &[3.0, 2.0], ago, |frame| frame < 8);
        let last = ran.iter().rposition(|&way| way == 1);
        assert!(race.duel.is_none() && last.is_none_or(|last| last < 100), "{ago}: {ran:?}");
    }
}

#[test]
fn a_champion_that_falls_behind_is_found_out() {
    let mut race = Race::new(2);
    run(&mut race, 200, |way, _| [1.0, 2.0][way]);
    assert_eq!(race.champion(), 0);
    let mut frames = 0;
    let mut last = None;
    while race.champion() == 0 {
        let way = race.next(last, &ALL);
        last = Some(([3.0, 2.0][way], 1));
        frames += 1;
        assert!(frames < 600, "nobody noticed");
    }
}

#[test]
fn without_times_nothing_happens() {
    let mut race = Race::new(3);
    assert!((0..100).all(|_| race.next(None, &ALL) == 0));
    assert_eq!(race.duels, 0);
}

#[test]
fn who_is_not_admitted_does_not_run() {
    let mut race = Race::new(3);
    let mut last = None;
    for _ in 0..500 {
        let way = race.next(last, &But(1));
        assert_ne!(way, 1);
        last = Some(([3.0, 1.0, 2.0][way], 1));
    }
    assert_eq!(race.champion(), 2);
}

/// Rivals whose times are close, and a champion that is held up now and then.
#[test]
fn rivals_take_no_more_than_their_share() {
    for rival in [1.1, 1.2, 1.3, 1.45] {
        let mut race = Race::new(3);
        let held_up = |frame: usize| if frame.is_multiple_of(12) { 1.6 } else { 1.0 };
        let time = |way: usize, frame: usize| [1.0, rival, 2.0][way] * held_up(frame);
        let (mut last, mut lost) = (None, 0.0);
        for frame in 0..2000 {
            let way = race.next(last, &ALL);
            lost += (time(way, frame) - time(0, frame)) / 2000.0;
            last = Some((time(way, frame), 1));
        }
        assert_eq!(race.champion(), 0);
        assert!(lost < 0.07, "a rival of {rival} costs {lost}");
    }
}
