//! The command line as `clap` takes it, and what `--help` prints below the flags.

use std::fmt::Write;

use clap::{Args, Command, CommandFactory};
use tercet::policy;
use tercet::tree::TreeConfig;
use tercet::{Dial, DialKind, PRESETS, Tradeoff};

use super::flags::{FLIGHT_END, Flags, by_name, has};
use super::program::Program;

/// The command with an example's own flags. Its name and purpose come last: adding flags brings
/// the doc comment of their type along.
pub(super) fn command<More: Args>(program: &Program) -> Command {
    program.adapt(More::augment_args(Flags::command())).after_long_help(catalogue(program))
}

/// What stands below the flags in `--help`.
fn catalogue(program: &Program) -> String {
    let run = format!("cargo run --release --example {}", program.name);
    let mut text = "Examples:\n".to_owned();
    for (flags, effect) in program.examples {
        let separator = if flags.is_empty() { "" } else { " -- " };
        let _ = writeln!(text, "  {run}{separator}{flags}\n      {effect}");
    }
    let names = if program.takes("policy") {
        let _ = writeln!(text, "\nPolicies: {}", policy::NAMES.join(", "));
        policy::NAMES.to_vec()
    } else {
        [&[program.policy], program.policies].concat()
    };
    for name in names {
        let dials = by_name(name, false).map(|policy| policy.dials()).unwrap_or_default();
        if !dials.is_empty() {
            list(&mut text, &format!("Dials of the policy {name}"), &dials);
        }
    }
    if program.gate {
        list(&mut text, "Dials of every policy that asks", &gate_dials());
    }
    list(&mut text, "Dials of the tree", &TreeConfig::default().dials());
    let _ = writeln!(text, "  {:<24} all of them at once: paper, stable", "preset=stable");
    list(&mut text, "Speed against accuracy", &Tradeoff::EXACT.dials());
    let presets: Vec<_> = PRESETS.iter().map(|(name, _)| *name).collect();
    let _ = writeln!(text, "  {:<24} all of them at once: {}", "tradeoff=exact", presets.join(", "));
    let flight_end = Dial {
        key: FLIGHT_END,
        value: 1.to_string(),
        about: "how far the camera flies, 0 to 1".to_owned(),
        kind: DialKind::Real,
    };
    list(&mut text, "Dials of the example", &[flight_end]);
    text.truncate(text.trim_end().len());
    text
}

fn list(text: &mut String, heading: &str, dials: &[Dial]) {
    let _ = writeln!(text, "\n{heading} (--set, with their defaults):");
    for dial in dials {
        let _ = writeln!(text, "  {:<24} {}", format!("{}={}", dial.key, dial.value), dial.about);
    }
}

/// The dials that a gate adds to those of a policy.
fn gate_dials() -> Vec<Dial> {
    let dials = |gate| by_name("dual-query", gate).map(|policy| policy.dials()).unwrap_or_default();
    let own = dials(false);
    dials(true).into_iter().filter(|dial| !has(&own, dial.key)).collect()
}
