//! Who owns a sample: the item buffer of the frame as drawn, against the oracle's.

use rand::RngExt;
use rayon::prelude::*;
use tercet::geom::Viewport;
use tercet::query::SweepTest;
use tercet::query::oracle::Oracle;
use tercet::scene::ObjectId;
use tercet::tree::TreeConfig;
use tercet::worlds;

use super::table::Table;
use crate::painter::draw;

#[test]
fn owners_are_those_whom_the_oracle_sees() {
    let counts = (0..24u64).into_par_iter().map(|seed| {
        let tree = TreeConfig::default();
        let mut table = Table::new(worlds::random(seed, 150), tree, seed, Viewport::new(161, 91));
        let (mut oracle, mut owners, mut others) = (Oracle::new(), 0, 0);
        for frame in 0..6 {
            table.next(frame, 1.0);
            let (world, view, detail) = (&table.stage.world, &table.view, table.stage.detail);
            // Of the table, everything is drawn into the depth: also what hides nothing.
            let candidates: Vec<_> = (table.objects.iter())
                .map(|&object| {
                    let bounds = table.scene.tree().aabb_of(object.id.slot() as u32);
                    tercet::query::oracle::Candidate { object, bounds, not_occluder: false }
                })
                .collect();
            let truth = oracle
                .look_at(view, &candidates, |pass, objects| draw(world, view, detail, pass, objects))
                .expect("the oracle looks");
            let asked: Vec<ObjectId> = table.objects.iter().map(|object| object.id).collect();
            let asked: Vec<ObjectId> = asked.into_iter().filter(|_| table.dice.random_bool(0.8)).collect();
            let found = table.sweep(&[], &asked, SweepTest::Owners);
            for id in asked {
                assert_eq!(found.contains(&id.slot()), truth.exact.contains(id), "seed {seed}: {id:?}");
            }
            owners += found.len();
            others += table.objects.len() - found.len();
        }
        (owners, others)
    });
    let counts: Vec<(usize, usize)> = counts.collect();
    let (owners, others) = counts.into_iter().fold((0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    assert!(owners > 1000 && others > 1000, "{owners} owners, {others} others");
}
