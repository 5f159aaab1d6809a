//! The exact visible set of a frame, as the app draws it.
//!
//! The app's own closure is run for each object by itself, so that every draw call has an owner.
//! The first pass rasterises all that hides; the second rasterises everything again and finds the
//! objects with at least one sample that is not behind the finished depth (*EVS*; ties at equal
//! depth all count). Objects that hide nothing (transparent ones) are tested against the finished
//! depth of those that do. The truth is that of the levels of detail drawn, and does not depend on
//! any bounds: they only order the first pass, from near to far, so that the hierarchy can skip
//! draw calls that change nothing.

use rayon::prelude::*;

use super::software::{DrawCall, Snapshot, SoftwarePass, SoftwareQueries, VisibilityImage};
use super::{Answer, QueryBackend, Ticket, Wait, Want};
use crate::Error;
use crate::geom::{Aabb, Frustum, Question, View};
use crate::scene::{ObjectRef, ObjectSet, Scene};

/// An object that may be visible.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// What the draw closure is handed.
    pub object: ObjectRef,
    /// The box that questions are about; None for an object that is drawn always.
    pub bounds: Option<Aabb>,
    /// Whether it hides nothing.
    pub not_occluder: bool,
}

/// What a frame really shows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Truth {
    /// The objects that own at least one sample of the finished frame.
    pub exact: ObjectSet,
    /// The objects whose own box would be found visible in the finished depth: the least that any
    /// method which asks about boxes can draw.
    pub box_visible: ObjectSet,
    /// The objects whose box meets the frustum.
    pub in_frustum: ObjectSet,
}

/// What a pixel of the finished frame shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Whose it is.
    pub object: ObjectRef,
    /// The draw call, an index into [`Oracle::calls`].
    pub call: u32,
    /// The corners of the triangle in world space.
    pub corners: [glam::Vec3; 3],
    /// See [`DepthDirection::nearness`](crate::geom::DepthDirection::nearness).
    pub nearness: f32,
}

impl Surface {
    /// The unit normal of the facet in world space, on either side; zero if it has no area.
    pub fn normal(&self) -> glam::Vec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a).normalize_or_zero()
    }
}

/// Finds the truth about frames. It keeps the last one, for pictures and comparisons.
#[derive(Debug, Default)]
pub struct Oracle {
    queries: SoftwareQueries,
    pass: SoftwarePass,
    /// Candidates from near to far: a distance in some measure, and an index.
    order: Vec<(f32, u32)>,
    /// Whose each draw call is.
    owners: Vec<ObjectRef>,
    /// The depth of what hides, while the frame's own holds more.
    opaque: Snapshot,
    image: VisibilityImage,
    questions: Vec<Question>,
}

impl Oracle {
    /// An oracle that has seen nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Looks at a frame of a scene with everything in it: `draw` is called once an object.
    ///
    /// # Errors
    /// [`Error::PendingEdits`] if the scene was edited since its last update.
    pub fn look(
        &mut self,
        scene: &Scene,
        view: &View,
        draw: impl FnMut(&mut SoftwarePass, &[ObjectRef]),
    ) -> Result<Truth, Error> {
        scene.check_updated()?;
        let candidates: Vec<Candidate> = scene
            .objects()
            .map(|o| Candidate { object: o.object, bounds: o.bounds, not_occluder: o.traits.not_occluder })
            .collect();
        self.look_at(view, &candidates, draw)
    }

    /// The same for a list of objects: `draw` is called once for each, with that one alone, from
    /// near to far, and those that hide nothing last.
    ///
    /// # Errors
    /// None yet; drawing on a device could fail.
    pub fn look_at(
        &mut self,
        view: &View,
        candidates: &[Candidate],
        mut draw: impl FnMut(&mut SoftwarePass, &[ObjectRef]),
    ) -> Result<Truth, Error> {
        self.pass.clear();
        self.owners.clear();
        sort_by_distance(view, candidates, &mut self.order);
        let order = &self.order;
        let mut record = |not_occluder: bool| {
            let sorted = order.iter().map(|&(_, i)| &candidates[i as usize]);
            for candidate in sorted.filter(|c| c.not_occluder == not_occluder) {
                draw(&mut self.pass, &[candidate.object]);
                self.owners.resize(self.pass.calls().len(), candidate.object);
            }
            self.pass.calls().len()
        };
        let occluders = record(false);
        let all = record(true);
        let calls = self.pass.calls();

        self.queries.begin(view)?;
        self.queries.rasterise(view, &calls[..occluders]);
        let mut truth = Truth::default();
        self.ask_boxes(view, candidates, &mut truth)?;

        let calls = self.pass.calls();
        self.queries.keep(&mut self.opaque);
        if all > occluders {
            self.queries.rasterise(view, &calls[occluders..]);
        }
        let seen = self.queries.look(view, calls, &self.opaque, &mut self.image);
        for (call, owner) in self.owners.iter().enumerate() {
            if seen[call / 64] & (1 << (call % 64)) != 0 {
                truth.exact.insert(owner.id);
            }
        }
        self.queries.end()?;
        Ok(truth)
    }

