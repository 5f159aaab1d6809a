// Brings verdicts from the order of places into that of meshes, an invocation an object.

@group(1) @binding(0) var<storage, read> found: array<u32>;
// The place of each object in the order of meshes.
@group(1) @binding(1) var<storage, read> places: array<u32>;
@group(1) @binding(2) var<storage, read_write> verdicts: array<u32>;

@compute @workgroup_size(64)
fn spread(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * groups.x + group.x) * 64u + lane;
    if i < arrayLength(&verdicts) {
        verdicts[i] = found[places[i]];
    }
}
