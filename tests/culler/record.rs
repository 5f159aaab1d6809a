//! Recordings: whatever happened, it happens again; and damage is found out.

use std::time::Duration;

use tercet::policy::{self, Policy};
use tercet::query::fault::{Faults, Faulty};
use tercet::query::software::SoftwareQueries;
use tercet::record::{Logged, Player, Recorder};
use tercet::scene::{Scene, SceneConfig};
use tercet::tree::TreeConfig;
use tercet::{Budget, Culler, Error, Latency, Tradeoff, worlds};

use crate::SCREEN;
use crate::painter::draw;
use crate::stage::Stage;

const FRAMES: u32 = 24;
/// Of half of the recordings: before it, the scene gets another origin.
const REBASED: u32 = 9;
/// A frame that is announced as a cut.
const CUT: u32 = 14;
/// A frame in which the device is lost.
const LOST: u32 = 17;

/// What a run showed, frame by frame: slots in the order of drawing.
type Shown = Vec<Vec<usize>>;

/// Runs a policy through a world in which everything happens, behind a backend on which nothing can be
/// relied, and records it. `noted` is the policy that the recording is said to be of.
fn record(policy: Box<dyn Policy>, noted: Box<dyn Policy>, seed: u64) -> (Vec<u8>, Shown) {
    let tree = if seed.is_multiple_of(3) { TreeConfig::paper() } else { TreeConfig::stable() };
    let config = SceneConfig { tree, ..SceneConfig::default() };
    let mut scene = Scene::new(config.clone());
    let mut eye = Culler::new(policy);
    let mut file = Vec::new();
    let noted = Culler::new(noted);
    let mut recorder = Recorder::new(&mut file, &config, &mut scene, &noted, "a test").expect("a recorder");
    let faults = Faults { lost_device: Some(LOST), room: Some(60), ..Faults::MANY };
    let mut software = SoftwareQueries::new();
    software.set_true_shapes(seed % 2 == 1);
    let mut queries = Logged::new(Faulty::new(software, faults, seed));
    let mut stage = Stage::new(worlds::random(seed, 150), seed, SCREEN, true);
    let mut shown = Vec::new();
    scene.adapt([&mut eye]);
    for frame in 0..FRAMES {
        let view = stage.next(frame);
        if frame == REBASED && seed % 2 == 1 {
            scene.rebase(glam::DVec3::splat(0.25));
        }
        scene.sync(&stage.world);
        if frame == CUT {
            eye.cut();
        }
        eye.tradeoff = tradeoff(frame);
        recorder.begin(&mut scene, &view, &eye);
        let result = eye.frame(&scene, &view, &mut queries, |pass, objects| {
            draw(&stage.world, &view, stage.detail, pass, objects);
        });
        assert!(result.is_ok() || frame == LOST, "frame {frame}: {result:?}");
        recorder.end(&eye, &mut queries).expect("a frame recorded");
        shown.push(eye.visible().iter().map(|object| object.id.slot()).collect());
        scene.adapt([&mut eye]);
    }
    recorder.finish().expect("an end");
    (file, shown)
}

/// Every dial has its turn.
fn tradeoff(frame: u32) -> Tradeoff {
    let budget = match frame % 5 {
        3 => Budget { queries: Some(7), ..Budget::default() },
        4 => Budget { time: Some(Duration::from_micros(150)), ..Budget::default() },
        _ => Budget::default(),
    };
    Tradeoff {
        visible_pixels: frame % 3,
        n_av: Some(frame % 4),
        p_skip: Some(0.5),
        resolution_divisor: 1 + frame / 4 % 2,
        latency: if frame < 12 { Latency::Late(2) } else { Latency::SameFrame },
        swept: frame.is_multiple_of(2),
        budget,
        ..Tradeoff::EXACT
    }
}

fn named(name: &str) -> Box<dyn Policy> {
    policy::by_name(name).expect("a policy of that name")
}

/// The names of policies that find out by themselves what they draw.
fn names() -> impl Iterator<Item = &'static str> {
    let finds_out = |name: &str| policy::by_name(name).is_ok_and(|policy| policy.wants_recorded().is_none());
    policy::NAMES.iter().copied().filter(move |name| finds_out(name))
}

