// Makes the proxy of each box, an invocation each: the twin of src/geom/proxy.rs in f32. The proof
// of what is different is in src/query/gpu/sweep/project.rs.

struct View {
    clip_from_world: mat4x4<f32>,
    // Times (|x|, |y|, |z|, 1), it bounds the error of clip coordinates.
    error: mat4x4<f32>,
    // To a scale of its own: only directions are taken from it.
    world_from_clip: mat4x4<f32>,
    // By the faces that are turned to the viewer: up to three pairs of edges, three bits a corner,
    // and how many pairs there are.
    silhouettes: array<vec4<u32>, 27>,
    // The viewport's upper left corner in the target, and its size, in pixels.
    origin: vec2<f32>,
    size: vec2<f32>,
    // Nearness is depth times this.
    sign: f32,
    // How far from a pixel's centre its samples lie.
    within_pixel: f32,
    // A step of the depth format: its share of the depth, and what comes on top.
    step_share: f32,
    step: f32,
    // The nearness of what nothing was drawn on.
    cleared: f32,
    // Added to nearness.
    slack: f32,
    // 0 if no box can be asked about.
    askable: u32,
    unused: u32,
}

struct Box {
    low: vec3<f32>,
    // See below.
    kind: u32,
    high: vec3<f32>,
    // The leaf that holds it.
    node: u32,
}

// Kinds of boxes: there is one; it is not to be asked about, but seen.
const BOXED: u32 = 1u;
const ALWAYS: u32 = 2u;

@group(0) @binding(0) var<uniform> view: View;
@group(1) @binding(0) var<storage, read> boxes: array<Box>;
// The boxes that are asked about, and in their order the proxies and verdicts.
@group(1) @binding(1) var<storage, read> asked: array<u32>;
@group(1) @binding(2) var<storage, read_write> made: array<Proxy>;
@group(1) @binding(3) var<storage, read_write> verdicts: array<u32>;

// Half of the distance from 1 to the next f32.
const UNIT: f32 = 5.9604645e-8;
// More than all that may be flushed to zero.
const TINY: f32 = 1e-18;
const FARTHEST: f32 = 3e38;
// See src/geom/proxy.rs and src/geom/project.rs.
const MAX_REACH: f32 = 32.0;
const MAX_SLOPE: f32 = 1e6;
const SNAP: f32 = 0.0625;

// The corners in pixels of the viewport and nearness, and how far from their hull a sample of
// geometry in the box may lie.
struct Screen {
    x: array<f32, 8>,
    y: array<f32, 8>,
    nearness: array<f32, 8>,
    low: vec2<f32>,
    high: vec2<f32>,
    reach: vec2<f32>,
    depth_error: f32,
    nearest: f32,
    farthest: f32,
}

fn corner(box: Box, k: u32) -> vec3<f32> {
    return select(box.low, box.high, vec3<bool>((k & 1u) != 0u, (k & 2u) != 0u, (k & 4u) != 0u));
}

// Whether all of a box that may reach behind the eye lies outside one side of the view.
fn is_beside(box: Box, error: vec4<f32>) -> bool {
    let k = 1.0 + 2.0 * (2.0 * SNAP + 40.0 * UNIT * (view.origin + view.size)) / view.size;
    let slack = 1.01 * (error.xy + k * error.w);
    var least_low = vec2<bool>(true);
    var least_high = vec2<bool>(true);
    for (var i = 0u; i < 8u; i++) {
        let clip = view.clip_from_world * vec4<f32>(corner(box, i), 1.0);
        least_low = least_low & (clip.xy + k * clip.w < -slack);
        least_high = least_high & (k * clip.w - clip.xy < -slack);
    }
    return any(least_low | least_high);
}

