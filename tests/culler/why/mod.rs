//! Explanations hold: whatever [`Culler::why`](tercet::Culler::why) and [`Culler::fates`](tercet::Culler::fates) say is
//! compared with what was drawn, with the geometry, and with what the backend was asked and answered in
//! that very frame.

mod listening;
mod small;
mod truth;
mod watch;
