// Which proxies may have a sample in sight, by the pyramid (Rákos 2010), an invocation each: the
// nearest point against the farthest of the four texels that hold the whole rectangle.

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
    let first = proxies[i].rect.xy;
    let last = proxies[i].rect.zw - 1u;
    // The finest level on which the rectangle spans two texels at most along each side.
    var level = 0u;
    while any((last >> vec2<u32>(level + 1u)) - (first >> vec2<u32>(level + 1u)) > vec2<u32>(1u)) {
        level++;
    }
    let size = level_size(level);
    let start = level_start(level);
    let low = first >> vec2<u32>(level + 1u);
    let high = last >> vec2<u32>(level + 1u);
    var farthest = pyramid[start + low.y * size.x + low.x];
    farthest = min(farthest, pyramid[start + low.y * size.x + high.x]);
    farthest = min(farthest, pyramid[start + high.y * size.x + low.x]);
    farthest = min(farthest, pyramid[start + high.y * size.x + high.x]);
    if proxies[i].nearest >= farthest {
        verdicts[i] = SEEN;
    }
}
