//! Speed against accuracy, in one value.

use std::time::Duration;

use crate::Error;
use crate::dial::{self, Dial, unknown};
use crate::draw::Detail;
use crate::tree::{TIGHT_BOXES, TightBoxes, TreeConfig};

/// How much may be given up for speed, in one view. The default gives up nothing.
///
/// Three dials may lose an object that owns samples: [`Tradeoff::visible_pixels`],
/// [`Tradeoff::resolution_divisor`] and [`Tradeoff::latency`]. The others trade time spent on asking
/// for objects drawn in vain, and lose nothing at any setting; [`Tradeoff::max_error_px`] draws
/// everything, more coarsely. A dial is a permission: a policy or a backend that has no use for it
/// stays exact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub struct Tradeoff {
    /// Pixels of the view that may be visible of a box that is culled all the same; 0 is exact. It
    /// holds for questions that count; an [`Any`](crate::query::Want::Any) question and a sweep are
    /// always exact.
    pub visible_pixels: u32,
    /// Frames for which what was found visible goes unasked (CHC and CHC++: *n_av*); None leaves it to
    /// the policy.
    pub n_av: Option<u32>,
    /// How often a hierarchy-updating policy leaves what was visible unasked (Bittner and Havran 2001,
    /// *p_skip*), 0 to 1; None leaves it to the policy.
    pub p_skip: Option<f32>,
    /// Where depth belongs to the backend (software), how many times fewer columns and rows it has than
    /// the view; 0 and 1 are exact. What shows only between the coarse samples is lost.
    pub resolution_divisor: u32,
    /// Whose depth questions are put to.
    pub latency: Latency,
    /// Whether boxes of late questions are enlarged by the way that the eye has gone since, which loses
    /// less.
    pub swept: bool,
    /// What asking may take.
    pub budget: Budget,
    /// When questions use tight boxes; None leaves it to the scene's tree. It holds for all views of a
    /// scene: [`Tradeoff::tree`] applies it where the scene is made.
    pub tight_boxes: Option<TightBoxes>,
    /// How far a drawn surface may lie from the true one, pixels; None leaves it to the app.
    /// [`Tradeoff::detail`] applies it where the app draws.
    pub max_error_px: Option<f32>,
}

/// Whose depth questions are put to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub enum Latency {
    /// That of the frame itself, as far as it is drawn: exact.
    #[default]
    SameFrame,
    /// The finished depth of so many frames ago, 1 to [`Latency::MOST`], seen with that frame's view: none of
    /// this frame's draws is waited for. The backend counts its own frames, so it must be this view's alone.
    /// It is approximate by nature: an occluder may have left since, and the camera
    /// may have moved. What was not wholly in that view is drawn. Backends that keep no depth answer as
    /// ever; sweeps do, too.
    Late(u32),
}

impl Latency {
    /// The oldest depth that is kept, in frames.
    pub const MOST: u32 = 8;

    /// How many frames ago.
    pub fn frames(self) -> u32 {
        match self {
            Self::SameFrame => 0,
            Self::Late(frames) => frames.min(Self::MOST),
        }
    }
}

/// What asking may take in a frame; None has no limit. The question that goes beyond it is not asked,
/// nor is any after it: what they were about is drawn. Nothing is lost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub struct Budget {
    /// Questions.
    pub queries: Option<u32>,
    /// Pixels of the view in the rectangles around the boxes asked about; those of a sweep are not counted.
    pub box_pixels: Option<u64>,
    /// Since the frame began.
    pub time: Option<Duration>,
}

/// Names of presets, and what they stand for.
pub const PRESETS: &[(&str, Tradeoff)] =
    &[("exact", Tradeoff::EXACT), ("balanced", Tradeoff::BALANCED), ("fast", Tradeoff::FAST)];

impl Tradeoff {
    /// No object that owns a sample is ever culled, whatever the policy.
    pub const EXACT: Self = Self {
        visible_pixels: 0,
        n_av: None,
        p_skip: None,
        resolution_divisor: 1,
        latency: Latency::SameFrame,
        swept: false,
        budget: Budget { queries: None, box_pixels: None, time: None },
        tight_boxes: None,
        max_error_px: None,
    };

