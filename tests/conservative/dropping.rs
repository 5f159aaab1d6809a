//! A backend that drops a part of its sweeps, for suites to find out.

use tercet::Error;
use tercet::geom::{Proxy, View};
use tercet::query::software::{SoftwarePass, SoftwareQueries};
use tercet::query::{Answer, QueryBackend, Sweep, Ticket, Wait, Want};
use tercet::scene::ObjectRef;

use crate::run::Shown;

/// Says nothing of the first few groups of each sweep, of the first few loose objects, or of the first few that
/// are to be drawn if they show. Where that is none, it tries nobody.
pub struct Dropping {
    pub inner: SoftwareQueries,
    pub groups: usize,
    pub loose: usize,
    pub tried: usize,
}

impl Shown for Dropping {
    fn shown(&self) -> &SoftwareQueries {
        &self.inner
    }
}

impl QueryBackend for Dropping {
    type Pass = SoftwarePass;

    fn name(&self) -> &'static str {
        "dropping"
    }

    fn can_block(&self) -> bool {
        true
    }

    fn begin(&mut self, view: &View) -> Result<(), Error> {
        self.inner.begin(view)
    }

    fn draw(&mut self, record: impl FnOnce(&mut SoftwarePass)) -> Result<(), Error> {
        self.inner.draw(record)
    }

    fn draw_objects(
        &mut self,
        objects: &[ObjectRef],
        record: impl FnMut(&mut SoftwarePass, &[ObjectRef]),
    ) -> Result<(), Error> {
        self.inner.draw_objects(objects, record)
    }

    fn draws_if_seen(&self) -> bool {
        self.tried > 0 && self.inner.draws_if_seen()
    }

    fn draw_if_seen(
        &mut self,
        ticket: Ticket,
        objects: &[ObjectRef],
        record: impl FnMut(&mut SoftwarePass, &[ObjectRef]),
    ) -> Result<(), Error> {
        self.inner.draw_if_seen(ticket, &objects[self.tried.min(objects.len())..], record)
    }

    fn ask(&mut self, ticket: Ticket, boxes: &[Proxy], want: Want) -> Result<(), Error> {
        self.inner.ask(ticket, boxes, want)
    }

    fn sweep(&mut self, ticket: Ticket, sweep: &Sweep<'_>) -> Result<(), Error> {
        let groups = &sweep.groups[self.groups.min(sweep.groups.len())..];
        let loose = &sweep.loose[self.loose.min(sweep.loose.len())..];
        self.inner.sweep(ticket, &Sweep { groups, loose, ..*sweep })
    }

    fn answers(&mut self, wait: Wait, deliver: impl FnMut(Ticket, Answer<'_>)) -> Result<(), Error> {
        self.inner.answers(wait, deliver)
    }

    fn end(&mut self) -> Result<(), Error> {
        self.inner.end()
    }
}
