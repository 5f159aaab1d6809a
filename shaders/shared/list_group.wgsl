// How a group is looked at: by rays, or object by object.

// A ray looks at boxes until it has come down to an object: it takes as long as so many pixels of a proxy.
const RAY: f32 = 4.0;
// Of larger groups nobody looks at each object.
const MOST: u32 = 512u;

// Where something is still to be found out about an object.
fn open_part(place: u32) -> vec4<u32> {
    if verdicts[place] != HIDDEN {
        return vec4<u32>(0u);
    }
    let part = proxies[place].part;
    if part.y == 0u {
        return proxies[place].rect;
    }
    return vec4<u32>(part.x & 0xffffu, part.x >> 16u, part.y & 0xffffu, part.y >> 16u);
}

// Lists an object, if something is.
fn list_object(place: u32) {
    let part = open_part(place);
    if !is_empty(part) {
        let next = atomicAdd(&loose.draw[INSTANCES], 1u);
        loose.things[next] = Listed(part, place);
    }
}

fn list_rays(rect: vec4<u32>, at: u32) {
    let next = atomicAdd(&listed.draw[INSTANCES], 1u);
    listed.things[next] = Listed(rect, at);
}

// Lists what is to be looked at of a node and all below it. Rays go where objects lie of which nothing is known
// yet, unless these have few pixels even if each is looked at by itself; the same are found.
fn list_group(at: u32) {
    let node = nodes[at];
    if is_empty(node.rect) {
        return;
    }
    // The places of all of them follow each other, up to those of the node that comes after.
    var end = arrayLength(&proxies);
    if node.skip != NONE {
        end = nodes[node.skip].first;
    }
    if end - node.first > MOST {
        list_rays(node.rect, at);
        return;
    }
    var part = vec4<u32>(node.rect.zw, node.rect.xy);
    var pixels = 0.0;
    for (var place = node.first; place < end; place++) {
        let rect = open_part(place);
        if !is_empty(rect) {
            part = vec4<u32>(min(part.xy, rect.xy), max(part.zw, rect.zw));
            pixels += f32((rect.z - rect.x) * (rect.w - rect.y));
        }
    }
    part = vec4<u32>(max(part.xy, node.rect.xy), min(part.zw, node.rect.zw));
    if is_empty(part) {
        return;
    }
    let size = part.zw - part.xy;
    if pixels > RAY * f32(size.x * size.y) {
        list_rays(part, at);
        return;
    }
    for (var place = node.first; place < end; place++) {
        list_object(place);
    }
}
