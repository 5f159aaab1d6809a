// The rectangle of each proxy, an instance each.

@vertex
fn rectangle(
    @builtin(vertex_index) corner: u32,
    @builtin(instance_index) proxy: u32,
    @location(0) rect: vec4<u32>,
) -> Corner {
    return corner_of(rect, corner, proxy);
}
