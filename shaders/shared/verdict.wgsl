// What is known of a box that a sweep asks about: the twins of the constants in
// src/query/gpu/sweep/project.rs.

// It can own no sample.
const OUTSIDE: u32 = 0u;
// It has a proxy, none of whose samples has been found in sight.
const HIDDEN: u32 = 1u;
// Some sample is in sight, or it cannot be asked about.
const SEEN: u32 = 2u;
