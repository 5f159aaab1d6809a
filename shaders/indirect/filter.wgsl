// Forgets who was drawn and owns no sample (Lee et al. 2021, occluder filtering), an invocation a slot: the next frame
// draws it first no more.

// By slot: who owns one.
@group(1) @binding(0) var<storage, read> owned: array<u32>;
// See select.wgsl.
@group(1) @binding(1) var<storage, read_write> remembered: array<u32>;

// It was visible in the last frame: the twin of the constant in select.wgsl.
const VISIBLE: u32 = 1u;

@compute @workgroup_size(64)
fn keep(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let slot = (group.y * groups.x + group.x) * 64u + lane;
    if slot < arrayLength(&owned) && owned[slot] != SEEN {
        remembered[slot] &= ~VISIBLE;
    }
}
