//! Tercet: a dynamic-scene occlusion-culling engine.
//!
//! Hand it a world of moving objects and a camera, and it answers, every frame, *what must be
//! drawn?* By default it never drops an object that owns a sample of the finished frame.
//!
//! # A frame, in the order of the folders
//!
//! ```text
//! hecs World ──sync──▶ scene ──▶ tree ──▶ policy ──▶ query ──▶ draw
//!                     what is    where    what to    is it     what the
//!                                it is    ask        hidden?   app sees
//!                                  ▲                   │
//!                                  └─ adapt ◀─ votes ◀─┘  (visible, total) per node, per view
//! ```
//!
//! 1. [`scene`] mirrors the app's world: spawned, moved and despawned bounds become edits.
//! 2. [`tree`]: the ternary tree places objects, refits boxes, splits and merges.
//! 3. [`policy`]: one paper each, a pure state machine: draw this, ask that, wait, done.
//! 4. [`query`]: a backend owns the frame's depth and answers.
//! 5. [`draw`]: what the demos and tests draw with; an app brings its own closure.
//!
//! [`Culler::frame`] ties them; `src/culler.rs` is the file to read first.
//!
//! # The minimal program
//!
//! ```
//! use glam::Vec3;
//! use tercet::geom::{Aabb, View, Viewport};
//! use tercet::policy::DualQuery;
//! use tercet::query::software::SoftwareQueries;
//! use tercet::scene::{Bounds, Scene, SceneConfig};
//! use tercet::{Culler, Error};
//!
//! fn main() -> Result<(), Error> {
//!     let mut world = hecs::World::new();
//!     world.spawn((Bounds(Aabb::from_center(Vec3::ZERO, Vec3::ONE)),));
//!
//!     let mut scene = Scene::new(SceneConfig::default()); // where things are: one a world
//!     let mut eye = Culler::new(DualQuery::default()); // what one camera sees
//!     let mut queries = SoftwareQueries::new(); // who answers
//!
//!     let view = View::look_at(Vec3::Z * 5.0, Vec3::ZERO, 60.0, 0.1, Viewport::new(320, 180))?;
//!     scene.sync(&world);
//!     eye.frame(&scene, &view, &mut queries, |_pass, objects| {
//!         for object in objects {
//!             println!("draw {:?}", object.entity()); // the app's own renderer
//!         }
//!     })?;
//!     scene.adapt([&mut eye]);
//!     assert_eq!(eye.visible().len(), 1);
//!     Ok(())
//! }
//! ```
//!
//! # Algorithms
//!
//! | algorithm | file | source |
//! |---|---|---|
//! | adaptive ternary tree, tight boxes, votes | `tree/` | Kovalčík and Tobola 2005 |
//! | skipping questions by their worth | `policy/skip.rs` | ours |
//! | dual query, overlap-ordered waves | `policy/dual_query.rs`, `policy/order.rs` | Kovalčík and Tobola 2005 |
//! | statistically optimised queries | `policy/statistical.rs` | Kovalčík and Sochor 2005 |
//! | CHC | `policy/chc.rs`, `policy/coherence.rs` | Bittner et al. 2004 |
//! | CHC++: queues, multiqueries, tight volumes | `policy/chc_plus_plus/` | Mattausch et al. 2008 |
//! | NOHC: cost against benefit, node by node | `policy/nohc.rs`, `policy/odds.rs` | Guthe et al. 2006 |
//! | a gate before any policy: never slower than the frustum | `policy/gated/` | ours, after Guthe et al. 2006 |
//! | hierarchy updating, visibility propagation | `policy/hierarchy/` | Bittner and Havran 2001 |
//! | raster occlusion culling in two phases: ROC, HROC, hybrid | `policy/two_phase.rs`, `policy/roc.rs`, `policy/hroc/`, `policy/hybrid/`, `query/software/sweep/` | Lee et al. 2021 |
//! | Hi-Z map | `policy/hi_z.rs`, `query/software/sweep/hi_z_build.rs`, `hi_z_test.rs` | Rákos 2010 |
//! | stop-and-wait, OPT, REF | `policy/stop_and_wait.rs`, `policy/recorded.rs` | Bittner et al. 2004, Mattausch et al. 2008, Lee et al. 2021 |
//! | conservative box proxy, and that of a group | `geom/proxy.rs`, `geom/group.rs` | their proofs are in the modules |
//! | exact software rasteriser and counts | `query/software/` | |
//! | exact counts on the GPU (feature `gpu`) | `query/gpu/`, `shaders/` | |
//! | exact visible set (item buffer) | `query/oracle.rs` | |
//! | error accounting while running | `audit/` | ours; intervals after Hoeffding 1963 |
//! | faults of devices, on purpose | `query/fault.rs` | |
//! | recordings, replayed bit for bit (feature `record`) | `record/` | |

#![warn(unreachable_pub)]

mod costs;
mod culler;
mod dial;
mod error;
mod stats;
mod tradeoff;

pub mod audit;
pub mod draw;
pub mod geom;
pub mod policy;
pub mod query;
#[cfg(feature = "record")]
pub mod record;
pub mod scene;
pub mod tree;
pub mod worlds;

pub use costs::{Costs, FrameCost};
pub use culler::{Culler, Holder, Voter, Why};
pub use dial::{Dial, DialKind};
pub use error::Error;
pub use stats::{Counter, FrameStats};
pub use tradeoff::{Budget, Latency, PRESETS, Tradeoff};

/// The README's programs compile; that which needs no GPU runs.
#[cfg(all(doctest, feature = "gpu"))]
#[doc = include_str!("../README.md")]
struct Readme;
