//! A backend that keeps what it was asked, and what it said.

use std::collections::HashMap;

use tercet::Error;
use tercet::geom::{Proxy, View};
use tercet::policy::Samples;
use tercet::query::software::{SoftwarePass, SoftwareQueries};
use tercet::query::{Answer, QueryBackend, Sweep, Ticket, Wait, Want};
use tercet::scene::ObjectRef;

/// Answers exactly, and keeps what it was asked in the frame and what it said.
#[derive(Default)]
pub(super) struct Listening {
    queries: SoftwareQueries,
    asked: HashMap<Ticket, Vec<Proxy>>,
    /// Each box that an answer spoke for; samples, where they were counted.
    pub(super) said: Vec<(Proxy, bool, Option<Samples>)>,
}

impl QueryBackend for Listening {
    type Pass = SoftwarePass;

    fn name(&self) -> &'static str {
        "listening"
    }

    fn can_block(&self) -> bool {
        true
    }

    fn begin(&mut self, view: &View) -> Result<(), Error> {
        self.asked.clear();
        self.said.clear();
        self.queries.begin(view)
    }

    fn draw(&mut self, record: impl FnOnce(&mut SoftwarePass)) -> Result<(), Error> {
        self.queries.draw(record)
    }

    fn ask(&mut self, ticket: Ticket, boxes: &[Proxy], want: Want) -> Result<(), Error> {
        self.asked.insert(ticket, boxes.to_vec());
        self.queries.ask(ticket, boxes, want)
    }

    fn draw_objects(
        &mut self,
        objects: &[ObjectRef],
        record: impl FnMut(&mut SoftwarePass, &[ObjectRef]),
    ) -> Result<(), Error> {
        self.queries.draw_objects(objects, record)
    }

    fn sweep(&mut self, ticket: Ticket, sweep: &Sweep<'_>) -> Result<(), Error> {
        // It says nothing of any node.
        self.asked.insert(ticket, vec![]);
        self.queries.sweep(ticket, sweep)
    }

    fn answers(&mut self, wait: Wait, mut deliver: impl FnMut(Ticket, Answer<'_>)) -> Result<(), Error> {
        self.queries.answers(wait, |ticket, answer| {
            let samples = match answer {
                Answer::Dual { visible, total } => Some(Samples { visible, total }),
                _ => None,
            };
            let (boxes, visible) = (&self.asked[&ticket], answer.is_visible(0));
            // Of several boxes, it says nothing unless all are hidden.
            if boxes.len() == 1 || !visible {
                self.said.extend(boxes.iter().map(|&proxy| (proxy, visible, samples)));
            }
            deliver(ticket, answer);
        })
    }

    fn end(&mut self) -> Result<(), Error> {
        self.queries.end()
    }
}
