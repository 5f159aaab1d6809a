// What is known of a node: nothing; it may be a group, for there is no occluder at or below it, but
// one below its parent; there is an occluder at or below it.
const UNKNOWN: u32 = 1u;
const VISIBLE: u32 = 2u;
