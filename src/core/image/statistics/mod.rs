//! Measurements on planes: histograms, statistics of a region, profiles along a line.

mod histogram;
mod profile;
mod region;

pub use histogram::{Histogram, Scale};
pub use profile::{Profile, profile};
pub use region::{Region, RegionStatistics, statistics};
