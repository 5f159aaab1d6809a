// Boxes and balls in the light of a low sun. Vertices are made here, from their numbers.

struct Frame {
    eye_clip_from_world: mat4x4<f32>,
    sun_clip_from_world: mat4x4<f32>,
    eye: vec4<f32>,
    toward_sun: vec4<f32>,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var shadows: texture_depth_2d;
@group(0) @binding(2) var shadow_sampler: sampler_comparison;

// An object: its box, its colour, and in alpha what it is made of.
struct Object {
    @location(0) low: vec3<f32>,
    @location(1) high: vec3<f32>,
    @location(2) color: vec4<f32>,
}

struct Vertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) color: vec4<f32>,
}

struct Corner { world: vec3<f32>, normal: vec3<f32> }

// Vertices 0 to 35 are a box; those after, a ball: a box with 8 × 8 squares a side, blown up.
fn corner(vertex: u32, object: Object) -> Corner {
    let is_ball = vertex >= 36u;
    let side = select(1u, 8u, is_ball);
    let number = select(vertex, vertex - 36u, is_ball);
    let face = number / (6u * side * side);
    let square = number / 6u % (side * side);
    // Two triangles a square: corners 0 1 2, 2 1 3, two bits each.
    let k = (3492u >> (2u * (number % 6u))) & 3u;
    let step = select(2.0, 0.25, is_ball);
    let u = f32(square % side + (k & 1u)) * step - 1.0;
    let v = f32(square / side + (k >> 1u)) * step - 1.0;
    let sign = select(-1.0, 1.0, face < 3u);
    var p = vec3(sign * u, v, sign);
    var out = vec3(0.0, 0.0, sign);
    if face % 3u == 1u {
        p = p.zxy;
        out = out.zxy;
    } else if face % 3u == 2u {
        p = p.yzx;
        out = out.yzx;
    }
    if is_ball {
        // A little smaller than its box, so that no rounding carries it out of there.
        let half = 0.5 * (object.high - object.low);
        let unit = normalize(p);
        return Corner(object.low + half + half * (0.999 * unit), normalize(unit / half));
    }
    return Corner(select(object.low, object.high, p > vec3(0.0)), out);
}

// What the sun sees: depth alone.
@vertex fn sun(@builtin(vertex_index) vertex: u32, object: Object) -> @builtin(position) vec4<f32> {
    return frame.sun_clip_from_world * vec4(corner(vertex, object).world, 1.0);
}

@vertex fn eye(@builtin(vertex_index) vertex: u32, object: Object) -> Vertex {
    let c = corner(vertex, object);
    let linear = vec4(pow(object.color.rgb, vec3(2.2)), object.color.a);
    return Vertex(frame.eye_clip_from_world * vec4(c.world, 1.0), c.world, c.normal, linear);
}

@fragment fn shade(in: Vertex) -> @location(0) vec4<f32> {
    let n = normalize(in.normal);
    let color = material(in.color, in.world, n);
    let sun = max(dot(n, frame.toward_sun.xyz), 0.0) * sunlit(in.world + 0.25 * n);
    let sky = mix(vec3(0.26, 0.22, 0.20), vec3(0.36, 0.46, 0.66), 0.5 + 0.5 * n.y);
    let lit = color * (sky + sun * vec3(2.1, 1.75, 1.3));
    let haze = 1.0 - exp(-pow(distance(in.world, frame.eye.xyz) / 520.0, 1.5));
    return vec4(mix(lit, vec3(0.62, 0.74, 0.88), haze), 1.0);
}

// The share of the sun's light that arrives: nine comparisons with the nearest thing it sees,
// each of them smoothed by the sampler. Depth is reversed: greater is nearer.
fn sunlit(world: vec3<f32>) -> f32 {
    let clip = frame.sun_clip_from_world * vec4(world, 1.0);
    let uv = clip.xy * vec2(0.5, -0.5) + 0.5;
    let texel = 1.0 / vec2<f32>(textureDimensions(shadows));
    var sum = 0.0;
    for (var i = 0; i < 9; i++) {
        let at = uv + vec2(f32(i % 3 - 1), f32(i / 3 - 1)) * texel;
        sum += textureSampleCompareLevel(shadows, shadow_sampler, at, clip.z + 0.0005);
    }
    // What the map does not reach is lit.
    return select(1.0, sum / 9.0, all(abs(clip.xy) < vec2(1.0)));
}

// Paint by the place: windows on walls, streets on the ground.
fn material(color: vec4<f32>, world: vec3<f32>, n: vec3<f32>) -> vec3<f32> {
    if color.a > 0.9 {
        let b = abs(fract(world.xz / 40.0 + 0.5) - 0.5) * 40.0; // metres from the middle of a street
        let near = min(b.x, b.y);
        let along = select(world.x, world.z, b.x < b.y);
        let dashes = near < 0.12 && max(b.x, b.y) > 8.0 && fract(along / 6.0) < 0.5;
        if dashes {
            return vec3(0.62, 0.60, 0.50);
        }
        let pavement = select(vec3(0.30, 0.28, 0.26), color.rgb, near > 8.5);
        return select(pavement, vec3(0.055, 0.055, 0.062), near < 6.0);
    }
    if color.a > 0.4 && abs(n.y) < 0.5 {
        let at = vec2(dot(world.xz, abs(n.zx)) / 2.2, world.y / 3.1);
        let glass = smoothstep(vec2(0.30), vec2(0.24), abs(fract(at) - 0.5));
        let is_lamp = fract(sin(dot(floor(at), vec2(12.9898, 78.233))) * 43758.5) > 0.93;
        let window = select(vec3(0.025, 0.04, 0.06), vec3(0.85, 0.60, 0.28), is_lamp);
        return mix(color.rgb, window, 0.85 * glass.x * glass.y * step(1.0, at.y));
    }
    return color.rgb;
}
