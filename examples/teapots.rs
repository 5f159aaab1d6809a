//! A cloud of teapots, all moving and each of 6 400 triangles: little is hidden, and what is, is
//! hidden by other teapots. Culling has the most to lose here.
//!
//! ```text
//! cargo run --release --example teapots
//! cargo run --release --example teapots -- --headless --static --oracle
//! cargo run --release --example teapots -- --help
//! ```

use support::demo;
use support::flags::Flags;
use support::scenario::Scenario;

fn main() -> anyhow::Result<()> {
    let flags =
        Flags::parse("teapots", "A cloud of teapots, --objects × --scale of them, that hide each other.");
    let count = (flags.objects as f64 * f64::from(flags.scale)).round() as usize;
    anyhow::ensure!(count > 0, "{} × {} teapots: a cloud needs at least one", flags.objects, flags.scale);
    demo::run(&flags, Scenario::teapots(&flags, count, !flags.still))
}
