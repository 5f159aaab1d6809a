//! The flags that all examples share, and what they mean for the engine.

use std::path::PathBuf;

use anyhow::bail;
use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{Args, FromArgMatches, Parser};
use tercet::draw::Detail;
use tercet::geom::Viewport;
use tercet::policy::{self, Gated, Policy};
use tercet::tree::TreeConfig;
use tercet::{Culler, Tradeoff};

pub use super::values::Backend;

use super::help;
use super::program::Program;
use super::stage::{Listed, gpu_driven};
use super::values::{key_value, scale, size};

/// What the command line says.
#[derive(Clone, Debug, Parser)]
pub struct Flags {
    /// The culling algorithm; see the list below
    #[arg(long, value_name = "NAME", default_value = "auto")]
    pub policy: String,

    /// Set dials of the policy, the tree or the example by name; see the lists below
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value, num_args = 1..)]
    pub dials: Vec<(String, String)>,

    /// What answers the questions; auto takes the best that there is
    #[arg(long, value_enum, default_value = "auto")]
    pub backend: Backend,

    /// How many frames the camera's flight is cut into; a window flies it again and again
    #[arg(long, value_name = "N", default_value = "240", value_parser = clap::value_parser!(u32).range(1..))]
    pub frames: u32,

    /// Width and height of the picture, in pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    pub size: (u32, u32),

    /// How many objects move about; 0 leaves the rest of the world, if there is any
    #[arg(long, value_name = "N", default_value = "2500")]
    pub objects: usize,

    /// How much of the world is built: 1 is the paper's size, 0.1 a tenth of its objects
    #[arg(long, value_name = "X", default_value = "1", value_parser = scale)]
    pub scale: f32,

    /// Draw every mesh with all its triangles, however far away it is
    #[arg(long)]
    pub full_detail: bool,

    /// What the world is generated from: the same number, the same world
    #[arg(long, value_name = "N", default_value = "1")]
    pub seed: u64,

    /// Leave the moving objects still
    #[arg(long = "static")]
    pub still: bool,

    /// Open no window: fly once, then write figures and pictures. So do --oracle, --out, --backend
    /// gpu-driven, and a machine without a display
    #[arg(long)]
    pub headless: bool,

    /// Compare each frame with the exact visible set, outside the clock: slower, same timings
    #[arg(long)]
    pub oracle: bool,

    /// Check every N-th frame against the exact visible set, outside the clock: what was lost, why, and
    /// which dial is to blame
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub audit: Option<u32>,

    /// Record the run, to be replayed bit for bit with the example `replay`; opens no window
    #[arg(long, value_name = "FILE")]
    pub record: Option<PathBuf>,

    /// Where the figures and pictures go [default: out/ and the example's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,

    /// The example's name.
    #[arg(skip)]
    pub example: &'static str,

    /// Whether the command line names a scale.
    #[arg(skip)]
    pub has_scale: bool,

    /// Whether the command line names a number of objects.
    #[arg(skip)]
    pub has_objects: bool,

    /// Whether the policy is behind a gate.
    #[arg(skip)]
    pub gate: bool,

    /// Other policies whose dials are taken.
    #[arg(skip)]
    pub policies: &'static [&'static str],
}

/// An example without flags of its own.
#[derive(Args)]
pub struct NoMore {}

impl Flags {
    /// Reads the command line. Prints help, or what is wrong with a flag, and exits.
    pub fn parse(example: &'static str, about: &'static str) -> Self {
        Self::parse_with::<NoMore>(example, about).0
    }

    /// As [`Flags::parse`], with flags of the example's own.
    pub fn parse_with<More: Args>(example: &'static str, about: &'static str) -> (Self, More) {
        Self::parse_for::<More>(&Program::demo(example, about))
    }

    /// The same for a program that is no demo.
    pub fn parse_for<More: Args>(program: &Program) -> (Self, More) {
        let command = help::command::<More>(program);
        let matches = command.clone().get_matches();
        let mut flags = Self::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
        let more = More::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
        flags.example = program.name;
        flags.full_detail |= program.full_detail;
        flags.gate = program.gate;
        flags.policies = program.policies;
        if flags.backend == Backend::GpuDriven && flags.policy == "auto" {
            flags.policy = gpu_driven::FASTEST.to_owned();
            println!("--policy auto: with --backend gpu-driven that is {}.", flags.policy);
        }
        flags.has_objects = matches.value_source("objects") == Some(ValueSource::CommandLine);
        flags.has_scale = matches.value_source("scale") == Some(ValueSource::CommandLine);
        if let Err(error) = program.check(&matches).and_then(|()| flags.check()) {
            command.clone().error(ErrorKind::InvalidValue, error).exit();
        }
        (flags, more)
    }

