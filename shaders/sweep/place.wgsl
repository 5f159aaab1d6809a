// Where a box lies on the screen: the twin of src/geom/project.rs in f32. The proof of what is
// different is in src/query/gpu/sweep/project.rs.

struct View {
    clip_from_world: mat4x4<f32>,
    // Times (|x|, |y|, |z|, 1), it bounds the error of clip coordinates.
    error: mat4x4<f32>,
    // To a scale of its own: only directions are taken from it.
    world_from_clip: mat4x4<f32>,
    // By the faces that are turned to the viewer: up to three pairs of edges, three bits a corner,
    // and how many pairs there are.
    silhouettes: array<vec4<u32>, 27>,
    // The viewport's upper left corner in the target, and its size, in pixels.
    origin: vec2<f32>,
    size: vec2<f32>,
    // Nearness is depth times this.
    sign: f32,
    // How far from a pixel's centre its samples lie.
    within_pixel: f32,
    // A step of the depth format: its share of the depth, and what comes on top.
    step_share: f32,
    step: f32,
    // The nearness of what nothing was drawn on.
    cleared: f32,
    // Added to nearness.
    slack: f32,
    // The kinds of boxes that can be asked about: BOXED, or none. As a mask it is compared with what is known
    // of a box: a branch on it alone makes Mesa's lavapipe compile the shader anew for each view.
    askable: u32,
    unused: u32,
}

struct Box {
    low: vec3<f32>,
    // See below.
    kind: u32,
    high: vec3<f32>,
    // The leaf that holds it.
    node: u32,
}

// Kinds of boxes: there is one; it is not to be asked about, but seen.
const BOXED: u32 = 1u;
const ALWAYS: u32 = 2u;

@group(0) @binding(0) var<uniform> view: View;
@group(1) @binding(0) var<storage, read> boxes: array<Box>;

// Half of the distance from 1 to the next f32.
const UNIT: f32 = 5.9604645e-8;
// More than all that may be flushed to zero.
const TINY: f32 = 1e-18;
const FARTHEST: f32 = 3e38;
// See src/geom/proxy.rs and src/geom/project.rs.
const MAX_REACH: f32 = 32.0;
const SNAP: f32 = 0.0625;

// The corners in pixels of the viewport and nearness, and how far from their hull a sample of
// geometry in the box may lie.
struct Screen {
    x: array<f32, 8>,
    y: array<f32, 8>,
    nearness: array<f32, 8>,
    low: vec2<f32>,
    high: vec2<f32>,
    reach: vec2<f32>,
    depth_error: f32,
    nearest: f32,
    farthest: f32,
}

fn corner(box: Box, k: u32) -> vec3<f32> {
    return select(box.low, box.high, vec3<bool>((k & 1u) != 0u, (k & 2u) != 0u, (k & 4u) != 0u));
}

// What is allowed for: 1 for an object. For a box that holds others, so much more that wherever one
// of those is, it is.
struct Room {
    // Times all errors.
    times: f32,
    // How many pixels beside the view a box must lie to be outside.
    beside: f32,
}

// Whether all of a box that may reach behind the eye lies outside one side of the view.
fn is_beside(box: Box, error: vec4<f32>, room: Room) -> bool {
    let snapped = 2.0 * SNAP + 40.0 * UNIT * (view.origin + view.size);
    let k = 1.0 + 2.0 * (snapped + room.beside) / view.size;
    let slack = 1.01 * (error.xy + k * error.w);
    var least_low = vec2<bool>(true);
    var least_high = vec2<bool>(true);
    for (var i = 0u; i < 8u; i++) {
        let clip = view.clip_from_world * vec4<f32>(corner(box, i), 1.0);
        least_low = least_low & (clip.xy + k * clip.w < -slack);
        least_high = least_high & (k * clip.w - clip.xy < -slack);
    }
    return any(least_low | least_high);
}

