// What all of the renderer's shaders know of a view: the twin of `PackedCamera` in
// src/draw/renderer/camera.rs.

struct Camera {
    clip_from_world: mat4x4<f32>,
    // The eye: a point (w = 1), or a direction toward the viewer (w = 0).
    eye: vec4<f32>,
    // The viewport's size in pixels.
    size: vec2<f32>,
    // 1; or -1 for a view that shows things mirrored.
    facing: f32,
    // Whether the target stores what is written as it is, so that colours must be encoded here.
    encodes: u32,
}

@group(0) @binding(0) var<uniform> camera: Camera;

fn srgb_from_linear(c: vec3<f32>) -> vec3<f32> {
    let dark = c * 12.92;
    let bright = 1.055 * pow(c, vec3<f32>(1.0 / 2.4)) - 0.055;
    return select(bright, dark, c <= vec3<f32>(0.0031308));
}

fn linear_from_srgb(c: vec3<f32>) -> vec3<f32> {
    let dark = c / 12.92;
    let bright = pow((c + 0.055) / 1.055, vec3<f32>(2.4));
    return select(bright, dark, c <= vec3<f32>(0.04045));
}

// A linear colour as the target takes it.
fn shown(linear: vec3<f32>) -> vec3<f32> {
    if camera.encodes != 0u {
        return srgb_from_linear(linear);
    }
    return linear;
}
