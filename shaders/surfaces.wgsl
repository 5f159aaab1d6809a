// Meshes, an instance an object.

struct Vertex {
    @location(0) position: vec3<f32>,
    @location(1) normal: vec4<f32>,
}

struct Instance {
    // The rows of world_from_object.
    @location(2) row_x: vec4<f32>,
    @location(3) row_y: vec4<f32>,
    @location(4) row_z: vec4<f32>,
    // Linear.
    @location(5) color: vec4<f32>,
}

struct Surface {
    @builtin(position) @invariant position: vec4<f32>,
    @location(0) world: vec3<f32>,
    // Not of unit length.
    @location(1) normal: vec3<f32>,
    @location(2) @interpolate(flat, either) color: vec3<f32>,
}

struct Place {
    @builtin(position) @invariant position: vec4<f32>,
}

// Two products in f32, as src/geom/proxy.rs allows an app: the model's, whose error is in the
// object's bounds, and that of the whole view, whose matrix was multiplied in f64. It depends on
// the vertex and the object alone, never on who else is drawn.
fn world_position(vertex: Vertex, instance: Instance) -> vec3<f32> {
    let p = vec4<f32>(vertex.position, 1.0);
    return vec3<f32>(dot(instance.row_x, p), dot(instance.row_y, p), dot(instance.row_z, p));
}

fn clip_position(world: vec3<f32>) -> vec4<f32> {
    return camera.clip_from_world * vec4<f32>(world, 1.0);
}

// The normal as the world sees it: the cofactors of the transform, so that it stands on the
// triangle's same side whether the transform mirrors or not. Only its direction means something.
fn world_normal(vertex: Vertex, instance: Instance) -> vec3<f32> {
    let n = vertex.normal.xyz;
    let largest = max(abs(instance.row_x.xyz), max(abs(instance.row_y.xyz), abs(instance.row_z.xyz)));
    let scale = 1.0 / max(max(largest.x, max(largest.y, largest.z)), 1e-30);
    let x = instance.row_x.xyz * scale;
    let y = instance.row_y.xyz * scale;
    let z = instance.row_z.xyz * scale;
    return vec3<f32>(dot(cross(y, z), n), dot(cross(z, x), n), dot(cross(x, y), n));
}

fn surface_of(vertex: Vertex, instance: Instance) -> Surface {
    let world = world_position(vertex, instance);
    let normal = world_normal(vertex, instance);
    return Surface(clip_position(world), world, normal, instance.color.xyz);
}

@vertex
fn surface(vertex: Vertex, instance: Instance) -> Surface {
    return surface_of(vertex, instance);
}

// Without what only colours need.
@vertex
fn place(vertex: Vertex, instance: Instance) -> Place {
    return Place(clip_position(world_position(vertex, instance)));
}

fn unit(v: vec3<f32>, otherwise: vec3<f32>) -> vec3<f32> {
    let square = dot(v, v);
    // A NaN fails the comparison.
    if square > 1e-30 {
        return v * inverseSqrt(square);
    }
    return otherwise;
}

// Linear light: a warm sun, the sky above, the ground below, and a little from the eye, which
// keeps the shapes of what stands in the shade readable.
const TOWARD_SUN: vec3<f32> = vec3<f32>(-0.539, 0.735, 0.412);
const SUN: vec3<f32> = vec3<f32>(0.78, 0.70, 0.58);
const SKY: vec3<f32> = vec3<f32>(0.30, 0.36, 0.44);
const GROUND: vec3<f32> = vec3<f32>(0.17, 0.15, 0.13);
const HEAD: f32 = 0.10;

fn lit_color(surface: Surface, front: bool) -> vec3<f32> {
    let toward_eye = unit(camera.eye.xyz - surface.world * camera.eye.w, vec3<f32>(0.0, 1.0, 0.0));
    var normal = unit(surface.normal, toward_eye);
    // Both sides are drawn. The triangle knows which one is seen; a smooth normal near an outline
    // may not.
    if front == (camera.facing < 0.0) {
        normal = -normal;
    }
    let ambient = mix(GROUND, SKY, 0.5 * normal.y + 0.5);
    let sun = SUN * max(dot(normal, TOWARD_SUN), 0.0);
    let head = HEAD * max(dot(normal, toward_eye), 0.0);
    return surface.color * (ambient + sun + head);
}

// An opaque colour, from linear light.
fn opaque(linear: vec3<f32>) -> vec4<f32> {
    return vec4<f32>(shown(linear), 1.0);
}

@fragment
fn lit(surface: Surface, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    return opaque(lit_color(surface, front));
}

@group(1) @binding(0) var noise: texture_2d<f32>;
@group(1) @binding(1) var noise_sampler: sampler;

// How often the texture is looked into.
override look_ups: u32 = 1u;

// The same, mottled. Each look-up says where the next one is.
fn mottled_color(surface: Surface, front: bool) -> vec3<f32> {
    // Not a whole number of times in a unit, lest what stands in rows looks all the same.
    var at = vec2<f32>(0.31, 0.37) * surface.world.xy + 0.23 * surface.world.zz;
    var sum = 0.0;
    for (var i = 0u; i < look_ups; i++) {
        let texel = textureSampleLevel(noise, noise_sampler, at, 0.0);
        at += 0.25 * (texel.xy - 0.5);
        sum += texel.z;
    }
    let mottled = 0.8 + 0.4 * sum / f32(look_ups);
    return lit_color(surface, front) * mottled;
}

@fragment
fn lit_by_look_ups(surface: Surface, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    return opaque(mottled_color(surface, front));
}

// The object's own colour.
@fragment
fn unlit(surface: Surface) -> @location(0) vec4<f32> {
    return opaque(surface.color);
}

// Nothing, into a target that must be there.
@fragment
fn nothing() -> @location(0) vec4<f32> {
    return vec4<f32>(0.0);
}

// One layer of many that are added up: black, red, orange, yellow, white.
@fragment
fn layer() -> @location(0) vec4<f32> {
    return vec4<f32>(24.0 / 255.0, 10.0 / 255.0, 4.0 / 255.0, 0.0);
}
