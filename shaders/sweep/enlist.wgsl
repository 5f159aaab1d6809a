// Lists what is to be looked at of the groups of a sweep, an invocation each.

@group(1) @binding(0) var<storage, read> nodes: array<Node>;
@group(1) @binding(1) var<storage, read> groups: array<u32>;
@group(1) @binding(2) var<storage, read> proxies: array<Proxy>;
@group(1) @binding(3) var<storage, read> verdicts: array<u32>;
@group(1) @binding(4) var<storage, read_write> listed: List;
@group(1) @binding(5) var<storage, read_write> loose: List;

@compute @workgroup_size(64)
fn enlist(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * workgroups.x + group.x) * 64u + lane;
    if i < arrayLength(&groups) {
        list_group(groups[i]);
    }
}
