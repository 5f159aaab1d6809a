//! What sets a program apart from the demos, where flags and help are concerned.

use anyhow::bail;
use clap::parser::ValueSource;
use clap::{ArgMatches, Command};

use super::flags::Backend;

/// A program that takes the shared [`Flags`](super::flags::Flags).
#[derive(Clone, Debug)]
pub struct Program {
    /// The example's name.
    pub name: &'static str,
    /// What it does, in a line.
    pub about: &'static str,
    /// For the help: flags, and what they do.
    pub examples: &'static [(&'static str, &'static str)],
    /// How many frames are run, unless the command line says otherwise.
    pub frames: &'static str,
    /// Which policy runs, unless the command line says otherwise.
    pub policy: &'static str,
    /// Whether meshes are drawn with all their triangles, unless the command line says otherwise.
    pub full_detail: bool,
    /// Whether the policy is behind a gate ([`Gated`](tercet::policy::Gated)): a demo shall never be
    /// slower than it need be, a comparison compares policies as they are.
    pub gate: bool,
    /// Policies beside `--policy` whose dials `--set` reaches.
    pub policies: &'static [&'static str],
    /// Shared flags without a meaning here, and what is said when they are given.
    pub refused: &'static [(&'static str, &'static str)],
}

impl Program {
    /// A demo: every flag means what it says.
    pub const fn demo(name: &'static str, about: &'static str) -> Self {
        const EXAMPLES: &[(&str, &str)] = &[
            ("", "a window to fly about in; the next line's run where there is no display"),
            ("--headless", "the whole flight, with its figures and pictures"),
            ("--frames 60 --oracle", "check each frame against the exact visible set"),
            (
                "--policy dual-query --audit 24 --set visible_pixels=16",
                "lossy: what is lost in every 24th frame, and why",
            ),
            ("--headless --policy frustum", "what the view frustum alone would leave to draw"),
            (
                "--backend gpu-driven --policy roc",
                "the GPU culls by itself: nothing is asked, nothing comes back",
            ),
            (
                "--headless --policy dual-query --set gate=off",
                "ask in every frame, even where it does not pay",
            ),
            (
                "--policy dual-query --set preset=paper",
                "the algorithm, the rule and the constants of the 2005 paper",
            ),
        ];
        Self {
            name,
            about,
            examples: EXAMPLES,
            frames: "240",
            policy: "auto",
            full_detail: false,
            gate: true,
            policies: &[],
            refused: &[],
        }
    }

    /// Whether a shared flag has a meaning here.
    pub(super) fn takes(&self, flag: &str) -> bool {
        self.refused.iter().all(|(refused, _)| *refused != flag)
    }

    /// The command of the shared flags, made this program's.
    pub(super) fn adapt(&self, command: Command) -> Command {
        let mut command = command.name(self.name).about(self.about);
        command = command.mut_arg("frames", |arg| arg.default_value(self.frames));
        command = command.mut_arg("policy", |arg| arg.default_value(self.policy));
        command = command.mut_arg("full_detail", |arg| arg.hide(self.full_detail));
        for (flag, _) in self.refused {
            command = command.mut_arg(flag, |arg| arg.hide(true));
        }
        command
    }

    /// Refuses what has no meaning here.
    pub(super) fn check(&self, matches: &ArgMatches) -> anyhow::Result<()> {
        for (flag, why) in self.refused {
            if matches.value_source(flag) == Some(ValueSource::CommandLine) {
                bail!("{why}");
            }
        }
        if !self.takes("policy") && matches.get_one("backend") == Some(&Backend::GpuDriven) {
            bail!("--backend gpu-driven has no meaning here: it culls in one way, and here several run");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::super::flags::Flags;
    use super::*;

    #[test]
    fn refused_flags_are_refused_when_they_are_given() {
        let program = Program { refused: &[("policy", "two policies run")], ..Program::demo("example", "") };
        let check = |line: &[&str]| {
            let matches = program.adapt(Flags::command()).try_get_matches_from(line)?;
            program.check(&matches)
        };
        assert!(check(&["example"]).is_ok());
        assert!(check(&["example", "--policy", "frustum"]).is_err());
    }
}
