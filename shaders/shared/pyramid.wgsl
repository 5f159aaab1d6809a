// The pyramid of farthest depths: all levels in one buffer, one after the other. A texel of level l
// stands for 2 << l pixels along each side, fewer at the right and lower borders: sizes are rounded
// up, so that none is left out.

fn level_size(level: u32) -> vec2<u32> {
    return (frame.size - 1u) / (2u << level) + 1u;
}

fn level_start(level: u32) -> u32 {
    var start = 0u;
    for (var l = 0u; l < level; l++) {
        let size = level_size(l);
        start += size.x * size.y;
    }
    return start;
}
