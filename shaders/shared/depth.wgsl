// The depth of a target with one sample a pixel.

@group(0) @binding(1) var depth: texture_2d<f32>;

// How many samples of a pixel are in sight at a nearness. Equal depth is.
fn in_sight(pixel: vec2<u32>, nearness: f32) -> u32 {
    let stored = frame.sign * textureLoad(depth, vec2<i32>(frame.origin + pixel), 0).x;
    return u32(nearness >= stored);
}

// The least and the greatest nearness of a pixel's samples.
fn nearness_range(pixel: vec2<u32>) -> vec2<f32> {
    return vec2<f32>(frame.sign * textureLoad(depth, vec2<i32>(frame.origin + pixel), 0).x);
}
