//! Recordings: a run, taken down so that it can be lived through again, bit for bit, without a GPU.
//!
//! Policies are pure: what a frame does follows from the world's edits, the view, the answers, and the
//! times that were measured. A [`Recorder`] writes those down while an app runs on whatever backend it
//! likes; a [`Player`] goes through the frames again, on any machine, and checks of each that it drew the
//! same objects in the same order and asked as much. A frame that went wrong at a user's desk can so be
//! looked at in a debugger.
//!
//! ```
//! use glam::Vec3;
//! use tercet::geom::{Aabb, View, Viewport};
//! use tercet::policy::{self, Policy};
//! use tercet::query::software::SoftwareQueries;
//! use tercet::record::{Logged, Player, Recorder};
//! use tercet::scene::{Scene, SceneConfig, Traits};
//! use tercet::{Culler, Error};
//!
//! fn main() -> Result<(), Error> {
//!     let config = SceneConfig::default();
//!     let mut scene = Scene::new(config.clone());
//!     let mut eye = Culler::new(policy::by_name("dual-query")?);
//!     let mut file = Vec::new(); // or a file
//!     let mut recorder = Recorder::new(&mut file, &config, &mut scene, &eye, "one box")?;
//!     let mut queries = Logged::new(SoftwareQueries::new());
//!     scene.insert(Aabb::from_center(Vec3::ZERO, Vec3::ONE), Traits::default());
//!     let view = View::look_at(Vec3::Z * 5.0, Vec3::ZERO, 60.0, 0.1, Viewport::new(320, 180))?;
//!     for _ in 0..3 {
//!         scene.update();
//!         recorder.begin(&mut scene, &view, &eye);
//!         eye.frame(&scene, &view, &mut queries, |_pass, _objects| {})?;
//!         recorder.end(&eye, &mut queries)?;
//!         scene.adapt([&mut eye]);
//!     }
//!     recorder.finish()?;
//!
//!     let mut player = Player::new(&file[..])?;
//!     while let Some(frame) = player.next_frame()? {
//!         assert_eq!(frame.stats.drawn, 1);
//!     }
//!     Ok(())
//! }
//! ```
//!
//! # What it does not hold
//!
//! Meshes and pictures: a player has the boxes of the world, not its triangles. One view: a recording is
//! of one culler, though other views may vote. Reference policies, which draw what they are given.
//!
//! # The file
//!
//! Eight bytes that name the format, its version, then chunks: the header, a chunk a frame, and the end.
//! Each chunk carries its length and a checksum, so a file that was cut short or altered is found out,
//! and the frames before the damage can still be played. Numbers are little-endian; floats are kept to
//! the bit, NaNs included.

mod chunk;
mod log;
mod player;
mod recorder;

pub use chunk::Header;
pub use log::Logged;
pub use player::{Played, Player};
pub use recorder::Recorder;
