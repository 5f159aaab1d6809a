// Who owns a sample (Lee et al. 2021, occluder filtering), by the item buffer that the app has drawn:
// an invocation a pixel.

// By slot.
@group(1) @binding(2) var<storage, read_write> verdicts: array<atomic<u32>>;

@compute @workgroup_size(8, 8)
fn look(@builtin(global_invocation_id) at: vec3<u32>) {
    if any(at.xy >= frame.size) {
        return;
    }
    for (var sample = 0u; sample < frame.samples; sample++) {
        let parts = id_of(at.xy, sample);
        // One more than the slot; 0 where nobody drew. What has a single channel keeps it in the first.
        let id = parts.x | (parts.y << 16u);
        // Neighbours mostly have the same owner: a look spares many stores.
        if id != 0u && id <= arrayLength(&verdicts) && atomicLoad(&verdicts[id - 1u]) != SEEN {
            atomicStore(&verdicts[id - 1u], SEEN);
        }
    }
}