#[test]
fn every_policy_lives_through_its_frames_again() {
    let mut lost_devices = 0;
    for (n, name) in names().enumerate() {
        for seed in [n as u64, n as u64 + 7] {
            let (file, shown) = record(named(name), named(name), seed);
            let mut player = Player::new(&file[..]).expect("a recording");
            assert_eq!((player.header().policy.as_str(), player.header().about.as_str()), (name, "a test"));
            let (mut failed, mut cuts) = (0, 0);
            for shown in &shown {
                let played = player.next_frame().expect("it draws as before").expect("a frame");
                let now: Vec<usize> = player.eye().visible().iter().map(|o| o.id.slot()).collect();
                assert_eq!(&now, shown, "{name}, frame {}", played.number);
                player.scene().tree().validate().expect("a valid tree");
                failed += u32::from(played.error.is_some());
                cuts += played.stats.cuts;
            }
            assert!(player.next_frame().expect("an end").is_none());
            assert!(player.next_frame().expect("it stays over").is_none());
            assert!(cuts > 0 && failed <= 1, "{name}: {cuts} cuts, {failed} failed");
            lost_devices += failed;
        }
    }
    assert!(lost_devices > 10, "{lost_devices} frames in which the device was lost");
}

/// A recording that says it is of another policy, or of one with other dials, is no proof of anything:
/// the frames must differ, and the player must say so.
#[test]
fn another_engine_is_found_out() {
    let with = |key: &str, value: &str| {
        let mut policy = named("dual-query");
        policy.set(key, value).expect("a dial");
        policy
    };
    for noted in [with("max_waves", "1"), named("stop-and-wait")] {
        let (file, _) = record(with("n_skip", "0"), noted, 3);
        let mut player = Player::new(&file[..]).expect("a recording");
        let error = loop {
            match player.next_frame() {
                Ok(Some(_)) => {}
                Ok(None) => panic!("nothing was noticed"),
                Err(error) => break error.to_string(),
            }
        };
        assert!(error.contains("instead of") && error.contains("the engine that replays"), "{error}");
        assert!(player.next_frame().expect("it is over").is_none());
    }
}

/// Goes through a file to its end or to the first error.
fn play(file: &[u8]) -> Result<u32, String> {
    let mut player = Player::new(file).map_err(|error| error.to_string())?;
    let mut frames = 0;
    while player.next_frame().map_err(|error| error.to_string())?.is_some() {
        frames += 1;
    }
    Ok(frames)
}

#[test]
fn a_file_that_was_cut_short_says_so() {
    let (file, _) = record(named("chc++"), named("chc++"), 2);
    assert_eq!(play(&file), Ok(FRAMES));
    for length in (0..200).chain((200..file.len()).step_by(97)) {
        let error = play(&file[..length]).expect_err("it is not whole");
        assert!(error.starts_with("the recording: it ends "), "{length} of {}: {error}", file.len());
    }
}

#[test]
fn an_altered_file_says_so() {
    let (file, _) = record(named("frustum"), named("frustum"), 4);
    let mut said = std::collections::BTreeSet::new();
    for at in (0..file.len()).step_by(13).chain(0..64) {
        for bit in [0, 7] {
            let mut altered = file.clone();
            altered[at] ^= 1 << bit;
            let error = play(&altered).expect_err("it was altered");
            assert!(error.starts_with("the recording: "), "byte {at}: {error}");
            said.insert(error.split_whitespace().take(4).collect::<Vec<_>>().join(" "));
        }
    }
    println!("{said:?}");
    assert!(said.len() >= 4, "{said:?}");
    let mut newer = file.clone();
    newer[8] = 200;
    let error = play(&newer).expect_err("it is of another version");
    assert!(error.contains("version 200") && error.contains("version 4:"), "{error}");
}

#[test]
fn what_cannot_be_recorded_is_refused() {
    let config = SceneConfig::default();
    let mut scene = Scene::new(config.clone());
    let refused = |scene: &mut Scene, policy: &str| {
        let eye = Culler::new(named(policy));
        Recorder::new(Vec::new(), &config, scene, &eye, "").map(drop).map_err(|error| error.to_string())
    };
    assert!(refused(&mut scene, "opt").is_err_and(|error| error.contains("choose another")));
    scene.update();
    assert!(refused(&mut scene, "frustum").is_err_and(|error| error.contains("before the first edit")));
    let mut scene = Scene::new(config.clone());
    let mut eye = Culler::new(named("frustum"));
    let mut recorder = Recorder::new(Vec::new(), &config, &mut scene, &eye, "").expect("a recorder");
    let mut silent = Logged::silent(SoftwareQueries::new());
    assert!(matches!(recorder.end(&eye, &mut silent), Err(Error::Recording { .. })), "no frame has begun");
    let view = Stage::new(worlds::random(0, 1), 0, SCREEN, false).next(0);
    scene.update();
    recorder.begin(&mut scene, &view, &eye);
    eye.frame(&scene, &view, &mut silent, |_, _| {}).expect("a frame");
    assert!(recorder.end(&eye, &mut silent).is_err_and(|error| error.to_string().contains("listens")));
    assert_eq!(recorder.frames(), 0);
}
