// Counts by drawing the rectangle of each proxy, an instance each, and adding up in atomics. No
// attachment decides anything, so no early depth test can skip an invocation.

@fragment
fn count(corner: Corner) {
    let pixel = vec2<u32>(corner.position.xy);
    let i = corner.index;
    var proxy = proxies[i];
    let d = offset(&proxy, pixel);
    if !covers(&proxy, d) {
        return;
    }
    let any = proxy.any != 0u;
    if any && atomicLoad(&counts[i].visible) != 0u {
        return;
    }
    let seen = in_sight(pixel, entry(&proxy, d));
    if seen != 0u {
        atomicAdd(&counts[i].visible, seen);
    }
    if !any {
        atomicAdd(&counts[i].total, frame.samples);
    }
}
