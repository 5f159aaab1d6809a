// Which proxies have a sample in sight, by drawing the rectangle of each: a plain store by whoever
// finds one, and nothing to do for those who come later. No attachment decides anything, so no early
// depth test can skip an invocation.

@group(1) @binding(2) var<storage, read_write> verdicts: array<atomic<u32>>;

@fragment
fn look(corner: Corner) {
    let i = corner.index;
    if atomicLoad(&verdicts[i]) == SEEN {
        return;
    }
    var proxy = proxies[i];
    let pixel = vec2<u32>(corner.position.xy);
    let d = offset(&proxy, pixel);
    if covers(&proxy, d) && in_sight(pixel, entry(&proxy, d)) != 0u {
        atomicStore(&verdicts[i], SEEN);
    }
}