    /// Half the columns and rows: errors that are hard to see. Measured in five worlds on the CPU: 0.55 of
    /// the time, 0.04 % of the pixels wrong where it is worst (docs/measurements/tradeoff.md). The threshold,
    /// less than one coarse pixel, is for backends whose depth is the app's.
    pub const BALANCED: Self = Self { visible_pixels: 3, resolution_divisor: 2, ..Self::EXACT };

    /// A quarter of the columns and rows: errors that can be seen where one looks for them. Measured in the
    /// same way: 0.39 of the time, 0.1 % of the pixels.
    pub const FAST: Self = Self { visible_pixels: 15, resolution_divisor: 4, ..Self::EXACT };

    /// The preset of a name.
    ///
    /// # Errors
    /// [`Error::Dial`], naming those there are.
    pub fn by_name(name: &str) -> Result<Self, Error> {
        dial::choice("tradeoff", name, PRESETS)
    }

    /// Whether it can lose nothing.
    pub const fn is_exact(&self) -> bool {
        let depth_is_now = matches!(self.latency, Latency::SameFrame | Latency::Late(0));
        self.visible_pixels == 0 && self.resolution_divisor <= 1 && depth_is_now
    }

    /// A tree's dials with what is set here.
    #[must_use]
    pub fn tree(&self, tree: TreeConfig) -> TreeConfig {
        TreeConfig { tight_boxes: self.tight_boxes.unwrap_or(tree.tight_boxes), ..tree }
    }

    /// How finely meshes are drawn with what is set here.
    #[must_use]
    pub fn detail(&self, detail: Detail) -> Detail {
        Detail { max_error_px: self.max_error_px.unwrap_or(detail.max_error_px) }
    }

    /// The same for a depth with so many times fewer columns and rows: pixels are its own.
    pub(crate) fn at_resolution(&self, divisor: u32) -> Self {
        let area = divisor.saturating_mul(divisor).max(1);
        let box_pixels = self.budget.box_pixels.map(|pixels| pixels / u64::from(area));
        let budget = Budget { box_pixels, ..self.budget };
        Self { visible_pixels: self.visible_pixels / area, budget, ..*self }
    }

    /// Its dials by name, with what they do; `none` leaves one to whoever else sets it.
    pub fn dials(&self) -> Vec<Dial> {
        let budget = &self.budget;
        vec![
            Dial::new(
                "visible_pixels",
                self.visible_pixels,
                "pixels of a culled box that may be visible; 0: exact",
            ),
            Dial::new(
                "resolution_divisor",
                self.resolution_divisor.max(1),
                "how many times coarser the software backend's depth is than the view; 1: exact",
            ),
            Dial::new(
                "latency",
                self.latency.frames(),
                "questions see the depth of so many frames ago; 0: exact",
            ),
            Dial::new("swept", self.swept, "with latency: boxes enlarged by the way that the eye has gone"),
            Dial::new("query_budget", text(&budget.queries), "questions a frame, at most; the rest is drawn"),
            Dial::new(
                "pixel_budget",
                text(&budget.box_pixels),
                "pixels of boxes asked about a frame, at most",
            ),
            Dial::new(
                "ms_budget",
                text(&budget.time.map(|time| time.as_secs_f64() * 1e3)),
                "milliseconds after which a frame asks nothing more",
            ),
            Dial::new(
                "n_av",
                text(&self.n_av),
                "frames for which what was visible goes unasked (chc, chc++)",
            ),
            Dial::new(
                "p_skip",
                text(&self.p_skip),
                "how often what was visible goes unasked (hierarchy-d), 0 to 1",
            ),
            Dial::new(
                "tight_boxes",
                self.tight_boxes.map_or(NONE, |mode| dial::choice_name(mode, TIGHT_BOXES)).to_owned(),
                "when questions use tight boxes: none, never, settled, always",
            ),
            Dial::new("max_error_px", text(&self.max_error_px), "how far a coarser mesh may lie off, pixels"),
        ]
    }

