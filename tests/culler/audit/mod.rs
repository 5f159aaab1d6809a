//! Error accounting: what an [`Auditor`](tercet::audit::Auditor) says of a frame is compared with what the oracle
//! and the culler say themselves, and with what a backend that lies has done.

mod blame;
mod counts;
#[path = "../../support/lying.rs"]
mod lying;
mod small;
mod watch;

use watch::Shown;
