// Counts with one workgroup for each tile of a proxy's rectangle. A workgroup adds up by itself
// and touches the proxy's counts once.

// The twins of the constants and the struct in src/query/gpu/pack.rs.
const TILE: u32 = 64u;
const LANES: u32 = 8u;

struct Tile {
    proxy: u32,
    // Which of the proxy's tiles.
    column: u32,
    row: u32,
    unused: u32,
}

@group(1) @binding(2) var<storage, read> tiles: array<Tile>;

var<workgroup> visible: atomic<u32>;
var<workgroup> total: atomic<u32>;

@compute @workgroup_size(8, 8)
fn count(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_id) lane: vec3<u32>,
) {
    let index = group.y * groups.x + group.x;
    // The last row of workgroups may reach beyond the tiles, of which the binding has exactly all.
    if index >= arrayLength(&tiles) {
        return;
    }
    let tile = tiles[index];
    let i = tile.proxy;
    var proxy = proxies[i];
    let first = proxy.rect.xy + vec2<u32>(tile.column, tile.row) * TILE;
    let end = min(first + TILE, proxy.rect.zw);
    let any = proxy.any != 0u;
    var seen = 0u;
    var covered = 0u;
    for (var y = first.y + lane.y; y < end.y; y += LANES) {
        // One visible sample is enough, whoever found it.
        if any && (seen != 0u || atomicLoad(&visible) != 0u) {
            break;
        }
        for (var x = first.x + lane.x; x < end.x; x += LANES) {
            let pixel = vec2<u32>(x, y);
            let d = offset(&proxy, pixel);
            if covers(&proxy, d) {
                covered += frame.samples;
                seen += in_sight(pixel, entry(&proxy, d));
            }
        }
        if any && seen != 0u {
            atomicAdd(&visible, seen);
        }
    }
    if !any {
        atomicAdd(&visible, seen);
        atomicAdd(&total, covered);
    }
    workgroupBarrier();
    if all(lane.xy == vec2<u32>(0u)) {
        atomicAdd(&counts[i].visible, atomicLoad(&visible));
        atomicAdd(&counts[i].total, atomicLoad(&total));
    }
}
