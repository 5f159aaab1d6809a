// What the pyramid says of a rectangle.

// The farthest of the four texels that hold the whole rectangle, which is not empty: no sample in it is farther.
fn farthest_in(rect: vec4<u32>) -> f32 {
    let first = rect.xy;
    let last = rect.zw - 1u;
    // The finest level on which the rectangle spans two texels at most along each side.
    var level = 0u;
    while any((last >> vec2<u32>(level + 1u)) - (first >> vec2<u32>(level + 1u)) > vec2<u32>(1u)) {
        level++;
    }
    let size = level_size(level);
    let start = level_start(level);
    let low = first >> vec2<u32>(level + 1u);
    let high = last >> vec2<u32>(level + 1u);
    var farthest = pyramid[start + low.y * size.x + low.x];
    farthest = min(farthest, pyramid[start + low.y * size.x + high.x]);
    farthest = min(farthest, pyramid[start + high.y * size.x + low.x]);
    return min(farthest, pyramid[start + high.y * size.x + high.x]);
}