// Projects the corners, if all of them are certain to lie before the near plane: HIDDEN if so.
fn place(box: Box, screen: ptr<function, Screen>) -> u32 {
    let error = view.error * vec4<f32>(max(abs(box.low), abs(box.high)), 1.0) + TINY;
    let is_reversed = view.sign > 0.0;
    let half = 0.5 * view.size;
    var near = vec2<f32>(FARTHEST, -FARTHEST);
    var far = -FARTHEST;
    var least_w = FARTHEST;
    for (var i = 0u; i < 8u; i++) {
        let clip = view.clip_from_world * vec4<f32>(corner(box, i), 1.0);
        let before_near = select(clip.z, clip.w - clip.z, is_reversed);
        let before_far = select(clip.w - clip.z, clip.z, is_reversed);
        near = vec2<f32>(min(near.x, before_near), max(near.y, before_near));
        far = max(far, before_far);
        least_w = min(least_w, clip.w);
    }
    let plane_error = error.w + error.z;
    if near.y < -plane_error || far < -plane_error {
        return OUTSIDE;
    }
    if !(least_w > 4.0 * error.w && near.x > plane_error) {
        return select(SEEN, OUTSIDE, is_beside(box, error));
    }
    var low = vec2<f32>(FARTHEST);
    var high = vec2<f32>(-FARTHEST);
    var nearest = -FARTHEST;
    var farthest = FARTHEST;
    for (var i = 0u; i < 8u; i++) {
        let clip = view.clip_from_world * vec4<f32>(corner(box, i), 1.0);
        let inverse = 1.0 / clip.w;
        let at = half + vec2<f32>(half.x, -half.y) * (clip.xy * inverse);
        let nearness = view.sign * (clip.z * inverse);
        (*screen).x[i] = at.x;
        (*screen).y[i] = at.y;
        (*screen).nearness[i] = nearness;
        low = min(low, at);
        high = max(high, at);
        nearest = max(nearest, nearness);
        farthest = min(farthest, nearness);
    }
    let far_out = max(abs(low), abs(high));
    if !(max(far_out.x, far_out.y) < 1e8) {
        return SEEN;
    }
    let snapped = 2.0 * SNAP + 40.0 * UNIT * (far_out + view.origin + view.size);
    let least_true_w = least_w - error.w;
    // Corners beside the viewport are less certain than what is drawn in it.
    let beside = max(half + snapped, max(abs(low - half), abs(high - half)));
    let moved = (half * error.xy + beside * error.w) / least_true_w;
    let reach = snapped + moved + view.within_pixel;
    if !(max(reach.x, reach.y) < MAX_REACH) {
        return SEEN;
    }
    let magnitude = max(abs(nearest), abs(farthest));
    let drawn = 1.3334 * (error.z + magnitude * error.w) / least_true_w + 32.0 * UNIT * magnitude;
    (*screen).low = low;
    (*screen).high = high;
    (*screen).reach = reach;
    (*screen).depth_error = drawn + (view.step_share * magnitude + view.step);
    (*screen).nearest = nearest;
    (*screen).farthest = farthest;
    return HIDDEN;
}

// The value of the inward plane `p[axis] = at` along a column of world_from_clip.
fn form(column: vec4<f32>, axis: u32, at: f32) -> f32 {
    return column[axis] - at * column.w;
}

// c of a function raised by its rounding, here and wherever it is evaluated.
fn raised(f: vec3<f32>, size: vec2<f32>) -> vec4<f32> {
    let up = 24.0 * UNIT * (dot(abs(f.xy), size) + abs(f.z)) + TINY;
    return vec4<f32>(f.xy, f.z + up, 0.0);
}

// The half planes that hold all corners and whose borders are parallel to an edge, and how much
// farther the box reaches beyond it on one side than on the other.
struct Support {
    slope: vec2<f32>,
    low: f32,
    high: f32,
    excess: f32,
}

fn support(screen: ptr<function, Screen>, origin: vec2<f32>, ends: u32) -> Support {
    let i = ends & 7u;
    let j = (ends >> 3u) & 7u;
    let along = vec2<f32>((*screen).x[j] - (*screen).x[i], (*screen).y[j] - (*screen).y[i]);
    let length = abs(along.x) + abs(along.y);
    var slope = vec2<f32>(0.0);
    if length > 1e-6 {
        slope = vec2<f32>(-along.y, along.x) / length;
    }
    var low = FARTHEST;
    var high = -FARTHEST;
    var at_edge = 0.0;
    for (var k = 0u; k < 8u; k++) {
        let at = dot(slope, vec2<f32>((*screen).x[k], (*screen).y[k]) - origin);
        low = min(low, at);
        high = max(high, at);
        at_edge = select(at_edge, at, k == i);
    }
    return Support(slope, low, high, (high - at_edge) - (at_edge - low));
}

