// Builds the pyramid, level by level: each texel is the farthest of the four below it.

@group(1) @binding(3) var<storage, read_write> pyramid: array<f32>;

// The first level, from the depth itself: all samples of all four pixels.
@compute @workgroup_size(8, 8)
fn first(@builtin(global_invocation_id) at: vec3<u32>) {
    let size = level_size(0u);
    if any(at.xy >= size) {
        return;
    }
    // Beyond an odd border the last pixel counts twice.
    let pixel = 2u * at.xy;
    let last = min(pixel + 1u, frame.size - 1u);
    var farthest = nearness_range(pixel).x;
    farthest = min(farthest, nearness_range(vec2<u32>(last.x, pixel.y)).x);
    farthest = min(farthest, nearness_range(vec2<u32>(pixel.x, last.y)).x);
    farthest = min(farthest, nearness_range(last).x);
    pyramid[at.y * size.x + at.x] = farthest;
}

// Any other one. The grid's depth says which: a dispatch has nothing else of its own.
@compute @workgroup_size(8, 8)
fn next(
    @builtin(global_invocation_id) at: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
) {
    let level = groups.z;
    let size = level_size(level);
    if at.z != 0u || any(at.xy >= size) {
        return;
    }
    let below = level_size(level - 1u);
    let start = level_start(level - 1u);
    let texel = 2u * at.xy;
    let last = min(texel + 1u, below - 1u);
    var farthest = pyramid[start + texel.y * below.x + texel.x];
    farthest = min(farthest, pyramid[start + texel.y * below.x + last.x]);
    farthest = min(farthest, pyramid[start + last.y * below.x + texel.x]);
    farthest = min(farthest, pyramid[start + last.y * below.x + last.x]);
    pyramid[start + below.x * below.y + at.y * size.x + at.x] = farthest;
}
