//! What the device reports, as errors instead of panics.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::pin::pin;
use std::task::{Context, Poll, Waker};
use std::time::Duration;

use wgpu::{Device, ErrorFilter, PollType, SubmissionIndex};

use crate::Error;

/// Runs something on a device. Without this, an error would reach the app's handler, which by
/// default panics.
pub(super) fn guarded<T>(device: &Device, run: impl FnOnce() -> T) -> Result<T, Error> {
    let filters = [ErrorFilter::Validation, ErrorFilter::OutOfMemory, ErrorFilter::Internal];
    let scopes = filters.map(|filter| device.push_error_scope(filter));
    let result = run();
    let mut found = None;
    // Scopes are popped in the reverse order.
    for scope in scopes.into_iter().rev() {
        // Off the web, the future is ready at once.
        let popped = pin!(scope.pop()).poll(&mut Context::from_waker(Waker::noop()));
        if let Poll::Ready(Some(error)) = popped {
            found.get_or_insert(error);
        }
    }
    match found {
        Some(error) => Err(failed(error)),
        None => Ok(result),
    }
}

/// Looks what has arrived, without waiting.
pub(super) fn poll(device: &Device) -> Result<(), Error> {
    poll_as(device, PollType::Poll)
}

/// Waits until a submission is done, for some time at most.
pub(super) fn wait(device: &Device, index: SubmissionIndex, timeout: Duration) -> Result<(), Error> {
    poll_as(device, PollType::Wait { submission_index: Some(index), timeout: Some(timeout) })
}

fn poll_as(device: &Device, poll: PollType) -> Result<(), Error> {
    // A device that is lost while it is waited for makes wgpu 30 panic; nothing of ours is left
    // half done by that.
    match catch_unwind(AssertUnwindSafe(|| device.poll(poll))) {
        Ok(Ok(_)) => Ok(()),
        Ok(Err(error)) => Err(failed(error)),
        Err(_) => Err(failed("the device was lost while it was waited for")),
    }
}

pub(super) fn failed(why: impl ToString) -> Error {
    Error::Device { why: why.to_string() }
}