@compute @workgroup_size(64)
fn project(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + lane;
    // The bindings have exactly what is asked about.
    if index >= arrayLength(&asked) {
        return;
    }
    let box = boxes[asked[index]];
    var proxy: Proxy;
    var screen: Screen;
    var verdict = OUTSIDE;
    if (box.kind & BOXED) != 0u {
        verdict = SEEN;
        if view.askable != 0u {
            verdict = place(box, &screen);
        }
    }
    if (box.kind & ALWAYS) != 0u {
        verdict = SEEN;
    }
    let low_pixel = clamp(ceil(screen.low - screen.reach - 0.5), vec2<f32>(0.0), view.size);
    let end_pixel = clamp(floor(screen.high + screen.reach - 0.5) + 1.0, vec2<f32>(0.0), view.size);
    if verdict == HIDDEN && any(low_pixel >= end_pixel) {
        verdict = OUTSIDE;
    }
    if verdict == HIDDEN {
        fill(box, &screen, low_pixel, end_pixel, &proxy);
    }
    // One without a proxy has an empty rectangle.
    made[index] = proxy;
    verdicts[index] = verdict;
}

fn fill(
    box: Box,
    screen: ptr<function, Screen>,
    low_pixel: vec2<f32>,
    end_pixel: vec2<f32>,
    proxy: ptr<function, Proxy>,
) {
    let size = end_pixel - low_pixel;
    let reach = (*screen).reach;
    // No corner is farther from the rectangle's own.
    let farthest_out = max(abs((*screen).low - low_pixel), abs((*screen).high - low_pixel));
    (*proxy).rect = vec4<u32>(vec2<u32>(low_pixel), vec2<u32>(end_pixel));
    (*proxy).any = 1u;
    let nearest = max((*screen).nearest + (*screen).depth_error, view.cleared);
    (*proxy).nearest = nearest + view.slack;

    var turned = 0u;
    var planes = 0u;
    let reaches_far = (*screen).farthest - (*screen).depth_error <= view.cleared;
    for (var axis = 0u; axis < 3u; axis++) {
        (*proxy).planes[axis] = vec4<f32>(0.0, 0.0, FARTHEST, 0.0);
    }
    for (var axis = 0u; axis < 3u; axis++) {
        let weight = select(select(9u, 3u, axis == 1u), 1u, axis == 0u);
        var at = box.low[axis];
        if view.sign * form(view.world_from_clip[2], axis, at) < 0.0 {
            turned += weight;
        } else {
            at = box.high[axis];
            if !(view.sign * form(view.world_from_clip[2], axis, at) > 0.0) {
                continue;
            }
            turned += 2u * weight;
        }
        let along_depth = -view.sign * form(view.world_from_clip[2], axis, at);
        let across = vec2<f32>(
            form(view.world_from_clip[0], axis, at) * 2.0 / view.size.x,
            form(view.world_from_clip[1], axis, at) * -2.0 / view.size.y,
        );
        if !(max(abs(across.x), abs(across.y)) < MAX_SLOPE * abs(along_depth)) {
            continue;
        }
        let slope = across / along_depth;
        var most = -FARTHEST;
        for (var k = 0u; k < 8u; k++) {
            let at_corner = vec2<f32>((*screen).x[k], (*screen).y[k]) - low_pixel;
            most = max(most, (*screen).nearness[k] - dot(slope, at_corner));
        }
        let rounding = 16.0 * UNIT * (abs((*screen).nearest) + abs((*screen).farthest) + dot(abs(slope), farthest_out));
        let c = most + (dot(abs(slope), reach) + (*screen).depth_error + rounding);
        let plane = raised(vec3<f32>(slope, c), size);
        let first = slope * 0.5;
        let last = slope * (size - 0.5);
        let lowest = c + min(first.x, last.x) + min(first.y, last.y) - (plane.z - c);
        if reaches_far && lowest < view.cleared {
            continue;
        }
        (*proxy).planes[planes] = vec4<f32>(plane.xy, plane.z + view.slack, 0.0);
        planes++;
    }

    let pairs = view.silhouettes[turned];
    for (var pair = 0u; pair < 3u; pair++) {
        if pair >= pairs.w {
            break;
        }
        let first = support(screen, low_pixel, pairs[pair]);
        let second = support(screen, low_pixel, pairs[pair] >> 6u);
        let first_is_low = first.excess >= second.excess;
        for (var side = 0u; side < 2u; side++) {
            var edge = first;
            if side == 1u {
                edge = second;
            }
            var f = vec3<f32>(edge.slope, -edge.low);
            if first_is_low == (side == 1u) {
                f = vec3<f32>(-edge.slope, edge.high);
            }
            let rounding = 16.0 * UNIT * (farthest_out.x + farthest_out.y);
            f.z += dot(abs(edge.slope), reach) + rounding;
            (*proxy).edges[2u * pair + side] = raised(f, size);
        }
    }
}
