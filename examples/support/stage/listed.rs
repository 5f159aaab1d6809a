//! What stands where the policy is when the device culls by itself.

use tercet::policy::{Action, Context, Policy};
use tercet::query::{Answer, SweepTest, Ticket};
use tercet::scene::ObjectId;

use super::gpu_driven;

/// Draws what it is told that the device drew, and asks nothing: so whatever looks at a culler, tables,
/// pictures and the oracle, sees the frame as it was.
#[derive(Clone, Debug)]
pub struct Listed {
    test: SweepTest,
    drawn: Vec<ObjectId>,
    done: bool,
}

impl Listed {
    /// The device tests in this way.
    pub fn new(test: SweepTest) -> Self {
        Self { test, drawn: Vec::new(), done: true }
    }
}

impl Policy for Listed {
    fn name(&self) -> &'static str {
        gpu_driven::name_of(self.test)
    }

    fn asks(&self) -> bool {
        false
    }

    fn begin(&mut self, _cx: &Context<'_>) {
        self.done = false;
    }

    fn next(&mut self, _cx: &Context<'_>) -> Action<'_> {
        if std::mem::replace(&mut self.done, true) { Action::Done } else { Action::DrawObjects(&self.drawn) }
    }

    fn answer(&mut self, _cx: &Context<'_>, _ticket: Ticket, _answer: Answer<'_>) {}

    fn give_recorded(&mut self, drawn: &[ObjectId]) {
        self.drawn.clear();
        self.drawn.extend_from_slice(drawn);
    }
}
