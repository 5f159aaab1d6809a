//! Error accounting while running: every n-th frame is checked against the oracle.
//!
//! ```no_run
//! # use tercet::{Culler, Error, audit::Auditor, geom::View, policy::DualQuery, scene::Scene};
//! # fn frame(auditor: &mut Auditor, scene: &mut Scene, view: &View, eye: &mut Culler<DualQuery>) -> Result<(), Error> {
//! // After `eye.frame(…)`, and before anything is edited or adapted:
//! if let Some(audit) = auditor.check(scene, view, eye, |pass, objects| { /* as for the software backend */ })? {
//!     audit.lost.iter().for_each(|lost| println!("{lost}"));
//!     println!("{}", auditor.estimate());
//! }
//! scene.adapt([eye]);
//! # Ok(())
//! # }
//! ```
//!
//! | file | |
//! |---|---|
//! | `report` | what a checked frame lost |
//! | `blame` | why, and which dial is to blame: the evidence, and its limits |
//! | `estimate` | what the checked frames say of all frames |

mod blame;
mod estimate;
mod report;

pub use blame::Blame;
pub use estimate::{Estimate, Share};
pub use report::{Audit, FalseCull};

use crate::geom::{Aabb, Proxy, Question, View};
use crate::policy::{Policy, Samples};
use crate::query::oracle::{Oracle, Truth};
use crate::query::software::{SoftwarePass, SoftwareQueries, VisibilityImage};
use crate::query::{Answer, QueryBackend, Ticket, Wait, Want};
use crate::scene::{ObjectRef, ObjectSet, Scene};
use crate::{Culler, Error};
use blame::{Evidence, Recount};
use estimate::Tally;

/// Checks every n-th frame of one view. A frame that is not due costs a comparison; one that is, an
/// [`Oracle`] look at the whole scene on the CPU, whichever backend culled.
#[derive(Debug)]
pub struct Auditor {
    every: u32,
    /// Frames shown so far.
    frames: u64,
    /// Frames since the last one that was checked.
    waited: u32,
    oracle: Oracle,
    /// Draws what the culler drew, and answers again.
    queries: SoftwareQueries,
    drawn: ObjectSet,
    suspects: Suspects,
    audit: Audit,
    tally: Tally,
}

impl Auditor {
    /// Checks the n-th frame that it is shown, the 2n-th, and so on; 0 counts as 1.
    pub fn new(every: u32) -> Self {
        Self {
            every: every.max(1),
            frames: 0,
            waited: 0,
            oracle: Oracle::new(),
            queries: SoftwareQueries::new(),
            drawn: ObjectSet::default(),
            suspects: Suspects::default(),
            audit: Audit::default(),
            tally: Tally::default(),
        }
    }

    /// Shows it the frame that `eye` has just drawn. None if it is not due.
    ///
    /// To be called with that frame's view and [`Culler::tradeoff`], before the scene is edited or
    /// adapted: later it may not be known any more why an object was culled, and what has moved
    /// since would be called lost. `draw` is called once an object, and two or three times with what was drawn.
    ///
    /// O(1), and no allocation, in a frame that is not due.
    ///
    /// # Errors
    /// [`Error::PendingEdits`] if the scene was edited since its last update.
    pub fn check<P: Policy>(
        &mut self,
        scene: &Scene,
        view: &View,
        eye: &Culler<P>,
        mut draw: impl FnMut(&mut SoftwarePass, &[ObjectRef]),
    ) -> Result<Option<&Audit>, Error> {
        self.frames += 1;
        self.waited += 1;
        if self.waited < self.every {
            return Ok(None);
        }
        self.waited = 0;
        let truth = self.oracle.look(scene, view, &mut draw)?;
        self.find(scene, view, eye, &truth);
        self.measure();
        self.ask_again(scene, view, eye, draw)?;
        self.judge(eye);
        self.tally.add(&self.audit);
        Ok(Some(&self.audit))
    }

    /// Every how many frames one is checked.
    pub fn every(&self) -> u32 {
        self.every
    }

    /// Changes that from now on; 0 counts as 1.
    pub fn set_every(&mut self, every: u32) {
        self.every = every.max(1);
    }

