//! The seeded worlds are what they claim to be, and the same on every machine.

use tercet::worlds;

#[test]
fn probe() {
    let t = std::time::Instant::now();
    let plant = worlds::power_plant(1, 1.0);
    println!(
        "{} objects, {} triangles, {:?}, bounds {:?}",
        plant.objects.len(),
        plant.triangles(),
        t.elapsed(),
        plant.bounds
    );
    let mut uses = vec![0usize; plant.meshes.len()];
    for o in &plant.objects {
        uses[o.mesh] += 1;
    }
    for (m, n) in plant.meshes.iter().zip(&uses) {
        println!(
            "{:20} {:6} x {:6} = {:9}  {:?}",
            m.name(),
            n,
            m.triangle_count(),
            n * m.triangle_count(),
            m.levels().iter().map(|l| (l.indices.len() / 3, l.error)).collect::<Vec<_>>()
        );
    }
    let path = worlds::power_plant::path(1.0);
    let mut worst: Vec<(f32, usize, usize)> = vec![];
    for n in 0..=2000 {
        let eye = path.pose(n as f32 / 2000.0).eye;
        for (i, o) in plant.objects.iter().enumerate() {
            let d = o.bounds.distance_squared(eye).sqrt();
            if d < 0.3 {
                worst.push((d, n, i));
            }
        }
    }
    for w in worst.iter().step_by(10).take(60) {
        println!(
            "{:?} {} {:?} {:?}",
            w,
            plant.meshes[plant.objects[w.2].mesh].name(),
            path.pose(w.1 as f32 / 2000.0).eye,
            plant.objects[w.2].bounds
        );
    }
    for s in [0.01, 0.03, 0.05, 0.1, 0.3, 0.5, 2.0, 10.0] {
        let p = worlds::power_plant(1, s);
        println!(
            "{s}: {} (want {}) {} tris/obj {} {:?}",
            p.objects.len(),
            11050.0 * s,
            p.triangles(),
            p.triangles() / p.objects.len() as u64,
            worlds::power_plant::interior(s).size()
        );
    }
}
