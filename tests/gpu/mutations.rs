//! Shaders that are wrong on purpose: the comparison with the plain loop must find out about small
//! mistakes in every one of them.

use std::borrow::Cow;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tercet::query::gpu::{AnyBy, Counting, GpuConfig, Shader, Shaders};

use crate::support::{gpus, skip};
use crate::twin::{Twin, conventions};

/// A change of one shader, as text: what is replaced and by what.
type Mutation = (&'static str, &'static str);

/// Who is broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Broken {
    Counting(Counting),
    Native,
}

/// The sources with the text replaced wherever it occurs in the passes of the one that is broken.
fn mutated(broken: Broken, (from, to): Mutation) -> Shaders {
    let mut shaders = Shaders::default();
    let change = |source: &mut Cow<'static, str>| *source = Cow::Owned(source.replace(from, to));
    let passes = match broken {
        Broken::Native => {
            change(&mut shaders.ask_natively);
            vec![]
        }
        Broken::Counting(Counting::Fragments) => vec![&mut shaders.count_fragments],
        Broken::Counting(Counting::Workgroups) => vec![&mut shaders.count_workgroups],
        Broken::Counting(Counting::Subgroups) => vec![&mut shaders.count_subgroups],
        Broken::Counting(Counting::Blocks) => vec![&mut shaders.count_blocks, &mut shaders.gather_blocks],
    };
    for Shader { single, multisampled } in passes {
        change(single);
        change(multisampled);
    }
    assert_ne!(format!("{shaders:?}"), format!("{:?}", Shaders::default()), "{from:?} occurs nowhere");
    shaders
}

#[test]
fn wrong_shaders_are_found_out() {
    const SHARED: &[Mutation] = &[
        ("edges[k], d) >= 0.0", "edges[k], d) >= 1.0"),
        ("k < 6u", "k < 5u"),
        ("k < 3u", "k < 2u"),
        ("+ 0.5", "+ 1.5"),
        ("frame.sign * ", ""),
        ("var nearness = (*proxy).nearest", "var nearness = 2.0"),
        ("min(nearness, affine", "max(nearness, affine"),
        ("f.y * d.y", "f.y * d.x"),
    ];
    const NATIVE: &[Mutation] = &[
        ("f32(rect.x) - 0.25", "f32(rect.x) + 1.0"),
        ("f32(rect.w) + 0.25", "f32(rect.w) - 1.0"),
        ("- vec2<i32>(frame.origin)", ""),
        ("pixel >= rect.zw", "pixel + 1 >= rect.zw"),
        ("!covers(&proxy, d) || ", ""),
        ("min(frame.sign, 0.0)", "0.0"),
        ("0.0, 1.0)", "0.0, 0.5)"),
    ];
    const COUNTING: &[Mutation] = &[
        ("nearness >= stored", "nearness > stored"),
        ("nearness >= stored", "nearness <= stored"),
        ("frame.origin + pixel", "pixel"),
        ("k < frame.samples", "k + 1u < frame.samples"),
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
        ("add_up(seen, covered)", "add_up(covered, seen)"),
        ("if !any {", "if !any && lane.y == 0u {"),
        ("if any && seen != 0u {", "if any && seen > 64u {"),
        (
            "atomicAdd(&counts[i].visible, atomicLoad(&visible))",
            "atomicStore(&counts[i].visible, atomicLoad(&visible))",
        ),
    ];
    const SUBGROUPS: &[Mutation] = &[
        ("subgroupExclusiveAdd(1u) == 0u", "subgroupExclusiveAdd(1u) == 99u"),
        ("subgroupExclusiveAdd(1u) == 0u", "true"),
        ("subgroupAdd(seen)", "seen"),
        ("subgroupAdd(covered)", "covered"),
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
    // Those about several samples need an adapter that has them, which OpenGL has not.
    let Some(gpu) = gpus().into_iter().find(|gpu| gpu.sample_counts().len() > 1) else {
        return skip("no adapter has several samples a pixel that can be read");
    };
    let of = |counting, own: &[Mutation]| (Broken::Counting(counting), [COUNTING, own].concat());
    for (broken, own) in [
        of(Counting::Fragments, FRAGMENTS),
        of(Counting::Workgroups, WORKGROUPS),
        of(Counting::Subgroups, SUBGROUPS),
        of(Counting::Blocks, BLOCKS),
        (Broken::Native, NATIVE.to_vec()),
    ] {
        if let Broken::Counting(counting) = broken
            && !counting.is_supported(&gpu.device)
        {
            continue;
        }
        for &mutation in SHARED.iter().chain(&own) {
            let shaders = mutated(broken, mutation);
            let config = match broken {
                Broken::Counting(counting) => {
                    GpuConfig { counting: Some(counting), shaders, ..GpuConfig::default() }
                }
                Broken::Native => GpuConfig { any: AnyBy::Native, shaders, ..GpuConfig::default() },
            };
            let windows = if broken == Broken::Native { 4 } else { 0 };
            let mut twin = Twin::new(&gpu, [config], windows);
            let mut dice = ChaCha8Rng::seed_from_u64(11);
            for convention in conventions(&gpu).into_iter().cycle().take(24) {
                if twin.tally.faults == 0 {
                    twin.round(&mut dice, convention);
                }
            }
            let tally = twin.tally;
            assert!(tally.faults > 0, "{broken:?} with {mutation:?} was not found out: {tally:?}");
        }
    }
}
