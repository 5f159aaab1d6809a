//! Is a gated policy ever slower than the view frustum alone? Frames of both in turns, in worlds where
//! asking can win nothing, and in one where it can: the median ratio of their times with a 95 % confidence
//! interval, of pairs of frames and of blocks of 32 pairs, each of which has a probe. On the software
//! backend, and on the GPU where there is an adapter.
//!
//! ```text
//! cargo bench --bench gate
//! cargo bench --bench gate -- chc++ city      # names of policies and worlds: only these
//! ```

mod interval;
mod lane;
mod world;

use std::env;
use std::time::Instant;

use interval::Ratio;
use lane::{Gpu, Lane};
use tercet::policy::{self, FrustumOnly, Gated};
use world::{WORLDS, World};

/// What a gated policy may take, of the frustum's time.
const FLOOR: f64 = 1.03;
/// Pairs of frames that are not counted: what is done once.
const WARM_UP: usize = 16;
const PAIRS: usize = 1600;
/// Seconds after which no more pairs are run.
const PATIENCE: f32 = 20.0;
const POLICIES: [&str; 2] = ["dual-query", "chc++"];

fn main() -> anyhow::Result<()> {
    let only: Vec<String> = env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let is_wanted = |names: &[&str], name: &str| {
        let named = |name: &&str| only.iter().any(|only| only == name);
        named(&name) || !names.iter().any(named)
    };
    let gpu = Gpu::open()?;
    println!("| backend | world | policy | frames gated | pairs | blocks | at most 3 % slower |");
    println!("|---|---|---|---|---|---|---|");
    let names: Vec<&str> = WORLDS.iter().map(|world| world.name).collect();
    for gpu in [None, gpu.as_ref()].into_iter().take(1 + usize::from(gpu.is_some())) {
        for kind in WORLDS.iter().filter(|world| is_wanted(&names, world.name)) {
            for policy in POLICIES.into_iter().filter(|policy| is_wanted(&POLICIES, policy)) {
                let (ratio, gated) = compare(kind.build(), policy, gpu)?;
                let backend = gpu.map_or("software", |gpu| &gpu.name);
                let Some(ratio) = ratio else {
                    println!("| {backend} | {} | {policy} | – | too slow here | – | – |", kind.about);
                    continue;
                };
                let verdict = ratio.verdict(FLOOR);
                println!("| {backend} | {} | {policy} | {gated:.0} % | {ratio} | {verdict} |", kind.about);
            }
        }
    }
    if gpu.is_none() {
        println!("\nThere is no graphics adapter: the GPU was left out.");
    }
    Ok(())
}

/// The gated policy's time over the frustum's, and the percentage of frames whose gate was shut.
fn compare(mut world: World, name: &str, gpu: Option<&Gpu>) -> anyhow::Result<(Option<Ratio>, f64)> {
    let mut frustum = Lane::new(Box::new(FrustumOnly::default()), gpu)?;
    let mut gated = Lane::new(Box::new(Gated::new(policy::by_name(name)?)), gpu)?;
    let (start, mut pairs, mut frames) = (Instant::now(), Vec::new(), 0);
    while frames < WARM_UP + PAIRS && start.elapsed().as_secs_f32() < PATIENCE {
        world.step();
        let view = world.view(frames);
        // Each goes first in every other pair.
        let (a, b) = if frames % 2 == 0 {
            let a = gated.frame(&world, &view)?;
            (a, frustum.frame(&world, &view)?)
        } else {
            let b = frustum.frame(&world, &view)?;
            (gated.frame(&world, &view)?, b)
        };
        frames += 1;
        if frames > WARM_UP {
            pairs.push((a, b));
        }
    }
    Ok((Ratio::of(&pairs), 100.0 * gated.gated as f64 / frames as f64))
}
