//! Whatever is said is true, whatever moves and whichever policy it is; and what is untrue is found out.

use std::collections::HashMap;

use tercet::Why;
use tercet::policy::{self, Action, Context, DualQuery, Fate, Policy, Samples};
use tercet::query::{Answer, Ticket};
use tercet::tree::{NodeId, Straddlers, TightBoxes, TreeConfig, Votes};
use tercet::worlds::{self, Pathology};

use super::watch::Watch;
use crate::SCREEN;
use crate::stage::Stage;

#[test]
fn every_explanation_is_true() {
    let mut kinds: HashMap<&str, usize> = HashMap::new();
    for policy in 0..policies().len() {
        for seed in 0..9u64 {
            let mut watch = Watch::new(trees()[seed as usize % 3].clone(), policies().swap_remove(policy));
            let model = match seed {
                7 => worlds::pathological(Pathology::ALL[policy % Pathology::ALL.len()]),
                _ => worlds::random(seed, 120),
            };
            let mut stage = Stage::new(model, seed, SCREEN, true);
            for number in 0..14 {
                let view = stage.next(number);
                watch.frame(&stage, view);
                for object in watch.scene.objects() {
                    let why = watch.checked(&object).unwrap_or_else(|wrong| panic!("seed {seed}: {wrong}"));
                    *kinds.entry(kind(&why)).or_default() += 1;
                }
                let asked = watch.eye.fates(&watch.scene, &watch.view).filter(|(_, fate)| fate.was_asked());
                assert_eq!(asked.count(), watch.queries.said.len(), "each question was about a node");
                watch.scene.adapt([&mut watch.eye]);
            }
        }
    }
    let all = ["always", "unasked", "given", "swept", "outside", "no sample", "hidden", "visible", "counted"];
    for kind in all.into_iter().chain(["remembered", "hidden now", "near"]) {
        assert!(kinds.get(kind).is_some_and(|&n| n > 10), "{kind} hardly occurred: {kinds:?}");
    }
    assert_eq!(kinds.get("unknown"), None);
}

/// Adapting the tree to a frame splits and merges the nodes that its answers were about.
#[test]
fn explanations_outlive_the_adaptation_of_the_tree() {
    let (mut objects, mut unknown) = (0, 0);
    let restless = TreeConfig { bulk_leaf: 1, cooldown: 0, o_merge: 8, ..TreeConfig::paper() };
    for seed in 0..6 {
        let mut watch = Watch::new(restless.clone(), DualQuery::default());
        let mut stage = Stage::new(worlds::random(seed, 120), seed, SCREEN, true);
        for number in 0..14 {
            let view = stage.next(number);
            watch.frame(&stage, view);
            watch.scene.adapt([&mut watch.eye]);
            for object in watch.scene.objects() {
                let drawn = watch.eye.visible().iter().any(|o| o.id == object.object.id);
                match watch.why(object.object.id) {
                    why if why == Why::Unknown { drawn } => unknown += 1,
                    // Of a leaf this policy always knows it.
                    Why::Remembered { node, within: None } => assert!(!watch.scene.tree().is_leaf(node.id)),
                    _ => drop(watch.checked(&object).unwrap_or_else(|wrong| panic!("seed {seed}: {wrong}"))),
                }
                objects += 1;
            }
        }
    }
    assert!(unknown > 0 && unknown * 20 < objects, "{unknown} of {objects}");
}

/// Each of these is found out, or the suite proves nothing.
#[test]
fn untrue_explanations_are_found_out() {
    let tales: [fn(Fate) -> Fate; 5] = [
        |fate| if fate == Fate::Hidden { Fate::Outside } else { fate },
        |fate| if let Fate::Remembered { .. } = fate { Fate::Visible { samples: None } } else { fate },
        |fate| if let Fate::Visible { .. } = fate { Fate::Near } else { fate },
        |fate| if fate == Fate::Near { Fate::Visible { samples: None } } else { fate },
        |fate| match fate {
            Fate::Visible { samples: Some(Samples { visible, total }) } => {
                Fate::Visible { samples: Some(Samples { visible: visible - 1, total }) }
            }
            fate => fate,
        },
    ];
    for (number, tale) in tales.into_iter().enumerate() {
        let policy = Lying { policy: DualQuery::default(), tale };
        let mut watch = Watch::new(TreeConfig::stable(), policy);
        let mut stage = Stage::new(worlds::random(0, 120), 0, SCREEN, true);
        let mut untrue = 0;
        for frame in 0..14 {
            let view = stage.next(frame);
            watch.frame(&stage, view);
            untrue += watch.scene.objects().filter(|object| watch.checked(object).is_err()).count();
        }
        assert!(untrue > 0, "tale {number}");
    }
}

/// Every policy, some of them with other dials. Explanations are about a node's own box, tight volumes
/// about others: those stay off.
fn policies() -> Vec<Box<dyn Policy>> {
    let mut all = Vec::new();
    for &name in policy::NAMES {
        let mut policy = policy::by_name(name).expect("its name");
        match name {
            "chc++" => policy.set("tight", "false").expect("its switch"),
            // What it does is not left to this machine's times.
            "auto" => policy.set("race", "false").expect("its switch"),
            _ => {}
        }
        all.push(policy);
    }
    for (name, key, value) in [
        ("chc", "n_av", "0"),
        ("dual-query", "order", "visible-first"),
        ("dual-query", "n_skip", "5"),
        ("statistical", "n_skip", "0"),
        ("hroc", "occluder_filtering", "true"),
    ] {
        let mut policy = policy::by_name(name).expect("its name");
        policy.set(key, value).expect("its dial");
        all.push(policy);
    }
    all
}

fn trees() -> [TreeConfig; 3] {
    let stable = TreeConfig::stable();
    [
        TreeConfig { straddlers: Straddlers::StayInParent, ..stable.clone() },
        TreeConfig { tight_boxes: TightBoxes::Never, ..TreeConfig::paper() },
        stable,
    ]
}

fn kind(why: &Why) -> &'static str {
    match why {
        Why::Gone | Why::Unknown { .. } => "unknown",
        Why::Always { .. } => "always",
        Why::Unasked => "unasked",
        Why::Given { .. } => "given",
        Why::Swept { .. } => "swept",
        Why::Outside => "outside",
        Why::NoSample(_) => "no sample",
        Why::Hidden(_) => "hidden",
        Why::Visible { samples: None, .. } => "visible",
        Why::Visible { samples: Some(_), .. } => "counted",
        Why::Remembered { .. } => "remembered",
        Why::HiddenNow(_) => "hidden now",
        Why::Near(_) => "near",
    }
}

/// A policy that culls as it should, and tells tales.
struct Lying {
    policy: DualQuery,
    tale: fn(Fate) -> Fate,
}

impl Policy for Lying {
    fn name(&self) -> &'static str {
        "lying"
    }

    fn needs_blocking(&self) -> bool {
        true
    }

    fn begin(&mut self, cx: &Context<'_>) {
        self.policy.begin(cx);
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        self.policy.next(cx)
    }

    fn answer(&mut self, cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>) {
        self.policy.answer(cx, ticket, answer);
    }

    fn vote(&mut self, votes: &mut Votes) {
        self.policy.vote(votes);
    }

    fn fate(&self, cx: &Context<'_>, node: NodeId) -> Fate {
        (self.tale)(self.policy.fate(cx, node))
    }
}
