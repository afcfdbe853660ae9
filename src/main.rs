//! Firstbounce: photometric stereo without the light between an object's own walls.

fn main() {}
