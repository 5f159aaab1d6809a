// Lists occludee groups, and the objects that are tested by themselves (Lee et al. 2021, HROC), an
// invocation a node: the twin of src/policy/hroc/mod.rs.

// A group of more pixels than the first component is opened.
@group(0) @binding(0) var<uniform> most: vec4<f32>;
@group(1) @binding(0) var<storage, read> nodes: array<Node>;
@group(1) @binding(1) var<storage, read> marks: array<u32>;
// By place. Who has none has an empty rectangle.
@group(1) @binding(2) var<storage, read> proxies: array<Proxy>;
// By place: what is known of objects so far.
@group(1) @binding(3) var<storage, read> verdicts: array<u32>;
@group(1) @binding(4) var<storage, read_write> listed: List;
@group(1) @binding(5) var<storage, read_write> loose: List;

// Whether rays over all of its rectangle would be too many.
fn is_too_large(node: Node) -> bool {
    let size = vec2<f32>(node.rect.zw - node.rect.xy);
    return node.verdict == SEEN || size.x * size.y > most.x;
}

// Lists a node's own objects.
fn loosen(node: Node) {
    for (var place = node.first; place < node.end; place++) {
        list_object(place);
    }
}

@compute @workgroup_size(64)
fn extract(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) workgroups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * workgroups.x + group.x) * 64u + lane;
    if i >= arrayLength(&nodes) {
        return;
    }
    // The root has no parent that could say that it may be a group.
    let mark = max(marks[i], select(0u, UNKNOWN, i == 0u));
    if mark == VISIBLE {
        loosen(nodes[i]);
    }
    if mark != UNKNOWN {
        return;
    }
    // Groups that are too large are opened: a walk without a stack, as that of rays.
    let end = nodes[i].skip;
    var at = i;
    for (var steps = 0u; at != end && steps < arrayLength(&nodes); steps++) {
        let node = nodes[at];
        if is_empty(node.rect) {
            at = node.skip;
        } else if is_too_large(node) {
            loosen(node);
            at = node.enter;
        } else {
            list_group(at);
            at = node.skip;
        }
    }
}
