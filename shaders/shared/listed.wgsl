// Things whose rectangles are drawn: the twins of the structs in src/query/gpu/rectangles.rs.

struct Listed {
    rect: vec4<u32>,
    // Which node, or which proxy, it is.
    index: u32,
}

struct List {
    // Of a draw: vertices, instances, two times 0, and what nobody reads.
    draw: array<atomic<u32>, 8>,
    things: array<Listed>,
}

// Which instance of a draw is next.
const INSTANCES: u32 = 1u;
