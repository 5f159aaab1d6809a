//! The gate through frames whose times were measured, and through others that never end.

use super::gate::{Gate, Plan};
use crate::costs::{FrameCost, KEPT};

/// A frame, as either way would have it.
#[derive(Clone, Copy)]
struct Frame {
    in_view: f32,
    /// What it takes to draw all of that.
    whole: f32,
    /// Asking: objects drawn, all it takes, and the part of it that is drawing.
    drawn: u32,
    asking: f32,
    drawing: f32,
}

/// What a policy pays once, when it first asks.
const FIRST: f32 = 72.0;

/// Sums over a run: of the gate's frames, and of those that ask, and that draw, from first to last.
#[derive(Debug, Default)]
struct Sums {
    gate: f32,
    asking: f32,
    whole: f32,
    asked: u32,
}

/// `frame` is given its number and how many have asked before.
fn run(frames: u32, frame: impl Fn(u32, u32) -> Frame) -> Sums {
    run_late(frames, 1, frame)
}

/// The same where what a frame took is known so many frames later.
fn run_late(frames: u32, ago: u32, frame: impl Fn(u32, u32) -> Frame) -> Sums {
    let (mut gate, mut costs, mut sums) = (Gate::default(), Vec::new(), Sums::default());
    for number in 0..frames {
        let last = number.checked_sub(ago).map(|known| costs[known as usize]);
        let Frame { in_view, whole, drawn, asking, drawing } = frame(number, sums.asked);
        sums.whole += whole;
        sums.asking += frame(number, number).asking;
        let cost = match gate.plan(last) {
            Plan::Whole { probe } => {
                if probe {
                    gate.probed(1.0 - drawn as f32 / in_view, in_view, 0.3, 32);
                }
                FrameCost { total: whole, draw: 0.95 * whole, drawn: in_view as u32, ago }
            }
            Plan::Ask { count } => {
                if count {
                    gate.counted(in_view);
                }
                sums.asked += 1;
                FrameCost { total: asking, draw: drawing, drawn, ago }
            }
        };
        sums.gate += cost.total;
        costs.push(cost);
    }
    sums
}

/// Much is hidden in a view that stays; a frame drawn whole takes 20.
fn steady(asking: f32) -> Frame {
    Frame { in_view: 10_000.0, whole: 20.0, drawn: 2000, asking, drawing: 4.0 }
}

/// As good as random, `1 - by` to `1 + by`, and the same in every run.
fn noise(number: u32, by: f32) -> f32 {
    let x = (number ^ number >> 7).wrapping_mul(0x9E37_79B1);
    let x = (x ^ x >> 15).wrapping_mul(0x85EB_CA77);
    1.0 + by * ((x >> 8) as f32 / (1 << 23) as f32 - 1.0)
}

/// The frames of the walk, many times over, with times that vary.
fn walk(number: u32, asked: u32, by: f32) -> Frame {
    let (in_view, whole, drawn, asking, drawing) = WALK[number as usize % WALK.len()];
    let asking = asking * noise(2 * number, by) + if asked == 0 { FIRST } else { 0.0 };
    Frame { in_view, whole: whole * noise(2 * number + 1, by), drawn, asking, drawing }
}

/// It asked in an eighth of these frames before trials and looks were as they are: its only trial in the
/// first hundred frames was held against a frame of another view, and then it waited.
#[test]
fn where_asking_pays_by_and_by_the_gate_is_as_good_as_none() {
    for (rounds, by) in [(1, 0.0), (1, 0.1), (1, 0.2), (5, 0.0), (5, 0.1), (5, 0.2)] {
        let sums = run(120 * rounds, |number, asked| walk(number, asked, by));
        assert!(sums.gate < 1.03 * sums.asking && sums.gate < 0.97 * sums.whole, "{rounds}, {by}: {sums:?}");
        assert!(sums.asked > 70 * rounds, "{rounds}, {by}: {sums:?}");
    }
}

