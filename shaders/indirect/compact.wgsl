// Puts the objects of a list together, mesh by mesh, and counts them for the draws.

// The twins of the structs in src/query/gpu/indirect/compact.rs.
struct Mesh {
    // Its objects in the order of all.
    first: u32,
    end: u32,
    index_count: u32,
    first_index: u32,
    base_vertex: i32,
    unused: u32,
}

struct Arguments {
    index_count: u32,
    instance_count: u32,
    first_index: u32,
    base_vertex: i32,
    first_instance: u32,
}

@group(1) @binding(0) var<storage, read> order: array<u32>;
// The mesh of each object in that order.
@group(1) @binding(1) var<storage, read> mesh_of: array<u32>;
@group(1) @binding(2) var<storage, read> meshes: array<Mesh>;
@group(1) @binding(3) var<storage, read> before: array<u32>;
// Slots. Each mesh has room for all of its objects, from its first one's place on.
@group(1) @binding(4) var<storage, read_write> instances: array<u32>;
@group(1) @binding(5) var<storage, read_write> arguments: array<Arguments>;

@compute @workgroup_size(64)
fn gather(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * groups.x + group.x) * 64u + lane;
    if i >= arrayLength(&order) || before[i] == before[i + 1u] {
        return;
    }
    let first = meshes[mesh_of[i]].first;
    instances[first + before[i] - before[first]] = order[i];
}

@compute @workgroup_size(64)
fn argue(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * groups.x + group.x) * 64u + lane;
    if i >= arrayLength(&meshes) {
        return;
    }
    let mesh = meshes[i];
    let count = before[mesh.end] - before[mesh.first];
    arguments[i] = Arguments(mesh.index_count, count, mesh.first_index, mesh.base_vertex, 0u);
}