    /// The last frame that was checked.
    pub fn last(&self) -> Option<&Audit> {
        (self.audit.frame > 0).then_some(&self.audit)
    }

    /// What the checked frames say of all frames. It assumes that what is checked is like what is not:
    /// start anew after a dial was turned.
    pub fn estimate(&self) -> Estimate {
        self.tally.estimate()
    }

    /// False culls in all checked frames, by what is to blame.
    pub fn blamed(&self) -> impl Iterator<Item = (Blame, u64)> {
        self.tally.blamed()
    }

    /// Finds out what was lost.
    fn find<P: Policy>(&mut self, scene: &Scene, view: &View, eye: &Culler<P>, truth: &Truth) {
        self.drawn.clear();
        for object in eye.visible() {
            self.drawn.insert(object.id);
        }
        let viewport = view.viewport();
        let mut lost = std::mem::take(&mut self.audit.lost);
        lost.clear();
        self.suspects.clear(scene.slot_bound());
        let mut culled = 0;
        for object in scene.objects() {
            let id = object.object.id;
            if self.drawn.contains(id) {
                continue;
            }
            culled += u32::from(truth.in_frustum.contains(id));
            if !truth.exact.contains(id) {
                continue;
            }
            self.suspects.add(id.slot(), object.bounds, view);
            lost.push(FalseCull {
                object: object.object,
                bounds: object.bounds,
                samples: 0,
                share: 0.0,
                why: eye.why(scene, view, id),
                recount: None,
                blame: Blame::Defect,
            });
        }
        self.audit = Audit {
            frame: self.frames,
            pixels: u64::from(viewport.width) * u64::from(viewport.height),
            wrong_pixels: 0,
            visible: truth.exact.len() as u32,
            drawn: eye.visible().len() as u32,
            culled,
            lost,
        };
    }

    /// Counts what the lost objects own of the finished frame, and looks whether it lies in their boxes.
    /// O(pixels) if something was lost.
    fn measure(&mut self) {
        if self.audit.lost.is_empty() {
            return;
        }
        let (oracle, image) = (&self.oracle, self.oracle.image());
        for (at, &call) in image.call.iter().enumerate() {
            if call == VisibilityImage::NOTHING {
                continue;
            }
            let Some(suspect) = self.suspects.at(oracle.owner(call).id.slot()) else { continue };
            let (lost, suspect) = (&mut self.audit.lost[suspect], &mut self.suspects.all[suspect]);
            lost.samples += 1;
            let (x, y) = (at as u32 % image.width, at as u32 / image.width);
            if !suspect.leaves_box && !suspect.covers(x, y, image.nearness[at]) {
                let corners = oracle.surface(x, y).map(|surface| surface.corners);
                let holds = |bounds: Aabb| corners.iter().flatten().all(|&p| bounds.contains_point(p));
                suspect.leaves_box = lost.bounds.is_some_and(|bounds| !holds(bounds));
            }
        }
        for lost in &mut self.audit.lost {
            lost.share = f64::from(lost.samples) / self.audit.pixels as f64;
        }
    }

    /// Draws what the culler drew, and asks about the boxes that decided when all that hides is there: at
    /// the resolution that the culler asked at, and at that of the view.
    fn ask_again<P: Policy>(
        &mut self,
        scene: &Scene,
        view: &View,
        eye: &Culler<P>,
        mut draw: impl FnMut(&mut SoftwarePass, &[ObjectRef]),
    ) -> Result<(), Error> {
        let hides = |object: &ObjectRef| scene.object(object.id).is_none_or(|o| !o.traits.not_occluder);
        // What hides nothing was drawn after all questions.
        let first_clear =
            eye.visible().iter().position(|object| !hides(object)).unwrap_or(eye.visible().len());
        let (occluders, clear) = eye.visible().split_at(first_clear);
        let decided = |lost: &FalseCull| lost.why.node().map(|node| node.bounds).or(lost.bounds);
        if eye.divisor() > 1 && !self.audit.lost.is_empty() {
            let counts = eye.tradeoff.at_resolution(eye.divisor()).visible_pixels > 0;
            let asked = |lost: &FalseCull| if counts { decided(lost) } else { lost.bounds };
            let coarse = view.coarsened(eye.divisor());
            let draw = |pass: &mut SoftwarePass| draw(pass, occluders);
            self.recount(&coarse, draw, asked, |suspect| suspect.coarse.insert(Recount::Visible))?;
        }
        self.recount(view, |pass| draw(pass, occluders), decided, |suspect| &mut suspect.full)?;
        self.queries.draw(|pass| draw(pass, clear))?;
        self.queries.end()?;
        self.audit.wrong_pixels = self.oracle.wrong_pixels(&self.queries);
        Ok(())
    }

