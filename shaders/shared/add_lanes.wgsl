// Adds up what the lanes of a workgroup have found, one by one.

fn add_up(seen: u32, covered: u32) {
    atomicAdd(&visible, seen);
    atomicAdd(&total, covered);
}
