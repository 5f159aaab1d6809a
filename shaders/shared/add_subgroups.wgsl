// Adds up what the lanes of a workgroup have found, those of a subgroup among themselves first. To
// be called by all lanes or none.

fn add_up(seen: u32, covered: u32) {
    let all_seen = subgroupAdd(seen);
    let all_covered = subgroupAdd(covered);
    // The first lane has nobody before it.
    if subgroupExclusiveAdd(1u) == 0u {
        atomicAdd(&visible, all_seen);
        atomicAdd(&total, all_covered);
    }
}
