// What sweeps and questions are put to: the twin of the struct in src/query/gpu/pack.rs.

struct Frame {
    // The viewport's upper left corner in the target, and its size, in pixels.
    origin: vec2<u32>,
    size: vec2<u32>,
    // Nearness is depth times this: 1 under reversed z, -1 under standard z.
    sign: f32,
    // Samples a pixel.
    samples: u32,
    unused: vec2<u32>,
}

@group(0) @binding(0) var<uniform> frame: Frame;
