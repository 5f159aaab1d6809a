//! Bytes as recordings: whole files, and sound recordings of which parts were altered and the checksums
//! made anew, so that what lies behind them is reached. A player refuses them in words or plays them; it
//! never panics, and takes no more memory or time than the file would have it.

use std::sync::OnceLock;

use arbitrary::Unstructured;
use glam::{DVec3, Vec3};
use tercet::Culler;
use tercet::geom::{Aabb, View, Viewport};
use tercet::policy::{self, Policy};
use tercet::query::software::SoftwareQueries;
use tercet::record::{Logged, Player, Recorder};
use tercet::scene::{ObjectId, Scene, SceneConfig, Traits};

use super::numbers::below;

/// What comes before the first chunk: a mark and the version.
const START: usize = 12;
/// Alterations of a recording, at most.
const MOST: usize = 8;
/// Frames of a sound recording.
const FRAMES: usize = 5;

/// Plays the bytes, or a recording that they alter.
pub fn run(bytes: &[u8]) {
    let mut u = Unstructured::new(bytes);
    let kind = below(&mut u, 1 + 2 * recordings().len());
    if kind == 0 {
        play(u.take_rest());
        return;
    }
    let mut chunks = recordings()[(kind - 1) / 2].clone();
    for _ in 0..1 + below(&mut u, MOST) {
        alter(&mut chunks, &mut u);
    }
    let frames = chunks.len().saturating_sub(1) as u32;
    play(&file(&chunks, if kind.is_multiple_of(2) { frames } else { u.arbitrary().unwrap_or(frames) }));
}

/// To the end, or to the first error.
fn play(file: &[u8]) {
    let Ok(mut player) = Player::new(file) else { return };
    while let Ok(Some(played)) = player.next_frame() {
        assert!(played.error.is_some() || played.stats.drawn as usize == player.eye().visible().len());
        if let Err(why) = player.scene().tree().validate() {
            panic!("{why}");
        }
    }
    assert!(player.next_frame().is_ok_and(|played| played.is_none()), "nothing can be played after that");
}

/// Changes a chunk, or which chunks there are.
fn alter(chunks: &mut Vec<Vec<u8>>, u: &mut Unstructured<'_>) {
    if chunks.is_empty() {
        return;
    }
    let (count, which) = (chunks.len(), below(u, chunks.len()));
    let chunk = &mut chunks[which];
    let at = below(u, chunk.len().max(1));
    let byte: u8 = u.arbitrary().unwrap_or_default();
    match below(u, 12) {
        0 => drop(chunks.remove(which)),
        1 => chunks.swap(which, (which + 1) % count),
        2 => chunks.push(chunks[which].clone()),
        3 => chunk.truncate(at),
        4 if at < chunk.len() => drop(chunk.remove(at)),
        5 | 6 => chunk.insert(at, byte),
        // The greatest number that there is, as the format has it.
        7 => drop(chunk.splice(at..at, [0xff, 0xff, 0xff, 0xff, 0x0f])),
        // A float that is none, or infinite.
        8 if at + 4 <= chunk.len() => chunk[at..at + 4].copy_from_slice(&[0, 0, 0x80 | byte & 0x40, 0x7f]),
        9 if at < chunk.len() => chunk[at] ^= 1 << (byte & 7),
        _ if at < chunk.len() => chunk[at] = byte,
        _ => {}
    }
}

/// A file of chunks, with sound lengths and checksums.
fn file(chunks: &[Vec<u8>], frames: u32) -> Vec<u8> {
    // Of the present version.
    let mut file = b"tercet\r\n\x04\0\0\0".to_vec();
    for chunk in chunks {
        let length = (chunk.len() as u32).to_le_bytes();
        let mut hasher = crc32fast::Hasher::new();
        hasher.update(&length);
        hasher.update(chunk);
        file.extend_from_slice(&length);
        file.extend_from_slice(&hasher.finalize().to_le_bytes());
        file.extend_from_slice(chunk);
    }
    file.extend_from_slice(&[0; 4]);
    file.extend_from_slice(&frames.to_le_bytes());
    file
}

/// The chunks of a file.
fn chunks(file: &[u8]) -> Vec<Vec<u8>> {
    let (mut chunks, mut rest) = (Vec::new(), &file[START..]);
    loop {
        let (length, after) = rest.split_first_chunk().expect("a length");
        let length = u32::from_le_bytes(*length) as usize;
        if length == 0 {
            return chunks;
        }
        let (chunk, after) = after[4..].split_at(length);
        chunks.push(chunk.to_vec());
        rest = after;
    }
}

/// A short recording of every policy, by chunks.
fn recordings() -> &'static [Vec<Vec<u8>>] {
    static RECORDINGS: OnceLock<Vec<Vec<Vec<u8>>>> = OnceLock::new();
    RECORDINGS.get_or_init(|| {
        let all = policy::NAMES.iter().map(|name| policy::by_name(name).expect("a policy of that name"));
        let made = all.filter(|policy| policy.wants_recorded().is_none()).map(record);
        let recordings: Vec<_> = made.map(|made| chunks(&made)).collect();
        // What is not altered is played to its end.
        for chunks in &recordings {
            let whole = file(chunks, FRAMES as u32);
            let mut player = Player::new(&whole[..]).expect("a recording");
            (0..FRAMES).for_each(|_| assert!(player.next_frame().expect("it is sound").is_some()));
        }
        recordings
    })
}

/// Some boxes, one of them a wall, of which some are moved, spoiled, removed and added; another origin.
fn record(policy: Box<dyn Policy>) -> Vec<u8> {
    let config = SceneConfig::default();
    let mut scene = Scene::new(config.clone());
    let mut eye = Culler::new(policy);
    let mut file = Vec::new();
    let mut recorder = Recorder::new(&mut file, &config, &mut scene, &eye, "a seed").expect("a recorder");
    let mut queries = Logged::new(SoftwareQueries::new());
    let at = |i: usize| Vec3::new((i % 5) as f32 - 2.0, (i / 5 % 3) as f32, -3.0 - (i / 15) as f32);
    let cube = |center: Vec3| Aabb::from_center(center, Vec3::splat(0.3));
    let slack = |i: usize| if i % 9 == 1 { 0.1 } else { 0.0 };
    let traits = |i: usize| Traits { not_occluder: i % 8 == 3, slack: slack(i), ..Traits::default() };
    let mut ids: Vec<ObjectId> = (0..24).map(|i| scene.insert(cube(at(i)), traits(i))).collect();
    for frame in 0..FRAMES {
        scene.set_bounds(ids[frame], cube(at(frame) + Vec3::X));
        scene.set_bounds(ids[5 + frame], Aabb::new(Vec3::NAN, Vec3::ONE));
        scene.remove(ids.swap_remove(10));
        ids.push(scene.insert(cube(at(frame) + Vec3::Y * 3.0), Traits::default()));
        if frame == 3 {
            scene.rebase(DVec3::splat(0.5));
            eye.cut();
        }
        scene.update();
        let from = Vec3::new(frame as f32, 1.0, 6.0);
        let view = View::look_at(from, Vec3::ZERO, 60.0, 0.1, Viewport::new(32, 18)).expect("a view");
        recorder.begin(&mut scene, &view, &eye);
        eye.frame(&scene, &view, &mut queries, |_, _| {}).expect("a frame");
        recorder.end(&eye, &mut queries).expect("a frame recorded");
        scene.adapt([&mut eye]);
    }
    recorder.finish().expect("an end");
    file
}