    /// Sets a dial by name; `none` unsets one that may be unset.
    ///
    /// # Errors
    /// [`Error::Dial`] for a name or value that does not exist, naming those that do.
    pub fn set(&mut self, key: &str, value: &str) -> Result<(), Error> {
        match key {
            "visible_pixels" => self.visible_pixels = dial::number(key, value, 0..=u32::MAX)?,
            "resolution_divisor" => self.resolution_divisor = dial::number(key, value, 1..=64)?,
            "latency" => {
                self.latency = match dial::number(key, value, 0..=Latency::MOST)? {
                    0 => Latency::SameFrame,
                    frames => Latency::Late(frames),
                }
            }
            "swept" => self.swept = dial::switch(key, value)?,
            "query_budget" => self.budget.queries = optional(key, value, 0..=u32::MAX)?,
            "pixel_budget" => self.budget.box_pixels = optional(key, value, 0..=u64::MAX)?,
            "ms_budget" => {
                let ms = optional(key, value, 0.0..=1e6)?;
                self.budget.time = ms.map(|ms: f64| Duration::from_secs_f64(ms * 1e-3));
            }
            "n_av" => self.n_av = optional(key, value, 0..=1000)?,
            "p_skip" => self.p_skip = optional(key, value, 0.0..=1.0)?,
            "tight_boxes" if value.trim() == NONE => self.tight_boxes = None,
            "tight_boxes" => self.tight_boxes = Some(dial::choice(key, value, TIGHT_BOXES)?),
            "max_error_px" => self.max_error_px = optional(key, value, 0.0..=1e6)?,
            _ => return Err(unknown(key, value, &self.dials())),
        }
        Ok(())
    }
}

/// What stands for an optional dial that is not set.
const NONE: &str = "none";

fn text<T: ToString>(value: &Option<T>) -> String {
    value.as_ref().map_or(NONE.to_owned(), T::to_string)
}

fn optional<T>(key: &str, value: &str, range: std::ops::RangeInclusive<T>) -> Result<Option<T>, Error>
where
    T: std::str::FromStr + PartialOrd + std::fmt::Display,
{
    if value.trim() == NONE { Ok(None) } else { dial::number(key, value, range).map(Some) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_dial_is_set_to_what_it_shows_and_to_something_else() {
        let others = [
            ("visible_pixels", "7"),
            ("resolution_divisor", "3"),
            ("latency", "2"),
            ("swept", "true"),
            ("query_budget", "100"),
            ("pixel_budget", "5000"),
            ("ms_budget", "2.5"),
            ("n_av", "4"),
            ("p_skip", "0.25"),
            ("tight_boxes", "settled"),
            ("max_error_px", "1.5"),
        ];
        let mut tradeoff = Tradeoff::EXACT;
        assert_eq!(others.map(|(key, _)| key).to_vec(), keys(&tradeoff));
        for (key, value) in others {
            tradeoff.set(key, value).expect("it takes this");
            let shown = tradeoff.dials().into_iter().find(|dial| dial.key == key).expect("it is listed");
            assert_eq!(shown.value, value, "{key}");
        }
        let mut copy = Tradeoff::EXACT;
        for dial in tradeoff.dials() {
            copy.set(dial.key, &dial.value).expect("what is shown can be set");
        }
        assert_eq!(copy, tradeoff);
        for key in
            ["query_budget", "pixel_budget", "ms_budget", "n_av", "p_skip", "tight_boxes", "max_error_px"]
        {
            copy.set(key, "none").expect("it may be unset");
        }
        assert_eq!(
            copy,
            Tradeoff {
                visible_pixels: 7,
                resolution_divisor: 3,
                latency: Latency::Late(2),
                swept: true,
                ..Tradeoff::EXACT
            }
        );
    }

    #[test]
    fn what_does_not_exist_is_refused() {
        let mut tradeoff = Tradeoff::EXACT;
        for (key, value) in [("nothing", "1"), ("latency", "9"), ("resolution_divisor", "0")] {
            assert!(tradeoff.set(key, value).is_err(), "{key}={value}");
        }
        assert_eq!(tradeoff, Tradeoff::EXACT);
        assert!(Tradeoff::by_name("reckless").is_err());
    }

    #[test]
    fn exact_is_exact_and_the_default_and_the_other_presets_are_not() {
        for (name, preset) in PRESETS {
            assert_eq!(Tradeoff::by_name(name).expect("it is listed"), *preset);
            assert_eq!(preset.is_exact(), *name == "exact");
        }
        assert!(Tradeoff::default().is_exact());
    }

    fn keys(tradeoff: &Tradeoff) -> Vec<&'static str> {
        tradeoff.dials().iter().map(|dial| dial.key).collect()
    }
}
