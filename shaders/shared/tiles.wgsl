// The parts of a proxy's rectangle that a workgroup each looks at.

// The twins of the constants and the struct in src/query/gpu/pack.rs.
const TILE: u32 = 64u;
const BLOCK: u32 = 8u;

struct Tile {
    proxy: u32,
    // Which of the proxy's tiles.
    column: u32,
    row: u32,
    unused: u32,
}

@group(1) @binding(2) var<storage, read> tiles: array<Tile>;

// What a workgroup has found.
var<workgroup> visible: atomic<u32>;
var<workgroup> total: atomic<u32>;

// A tile's upper left pixel. It lies on the grid of blocks, so maybe before the rectangle.
fn tile_corner(tile: Tile) -> vec2<u32> {
    return proxies[tile.proxy].rect.xy / BLOCK * BLOCK + vec2<u32>(tile.column, tile.row) * TILE;
}
