//! The example `own_world` shows the same picture, to the bit, whatever is culled. Its shadow map
//! is culled too: a shadow that was lost would show.

#![cfg(feature = "gpu")]

#[path = "../examples/own_world/main.rs"]
#[expect(dead_code, reason = "the program's own entry point")]
mod own_world;

#[test]
fn culling_leaves_the_picture_as_it_is() {
    let Ok(whole) = own_world::run("none", 4, [640, 360]) else {
        let required = std::env::var("TERCET_REQUIRE_GPU").is_ok_and(|value| value == "1");
        assert!(!required, "there is no adapter, and TERCET_REQUIRE_GPU is 1");
        return;
    };
    for policy in ["dual-query", "statistical"] {
        let culled = own_world::run(policy, 4, [640, 360]).expect("a picture, as before");
        let differ = whole.pixels().zip(culled.pixels()).filter(|(a, b)| a != b).count();
        assert_eq!(differ, 0, "{policy} changes {differ} of {} pixels", whole.len() / 4);
    }
}