    /// What the last frame shows: of each pixel the draw call, the triangle and the nearness.
    pub fn image(&self) -> &VisibilityImage {
        &self.image
    }

    /// The draw calls that [`Oracle::image`] speaks of.
    pub fn calls(&self) -> &[DrawCall] {
        self.pass.calls()
    }

    /// Whose a draw call is.
    pub fn owner(&self, call: u32) -> ObjectRef {
        self.owners[call as usize]
    }

    /// What a pixel of the last frame shows; None for the background.
    pub fn surface(&self, x: u32, y: u32) -> Option<Surface> {
        let pixel = y as usize * self.image.width as usize + x as usize;
        let call = self.image.call[pixel];
        if call == VisibilityImage::NOTHING {
            return None;
        }
        let drawn = &self.pass.calls()[call as usize];
        let level = drawn.geometry();
        let first = 3 * self.image.triangle[pixel] as usize;
        let corner = |k: usize| {
            let position = level.positions[level.indices[first + k] as usize];
            drawn.world_from_object.transform_point3(position)
        };
        Some(Surface {
            object: self.owner(call),
            call,
            corners: [corner(0), corner(1), corner(2)],
            nearness: self.image.nearness[pixel],
        })
    }

    /// How many samples of a frame drawn with culling differ in nearness from the last frame seen
    /// here, where everything was drawn. All of them if the sizes differ.
    pub fn wrong_pixels(&self, shown: &SoftwareQueries) -> u64 {
        let (want, got) = (self.queries.depth(), shown.depth());
        if (want.width(), want.height()) != (got.width(), got.height()) {
            return u64::from(want.width()) * u64::from(want.height());
        }
        (0..want.height())
            .into_par_iter()
            .map(|y| want.row(y).zip(got.row(y)).filter(|(a, b)| a != b).count() as u64)
            .sum()
    }

    /// Finds out what asking about each box alone would have said.
    fn ask_boxes(&mut self, view: &View, candidates: &[Candidate], truth: &mut Truth) -> Result<(), Error> {
        let frustum = Frustum::new(view);
        self.questions.clear();
        self.questions.par_extend(
            candidates
                .par_iter()
                .map(|c| c.bounds.map_or(Question::Visible, |bounds| Question::new(&bounds, view))),
        );
        for (i, (candidate, question)) in candidates.iter().zip(&self.questions).enumerate() {
            if candidate.bounds.is_none_or(|bounds| frustum.intersects(&bounds)) {
                truth.in_frustum.insert(candidate.object.id);
            }
            match question {
                Question::Outside => {}
                Question::Visible => {
                    truth.box_visible.insert(candidate.object.id);
                }
                Question::Ask(proxy) => self.queries.ask(Ticket(i as u32), &[*proxy], Want::Any)?,
            }
        }
        self.queries.answers(Wait::Block, |ticket, answer| {
            if !matches!(answer, Answer::Any(false)) {
                truth.box_visible.insert(candidates[ticket.0 as usize].object.id);
            }
        })
    }
}

/// Orders candidates roughly from near to far. It saves time and decides nothing.
fn sort_by_distance(view: &View, candidates: &[Candidate], order: &mut Vec<(f32, u32)>) {
    let eye = view.eye();
    let distance = |bounds: &Aabb| match eye.w {
        0.0 => -eye.truncate().dot(bounds.center()),
        _ => bounds.distance_squared(eye.truncate()),
    };
    order.clear();
    order.extend(
        candidates
            .iter()
            .enumerate()
            .map(|(i, c)| (c.bounds.as_ref().map_or(f32::NEG_INFINITY, distance), i as u32)),
    );
    order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
}
