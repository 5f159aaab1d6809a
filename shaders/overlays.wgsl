// What lies over a frame: the edges of boxes, and polygons on the screen.

struct Overlay {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat, either) color: vec4<f32>,
}

// An instance a box, two vertices an edge.
@vertex
fn box_edge(
    @builtin(vertex_index) i: u32,
    @location(0) low: vec3<f32>,
    @location(1) high: vec3<f32>,
    @location(2) color: vec4<f32>,
) -> Overlay {
    // Four edges an axis: each runs from the low end of the axis to the high one, at one of four
    // combinations of the other two.
    let axis = i / 8u;
    let ends = vec3<bool>((i & 1u) != 0u, (i & 2u) != 0u, (i & 4u) != 0u);
    var far = ends;
    if axis == 1u {
        far = ends.zxy;
    }
    if axis == 2u {
        far = ends.yzx;
    }
    return Overlay(camera.clip_from_world * vec4<f32>(select(low, high, far), 1.0), color);
}

// A corner, in pixels of the viewport.
@vertex
fn corner(@location(0) pixel: vec2<f32>, @location(1) color: vec4<f32>) -> Overlay {
    let at = 2.0 * pixel / camera.size - 1.0;
    return Overlay(vec4<f32>(at.x, -at.y, 0.5, 1.0), color);
}

@fragment
fn plain(overlay: Overlay) -> @location(0) vec4<f32> {
    if camera.encodes != 0u {
        return overlay.color;
    }
    return vec4<f32>(linear_from_srgb(overlay.color.xyz), overlay.color.w);
}
