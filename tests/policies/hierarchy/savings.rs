//! How many questions the family saves on a walk through the plant, on the published binary tree
//! and on the ternary one. Counts, not times: they are the same on every machine.

use hecs::World;
use tercet::Culler;
use tercet::draw::Drawable;
use tercet::geom::{View, Viewport};
use tercet::policy;
use tercet::query::software::SoftwareQueries;
use tercet::scene::{Scene, SceneConfig};
use tercet::tree::{Straddlers, TightBoxes, TreeConfig};
use tercet::worlds::{self, power_plant};

const SCALE: f32 = 0.1;
const FRAMES: u32 = 60;

/// What a policy came to on the walk.
#[derive(Clone, Copy, Debug, Default)]
struct Walk {
    asked: u32,
    drawn: u32,
    propagated: u32,
}

/// Walks `FRAMES` frames through the plant, from the door on, at a speed in the paper's sense.
fn walk(name: &str, dials: &[(&str, &str)], tree: &TreeConfig, speed: f32) -> Walk {
    let (mut world, path) = (World::new(), power_plant::path(SCALE));
    worlds::power_plant(3, SCALE).spawn(&mut world);
    let mut scene = Scene::new(SceneConfig { tree: tree.clone(), ..SceneConfig::default() });
    scene.sync(&world);
    let mut policy = policy::by_name(name).expect("a policy of that name");
    dials.iter().for_each(|(key, value)| policy.set(key, value).expect("a dial of that name"));
    let (mut eye, mut queries) = (Culler::new(policy), SoftwareQueries::new());
    let mut all = Walk::default();
    for frame in 0..FRAMES {
        let pose = path.pose(0.4 + 0.0025 * speed * frame as f32);
        let view = View::look_at(pose.eye, pose.target, pose.fov_y_degrees, 0.1, Viewport::new(320, 180));
        let stats = eye.frame(&scene, &view.expect("a view"), &mut queries, |pass, objects| {
            for object in objects {
                let drawable = world.get::<&Drawable>(object.entity()).expect("it is drawable");
                pass.draw_level(&drawable.mesh, 0, &drawable.world_from_object);
            }
        });
        let stats = stats.expect("a frame");
        let counters = policy::Policy::counters(eye.policy());
        let propagated = counters.iter().find(|c| c.key == "propagated_nodes");
        all.asked += stats.queries;
        all.drawn += stats.drawn;
        all.propagated += propagated.map_or(0, |c| c.count);
    }
    all
}

/// The shares of A's questions that B, C and D save, printed with what they draw.
fn savings(tree: &TreeConfig, label: &str) -> [f64; 3] {
    let classical = walk("hierarchy-a", &[], tree, 1.0);
    println!("{label}: A asks {} and draws {}", classical.asked, classical.drawn);
    ["hierarchy-b", "hierarchy-c", "hierarchy-d"].map(|name| {
        let all = walk(name, &[], tree, 1.0);
        let saved = 1.0 - f64::from(all.asked) / f64::from(classical.asked);
        println!("{label}: {name} saves {saved:.3}, draws {}, {} propagated", all.drawn, all.propagated);
        saved
    })
}

#[test]
fn questions_are_saved_on_the_binary_tree() {
    let [b, c, d] = savings(&TreeConfig::binary(), "binary, cells");
    assert!(b >= 0.40, "B saves {b:.3}: nearly half of a binary tree's visited nodes are opened");
    assert!(c >= b - 0.01 && d >= 0.60, "C saves {c:.3}, D saves {d:.3}");
    savings(&TreeConfig { tight_boxes: TightBoxes::Always, ..TreeConfig::binary() }, "binary, tight boxes");
}

#[test]
fn questions_are_saved_on_the_ternary_tree() {
    let ternary = TreeConfig { straddlers: Straddlers::Leaf, ..TreeConfig::binary() };
    let [b, _, d] = savings(&ternary, "ternary, cells");
    // At most a third of the nodes visited in a ternary tree are opened ones.
    assert!((0.2..0.5).contains(&b) && d > b, "B saves {b:.3}, D saves {d:.3}");
    savings(&TreeConfig::default(), "ternary, default");
}

/// The same plots as the paper's, in figures: against the walking speed, and against `p_skip`.
#[test]
fn faster_walks_and_more_questions_save_less() {
    let tree = TreeConfig::binary();
    let saved = |name, dials: &[(&str, &str)], speed| {
        let all = walk(name, dials, &tree, speed);
        let saved = 1.0 - f64::from(all.asked) / f64::from(walk("hierarchy-a", &[], &tree, speed).asked);
        println!("{name} {dials:?} at speed {speed}: saves {saved:.3}, draws {}", all.drawn);
        saved
    };
    let [slow, fast] = [0.5, 4.0].map(|speed| saved("hierarchy-b", &[], speed));
    assert!(slow > fast, "coherence is less on a faster walk: {slow:.3}, {fast:.3}");
    let [some, most] = ["0.3", "0.9"].map(|p| saved("hierarchy-d", &[("p_skip", p)], 1.0));
    assert!(most > some);
}