    /// The policy, its dials set; behind a gate in a demo. Where the device culls by itself, what it does
    /// in its place.
    pub fn policy(&self) -> anyhow::Result<Box<dyn Policy>> {
        if self.backend == Backend::GpuDriven {
            return Ok(Box::new(Listed::new(gpu_driven::test_of(&self.policy)?)));
        }
        let mut policy = by_name(&self.policy, self.gate)?;
        self.turn(&mut *policy)?;
        Ok(policy)
    }

    /// A culler with that policy, as exact as the flags say.
    pub fn eye(&self) -> anyhow::Result<Culler<Box<dyn Policy>>> {
        let mut eye = Culler::new(self.policy()?);
        eye.tradeoff = self.tradeoff()?;
        Ok(eye)
    }

    /// Turns the dials that a policy has.
    pub fn turn(&self, policy: &mut dyn Policy) -> anyhow::Result<()> {
        let known = policy.dials();
        for (key, value) in self.dials.iter().filter(|(key, _)| has(&known, key)) {
            policy.set(key, value)?;
        }
        Ok(())
    }

    /// Refuses what has no meaning for a table of these policies, in worlds of their own.
    pub fn check_table(&self, policies: &[&str]) -> anyhow::Result<()> {
        if self.has_objects {
            bail!("--objects has no meaning for this table: --scale says how large its worlds are");
        }
        self.check_dials(policies)
    }

    /// Refuses dials that nobody has: none of these policies, nor the tree, nor the example.
    pub fn check_dials(&self, policies: &[&str]) -> anyhow::Result<()> {
        let mut known = Vec::new();
        for name in policies {
            let mut policy = by_name(name, self.gate)?;
            self.turn(&mut *policy)?;
            known.extend(policy.dials());
        }
        let names = if policies.is_empty() { "the GPU".to_owned() } else { policies.join(", nor ") };
        for (key, value) in &self.dials {
            if !has(&known, key) && !is_tree_dial(key) && !is_own_dial(key) {
                bail!(
                    "--set {key}={value}: neither {names}, nor the tree, nor the example has a dial of that \
                     name; --help lists them"
                );
            }
        }
        Ok(())
    }

    /// Speed against accuracy: a preset (`--set tradeoff=NAME`), and dials turned from there.
    pub fn tradeoff(&self) -> anyhow::Result<Tradeoff> {
        let mut tradeoff = Tradeoff::EXACT;
        for (_, name) in self.dials.iter().filter(|(key, _)| key == "tradeoff") {
            tradeoff = Tradeoff::by_name(name)?;
        }
        let known = tradeoff.dials();
        for (key, value) in self.dials.iter().filter(|(key, _)| has(&known, key)) {
            tradeoff.set(key, value)?;
        }
        Ok(tradeoff)
    }

    /// The tree's dials.
    pub fn tree(&self) -> anyhow::Result<TreeConfig> {
        let default = TreeConfig::default();
        self.tree_from(match self.backend {
            Backend::GpuDriven => gpu_driven::tree(gpu_driven::test_of(&self.policy)?, default),
            _ => default,
        })
    }

    /// The same, with other defaults.
    pub fn tree_from(&self, mut tree: TreeConfig) -> anyhow::Result<TreeConfig> {
        for (key, value) in self.dials.iter().filter(|(key, _)| is_tree_dial(key)) {
            tree.set(key, value)?;
        }
        Ok(self.tradeoff()?.tree(tree))
    }

    /// The same flags with another default for the scale.
    pub fn with_default_scale(&self, default: f32) -> Self {
        let scale = if self.has_scale { self.scale } else { default };
        Self { scale, ..self.clone() }
    }

    /// How finely meshes are drawn.
    pub fn detail(&self) -> anyhow::Result<Detail> {
        let is_full = self.full_detail || self.backend == Backend::GpuDriven;
        let default = if is_full { Detail::FULL } else { Detail::default() };
        Ok(self.tradeoff()?.detail(default))
    }

    /// How far the camera flies, 0 to 1.
    pub fn flight_end(&self) -> anyhow::Result<f32> {
        let Some((key, value)) = self.dials.iter().rev().find(|(key, _)| key == FLIGHT_END) else {
            return Ok(1.0);
        };
        match value.parse() {
            Ok(x) if (0.0..=1.0).contains(&x) => Ok(x),
            _ => bail!("cannot set {key}={value}: it takes a number from 0 to 1"),
        }
    }

    /// Whether figures are wanted rather than a window.
    pub fn is_headless(&self) -> bool {
        let is_driven = self.backend == Backend::GpuDriven;
        self.headless || self.oracle || self.out.is_some() || self.record.is_some() || is_driven
    }

    /// The rectangle that is drawn.
    pub fn viewport(&self) -> Viewport {
        Viewport::new(self.size.0, self.size.1)
    }

