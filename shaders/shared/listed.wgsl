// Something whose rectangle is drawn: the twin of the struct in src/query/gpu/rectangles.rs.
struct Listed {
    rect: vec4<u32>,
    // Which node, or which proxy, it is.
    index: u32,
}
