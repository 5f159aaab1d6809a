// The rectangle of each proxy, an instance each, drawn as a strip of two triangles.

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
    let x = select(rect.x, rect.z, (corner & 1u) != 0u);
    let y = select(rect.y, rect.w, (corner & 2u) != 0u);
    // Pixel corners: a rounding moves them by far less than the half pixel to the next centre.
    let at = vec2<f32>(vec2<u32>(x, y)) / vec2<f32>(frame.size);
    return Corner(vec4<f32>(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.5, 1.0), proxy);
}
