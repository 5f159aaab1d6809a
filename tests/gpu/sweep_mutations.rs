//! Shaders of sweeps and of indirect frames that are wrong on purpose: the twins must find out about
//! small mistakes in every one of them.

use std::borrow::Cow;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tercet::query::SweepTest;
use tercet::query::gpu::{GpuConfig, IndirectConfig, Shaders};

use crate::indirect::wrong_lists;
use crate::support::{gpus, skip};
use crate::sweep::Twin;
use crate::twin::conventions;

/// A change of one shader, as text: what is replaced and by what.
type Mutation = (&'static str, &'static str);

/// The sources of one pass.
type Sources = for<'a> fn(&'a mut Shaders) -> Vec<&'a mut Cow<'static, str>>;

fn mutated(sources: Sources, (from, to): Mutation) -> Shaders {
    let mut shaders = Shaders::default();
    for source in sources(&mut shaders) {
        assert!(source.contains(from), "{from:?} occurs nowhere");
        *source = Cow::Owned(source.replace(from, to));
    }
    shaders
}

#[test]
fn wrong_sweeps_are_found_out() {
    const PROJECT: &[Mutation] = &[
        ("(k & 4u) != 0u", "(k & 2u) != 0u"),
        ("vec4<f32>(max(abs(box.low), abs(box.high)), 1.0)", "vec4<f32>(-1e7)"),
        ("select(SEEN, OUTSIDE, is_beside", "select(OUTSIDE, OUTSIDE, is_beside"),
        ("vec2<f32>(half.x, -half.y)", "half"),
        ("nearest = max(nearest, nearness)", "nearest = min(nearest, nearness)"),
        ("floor(screen.high + screen.reach - 0.5) + 1.0", "floor(screen.high + screen.reach - 0.5)"),
        ("ceil(screen.low - screen.reach - 0.5)", "ceil(screen.low - screen.reach + 0.5)"),
        ("snapped + moved + view.within_pixel", "-snapped - moved"),
        ("f.z += dot(abs(edge.slope), reach) + rounding", "f.z -= 1.0"),
        ("vec3<f32>(edge.slope, -edge.low)", "vec3<f32>(edge.slope, -edge.high)"),
        ("vec3<f32>(-edge.slope, edge.high)", "vec3<f32>(-edge.slope, edge.low)"),
        ("most = max(most,", "most = min(most,"),
        ("nearness[k] - dot(slope", "nearness[k] + dot(slope"),
        ("view.sign * (clip.z * inverse)", "clip.z * inverse"),
    ];
    const RASTER: &[Mutation] = &[
        ("edges[k], d) >= 0.0", "edges[k], d) >= 1.0"),
        ("nearness >= stored", "nearness <= stored"),
        ("frame.origin + pixel", "pixel"),
        ("rect.x, rect.z", "rect.x + 1u, rect.z"),
        ("if covers(&proxy, d) && ", "if "),
        ("atomicStore(&verdicts[i], SEEN)", "atomicStore(&verdicts[i / 2u], SEEN)"),
    ];
    const PYRAMID: &[Mutation] = &[
        ("min(pixel + 1u, frame.size - 1u)", "pixel"),
        ("min(texel + 1u, below - 1u)", "texel"),
        ("nearness_range(last).x", "nearness_range(pixel).x"),
        ("(2u << level) + 1u", "(2u << level)"),
        ("let level = groups.z", "let level = groups.z + 1u"),
        ("nearness_range(pixel).x", "nearness_range(pixel + 1u).x"),
        ("frame.sign * ", ""),
    ];
    const HI_Z: &[Mutation] = &[
        ("rect.zw - 1u", "rect.zw"),
        ("> vec2<u32>(1u)", "> vec2<u32>(2u)"),
        ("nearest >= farthest", "nearest > farthest + 0.01"),
        ("+ high.x]", "+ low.x]"),
        ("start + high.y", "start + low.y"),
        ("verdicts[i] != HIDDEN", "verdicts[i] == OUTSIDE + 9u"),
    ];
    // Those about several samples need an adapter that has them, which OpenGL has not.
    let Some(gpu) = gpus().into_iter().find(|gpu| gpu.sample_counts().len() > 1) else {
        return skip("no adapter has several samples a pixel that can be read");
    };
    // Seldom does the farthest of four texels alone decide.
    let passes: [(Sources, &[Mutation], usize); 4] = [
        (|shaders| vec![&mut shaders.project], PROJECT, 24),
        (
            |shaders| vec![&mut shaders.sweep_raster.single, &mut shaders.sweep_raster.multisampled],
            RASTER,
            24,
        ),
        (
            |shaders| vec![&mut shaders.build_pyramid.single, &mut shaders.build_pyramid.multisampled],
            PYRAMID,
            24,
        ),
        (|shaders| vec![&mut shaders.sweep_hi_z.single, &mut shaders.sweep_hi_z.multisampled], HI_Z, 48),
    ];
    let mut unnoticed = Vec::new();
    for (sources, mutations, rounds) in passes {
        for &mutation in mutations {
            let shaders = mutated(sources, mutation);
            let mut twin = Twin::new(&gpu, GpuConfig { shaders, ..GpuConfig::default() });
            let mut dice = ChaCha8Rng::seed_from_u64(13);
            for convention in conventions(&gpu).into_iter().cycle().take(rounds) {
                if twin.tally.faults == [0; 4] {
                    twin.round(&mut dice, convention);
                }
            }
            // Proxies may also be too large.
            if twin.tally.faults == [0; 4] && twin.tally.more * 3 < twin.tally.hidden {
                unnoticed.push((mutation, twin.tally));
            }
        }
    }
    assert!(unnoticed.is_empty(), "{unnoticed:#?}");
}

#[test]
fn wrong_lists_are_found_out() {
    const SELECT: &[Mutation] = &[
        ("return is_late && verdict == SEEN", "return verdict == SEEN"),
        ("verdict != OUTSIDE && ", ""),
        ("(remembered[slot] & DRAWN) == 0u", "true"),
        ("if lane >= reach {", "if lane > reach {"),
        ("reach *= 2u", "reach *= 4u"),
        ("sums[row] + sum", "sum"),
        ("DRAWN * wanted", "0u"),
        ("VISIBLE * u32(verdicts[i] == SEEN)", "0u"),
        ("sums[row] = earlier + sum - own", "sums[row] = earlier + sum"),
        ("carried = earlier + sum", "carried = sum + 1u"),
    ];
    const COMPACT: &[Mutation] = &[
        ("- before[first]", ""),
        ("before[i] == before[i + 1u]", "before[i] != before[i + 1u]"),
        ("before[mesh.end]", "before[mesh.end - 1u]"),
        ("mesh.base_vertex, 0u", "mesh.base_vertex, 1u"),
        ("mesh.first_index, mesh", "mesh.index_count, mesh"),
    ];
    let Some(gpu) = gpus().into_iter().next() else { return };
    let passes: [(Sources, &[Mutation]); 2] =
        [(|shaders| vec![&mut shaders.select], SELECT), (|shaders| vec![&mut shaders.compact], COMPACT)];
    for (sources, mutations) in passes {
        for &mutation in mutations {
            let shaders = mutated(sources, mutation);
            let config = IndirectConfig { shaders, test: SweepTest::Raster, ..IndirectConfig::default() };
            // What is carried from one step of the sum to the next shows only with many objects.
            let count = if mutation.0.starts_with("carried") { 140_000 } else { 1000 };
            assert!(wrong_lists(&gpu, config, count) > 0, "{mutation:?} was not found out");
        }
    }
}
