// Draws the rectangle of each proxy inside an occlusion query, at the proxy's own depth. The depth
// test of the pass decides, so a sample passes exactly if the counting shaders find it in sight.
//
// The entry depth is not planar, and the corners of an outline do not lie on the grid that vertices
// are snapped to. So each fragment writes its depth: all of its samples have the same, as in
// `in_sight`.

struct Corner {
    @builtin(position) @invariant position: vec4<f32>,
    @location(0) @interpolate(flat, either) proxy: u32,
}

@vertex
fn rectangle(
    @builtin(vertex_index) corner: u32,
    @builtin(instance_index) proxy: u32,
    @location(0) rect: vec4<u32>,
) -> Corner {
    // A quarter pixel more on each side: samples may lie on the very border of a pixel.
    let x = select(f32(rect.x) - 0.25, f32(rect.z) + 0.25, (corner & 1u) != 0u);
    let y = select(f32(rect.y) - 0.25, f32(rect.w) + 0.25, (corner & 2u) != 0u);
    let at = vec2<f32>(x, y) / vec2<f32>(frame.size);
    return Corner(vec4<f32>(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.5, 1.0), proxy);
}

@fragment
fn sight(corner: Corner) -> @builtin(frag_depth) f32 {
    let pixel = vec2<i32>(corner.position.xy) - vec2<i32>(frame.origin);
    var proxy = proxies[corner.proxy];
    let rect = vec4<i32>(proxy.rect);
    if any(pixel < rect.xy) || any(pixel >= rect.zw) {
        discard;
    }
    let d = offset(&proxy, vec2<u32>(pixel));
    let nearness = entry(&proxy, d);
    // What lies beyond the cleared depth hides behind anything, and must not be clamped to it.
    if !covers(&proxy, d) || nearness < min(frame.sign, 0.0) {
        discard;
    }
    return clamp(frame.sign * nearness, 0.0, 1.0);
}
