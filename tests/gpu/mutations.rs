//! Shaders that are wrong on purpose: the comparison with the plain loop must find out about small
//! mistakes in every one of them.

use std::borrow::Cow;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tercet::query::gpu::{Counting, GpuConfig, Shader, Shaders};

use crate::support::gpus;
use crate::twin::{Tally, conventions, round};

/// A change of one shader, as text: what is replaced and by what.
type Mutation = (&'static str, &'static str);

/// Wherever the text occurs in the passes of one of the ways of counting.
fn mutated(counting: Counting, (from, to): Mutation) -> Shaders {
    let mut shaders = Shaders::default();
    let passes = match counting {
        Counting::Fragments => vec![&mut shaders.count_fragments],
        Counting::Workgroups => vec![&mut shaders.count_workgroups],
        Counting::Blocks => vec![&mut shaders.count_blocks, &mut shaders.gather_blocks],
    };
    let change = |source: &Cow<'static, str>| Cow::Owned(source.replace(from, to));
    for shader in passes {
        *shader = Shader { single: change(&shader.single), multisampled: change(&shader.multisampled) };
    }
    shaders
}

#[test]
fn wrong_shaders_are_found_out() {
    const SHARED: &[Mutation] = &[
        ("nearness >= stored", "nearness > stored"),
        ("nearness >= stored", "nearness <= stored"),
        ("edges[k], d) >= 0.0", "edges[k], d) >= 1.0"),
        ("k < 6u", "k < 5u"),
        ("k < 3u", "k < 2u"),
        ("+ 0.5", "+ 1.5"),
        ("frame.origin + pixel", "pixel"),
        ("frame.sign * ", ""),
        ("k < frame.samples", "k + 1u < frame.samples"),
        ("var nearness = (*proxy).nearest", "var nearness = 2.0"),
        ("min(nearness, affine", "max(nearness, affine"),
        ("f.y * d.y", "f.y * d.x"),
    ];
    const FRAGMENTS: &[Mutation] = &[
        ("rect.x, rect.z", "rect.x, rect.z - 1u"),
        ("rect.y, rect.w", "rect.y + 1u, rect.w"),
        ("atomicAdd(&counts[i].total, frame.samples)", "atomicAdd(&counts[i].total, 2u)"),
        ("atomicAdd(&counts[i].visible, seen)", "atomicStore(&counts[i].visible, seen)"),
        ("if any && atomicLoad(&counts[i].visible) != 0u", "if any"),
    ];
    const WORKGROUPS: &[Mutation] = &[
        ("corner + TILE", "corner + TILE - 1u"),
        ("y += LANES", "y += LANES + 1u"),
        ("x < end.x", "x + 1u < end.x"),
        ("tile.column, tile.row", "tile.row, tile.column"),
        ("covered += frame.samples", "covered += 2u"),
        ("if any && seen != 0u {", "if any && seen > 64u {"),
        (
            "atomicAdd(&counts[i].visible, atomicLoad(&visible))",
            "atomicStore(&counts[i].visible, atomicLoad(&visible))",
        ),
    ];
    const BLOCKS: &[Mutation] = &[
        ("first.x) * (end.y - first.y)", "first.x + 1u) * (end.y - first.y)"),
        ("offset(proxy, end - 1u)", "offset(proxy, end - 2u)"),
        ("entry_least >= range.y", "entry_least >= range.x"),
        ("entry_most < range.x", "entry_most < range.y"),
        ("if hidden && (inside || (*proxy).any != 0u)", "if hidden"),
        ("if inside && entry_least", "if entry_least"),
        ("select(first, last, f.xy", "select(last, first, f.xy"),
        ("select(last, first, f.xy", "select(first, last, f.xy"),
        ("+ lane.xy * BLOCK", "+ lane.xx * BLOCK"),
        ("first + BLOCK, frame.size", "first + BLOCK - 1u, frame.size"),
        ("min(range.x, pixel.x)", "range.x"),
        ("max(range.y, pixel.y)", "range.y"),
        ("min(range.x, stored)", "range.x"),
        ("max(range.y, stored)", "range.y"),
        ("blocks[at.y * grid.x + at.x]", "blocks[at.x * grid.y + at.y]"),
    ];
    // Those about several samples need an adapter that has them.
    let Some(gpu) = gpus().into_iter().find(|gpu| gpu.sample_counts().len() > 1) else { return };
    for (counting, own) in
        [(Counting::Fragments, FRAGMENTS), (Counting::Workgroups, WORKGROUPS), (Counting::Blocks, BLOCKS)]
    {
        for &mutation in SHARED.iter().chain(own) {
            let shaders = mutated(counting, mutation);
            let sources = |shaders: &Shaders| {
                [false, true].map(|several| {
                    [shaders.source(counting, several), shaders.gather_blocks_source(several)].concat()
                })
            };
            assert_ne!(sources(&shaders), sources(&Shaders::default()), "{mutation:?} changes nothing");
            let config = GpuConfig { counting: Some(counting), shaders, ..GpuConfig::default() };
            let mut queries = gpu.exact_queries(config);
            let (mut dice, mut tally) = (ChaCha8Rng::seed_from_u64(11), Tally::default());
            for convention in conventions(&gpu).into_iter().cycle().take(24) {
                if tally.faults == 0 {
                    round(&gpu, &mut queries, &mut dice, convention, &mut tally);
                }
            }
            assert!(tally.faults > 0, "{counting:?} with {mutation:?} was not found out: {tally:?}");
        }
    }
}
