// Before closer tests, an invocation each: what the pyramid shows to be hidden need not be looked at, nor what
// has one of a few samples in sight. See src/query/gpu/sweep/prune.rs.

@group(1) @binding(0) var<storage, read_write> proxies: array<Proxy>;
@group(1) @binding(1) var<storage, read_write> nodes: array<Node>;
@group(1) @binding(2) var<storage, read_write> verdicts: array<u32>;
@group(1) @binding(3) var<storage, read> pyramid: array<f32>;
// Of whom nothing is known yet.
@group(1) @binding(4) var<storage, read_write> open: List;
// The places of those who are looked at.
@group(1) @binding(5) var<storage, read> wanted: array<u32>;

// Rectangles of so many pixels are looked at pixel by pixel.
const CLOSELY: u32 = 256u;
// Others by parts, so many along each side.
const CELLS: u32 = 8u;
// The verdict of nobody.
const OPEN: u32 = 3u;

fn is_hidden(rect: vec4<u32>, nearest: f32) -> bool {
    return nearest < farthest_in(rect);
}

// Whether a proxy has a sample in sight in a pixel.
fn is_seen_at(proxy: ptr<function, Proxy>, pixel: vec2<u32>) -> bool {
    let d = offset(proxy, pixel);
    return covers(proxy, d) && in_sight(pixel, entry(proxy, d)) != 0u;
}

// The greatest value of a function between two points.
fn greatest(f: vec4<f32>, low: vec2<f32>, high: vec2<f32>) -> f32 {
    return affine(f, select(low, high, f.xy > vec2<f32>(0.0)));
}

// Whether a proxy can have a sample in sight in a part of its rectangle.
fn may_show_in(proxy: ptr<function, Proxy>, part: vec4<u32>) -> bool {
    let low = offset(proxy, part.xy);
    let high = offset(proxy, part.zw - 1u);
    var covered = true;
    for (var k = 0u; k < 6u; k++) {
        covered = covered && greatest((*proxy).edges[k], low, high) >= 0.0;
    }
    var nearest = (*proxy).nearest;
    for (var k = 0u; k < 3u; k++) {
        nearest = min(nearest, greatest((*proxy).planes[k], low, high));
    }
    return covered && !is_hidden(part, nearest);
}

// What is found out about a proxy, and where it is open.
struct Found {
    verdict: u32,
    rect: vec4<u32>,
}

fn look(i: u32) -> Found {
    let whole = proxies[i].rect;
    let nothing = vec4<u32>(0u);
    if is_empty(whole) || is_hidden(whole, proxies[i].nearest) {
        return Found(HIDDEN, nothing);
    }
    var proxy = proxies[i];
    let size = whole.zw - whole.xy;
    if size.x * size.y <= CLOSELY {
        for (var k = 0u; k < size.x * size.y; k++) {
            if is_seen_at(&proxy, whole.xy + vec2<u32>(k % size.x, k / size.x)) {
                return Found(SEEN, nothing);
            }
        }
        return Found(HIDDEN, nothing);
    }
    let cells = min(size, vec2<u32>(CELLS));
    var open = vec4<u32>(whole.zw, whole.xy);
    for (var k = 0u; k < cells.x * cells.y; k++) {
        let cell = vec2<u32>(k % cells.x, k / cells.x);
        let part = vec4<u32>(whole.xy + cell * size / cells, whole.xy + (cell + 1u) * size / cells);
        if may_show_in(&proxy, part) {
            if is_seen_at(&proxy, (part.xy + part.zw) / 2u) {
                return Found(SEEN, nothing);
            }
            open = vec4<u32>(min(open.xy, part.xy), max(open.zw, part.zw));
        }
    }
    if is_empty(open) {
        return Found(HIDDEN, nothing);
    }
    return Found(OPEN, open);
}

// Of proxies that are made anew for each test.
@compute @workgroup_size(64)
fn prune_proxies(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * groups.x + group.x) * 64u + lane;
    if i >= arrayLength(&verdicts) || verdicts[i] != HIDDEN {
        return;
    }
    let found = look(i);
    switch found.verdict {
        case SEEN: {
            verdicts[i] = SEEN;
        }
        case OPEN: {
            let next = atomicAdd(&open.draw[INSTANCES], 1u);
            open.things[next] = Listed(found.rect, i);
        }
        default: {}
    }
}

// Of the tree's objects, by place: who is hidden has no rectangle any more.
@compute @workgroup_size(64)
fn prune_placed(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + lane;
    if index >= arrayLength(&wanted) {
        return;
    }
    let i = wanted[index];
    if verdicts[i] != HIDDEN {
        return;
    }
    let found = look(i);
    switch found.verdict {
        case SEEN: {
            verdicts[i] = SEEN;
        }
        case OPEN: {
            proxies[i].part = vec2<u32>(
                found.rect.x | (found.rect.y << 16u),
                found.rect.z | (found.rect.w << 16u)
            );
        }
        default: {
            proxies[i].rect = vec4<u32>(0u);
        }
    }
}

@compute @workgroup_size(64)
fn prune_nodes(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * groups.x + group.x) * 64u + lane;
    if i < arrayLength(&nodes) && !is_empty(nodes[i].rect) && is_hidden(nodes[i].rect, nodes[i].nearest) {
        nodes[i].rect = vec4<u32>(0u);
    }
}