// Projects the corners, if all of them are certain to lie before the near plane: HIDDEN if so.
fn place(box: Box, room: Room, screen: ptr<function, Screen>) -> u32 {
    let error = room.times * (view.error * vec4<f32>(max(abs(box.low), abs(box.high)), 1.0) + TINY);
    let is_reversed = view.sign > 0.0;
    let half = 0.5 * view.size;
    var near = vec2<f32>(FARTHEST, -FARTHEST);
    var far = -FARTHEST;
    var least_w = FARTHEST;
    for (var i = 0u; i < 8u; i++) {
        let clip = view.clip_from_world * vec4<f32>(corner(box, i), 1.0);
        let before_near = select(clip.z, clip.w - clip.z, is_reversed);
        let before_far = select(clip.w - clip.z, clip.z, is_reversed);
        near = vec2<f32>(min(near.x, before_near), max(near.y, before_near));
        far = max(far, before_far);
        least_w = min(least_w, clip.w);
    }
    let plane_error = error.w + error.z;
    if near.y < -plane_error || far < -plane_error {
        return OUTSIDE;
    }
    if !(least_w > 4.0 * error.w && near.x > plane_error) {
        return select(SEEN, OUTSIDE, is_beside(box, error, room));
    }
    var low = vec2<f32>(FARTHEST);
    var high = vec2<f32>(-FARTHEST);
    var nearest = -FARTHEST;
    var farthest = FARTHEST;
    for (var i = 0u; i < 8u; i++) {
        let clip = view.clip_from_world * vec4<f32>(corner(box, i), 1.0);
        let inverse = 1.0 / clip.w;
        let at = half + vec2<f32>(half.x, -half.y) * (clip.xy * inverse);
        let nearness = view.sign * (clip.z * inverse);
        (*screen).x[i] = at.x;
        (*screen).y[i] = at.y;
        (*screen).nearness[i] = nearness;
        low = min(low, at);
        high = max(high, at);
        nearest = max(nearest, nearness);
        farthest = min(farthest, nearness);
    }
    let far_out = max(abs(low), abs(high));
    if !(max(far_out.x, far_out.y) < 1e8) {
        return SEEN;
    }
    let snapped = room.times * (2.0 * SNAP + 40.0 * UNIT * (far_out + view.origin + view.size));
    let least_true_w = least_w - error.w;
    // Corners beside the viewport are less certain than what is drawn in it.
    let beside = max(half + snapped, max(abs(low - half), abs(high - half)));
    let moved = (half * error.xy + beside * error.w) / least_true_w;
    let reach = snapped + moved + view.within_pixel;
    if !(max(reach.x, reach.y) < MAX_REACH) {
        return SEEN;
    }
    let magnitude = max(abs(nearest), abs(farthest));
    let drawn = 1.3334 * (error.z + magnitude * error.w) / least_true_w + room.times * 32.0 * UNIT * magnitude;
    (*screen).low = low;
    (*screen).high = high;
    (*screen).reach = reach;
    (*screen).depth_error = drawn + (view.step_share * magnitude + view.step);
    (*screen).nearest = nearest;
    (*screen).farthest = farthest;
    return HIDDEN;
}

// What is known of a box before any test; its corners are projected if it is HIDDEN.
fn known(box: Box, room: Room, screen: ptr<function, Screen>) -> u32 {
    if (box.kind & view.askable) != 0u {
        return place(box, room, screen);
    }
    return select(OUTSIDE, SEEN, (box.kind & (BOXED | ALWAYS)) != 0u);
}

// The pixels whose centres lie within reach, clipped to the viewport: x0, y0, x1, y1, half open.
fn pixels(screen: ptr<function, Screen>) -> vec4<f32> {
    let low = clamp(ceil((*screen).low - (*screen).reach - 0.5), vec2<f32>(0.0), view.size);
    let end = clamp(floor((*screen).high + (*screen).reach - 0.5) + 1.0, vec2<f32>(0.0), view.size);
    return vec4<f32>(low, end);
}
