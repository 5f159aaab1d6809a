// Counts with one workgroup for each tile of a proxy's rectangle. A workgroup adds up by itself
// and touches the proxy's counts once.

const LANES: u32 = 8u;

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
    let corner = tile_corner(tile);
    let first = max(corner, proxy.rect.xy);
    let end = min(corner + TILE, proxy.rect.zw);
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
        add_up(seen, covered);
    }
    workgroupBarrier();
    if all(lane.xy == vec2<u32>(0u)) {
        atomicAdd(&counts[i].visible, atomicLoad(&visible));
        atomicAdd(&counts[i].total, atomicLoad(&total));
    }
}
