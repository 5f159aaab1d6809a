// Who owns the samples of a target with one sample a pixel.

@group(0) @binding(1) var ids: texture_2d<u32>;

fn id_of(pixel: vec2<u32>, sample: u32) -> vec2<u32> {
    return textureLoad(ids, vec2<i32>(frame.origin + pixel), 0).xy;
}
