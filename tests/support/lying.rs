//! A backend that culls what is visible, for suites to find out.

use tercet::Error;
use tercet::geom::{Proxy, View};
use tercet::query::software::{SoftwarePass, SoftwareQueries};
use tercet::query::{Answer, QueryBackend, Sweep, Ticket, Wait, Want};
use tercet::scene::ObjectRef;

use super::Shown;

/// A backend that lies a little: a box of which few samples are visible is called hidden. The
/// suite must find that out, or it proves nothing.
pub struct Lying(pub SoftwareQueries);

impl Shown for Lying {
    fn shown(&self) -> &SoftwareQueries {
        &self.0
    }
}

impl QueryBackend for Lying {
    type Pass = SoftwarePass;

    fn name(&self) -> &'static str {
        "lying"
    }

    fn can_block(&self) -> bool {
        true
    }

    fn begin(&mut self, view: &View) -> Result<(), Error> {
        self.0.begin(view)
    }

    fn draw(&mut self, record: impl FnOnce(&mut SoftwarePass)) -> Result<(), Error> {
        self.0.draw(record)
    }

    fn ask(&mut self, ticket: Ticket, boxes: &[Proxy], want: Want) -> Result<(), Error> {
        self.0.ask(ticket, boxes, want)
    }

    fn draw_objects(
        &mut self,
        objects: &[ObjectRef],
        record: impl FnMut(&mut SoftwarePass, &[ObjectRef]),
    ) -> Result<(), Error> {
        self.0.draw_objects(objects, record)
    }

    fn sweep(&mut self, ticket: Ticket, sweep: &Sweep<'_>) -> Result<(), Error> {
        self.0.sweep(ticket, sweep)
    }

    fn answers(&mut self, wait: Wait, mut deliver: impl FnMut(Ticket, Answer<'_>)) -> Result<(), Error> {
        self.0.answers(wait, |ticket, answer| match answer {
            Answer::Dual { visible, total } if visible < 20 => {
                deliver(ticket, Answer::Dual { visible: 0, total });
            }
            other => deliver(ticket, other),
        })
    }

    fn end(&mut self) -> Result<(), Error> {
        self.0.end()
    }
}
