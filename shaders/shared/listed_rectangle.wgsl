// The rectangle of each thing in a list, an instance each.

@vertex
fn listed_rectangle(
    @builtin(vertex_index) corner: u32,
    @location(0) rect: vec4<u32>,
    @location(1) index: u32,
) -> Corner {
    return corner_of(rect, corner, index);
}
