//! Shaders of sweeps and of indirect frames that are wrong on purpose: the twins must find out about
//! small mistakes in every one of them.

use std::borrow::Cow;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use tercet::query::SweepTest;
use tercet::query::gpu::{GpuConfig, GpuQueries, IndirectConfig, Shader, Shaders};

use crate::indirect::{wrong_groups, wrong_lists};
use crate::owners;
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

/// Has groups looked at by rays, however few pixels their objects have.
pub fn rays_alone(shaders: &mut Shaders) {
    for source in [&mut shaders.enlist, &mut shaders.extract] {
        let alone = source.replace("const RAY: f32 = 4.0;", "const RAY: f32 = -1.0;");
        assert_ne!(alone, *source, "nothing was replaced");
        *source = Cow::Owned(alone);
    }
}

#[test]
fn wrong_sweeps_are_found_out() {
    const PROJECT: &[Mutation] = &[
        ("(k & 4u) != 0u", "(k & 2u) != 0u"),
        ("vec4<f32>(max(abs(box.low), abs(box.high)), 1.0)", "vec4<f32>(-1e7)"),
        ("select(SEEN, OUTSIDE, is_beside", "select(OUTSIDE, OUTSIDE, is_beside"),
        ("vec2<f32>(half.x, -half.y)", "half"),
        ("nearest = max(nearest, nearness)", "nearest = min(nearest, nearness)"),
        (
            "floor((*screen).high + (*screen).reach - 0.5) + 1.0",
            "floor((*screen).high + (*screen).reach - 0.5)",
        ),
        ("ceil((*screen).low - (*screen).reach - 0.5)", "ceil((*screen).low - (*screen).reach + 0.5)"),
        ("snapped + moved + view.within_pixel", "-snapped - moved"),
        ("f.z += dot(abs(edge.slope), reach) + rounding", "f.z -= 1.0"),
        ("vec3<f32>(edge.slope, -edge.low)", "vec3<f32>(edge.slope, -edge.high)"),
        ("vec3<f32>(-edge.slope, edge.high)", "vec3<f32>(-edge.slope, edge.low)"),
        ("most = max(most,", "most = min(most,"),
        ("nearness[k] - dot(slope", "nearness[k] + dot(slope"),
        ("view.sign * (clip.z * inverse)", "clip.z * inverse"),
        ("let index = wanted[at]", "let index = at / 2u"),
    ];
    const RASTER: &[Mutation] = &[
        ("edges[k], d) >= 0.0", "edges[k], d) >= 1.0"),
        ("nearness >= stored", "nearness <= stored"),
        ("frame.origin + pixel", "pixel"),
        ("rect.x, rect.z", "rect.x + 1u, rect.z"),
        ("if covers(&proxy, d) && ", "if "),
        ("atomicStore(&verdicts[i], SEEN)", "atomicStore(&verdicts[i / 2u], SEEN)"),
    ];
    const RAYS: &[Mutation] = &[
        ("all(pixel < rect.zw)", "all(pixel + 1u < rect.zw)"),
        ("entry(&proxy, d) >= stored", "entry(&proxy, d) > stored + 0.01"),
        ("return covers(&proxy, d) && ", "return "),
        ("node.nearest < stored", "node.nearest > stored"),
        ("place < node.end", "place + 1u < node.end"),
        ("at = node.skip;", "at = end;"),
        ("at = node.enter;", "at = node.skip;"),
        ("at != end", "at == corner.index"),
        ("== HIDDEN && meets", "!= HIDDEN && meets"),
        ("frame.origin + pixel", "pixel"),
    ];
    const ENCLOSE: &[Mutation] = &[
        ("Room(3.0, 100.0)", "Room(-3.0, 100.0)"),
        ("link.first, link.end", "link.first, link.first"),
        ("link.enter, link.skip", "link.skip, link.skip"),
        ("boxes[i]", "boxes[i / 2u]"),
        ("max(screen.nearest + screen.depth_error, view.cleared)", "view.cleared"),
        ("(box.kind & view.askable) != 0u", "(box.kind & view.askable) == 0u"),
    ];
    const ENLIST: &[Mutation] = &[
        ("if i < arrayLength(&groups)", "if i + 1u < arrayLength(&groups)"),
        ("list_group(groups[i])", "list_group(i)"),
        ("Listed(rect, at)", "Listed(rect, at + 1u)"),
        ("Listed(part, place)", "Listed(part, place + 1u)"),
        ("&listed.draw[INSTANCES]", "&listed.draw[0]"),
        ("end = nodes[node.skip].first", "end = node.first + 1u"),
        ("max(part.zw, rect.zw)", "min(part.zw, rect.zw)"),
        ("verdicts[place] != HIDDEN", "verdicts[place] == HIDDEN"),
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
    const PRUNE: &[Mutation] = &[
        ("return nearest < farthest_in(rect)", "return nearest <= farthest_in(rect) + 0.01"),
        ("covers(proxy, d) && in_sight", "in_sight"),
        ("in_sight(pixel, entry(proxy, d)) != 0u", "true"),
        ("+ high.x]", "+ low.x]"),
        ("select(low, high, f.xy", "select(high, low, f.xy"),
        ("k < size.x * size.y", "k + 1u < size.x * size.y"),
        ("cells.x * cells.y; k++", "cells.x; k++"),
        ("max(open.zw, part.zw)", "min(open.zw, part.zw)"),
        ("Listed(found.rect, i)", "Listed(found.rect, 0u)"),
        ("found.rect.x | (found.rect.y << 16u)", "found.rect.z | (found.rect.y << 16u)"),
    ];
    // Those about several samples need an adapter that has them, which OpenGL has not.
    let Some(gpu) = gpus().into_iter().find(|gpu| gpu.sample_counts().len() > 1) else {
        return skip("no adapter has several samples a pixel that can be read");
    };
    // Seldom does the farthest of four texels alone decide.
    let passes: [(Sources, &[Mutation], usize); 8] = [
        (|shaders| vec![&mut shaders.project], PROJECT, 24),
        (
            |shaders| vec![&mut shaders.sweep_raster.single, &mut shaders.sweep_raster.multisampled],
            RASTER,
            24,
        ),
        (|shaders| vec![&mut shaders.sweep_rays.single, &mut shaders.sweep_rays.multisampled], RAYS, 24),
        (|shaders| vec![&mut shaders.enclose], ENCLOSE, 24),
        (|shaders| vec![&mut shaders.enlist], ENLIST, 24),
        (
            |shaders| vec![&mut shaders.build_pyramid.single, &mut shaders.build_pyramid.multisampled],
            PYRAMID,
            24,
        ),
        (|shaders| vec![&mut shaders.sweep_hi_z.single, &mut shaders.sweep_hi_z.multisampled], HI_Z, 48),
        (|shaders| vec![&mut shaders.prune.single, &mut shaders.prune.multisampled], PRUNE, 48),
    ];
    let mut unnoticed = Vec::new();
    for (sources, mutations, rounds) in passes {
        for &mutation in mutations {
            let mut shaders = mutated(sources, mutation);
            if std::ptr::eq(mutations, RAYS) {
                rays_alone(&mut shaders);
            }
            // What is found beforehand would hide the mistakes of those who look closely.
            let prune_from = if std::ptr::eq(mutations, PRUNE) { 0 } else { usize::MAX };
            let mut twin = Twin::new(&gpu, GpuConfig { shaders, prune_from, ..GpuConfig::default() });
            let mut dice = ChaCha8Rng::seed_from_u64(13);
            for convention in conventions(&gpu).into_iter().cycle().take(rounds) {
                if twin.tally.faults == [0; 5] {
                    twin.round(&mut dice, convention);
                }
            }
            // Proxies may also be too large.
            if twin.tally.faults == [0; 5] && twin.tally.more * 3 < twin.tally.hidden {
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
    // Sweeps open what the device cannot place before it is asked.
    const ENCLOSE: &[Mutation] =
        &[("verdict == SEEN {\n        rect = vec4<f32>(vec2<f32>(0.0), view.size);", "verdict == SEEN {")];
    const MARK: &[Mutation] = &[
        ("atomicMax(&marks[child], UNKNOWN)", "atomicMax(&marks[child], 0u)"),
        ("child = nodes[child].skip", "child = nodes[at].skip"),
    ];
    const EXTRACT: &[Mutation] = &[
        ("if mark == VISIBLE {", "if mark == 9u {"),
        ("select(0u, UNKNOWN, i == 0u)", "0u"),
        ("at = node.enter;", "at = node.skip;"),
        ("Listed(part, place)", "Listed(part, place / 2u)"),
        ("place < node.end", "place + 1u < node.end"),
        ("&loose.draw[INSTANCES]", "&loose.draw[0]"),
        ("list_group(at);", ""),
    ];
    const SPREAD: &[Mutation] = &[
        ("found[places[i]]", "found[i]"),
        ("if i < arrayLength(&verdicts)", "if i + 1u < arrayLength(&verdicts)"),
    ];
    let passes: [(Sources, &[Mutation], SweepTest); 6] = [
        (|shaders| vec![&mut shaders.select], SELECT, SweepTest::Raster),
        (|shaders| vec![&mut shaders.compact], COMPACT, SweepTest::Raster),
        (|shaders| vec![&mut shaders.enclose], ENCLOSE, SweepTest::Rays),
        (|shaders| vec![&mut shaders.mark], MARK, SweepTest::Rays),
        (|shaders| vec![&mut shaders.extract], EXTRACT, SweepTest::Rays),
        (|shaders| vec![&mut shaders.spread], SPREAD, SweepTest::Rays),
    ];
    for (sources, mutations, test) in passes {
        for &mutation in mutations {
            let shaders = mutated(sources, mutation);
            let prune_from = usize::MAX;
            let config = IndirectConfig { shaders, test, prune_from, ..IndirectConfig::default() };
            // What is carried from one step of the sum to the next shows only with many objects.
            let count = if mutation.0.starts_with("carried") { 140_000 } else { 1000 };
            assert!(wrong_lists(&gpu, config, count) > 0, "{mutation:?} was not found out");
        }
    }
}

#[test]
fn wrong_groups_are_found_out() {
    const MARK: &[Mutation] = &[
        ("& DRAWN) != 0u", "& DRAWN) == 0u"),
        ("at = nodes[at].parent;", "at = NONE;"),
        ("place < node.end", "place + 1u < node.end"),
    ];
    const EXTRACT: &[Mutation] = &[
        ("size.x * size.y > most.x", "size.x * size.y >= 0.0"),
        ("node.verdict == SEEN", "node.verdict != SEEN"),
        ("if mark != UNKNOWN {", "if mark == 9u {"),
    ];
    let Some(gpu) = gpus().into_iter().next() else { return };
    let passes: [(Sources, &[Mutation]); 2] =
        [(|shaders| vec![&mut shaders.mark], MARK), (|shaders| vec![&mut shaders.extract], EXTRACT)];
    for (sources, mutations) in passes {
        for &mutation in mutations {
            let config = IndirectConfig {
                shaders: mutated(sources, mutation),
                test: SweepTest::Rays,
                ..IndirectConfig::default()
            };
            assert!(wrong_groups(&gpu, config) > 0, "{mutation:?} was not found out");
        }
    }
}

#[test]
fn wrong_owners_are_found_out() {
    const OWNERS: &[Mutation] = &[
        ("verdicts[id - 1u], SEEN", "verdicts[id], SEEN"),
        ("sample < frame.samples", "sample + 1u < frame.samples"),
        ("i32(sample)", "0"),
        ("any(at.xy >= frame.size)", "any(at.xy >= frame.size / 2u)"),
        ("id != 0u && id <=", "id != 0u && id + 2u <="),
    ];
    let Some(gpu) = gpus().into_iter().find(|gpu| gpu.sample_counts().len() > 1) else {
        return skip("no adapter has several samples a pixel that can be read");
    };
    for &mutation in OWNERS {
        let mut shaders = Shaders::default();
        let Shader { single, multisampled } = &mut shaders.sweep_owners;
        for source in [single, multisampled] {
            *source = Cow::Owned(source.replace(mutation.0, mutation.1));
        }
        let config = GpuConfig { shaders, ..GpuConfig::default() };
        let mut queries = GpuQueries::with_config(&gpu.device, &gpu.queue, config).expect("a backend");
        let wrong = (0..4).any(|seed| owners::run(&gpu, &mut queries, seed, 4).wrong > 0);
        assert!(wrong, "{mutation:?} was not found out");
    }
}
