// Makes the proxy of each box, an invocation each: the twin of src/geom/proxy.rs in f32. The proof
// of what is different is in src/query/gpu/sweep/project.rs.

// The boxes that are asked about, and in their order the proxies and verdicts.
@group(1) @binding(1) var<storage, read> asked: array<u32>;
@group(1) @binding(2) var<storage, read_write> made: array<Proxy>;
@group(1) @binding(3) var<storage, read_write> verdicts: array<u32>;
// Where their leaves lie.
@group(1) @binding(4) var<storage, read> nodes: array<Node>;
// The places of those that are wanted.
@group(1) @binding(5) var<storage, read> wanted: array<u32>;

// See src/geom/coefficients.rs.
const MAX_SLOPE: f32 = 1e6;

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

fn make(index: u32, box: Box) {
    var proxy: Proxy;
    var screen: Screen;
    var verdict = known(box, Room(1.0, 0.0), &screen);
    let rect = pixels(&screen);
    if verdict == HIDDEN && any(rect.xy >= rect.zw) {
        verdict = OUTSIDE;
    }
    if verdict == HIDDEN {
        fill(box, &screen, rect.xy, rect.zw, &proxy);
    }
    // One without a proxy has an empty rectangle.
    made[index] = proxy;
    verdicts[index] = verdict;
}

@compute @workgroup_size(64)
fn project(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + lane;
    // The bindings have exactly what is asked about.
    if index < arrayLength(&asked) {
        make(index, boxes[asked[index]]);
    }
}

// The same for the tree's objects: where a leaf that was placed has no rectangle, none of its objects has a
// sample. (Of a leaf that lies beside the eye that is true as well, but some of its objects may count as seen.)
@compute @workgroup_size(64)
fn project_below(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let at = (group.y * groups.x + group.x) * 64u + lane;
    if at >= arrayLength(&wanted) {
        return;
    }
    let index = wanted[at];
    let box = boxes[asked[index]];
    if box.node < arrayLength(&nodes)
        && nodes[box.node].verdict == HIDDEN
        && is_empty(nodes[box.node].rect) {
        made[index].rect = vec4<u32>(0u);
        verdicts[index] = OUTSIDE;
        return;
    }
    make(index, box);
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
