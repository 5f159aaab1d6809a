// A corner of a rectangle, which is drawn as a strip of two triangles.

struct Corner {
    @builtin(position) @invariant position: vec4<f32>,
    // Whose rectangle it is.
    @location(0) @interpolate(flat, either) index: u32,
}

fn corner_of(rect: vec4<u32>, corner: u32, index: u32) -> Corner {
    let x = select(rect.x, rect.z, (corner & 1u) != 0u);
    let y = select(rect.y, rect.w, (corner & 2u) != 0u);
    // Pixel corners: a rounding moves them by far less than the half pixel to the next centre.
    let at = vec2<f32>(vec2<u32>(x, y)) / vec2<f32>(frame.size);
    return Corner(vec4<f32>(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.5, 1.0), index);
}
