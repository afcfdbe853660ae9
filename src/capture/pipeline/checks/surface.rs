//! What the surface shows of the captures: an object in several parts.

use firstbounce_core::Mask;

use super::{CaptureWarning, CheckOptions};

/// Warns of what a surface shows, where there is one; `mask` is where it has depth.
pub fn check_surface(mask: &Mask, options: &CheckOptions) -> Vec<CaptureWarning> {
    let island = mask.islands();
    let count = island.iter().copied().max().unwrap_or_default() as usize;
    let mut sizes = vec![0; count];
    island.iter().filter(|island| **island > 0).for_each(|island| sizes[*island as usize - 1] += 1);
    let least = options.min_island_px.max((options.min_island_share * mask.count() as f64).ceil() as usize);
    sizes.retain(|size| *size >= least);
    sizes.sort_unstable_by(|one, other| other.cmp(one));
    match sizes.as_slice() {
        [] | [_] => Vec::new(),
        [largest, others @ ..] => {
            let beside = others.iter().sum::<usize>() as f64 / (largest + others.iter().sum::<usize>()) as f64;
            vec![CaptureWarning::Islands { islands: sizes.len(), share_beside: beside }]
        }
    }
}
