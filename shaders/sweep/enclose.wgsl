// Where each node of the tree lies on the screen, an invocation each: the rectangle and the nearest
// point of its box, with so much room that they hold the proxy of every object below. The proof is in
// src/query/gpu/sweep/enclose.rs.

// The twin of the struct in src/query/gpu/sweep/flat.rs.
struct Link {
    enter: u32,
    skip: u32,
    first: u32,
    end: u32,
    parent: u32,
}

// Those of the nodes, by the tree's own indices, as are the boxes.
@group(1) @binding(1) var<storage, read> links: array<Link>;
@group(1) @binding(2) var<storage, read_write> nodes: array<Node>;

@compute @workgroup_size(64)
fn enclose(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i = (group.y * groups.x + group.x) * 64u + lane;
    if i >= arrayLength(&links) {
        return;
    }
    let box = boxes[i];
    let link = links[i];
    var screen: Screen;
    var verdict = known(box, Room(3.0, 100.0), &screen);
    var rect = vec4<f32>(0.0);
    var nearest = FARTHEST;
    if verdict == HIDDEN {
        rect = pixels(&screen);
        nearest = max(screen.nearest + screen.depth_error, view.cleared) + view.slack;
    }
    if verdict == SEEN {
        rect = vec4<f32>(vec2<f32>(0.0), view.size);
    }
    nodes[i] = Node(
        vec4<u32>(rect), nearest, link.enter, link.skip, link.first, link.end, link.parent, verdict, 0u
    );
}
