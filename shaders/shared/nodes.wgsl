// A node of the tree on the screen, and the way that a ray takes through the tree: the twin of the
// struct in src/query/gpu/sweep/enclose.rs.

struct Node {
    // x0, y0, x1, y1 in pixels of the viewport, half open: where what lies below may own samples.
    rect: vec4<u32>,
    // Nothing below is nearer.
    nearest: f32,
    // Where a ray goes on that meets the node, and one that does not.
    enter: u32,
    skip: u32,
    // Its own objects: from one place to another.
    first: u32,
    end: u32,
    parent: u32,
    // Whether it is OUTSIDE, HIDDEN for all that is known (outside or hidden, if the rectangle is empty), or SEEN:
    // it cannot be asked about.
    verdict: u32,
    unused: u32,
}

// No node.
const NONE: u32 = 0xffffffffu;

fn is_empty(rect: vec4<u32>) -> bool {
    return any(rect.xy >= rect.zw);
}
