//! Drawing what shows, against a plain loop: each object drawn alone, sample by sample against all before it.

use std::collections::BTreeSet;
use std::slice;

use rand::RngExt;
use rand::seq::SliceRandom;
use rayon::prelude::*;
use tercet::geom::Viewport;
use tercet::query::software::{SimdLevel, SoftwareQueries};
use tercet::query::{Answer, QueryBackend, SweepTest, Ticket, Wait};
use tercet::scene::{ObjectId, ObjectRef};
use tercet::tree::TreeConfig;
use tercet::worlds::{self, Model, Pathology};

use super::table::Table;
use crate::painter::draw;

const LEVELS: [SimdLevel; 4] = [SimdLevel::Portable, SimdLevel::Sse41, SimdLevel::Avx2, SimdLevel::Avx512];

/// What was met.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    shown: usize,
    left_out: usize,
    /// Left out, though the box was in sight.
    beyond_boxes: usize,
}

impl Tally {
    fn plus(self, other: Self) -> Self {
        Self {
            shown: self.shown + other.shown,
            left_out: self.left_out + other.left_out,
            beyond_boxes: self.beyond_boxes + other.beyond_boxes,
        }
    }
}

/// Runs some frames of a model. Of each, a share is drawn; then all objects are tried, in any order: those
/// that were drawn lie exactly where they lie, so what is in sight of them ties with itself.
fn check(model: Model, seed: u64, frames: u32) -> Tally {
    let mut table = Table::new(model, TreeConfig::default(), seed, Viewport::new(161, 91));
    table.queries = SoftwareQueries::with_level(LEVELS[seed as usize % LEVELS.len()]);
    table.queries.set_true_shapes(true);
    let mut tally = Tally::default();
    for frame in 0..frames {
        table.next(frame, [0.0, 0.2, 0.6][frame as usize % 3]);
        let mut tried = table.objects.clone();
        tried.shuffle(&mut table.dice);
        tried.truncate(table.dice.random_range(1..400));
        let ids: Vec<ObjectId> = tried.iter().map(|object| object.id).collect();
        let boxes = table.sweep(&[], &ids, SweepTest::Raster);
        let (expected, depth) = plain(&table, &tried);
        let found = draw_if_seen(&mut table, &tried);
        assert_eq!(found, expected, "seed {seed}, frame {frame}");
        assert_eq!(depth_of(&table.queries), depth, "seed {seed}, frame {frame}: the depth");
        let is_bounded = |slot: &usize| table.scene.tree().aabb_of(*slot as u32).is_some();
        let beyond = found.iter().filter(|slot| is_bounded(slot) && !boxes.contains(slot)).count();
        assert_eq!(beyond, 0, "seed {seed}, frame {frame}: shown, and not the box");
        tally = tally.plus(Tally {
            shown: found.len(),
            left_out: tried.len() - found.len(),
            beyond_boxes: boxes.difference(&found).count(),
        });
    }
    tally
}

fn draw_if_seen(table: &mut Table, tried: &[ObjectRef]) -> BTreeSet<usize> {
    let (world, view, detail) = (&table.stage.world, &table.view, table.stage.detail);
    assert!(table.queries.draws_if_seen());
    table
        .queries
        .draw_if_seen(Ticket(3), tried, |pass, objects| draw(world, view, detail, pass, objects))
        .expect("draws");
    let mut found = None;
    let deliver = |ticket, answer: Answer<'_>| match answer {
        Answer::Swept(set) if ticket == Ticket(3) => found = Some(set.slots().collect()),
        other => panic!("{other:?} to {ticket:?}"),
    };
    table.queries.answers(Wait::Block, deliver).expect("answers");
    found.expect("one answer")
}

/// Who shows, and the depth that is left.
fn plain(table: &Table, tried: &[ObjectRef]) -> (BTreeSet<usize>, Vec<f32>) {
    let (world, view, detail) = (&table.stage.world, &table.view, table.stage.detail);
    let mut depth = depth_of(&table.queries);
    let (mut shown, mut alone) = (BTreeSet::new(), SoftwareQueries::new());
    for object in tried {
        alone.begin(view).expect("a frame");
        alone.draw(|pass| draw(world, view, detail, pass, slice::from_ref(object))).expect("draws");
        for (kept, nearness) in depth.iter_mut().zip(depth_of(&alone)) {
            if nearness != view.depth().cleared() && nearness >= *kept {
                shown.insert(object.id.slot());
                *kept = nearness;
            }
        }
    }
    (shown, depth)
}

fn depth_of(queries: &SoftwareQueries) -> Vec<f32> {
    let depth = queries.depth();
    (0..depth.height()).flat_map(|y| depth.row(y)).collect()
}

#[test]
fn random_objects_show_as_in_a_plain_loop() {
    let tallies = (0..24u64).into_par_iter().map(|seed| check(worlds::random(seed, 150), seed, 6));
    let all = tallies.reduce(Tally::default, Tally::plus);
    println!("{all:?}");
    assert!(all.shown > 1000 && all.left_out > 1000 && all.beyond_boxes > 300, "{all:?}");
}

#[test]
fn hard_objects_show_as_in_a_plain_loop() {
    let kinds = Pathology::ALL.into_par_iter().enumerate();
    let tallies = kinds.map(|(n, kind)| check(worlds::pathological(kind), n as u64, 6));
    let all = tallies.reduce(Tally::default, Tally::plus);
    println!("{all:?}");
    assert!(all.shown > 300 && all.left_out > 300, "{all:?}");
}

/// Meshes of many parts, and many small ones.
#[test]
fn worlds_show_as_in_a_plain_loop() {
    let models = [worlds::city(1, 0.005), worlds::factory(2, 0.05), worlds::fantasy(3, 0.05)];
    let tallies = models.into_par_iter().enumerate().map(|(n, model)| check(model, n as u64, 6));
    let all = tallies.reduce(Tally::default, Tally::plus);
    println!("{all:?}");
    assert!(all.shown > 100 && all.left_out > 300 && all.beyond_boxes > 30, "{all:?}");
}

/// Who records nothing is not known, and shows; who may be a stand-in, or is sampled elsewhere, is not tried.
#[test]
fn what_nobody_can_tell_is_drawn() {
    let mut table = Table::new(worlds::random(1, 50), TreeConfig::default(), 1, Viewport::new(64, 36));
    table.next(0, 1.0);
    assert!(!table.queries.draws_if_seen(), "it may be stand-ins that are drawn");
    table.queries.set_true_shapes(true);
    assert!(table.queries.draws_if_seen());
    let objects = table.objects.clone();
    table.queries.draw_if_seen(Ticket(1), &objects, |_, _| {}).expect("draws");
    let mut answers = 0;
    let deliver = |_, answer: Answer<'_>| {
        assert!(matches!(answer, Answer::Swept(found) if found.len() == objects.len()));
        answers += 1;
    };
    table.queries.answers(Wait::Block, deliver).expect("answers");
    assert_eq!(answers, 1);
    let view = table.view.clone();
    let multisampled = view.clone().with_target(view.depth(), view.format(), 4);
    table.queries.begin(&multisampled).expect("a frame");
    assert!(!table.queries.draws_if_seen(), "the app's samples lie elsewhere");
}