    /// The folder that the run writes to.
    pub fn out(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| PathBuf::from("out").join(self.example))
    }

    /// Refuses what cannot be done, before a world is built.
    fn check(&self) -> anyhow::Result<()> {
        if self.backend == Backend::GpuDriven {
            self.check_gpu_driven()?;
        } else {
            self.check_dials(&[&[self.policy.as_str()], self.policies].concat())?;
        }
        self.tree()?;
        self.detail()?;
        self.flight_end()?;
        Ok(())
    }

    /// Refuses what a device that culls by itself cannot do: nobody on the host asks or is answered.
    fn check_gpu_driven(&self) -> anyhow::Result<()> {
        gpu_driven::test_of(&self.policy)?;
        // The policy's own are for the host.
        self.check_dials(&[])?;
        if self.record.is_some() {
            bail!("--record has no meaning with --backend gpu-driven: no question is asked, no answer comes");
        }
        if self.audit.is_some() {
            bail!("--audit has no meaning with --backend gpu-driven: use --oracle, which checks every frame");
        }
        if self.detail()? != Detail::FULL {
            bail!(
                "--backend gpu-driven draws every mesh with all its triangles: max_error_px has no meaning"
            );
        }
        Ok(())
    }
}

/// A dial of the examples themselves.
pub(super) const FLIGHT_END: &str = "flight_end";

/// A policy with its default dials.
pub(super) fn by_name(name: &str, gate: bool) -> anyhow::Result<Box<dyn Policy>> {
    let policy = policy::by_name(name)?;
    // This one weighs by itself whether to ask.
    let weighs = policy.name() == "auto";
    Ok(if gate && !weighs { Box::new(Gated::new(policy)) } else { policy })
}

/// Whether one of the dials has that name.
pub(super) fn has(dials: &[tercet::Dial], key: &str) -> bool {
    dials.iter().any(|dial| dial.key == key)
}

fn is_tree_dial(key: &str) -> bool {
    key == "preset" || has(&TreeConfig::default().dials(), key)
}

fn is_own_dial(key: &str) -> bool {
    key == FLIGHT_END || key == "tradeoff" || has(&Tradeoff::EXACT.dials(), key)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flags(line: &str) -> anyhow::Result<Flags> {
        let flags = Flags::try_parse_from(std::iter::once("example").chain(line.split_whitespace()))?;
        flags.check()?;
        Ok(flags)
    }

    #[test]
    fn the_command_is_well_formed() {
        let command = help::command::<NoMore>(&Program::demo("example", "What it shows."));
        assert_eq!(command.get_about().map(ToString::to_string).as_deref(), Some("What it shows."));
        command.debug_assert();
    }

    #[test]
    fn dials_reach_the_one_that_has_them() -> anyhow::Result<()> {
        let flags = flags("--set o_split=7 tight_boxes=never --set max_error_px=2.5")?;
        assert_eq!(flags.tree()?.o_split, 7);
        assert_eq!(flags.detail()?.max_error_px, 2.5);
        Ok(())
    }

    #[test]
    fn what_cannot_be_done_is_refused() {
        for line in [
            "--backend nonsense",
            "--policy nonsense",
            "--set nonsense=1",
            "--set o_split=many",
            "--set o_split",
            "--set max_error_px=-1",
            "--set flight_end=1.5",
            "--size 0x720",
            "--size 1280",
            "--size 16385x1",
            "--scale 0",
            "--frames 0",
            "--audit 0",
            "--objects -1",
            "--backend gpu-driven --policy dual-query",
            "--backend gpu-driven --policy roc --set by_geometry=false",
            "--backend gpu-driven --policy roc --record run.tercet",
            "--backend gpu-driven --policy roc --audit 4",
            "--backend gpu-driven --policy roc --set max_error_px=1",
        ] {
            assert!(flags(line).is_err(), "{line} was taken");
        }
        assert!(flags("--backend software --size 1x16384 --objects 0 --static --oracle").is_ok());
        assert!(flags("--backend gpu-driven --policy hroc --oracle").is_ok());
    }

    #[test]
    fn a_device_that_culls_by_itself_draws_in_full_and_by_rays_has_a_fine_tree() -> anyhow::Result<()> {
        let leaf = |line| flags(line)?.tree().map(|tree| tree.unasked_leaf);
        let default = TreeConfig::default();
        assert_eq!(leaf("--backend gpu-driven --policy hi-z")?, default.unasked_leaf);
        assert_eq!(leaf("--backend gpu-driven --policy hroc")?, default.bulk_leaf);
        assert_eq!(leaf("--backend gpu-driven --policy hroc --set unasked_leaf=9")?, 9);
        assert_eq!(flags("--backend gpu-driven --policy roc")?.detail()?, Detail::FULL);
        Ok(())
    }
}
