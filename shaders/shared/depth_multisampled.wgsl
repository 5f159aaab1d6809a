// The depth of a target with several samples a pixel. A proxy's functions, taken at the pixel's
// centre, are bounds for every sample position in it.

@group(0) @binding(1) var depth: texture_multisampled_2d<f32>;

// How many samples of a pixel are in sight at a nearness. Equal depth is.
fn in_sight(pixel: vec2<u32>, nearness: f32) -> u32 {
    var seen = 0u;
    for (var k = 0u; k < frame.samples; k++) {
        let stored = frame.sign * textureLoad(depth, vec2<i32>(frame.origin + pixel), i32(k)).x;
        seen += u32(nearness >= stored);
    }
    return seen;
}

// The least and the greatest nearness of a pixel's samples.
fn nearness_range(pixel: vec2<u32>) -> vec2<f32> {
    let texel = vec2<i32>(frame.origin + pixel);
    var range = vec2<f32>(frame.sign * textureLoad(depth, texel, 0).x);
    for (var k = 1u; k < frame.samples; k++) {
        let stored = frame.sign * textureLoad(depth, texel, i32(k)).x;
        range = vec2<f32>(min(range.x, stored), max(range.y, stored));
    }
    return range;
}
