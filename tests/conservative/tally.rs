//! A policy that is watched: one of its counters, summed over all frames.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use tercet::policy::{Action, Context, Policy};
use tercet::query::{Answer, Ticket};

/// Adds up a counter of another policy.
pub struct Tally<P> {
    pub inner: P,
    pub key: &'static str,
    pub sum: Arc<AtomicU32>,
}

impl<P: Policy> Policy for Tally<P> {
    fn name(&self) -> &'static str {
        self.inner.name()
    }

    fn needs_blocking(&self) -> bool {
        self.inner.needs_blocking()
    }

    fn begin(&mut self, cx: &Context<'_>) {
        let last = self.inner.counters().into_iter().filter(|c| c.key == self.key);
        self.sum.fetch_add(last.map(|c| c.count).sum(), Ordering::Relaxed);
        self.inner.begin(cx);
    }

    fn next(&mut self, cx: &Context<'_>) -> Action<'_> {
        self.inner.next(cx)
    }

    fn answer(&mut self, cx: &Context<'_>, ticket: Ticket, answer: Answer<'_>) {
        self.inner.answer(cx, ticket, answer);
    }

    fn reset(&mut self) {
        self.inner.reset();
    }
}
