// Gathers the least and the greatest nearness of each block of 8 × 8 pixels, an invocation each.

// The twin of the constant in src/query/gpu/pack.rs.
const BLOCK: u32 = 8u;

@group(1) @binding(3) var<storage, read_write> blocks: array<vec2<f32>>;

@compute @workgroup_size(8, 8)
fn gather(@builtin(global_invocation_id) at: vec3<u32>) {
    let grid = (frame.size + BLOCK - 1u) / BLOCK;
    if any(at.xy >= grid) {
        return;
    }
    let first = at.xy * BLOCK;
    let end = min(first + BLOCK, frame.size);
    var range = nearness_range(first);
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            let pixel = nearness_range(vec2<u32>(x, y));
            range = vec2<f32>(min(range.x, pixel.x), max(range.y, pixel.y));
        }
    }
    blocks[at.y * grid.x + at.x] = range;
}
