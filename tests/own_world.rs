//! The example `own_world` shows the same picture, to the bit, whatever is culled. Its shadow map
//! is culled too: a shadow that was lost would show.

#![cfg(feature = "gpu")]

use std::io::Write;

#[path = "../examples/own_world/main.rs"]
#[expect(dead_code, reason = "the program's own entry point")]
mod own_world;

#[test]
fn culling_leaves_the_picture_as_it_is() {
    let whole = match own_world::run("none", 4, [640, 360]) {
        Ok(whole) => whole,
        Err(error) if error.to_string().starts_with("no GPU was found") => {
            let required = std::env::var("TERCET_REQUIRE_GPU").is_ok_and(|value| value == "1");
            assert!(!required, "{error}");
            // Not captured by the test harness.
            let _ = writeln!(std::io::stderr(), "SKIPPED: {error}");
            return;
        }
        Err(error) => panic!("{error:#}"),
    };
    assert_eq!([whole.seen, whole.cast], [whole.all; 2], "nothing is culled here");
    let whole = whole.picture;
    for policy in ["dual-query", "statistical"] {
        let culled = own_world::run(policy, 4, [640, 360]).expect("a picture, as before");
        let own_world::Frame { picture, all, seen, cast } = culled;
        assert!(seen < all && cast < all, "{policy} draws {seen} and {cast} of {all}");
        let differ = whole.pixels().zip(picture.pixels()).filter(|(a, b)| a != b).count();
        assert_eq!(differ, 0, "{policy} changes {differ} of {} pixels", whole.len() / 4);
    }
}
