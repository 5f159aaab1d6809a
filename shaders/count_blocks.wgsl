// Counts with one workgroup for each tile of a proxy's rectangle, and an invocation for each block
// of it. A block that is wholly outside, hidden or in sight is decided at once.
//
// That changes no answer beyond the bound in src/query/gpu/pack.rs: an affine function is greatest
// at the corner that the signs of its slopes name, and there too the raised constant keeps this
// value above, and within the bound of, what the software backend finds at any sample of the block.

@group(1) @binding(3) var<storage, read> blocks: array<vec2<f32>>;

fn greatest(f: vec4<f32>, first: vec2<f32>, last: vec2<f32>) -> f32 {
    return affine(f, select(first, last, f.xy >= vec2<f32>(0.0)));
}

fn least(f: vec4<f32>, first: vec2<f32>, last: vec2<f32>) -> f32 {
    return affine(f, select(last, first, f.xy >= vec2<f32>(0.0)));
}

// Visible and covered samples of a rectangle of pixels that lies in one block.
fn count_block(proxy: ptr<function, Proxy>, first: vec2<u32>, end: vec2<u32>) -> vec2<u32> {
    let low = offset(proxy, first);
    let high = offset(proxy, end - 1u);
    var outside = false;
    var inside = true;
    for (var k = 0u; k < 6u; k++) {
        outside = outside || greatest((*proxy).edges[k], low, high) < 0.0;
        inside = inside && least((*proxy).edges[k], low, high) >= 0.0;
    }
    if outside {
        return vec2<u32>(0u);
    }
    var entry_most = (*proxy).nearest;
    var entry_least = (*proxy).nearest;
    for (var k = 0u; k < 3u; k++) {
        entry_most = min(entry_most, greatest((*proxy).planes[k], low, high));
        entry_least = min(entry_least, least((*proxy).planes[k], low, high));
    }
    let at = first / BLOCK;
    let range = blocks[at.y * ((frame.size.x + BLOCK - 1u) / BLOCK) + at.x];
    let hidden = entry_most < range.x;
    let samples = (end.x - first.x) * (end.y - first.y) * frame.samples;
    if hidden && (inside || (*proxy).any != 0u) {
        return vec2<u32>(0u, samples);
    }
    if inside && entry_least >= range.y {
        return vec2<u32>(samples);
    }
    var found = vec2<u32>(0u);
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            let pixel = vec2<u32>(x, y);
            let d = offset(proxy, pixel);
            if covers(proxy, d) {
                found += vec2<u32>(in_sight(pixel, entry(proxy, d)), frame.samples);
            }
        }
    }
    return found;
}

@compute @workgroup_size(8, 8)
fn count(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_id) lane: vec3<u32>,
) {
    let index = group.y * groups.x + group.x;
    // The last row of workgroups may reach beyond the tiles, of which the binding has exactly all.
    if index >= arrayLength(&tiles) {
        return;
    }
    let tile = tiles[index];
    var proxy = proxies[tile.proxy];
    let corner = tile_corner(tile) + lane.xy * BLOCK;
    let first = max(corner, proxy.rect.xy);
    let end = min(corner + BLOCK, proxy.rect.zw);
    if all(first < end) {
        let found = count_block(&proxy, first, end);
        atomicAdd(&visible, found.x);
        atomicAdd(&total, found.y);
    }
    workgroupBarrier();
    if all(lane.xy == vec2<u32>(0u)) {
        atomicAdd(&counts[tile.proxy].visible, atomicLoad(&visible));
        atomicAdd(&counts[tile.proxy].total, atomicLoad(&total));
    }
}
