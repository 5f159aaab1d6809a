// Which objects a list holds, and how many come before each of them: a prefix sum over the objects in
// the order of their meshes, in three steps. So a list keeps that order from frame to frame, and
// equal depths do not flicker.

struct Box {
    low: vec3<f32>,
    kind: u32,
    high: vec3<f32>,
    node: u32,
}

// It hides nothing, and is drawn last: the twin of the constant in src/query/gpu/sweep/boxes.rs.
const LATE: u32 = 4u;

struct List {
    which: u32,
    // How many objects there are.
    count: u32,
    unused: vec2<u32>,
}

// What the last frame found visible; what tests have found since; what is drawn last.
const FIRST: u32 = 0u;
const MISSED: u32 = 1u;
const LAST: u32 = 2u;

// What is remembered of an object: it was visible in the last frame; it has been drawn in this one.
const VISIBLE: u32 = 1u;
const DRAWN: u32 = 2u;

@group(0) @binding(0) var<uniform> list: List;
@group(1) @binding(0) var<storage, read> boxes: array<Box>;
// Slots in the order of their meshes, and verdicts in the same.
@group(1) @binding(1) var<storage, read> order: array<u32>;
@group(1) @binding(2) var<storage, read> verdicts: array<u32>;
// By slot.
@group(1) @binding(3) var<storage, read_write> remembered: array<u32>;
// By workgroup: how many of the list it has, then how many come before it.
@group(1) @binding(4) var<storage, read_write> sums: array<u32>;
// How many of the list come before each object, and before the end.
@group(1) @binding(5) var<storage, read_write> before: array<u32>;

const LANES: u32 = 256u;

var<workgroup> running: array<u32, 256>;
var<workgroup> carried: u32;

fn is_wanted(slot: u32, verdict: u32) -> bool {
    let is_late = (boxes[slot].kind & LATE) != 0u;
    if list.which == LAST {
        return is_late && verdict == SEEN;
    }
    if is_late {
        return false;
    }
    if list.which == FIRST {
        return verdict == SEEN || (verdict != OUTSIDE && (remembered[slot] & VISIBLE) != 0u);
    }
    return verdict == SEEN && (remembered[slot] & DRAWN) == 0u;
}

// How many of the lanes up to this one, and itself, have something. To be called by all lanes.
fn up_to(lane: u32, value: u32) -> u32 {
    running[lane] = value;
    workgroupBarrier();
    for (var reach = 1u; reach < LANES; reach *= 2u) {
        var sum = running[lane];
        if lane >= reach {
            sum += running[lane - reach];
        }
        workgroupBarrier();
        running[lane] = sum;
        workgroupBarrier();
    }
    return running[lane];
}

@compute @workgroup_size(256)
fn count(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let row = group.y * groups.x + group.x;
    let i = row * LANES + lane;
    var wanted = 0u;
    if i < list.count {
        wanted = u32(is_wanted(order[i], verdicts[i]));
    }
    let sum = up_to(lane, wanted);
    if lane == LANES - 1u && row < arrayLength(&sums) {
        sums[row] = sum;
    }
}

// One workgroup.
@compute @workgroup_size(256)
fn add_up(@builtin(local_invocation_index) lane: u32) {
    let rows = (list.count + LANES - 1u) / LANES;
    if lane == 0u {
        carried = 0u;
    }
    for (var first = 0u; first < rows; first += LANES) {
        let row = first + lane;
        var own = 0u;
        if row < rows {
            own = sums[row];
        }
        let sum = up_to(lane, own);
        let earlier = carried;
        workgroupBarrier();
        if row < rows {
            sums[row] = earlier + sum - own;
        }
        if lane == LANES - 1u {
            carried = earlier + sum;
        }
        workgroupBarrier();
    }
}

@compute @workgroup_size(256)
fn number(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let row = group.y * groups.x + group.x;
    let i = row * LANES + lane;
    var wanted = 0u;
    if i < list.count {
        wanted = u32(is_wanted(order[i], verdicts[i]));
    }
    let sum = up_to(lane, wanted);
    if i >= list.count {
        return;
    }
    before[i + 1u] = sums[row] + sum;
    if i == 0u {
        before[0] = 0u;
    }
    let slot = order[i];
    if list.which == FIRST {
        remembered[slot] = DRAWN * wanted;
    } else if list.which == MISSED {
        remembered[slot] = VISIBLE * u32(verdicts[i] == SEEN);
    }
}