/// From two and a half times what drawing takes to a part of it, most of the way in 40 frames.
#[test]
fn a_trial_lasts_while_asking_becomes_cheaper() {
    for in_the_end in [10.0, 14.0] {
        for by in [0.0, 0.1] {
            let learning = |number: u32, asked: u32| {
                let falls = (50.0 - in_the_end) * (-(asked as f32) / 15.0).exp();
                steady((in_the_end + falls) * noise(number, by))
            };
            let sums = run(400, learning);
            assert!(sums.asked > 300, "{in_the_end}, {by}: {sums:?}");
            assert!(sums.gate < 1.05 * sums.asking, "{in_the_end}, {by}: {sums:?}");
        }
    }
}

/// What asking builds at first may take long, and a device tells of it a frame late.
#[test]
fn one_dear_frame_does_not_end_a_trial() {
    for dear in 0..8 {
        let sums = run(300, |_, asked| steady(if asked == dear { 100.0 } else { 10.0 }));
        assert!(sums.asked > 280, "frame {dear}: {sums:?}");
    }
}

/// What a device tells late is held against its frame: the first one that asks, which is the dearest, ends no trial,
/// and frames drawn whole are not taken for such as ask.
#[test]
fn a_device_that_tells_late_changes_little() {
    for ago in 1..KEPT as u32 {
        let sums = run_late(300, ago, |_, asked| steady(if asked == 0 { 400.0 } else { 10.0 }));
        assert!(sums.asked > 270, "{ago} frames: {sums:?}");
        let sums = run_late(2000, ago, |number, _| steady(30.0 * noise(2 * number, 0.1)));
        assert!(sums.gate < 1.05 * sums.whole, "{ago} frames: {sums:?}");
    }
}

/// And if it ends up dearer than drawing after all, little is lost.
#[test]
fn asking_that_never_pays_costs_less_than_three_per_cent() {
    for times in [1.02, 1.05, 1.1, 1.2, 1.3, 1.5, 2.0, 3.0, 5.0, 20.0] {
        for by in [0.0, 0.1, 0.2] {
            let constant = |number: u32, _| Frame {
                whole: 20.0 * noise(2 * number + 1, by),
                ..steady(20.0 * times * noise(2 * number, by))
            };
            let sums = run(1500, constant);
            assert!(sums.gate < 1.03 * sums.whole, "{times}, {by}: {sums:?}");
        }
    }
    let falls_short = |_, asked: u32| steady(24.0 + 26.0 * (-(asked as f32) / 15.0).exp());
    let sums = run(1500, falls_short);
    assert!(sums.gate < 1.03 * sums.whole, "{sums:?}");
}

/// Drawing is much dearer than asking was, since nothing is hidden now: no reason to probe every frame.
#[test]
fn dear_frames_are_probed_no_more_often_than_others() {
    let (mut gate, mut last, mut probes) = (Gate::default(), None, 0);
    for number in 0..1000 {
        let turned = number >= 100;
        let cost = match gate.plan(last) {
            Plan::Whole { probe } => {
                probes += u32::from(probe && number >= 200);
                if probe {
                    gate.probed(if turned { 0.0 } else { 0.9 }, 10_000.0, 0.3, 32);
                }
                let total = if turned { 20.0 * (1.0 + number as f32 / 10_000.0) } else { 5.0 };
                FrameCost { total, draw: total, drawn: 10_000, ago: 1 }
            }
            Plan::Ask { count } => {
                if count {
                    gate.counted(10_000.0);
                }
                let total = if turned { 30.0 } else { 5.5 };
                FrameCost { total, draw: 1.0, drawn: 1000, ago: 1 }
            }
        };
        last = Some(cost);
    }
    assert!(probes < 40, "{probes} probes in 800 frames");
}

/// A frame whose time nobody knows, at the end of a look or anywhere.
#[test]
fn a_look_ends_though_a_time_is_lost() {
    for lost in 0..60 {
        let (mut gate, mut last, mut whole) = (Gate::default(), None, 0);
        for number in 0..200 {
            let plan = gate.plan(last);
            let total = match plan {
                Plan::Whole { probe } => {
                    whole += u32::from(number > 60);
                    if probe {
                        gate.probed(0.9, 10_000.0, 0.3, 32);
                    }
                    20.0
                }
                Plan::Ask { .. } => 18.0,
            };
            let drawn = if matches!(plan, Plan::Ask { .. }) { 1000 } else { 10_000 };
            last = (number != lost).then_some(FrameCost { total, draw: 1.0, drawn, ago: 1 });
        }
        assert!(whole < 30, "without frame {lost}: {whole} drawn whole");
    }
}

