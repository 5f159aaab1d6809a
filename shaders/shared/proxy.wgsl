// A proxy: the twin of the struct in src/query/gpu/pack.rs, and the normative functions of
// src/geom/proxy.rs. Fused or reordered arithmetic is allowed for: see `pack.rs`.

struct Proxy {
    // x0, y0, x1, y1 in pixels of the viewport, half open.
    rect: vec4<u32>,
    // a, b, c of each function a·dx + b·dy + c; the fourth is unused.
    edges: array<vec4<f32>, 6>,
    planes: array<vec4<f32>, 3>,
    nearest: f32,
    // 1 if it is enough to know whether one sample is in sight.
    any: u32,
    // The part of the rectangle outside of which no sample is in sight: x0, y0 and x1, y1, 16 bits each; all
    // of it, if there are no pixels in it.
    part: vec2<u32>,
}

fn affine(f: vec4<f32>, d: vec2<f32>) -> f32 {
    return (f.x * d.x + f.y * d.y) + f.z;
}

// A proxy is copied once an invocation, and the loops have fixed bounds: compilers then keep it in
// registers, which on lavapipe makes counting five times as fast.

// The offset of a pixel's centre from the proxy's origin. Exact.
fn offset(proxy: ptr<function, Proxy>, pixel: vec2<u32>) -> vec2<f32> {
    return vec2<f32>(pixel - (*proxy).rect.xy) + 0.5;
}

fn covers(proxy: ptr<function, Proxy>, d: vec2<f32>) -> bool {
    var inside = true;
    for (var k = 0u; k < 6u; k++) {
        inside = inside && affine((*proxy).edges[k], d) >= 0.0;
    }
    return inside;
}

fn entry(proxy: ptr<function, Proxy>, d: vec2<f32>) -> f32 {
    var nearness = (*proxy).nearest;
    for (var k = 0u; k < 3u; k++) {
        nearness = min(nearness, affine((*proxy).planes[k], d));
    }
    return nearness;
}
