// The same surfaces of a frame that the device culls by itself: an instance is the slot of an object,
// and what else it needs lies where the slot says. The twin of `Object` in src/draw/renderer/by_slot.rs.

struct Object {
    // The rows of world_from_object.
    row_x: vec4<f32>,
    row_y: vec4<f32>,
    row_z: vec4<f32>,
    // Linear.
    color: vec4<f32>,
}

@group(0) @binding(1) var<storage, read> objects: array<Object>;

fn instance_in(slot: u32) -> Instance {
    let object = objects[slot];
    return Instance(object.row_x, object.row_y, object.row_z, object.color);
}

@vertex
fn surface_by_slot(vertex: Vertex, @location(2) slot: u32) -> Surface {
    return surface_of(vertex, instance_in(slot));
}

@vertex
fn place_by_slot(vertex: Vertex, @location(2) slot: u32) -> Place {
    return Place(clip_position(world_position(vertex, instance_in(slot))));
}
