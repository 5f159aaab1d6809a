// Lists the groups of a sweep for the draw of their rectangles, an invocation each.

@group(1) @binding(0) var<storage, read> nodes: array<Node>;
@group(1) @binding(1) var<storage, read> groups: array<u32>;
@group(1) @binding(2) var<storage, read_write> listed: array<Listed>;

@compute @workgroup_size(64)
fn enlist(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * workgroups.x + group.x) * 64u + lane;
    if i < arrayLength(&groups) {
        listed[i] = Listed(nodes[groups[i]].rect, groups[i]);
    }
}
