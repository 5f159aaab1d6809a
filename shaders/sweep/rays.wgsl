// The rays of groups (Lee et al. 2021, HROC), by drawing the rectangle of each: the twin of
// src/query/software/sweep/cast_rays.rs.
//
// A ray is a pixel with the depth that is stored there. It goes down the group's subtree without a
// stack, and flags every object whose proxy covers the pixel and is not behind that depth: it does
// not stop at the nearest one.

@group(1) @binding(2) var<storage, read_write> verdicts: array<atomic<u32>>;
@group(1) @binding(3) var<storage, read> nodes: array<Node>;

fn holds(rect: vec4<u32>, pixel: vec2<u32>) -> bool {
    return all(pixel >= rect.xy) && all(pixel < rect.zw);
}

// Whether a ray meets an object, which is looked at closely only if its rectangle is met.
fn meets(place: u32, pixel: vec2<u32>, stored: f32) -> bool {
    if !holds(proxies[place].rect, pixel) || proxies[place].nearest < stored {
        return false;
    }
    var proxy = proxies[place];
    let d = offset(&proxy, pixel);
    return covers(&proxy, d) && entry(&proxy, d) >= stored;
}

@fragment
fn cast_ray(corner: Corner) {
    let pixel = vec2<u32>(corner.position.xy);
    // Of several samples the farthest: in sight of some of them is what is in sight of that one.
    let stored = nearness_range(pixel).x;
    let end = nodes[corner.index].skip;
    var at = corner.index;
    // No node is visited twice.
    for (var steps = 0u; at != end && steps < arrayLength(&nodes); steps++) {
        let node = nodes[at];
        if !holds(node.rect, pixel) || node.nearest < stored {
            at = node.skip;
            continue;
        }
        for (var place = node.first; place < node.end; place++) {
            // Who has been seen need not be looked at again.
            if atomicLoad(&verdicts[place]) == HIDDEN && meets(place, pixel, stored) {
                atomicStore(&verdicts[place], SEEN);
            }
        }
        at = node.enter;
    }
}
