//! Where things are: a scene follows the app's world, and its tree divides space as views ask for it.

mod model;
mod ops;
mod sync;
mod tree;
mod votes;
