// Which proxies may have a sample in sight, by the pyramid (Rákos 2010), an invocation each: the
// nearest point against the farthest sample of the whole rectangle.

@group(1) @binding(2) var<storage, read_write> verdicts: array<u32>;
@group(1) @binding(3) var<storage, read> pyramid: array<f32>;

@compute @workgroup_size(64)
fn look(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * groups.x + group.x) * 64u + lane;
    if i >= arrayLength(&verdicts) || verdicts[i] != HIDDEN {
        return;
    }
    let farthest = farthest_in(proxies[i].rect);
    if proxies[i].nearest >= farthest {
        verdicts[i] = SEEN;
    }
}
