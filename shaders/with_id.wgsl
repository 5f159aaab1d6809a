// The same surfaces with an item buffer: every fragment says whose it is, beside its colour. So one
// depth test decides on both.

// From the vertex stage to the fragment stage, beside the surface.
struct Owner {
    @location(3) @interpolate(flat, either) id: u32,
}

// `Surface` and `Owner`: what stages hand on cannot be nested.
struct OwnedSurface {
    @builtin(position) @invariant position: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) @interpolate(flat, either) color: vec3<f32>,
    @location(3) @interpolate(flat, either) id: u32,
}

// `Place` and `Owner`.
struct OwnedPlace {
    @builtin(position) @invariant position: vec4<f32>,
    @location(3) @interpolate(flat, either) id: u32,
}

@vertex
fn surface_with_id(vertex: Vertex, instance: Instance, @location(6) id: u32) -> OwnedSurface {
    let it = surface_of(vertex, instance);
    return OwnedSurface(it.position, it.world, it.normal, it.color, id);
}

@vertex
fn place_with_id(vertex: Vertex, instance: Instance, @location(6) id: u32) -> OwnedPlace {
    return OwnedPlace(clip_position(world_position(vertex, instance)), id);
}

struct Owned {
    @location(0) color: vec4<f32>,
    @location(1) id: vec2<u32>,
}

// 16 bits a channel, the lower ones first.
fn halves(owner: Owner) -> vec2<u32> {
    return vec2<u32>(owner.id & 0xffffu, owner.id >> 16u);
}

fn owned(linear: vec3<f32>, owner: Owner) -> Owned {
    return Owned(opaque(linear), halves(owner));
}

@fragment
fn lit_with_id(surface: Surface, owner: Owner, @builtin(front_facing) front: bool) -> Owned {
    return owned(lit_color(surface, front), owner);
}

@fragment
fn lit_by_look_ups_with_id(surface: Surface, owner: Owner, @builtin(front_facing) front: bool) -> Owned {
    return owned(mottled_color(surface, front), owner);
}

@fragment
fn unlit_with_id(surface: Surface, owner: Owner) -> Owned {
    return owned(surface.color, owner);
}

@fragment
fn id_alone(owner: Owner) -> @location(1) vec2<u32> {
    return halves(owner);
}