#[test]
fn looks_cost_less_than_two_per_cent() {
    for times in [0.05, 0.2, 0.5, 0.75, 0.9] {
        let sums = run(1500, |_, _| steady(20.0 * times));
        // The first frames are drawn whole.
        assert!(sums.gate - 40.0 < 1.025 * sums.asking, "{times}: {sums:?}");
    }
}

/// `moving_bunnies --headless --frames 120`: objects in view, milliseconds to draw them; objects drawn
/// with `--set gate=off`, milliseconds, and those of drawing. Medians of three runs on the software
/// backend. In some parts asking is much faster, in some it is slower.
const WALK: [(f32, f32, u32, f32, f32); 120] = [
    (13406.0, 20.4, 730, 26.2, 9.2),
    (13389.0, 17.9, 547, 26.2, 5.6),
    (13380.0, 19.2, 549, 15.6, 4.6),
    (13330.0, 19.4, 590, 18.3, 5.6),
    (13244.0, 22.3, 1145, 21.3, 8.3),
    (13123.0, 26.2, 911, 24.8, 7.5),
    (12913.0, 24.1, 788, 24.7, 7.1),
    (12683.0, 22.6, 768, 22.6, 6.8),
    (12491.0, 24.3, 771, 17.4, 5.7),
    (12495.0, 22.6, 736, 20.9, 6.4),
    (12527.0, 22.4, 609, 22.0, 8.1),
    (12466.0, 20.7, 547, 12.6, 5.2),
    (12508.0, 21.2, 485, 14.9, 5.1),
    (12655.0, 24.2, 609, 20.0, 6.5),
    (12758.0, 25.7, 841, 19.0, 7.5),
    (12727.0, 23.9, 967, 18.5, 7.2),
    (12835.0, 25.1, 945, 19.9, 8.4),
    (13062.0, 26.3, 916, 16.9, 6.2),
    (13270.0, 26.5, 1089, 21.2, 8.5),
    (13404.0, 25.0, 1093, 19.6, 8.1),
    (13466.0, 25.6, 926, 20.0, 9.2),
    (13495.0, 25.0, 759, 21.6, 7.4),
    (13515.0, 21.2, 725, 15.6, 5.6),
    (13522.0, 21.6, 662, 15.1, 5.8),
    (13478.0, 23.9, 521, 15.4, 6.8),
    (13279.0, 25.4, 383, 16.0, 4.5),
    (12969.0, 31.1, 340, 13.0, 4.0),
    (12706.0, 28.9, 325, 11.5, 3.8),
    (12246.0, 31.9, 302, 10.1, 3.9),
    (11457.0, 33.0, 442, 25.4, 15.4),
    (11098.0, 32.1, 393, 20.5, 13.2),
    (10522.0, 29.8, 419, 20.1, 11.1),
    (10136.0, 25.0, 328, 14.9, 7.7),
    (9605.0, 27.0, 359, 17.0, 8.3),
    (9176.0, 21.3, 371, 16.4, 9.3),
    (8748.0, 30.1, 375, 21.2, 12.2),
    (5160.0, 22.7, 248, 23.7, 16.5),
    (1358.0, 8.9, 208, 18.3, 11.1),
    (959.0, 10.6, 243, 18.1, 12.7),
    (702.0, 7.5, 278, 16.5, 10.9),
    (462.0, 9.2, 338, 15.4, 11.1),
    (924.0, 14.1, 518, 25.5, 16.4),
    (5115.0, 22.9, 766, 31.5, 18.2),
    (7230.0, 21.9, 575, 26.8, 15.1),
    (6561.0, 23.9, 470, 24.3, 15.7),
    (6059.0, 28.8, 401, 25.9, 18.0),
    (5649.0, 26.1, 309, 24.1, 16.7),
    (4990.0, 24.3, 257, 22.1, 15.2),
    (5579.0, 28.3, 247, 18.3, 11.6),
    (4576.0, 21.8, 193, 16.3, 10.0),
    (3983.0, 17.3, 203, 14.9, 8.6),
    (3031.0, 15.9, 153, 15.7, 9.5),
    (2458.0, 6.5, 73, 7.1, 3.9),
    (1939.0, 22.8, 106, 17.3, 13.6),
    (2718.0, 38.5, 116, 27.0, 22.5),
    (3900.0, 33.7, 277, 24.0, 17.2),
    (3732.0, 42.2, 171, 26.4, 19.8),
    (3268.0, 35.9, 178, 19.0, 14.0),
    (2666.0, 25.9, 172, 15.6, 10.3),
    (2255.0, 32.1, 157, 14.5, 9.7),
    (1735.0, 31.9, 181, 17.6, 12.3),
    (1371.0, 20.6, 203, 18.6, 12.7),
    (935.0, 22.0, 137, 18.9, 13.9),
    (707.0, 29.6, 127, 19.1, 14.4),
    (700.0, 25.1, 230, 28.6, 21.6),
    (713.0, 21.1, 161, 26.0, 19.0),
    (262.0, 20.2, 72, 23.4, 19.5),
    (323.0, 28.1, 73, 32.5, 27.5),
    (597.0, 31.0, 82, 37.3, 30.9),
    (7023.0, 27.0, 22, 24.1, 20.1),
    (2964.0, 16.5, 97, 16.5, 12.5),
    (5948.0, 35.6, 55, 26.9, 23.1),
    (9123.0, 27.2, 560, 24.3, 13.0),
    (8734.0, 18.4, 238, 21.8, 9.8),
    (8283.0, 23.8, 267, 19.6, 13.0),
    (7692.0, 21.9, 219, 17.4, 9.7),
    (7304.0, 27.5, 233, 18.8, 12.0),
    (6728.0, 19.9, 146, 14.4, 8.5),
    (6323.0, 26.1, 368, 21.5, 15.2),
    (5804.0, 32.5, 236, 24.8, 17.9),
    (5318.0, 16.4, 165, 14.2, 8.7),
    (4831.0, 33.9, 233, 39.7, 34.7),
    (4263.0, 10.7, 221, 14.3, 9.0),
    (3877.0, 19.7, 238, 17.5, 11.4),
    (3400.0, 19.8, 235, 20.3, 11.6),
    (2683.0, 28.1, 246, 25.5, 16.9),
    (1696.0, 22.4, 121, 17.3, 10.5),
    (1838.0, 17.4, 186, 21.4, 12.2),
    (5312.0, 28.2, 181, 20.2, 11.7),
    (7795.0, 25.0, 213, 22.4, 11.9),
    (4826.0, 15.3, 129, 17.9, 10.3),
    (5238.0, 15.2, 91, 19.4, 12.4),
    (6950.0, 26.7, 237, 24.1, 14.7),
    (6599.0, 14.2, 192, 15.9, 7.3),
    (6163.0, 17.2, 217, 17.3, 11.6),
    (5573.0, 19.5, 178, 15.5, 9.3),
    (5111.0, 31.8, 186, 23.5, 15.9),
    (4553.0, 29.9, 169, 18.5, 11.4),
    (4074.0, 33.7, 180, 23.9, 16.6),
    (3495.0, 36.4, 199, 25.0, 17.7),
    (2959.0, 33.3, 180, 17.9, 11.1),
    (2462.0, 32.4, 192, 19.2, 13.1),
    (1948.0, 16.3, 128, 15.3, 9.7),
    (1402.0, 25.9, 118, 21.2, 14.9),
    (1123.0, 38.7, 157, 25.6, 18.0),
    (1157.0, 41.5, 201, 23.2, 15.8),
    (932.0, 41.3, 221, 44.9, 36.2),
    (3198.0, 18.5, 49, 16.9, 12.1),
    (1235.0, 30.1, 115, 39.6, 32.4),
    (555.0, 35.2, 110, 39.7, 31.9),
    (544.0, 25.4, 105, 36.8, 30.9),
    (504.0, 30.2, 100, 36.0, 29.7),
    (9485.0, 26.3, 303, 40.8, 21.7),
    (9447.0, 17.5, 217, 21.7, 8.0),
    (9793.0, 17.5, 236, 17.2, 4.5),
    (10404.0, 18.9, 306, 20.7, 6.0),
    (11158.0, 18.8, 397, 22.3, 7.7),
    (11999.0, 19.4, 497, 28.2, 9.8),
    (12872.0, 21.0, 667, 22.4, 7.7),
    (13237.0, 23.3, 1106, 29.2, 8.4),
];
