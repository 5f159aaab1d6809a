// Marks the nodes that hold what was drawn first, and what hangs off the way up to the root (Lee et
// al. 2021, HROC, extraction of occludee groups), an invocation a node: the twin of
// src/policy/hroc/extract.rs.

@group(1) @binding(0) var<storage, read> nodes: array<Node>;
// Slots of objects by place, and what is remembered of them by slot.
@group(1) @binding(1) var<storage, read> places: array<u32>;
@group(1) @binding(2) var<storage, read> remembered: array<u32>;
// None at first.
@group(1) @binding(3) var<storage, read_write> marks: array<atomic<u32>>;

// It has been drawn in this frame: the twin of the constant in select.wgsl.
const DRAWN: u32 = 2u;

fn holds_occluder(node: Node) -> bool {
    for (var place = node.first; place < node.end; place++) {
        if (remembered[places[place]] & DRAWN) != 0u {
            return true;
        }
    }
    return false;
}

@compute @workgroup_size(64)
fn mark(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * groups.x + group.x) * 64u + lane;
    if i >= arrayLength(&nodes) || !holds_occluder(nodes[i]) {
        return;
    }
    var at = i;
    for (var steps = 0u; at != NONE && steps < arrayLength(&nodes); steps++) {
        // Whoever was here before has marked, or will, all that is above.
        if atomicMax(&marks[at], VISIBLE) == VISIBLE {
            return;
        }
        // One that is visible already stays so.
        var child = nodes[at].enter;
        while child != nodes[at].skip {
            atomicMax(&marks[child], UNKNOWN);
            child = nodes[child].skip;
        }
        at = nodes[at].parent;
    }
}
