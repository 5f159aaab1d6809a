#[path = "../../../tree_maintenance/clock.rs"]
mod clock;
#[path = "../../../tree_maintenance/measure.rs"]
mod measure;
#[path = "../../../tree_maintenance/workload.rs"]
mod workload;
#[path = "../../../tree_maintenance/yardstick.rs"]
mod yardstick;

fn main() {
    let args: Vec<f64> = std::env::args().skip(1).map(|a| a.parse().unwrap()).collect();
    let frames = args[0] as usize;
    let counts = if args.len() > 1 { vec![args[1] as usize] } else { vec![2_500, 13_550, 100_000, 1_000_000] };
    let shares = if args.len() > 2 { vec![args[2]] } else { vec![0.0, 0.2, 0.5, 1.0] };
    for &n in &counts {
        for &s in &shares {
            let r = measure::run(n, s, if n > 500_000 { frames.min(60) } else { frames }, tercet::tree::TreeConfig { unasked_leaf: args.get(3).map_or(64, |&x| x as u32), ..Default::default() });
            println!(
                "{n:8} {s:.1}: write {:8.1}us copy {:8.1}us update {:8.1}us (worst {:.1}, age {:.2})  /write {:.2} /copy {:.2} /scan {:.3}",
                r.write * 1e6, r.copy * 1e6, r.update * 1e6, r.worst_update / r.update, r.ageing,
                r.update / r.write, r.update / r.copy, r.update / r.scan[0]
            );
            println!(
                "   scan {:.2?}us query {:.2?}us ratio {:.2?} seen {:.4?} bytes {:.1} / {:.1}",
                r.scan.map(|x| x * 1e6), r.query.map(|x| x * 1e6),
                [0, 1, 2].map(|i| r.query[i] / r.scan[i]), r.seen, r.tree_bytes, r.scene_bytes
            );
        }
    }
}