    /// Draws what hides, and counts what is in sight of a box of each suspect.
    fn recount(
        &mut self,
        view: &View,
        draw: impl FnOnce(&mut SoftwarePass),
        which: impl Fn(&FalseCull) -> Option<Aabb>,
        count: impl Fn(&mut Suspect) -> &mut Recount,
    ) -> Result<(), Error> {
        let Self { queries, suspects, audit, .. } = self;
        queries.begin(view)?;
        queries.draw(draw)?;
        for (number, (lost, suspect)) in audit.lost.iter().zip(&mut suspects.all).enumerate() {
            match which(lost).map_or(Question::Visible, |bounds| Question::new(&bounds, view)) {
                Question::Outside => *count(suspect) = Recount::Outside,
                Question::Visible => *count(suspect) = Recount::Visible,
                Question::Ask(proxy) => queries.ask(Ticket(number as u32), &[proxy], Want::Dual)?,
            }
        }
        queries.answers(Wait::Block, |Ticket(number), answer| {
            if let Answer::Dual { visible, total } = answer {
                *count(&mut suspects.all[number as usize]) = Recount::Counted(Samples { visible, total });
            }
        })
    }

    fn judge<P: Policy>(&mut self, eye: &Culler<P>) {
        for (lost, suspect) in self.audit.lost.iter_mut().zip(&self.suspects.all) {
            let evidence = Evidence {
                why: lost.why,
                leaves_box: suspect.leaves_box,
                full: suspect.full,
                as_asked: suspect.coarse.unwrap_or(suspect.full),
                divisor: eye.divisor(),
                was_late: eye.was_late(),
            };
            lost.recount = suspect.full.samples();
            lost.blame = evidence.blame(&eye.tradeoff);
        }
    }
}

/// The lost objects of a frame, in the order of the report.
#[derive(Debug, Default)]
struct Suspects {
    all: Vec<Suspect>,
    /// By slot: which of them, counted from 1; 0 for an object that was not lost.
    number: Vec<u32>,
}

#[derive(Debug)]
struct Suspect {
    /// Its own box; None if that is no question.
    proxy: Option<Proxy>,
    /// Whether no part of the box owns a sample.
    is_outside: bool,
    leaves_box: bool,
    /// What is in sight of the box that decided.
    full: Recount,
    /// What is in sight of what was asked about, in a depth as coarse as the culler's, if that was coarse.
    coarse: Option<Recount>,
}

impl Suspects {
    fn clear(&mut self, slots: usize) {
        self.all.clear();
        self.number.clear();
        self.number.resize(slots, 0);
    }

    fn add(&mut self, slot: usize, bounds: Option<Aabb>, view: &View) {
        let (proxy, is_outside) = match bounds.map_or(Question::Visible, |b| Question::new(&b, view)) {
            Question::Ask(proxy) => (Some(proxy), false),
            question => (None, question == Question::Outside),
        };
        self.all.push(Suspect { proxy, is_outside, leaves_box: false, full: Recount::Visible, coarse: None });
        self.number[slot] = self.all.len() as u32;
    }

    fn at(&self, slot: usize) -> Option<usize> {
        (self.number[slot] as usize).checked_sub(1)
    }
}

impl Suspect {
    /// Whether geometry in its box could own this sample.
    fn covers(&self, x: u32, y: u32, nearness: f32) -> bool {
        match &self.proxy {
            Some(proxy) => {
                proxy.rect.contains(x, y) && proxy.covers(x, y) && proxy.nearness(x, y) >= nearness
            }
            None => !self.is_outside,
        }
    }
}
