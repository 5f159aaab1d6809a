//! Lives through a recorded run again, without a GPU and without drawing: the same edits, views, answers
//! and times, and of each frame the check that it draws what it drew then.
//!
//! ```text
//! cargo run --release --example moving_bunnies -- --headless --frames 60 --record run.tercet
//! cargo run --release --example replay -- run.tercet
//! cargo run --release --example replay -- run.tercet --frame 41
//! ```

use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;

use anyhow::{Context, ensure};
use clap::Parser;
use tercet::geom::Frustum;
use tercet::record::{Played, Player};

/// Lives through a recorded run again, and checks that every frame draws what it drew then
#[derive(Parser)]
#[command(after_long_help = "\
Examples:
  cargo run --release --example moving_bunnies -- --headless --frames 60 --record run.tercet
      record a run; every demo takes --record
  cargo run --release --example replay -- run.tercet
      replay it: exit status 0 only if every frame is as it was, bit for bit
  cargo run --release --example replay -- run.tercet --frame 41
      what frame 41 did")]
struct Arguments {
    /// A recording, as --record writes it
    file: PathBuf,

    /// Say what this frame did, counted from 0, and stop there
    #[arg(long, value_name = "N")]
    frame: Option<u32>,
}

fn main() -> anyhow::Result<()> {
    let arguments = Arguments::parse();
    let name = arguments.file.display().to_string();
    let file = File::open(&arguments.file)
        .with_context(|| format!("cannot open {name}: record a run with --record {name}"))?;
    let mut player = Player::new(BufReader::new(file)).with_context(|| name.clone())?;
    let header = player.header();
    println!("{name}: {}; policy {}", header.about, header.policy);

    let mut frames = 0;
    let (mut drawn, mut queries, mut failed) = (0u64, 0u64, 0);
    while let Some(played) = player.next_frame().with_context(|| name.clone())? {
        frames += 1;
        drawn += u64::from(played.stats.drawn);
        queries += u64::from(played.stats.queries);
        failed += u32::from(played.error.is_some());
        if arguments.frame == Some(played.number) {
            describe(&player, &played);
            return Ok(());
        }
    }
    if let Some(number) = arguments.frame {
        ensure!(number < frames, "there is no frame {number}: the recording has {frames}, from 0");
    }
    ensure!(frames > 0, "the recording has no frames");
    let mean = |total: u64| total as f64 / f64::from(frames);
    println!(
        "{frames} frames, each as it was: {:.1} objects drawn and {:.1} questions a frame, {failed} frames \
         whose device failed",
        mean(drawn),
        mean(queries)
    );
    Ok(())
}

/// Prints what a frame did.
fn describe(player: &Player<BufReader<File>>, played: &Played) {
    let (scene, eye, stats) = (player.scene(), player.eye(), &played.stats);
    let frustum = Frustum::new(&played.view);
    let in_frustum = |bounds: Option<tercet::geom::Aabb>| bounds.is_none_or(|b| frustum.intersects(&b));
    println!("frame {}:", played.number);
    println!("  the eye is at {}, looking along {}", played.view.eye(), played.view.forward());
    println!(
        "  {} objects, {} in the frustum, {} drawn ({} new, {} no more)",
        scene.len(),
        scene.objects().filter(|object| in_frustum(object.bounds)).count(),
        stats.drawn,
        eye.entered().len(),
        eye.left().count()
    );
    println!(
        "  {} questions about {} boxes in {} waves, {} state changes",
        stats.queries, stats.query_boxes, stats.waves, stats.state_changes
    );
    let tree = scene.tree().stats();
    println!("  the tree has {} nodes and is {} deep", tree.nodes, tree.depth);
    for counter in eye.policy().counters() {
        println!("  {}: {}", counter.key.replace('_', " "), counter.count);
    }
    if let Some(error) = &played.error {
        println!("  the device failed: {error}");
    }
}
