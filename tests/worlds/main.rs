//! The seeded worlds are what they claim to be, and the same on every machine.

mod city;
mod models;
mod moving;
mod pinned;
mod plant;
mod surface;
mod teapots;
mod three;
