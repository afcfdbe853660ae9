//! The direct light of every cell from what is known of its indirect light.

use rayon::prelude::*;

use super::grid::{Grid, GridLight};
use super::indirect::Indirect;
use crate::separate::{OUTSIDE, UNSOLVED};
use crate::stereo::normals::{DirectLight, Lamp};
use crate::{Marks, Plane};

/// The direct light of one light on the grid.
pub(super) struct GridDirect {
    direct: Plane,
    noise: Plane,
    marks: Marks,
}

/// By light.
pub(super) fn direct_light(grid: &Grid, indirect: &[Indirect]) -> Vec<GridDirect> {
    grid.lights.iter().zip(indirect).map(|(light, indirect)| GridDirect::of(grid, light, indirect)).collect()
}

/// As photometric stereo takes them, without those that the surface is recovered without.
pub(super) fn placed<'a>(solved: &'a [GridDirect], lamps: &[Option<(Lamp, f64)>]) -> Vec<DirectLight<'a>> {
    let placed = solved.iter().zip(lamps).filter_map(|(GridDirect { direct, noise, marks }, lamp)| {
        let (lamp, intensity) = (*lamp)?;
        Some(DirectLight { direct, noise: Some(noise), marks, lamp, intensity })
    });
    placed.collect()
}

impl GridDirect {
    fn of(grid: &Grid, light: &GridLight, indirect: &Indirect) -> Self {
        let (width, height) = grid.size();
        let (share, mean) = if indirect.amount.is_none() { mean_light(grid, light, indirect) } else { (0.0, 0.0) };
        let of_cell = |cell: usize| {
            let split = indirect.split(light, cell);
            let direct = match &indirect.amount {
                _ if !grid.mask.data()[cell] || !split.has_light() => None,
                // One colour does not tell indirect light. Where the others are clipped it has about the share of the rest of the
                // object, for a hole would send no light; dim cells are in shadow.
                None => split.direct().or_else(|| {
                    let (all, variance) = split.direct_given(0.0, 0.0);
                    (all > mean).then(|| ((1.0 - share) * all, variance + (share * all).powi(2)))
                }),
                Some(amount) => {
                    let (light, variance) = (amount.light.data()[cell], amount.variance.data()[cell]);
                    Some(split.direct_given(f64::from(light), f64::from(variance)))
                }
            };
            let marks = if grid.mask.data()[cell] { UNSOLVED } else { OUTSIDE };
            direct.map_or((0.0, (0.0, marks)), |(direct, variance)| (direct as f32, (variance.sqrt() as f32, 0)))
        };
        let (direct, (noise, marks)): (Vec<f32>, (Vec<f32>, Vec<u8>)) =
            (0..width * height).into_par_iter().map(of_cell).unzip();
        let plane = |data| Plane::from_vec(width, height, data).unwrap_or_default();
        let marks = Marks::from_vec(width, height, marks).unwrap_or_default();
        Self { direct: plane(direct), noise: plane(noise), marks }
    }
}

/// Of all light of the object in the reference colour, the part that the colours find indirect, from 0 to 1; the mean of all light.
fn mean_light(grid: &Grid, light: &GridLight, indirect: &Indirect) -> (f64, f64) {
    let of_cell = |cell: usize| {
        let split = indirect.split(light, cell);
        let (precision, weighted) = split.indirect();
        let (direct, _) = split.direct().filter(|_| grid.mask.data()[cell] && precision > 0.0)?;
        Some((weighted / precision, direct + weighted / precision, 1.0))
    };
    let cells = (0..grid.mask.data().len()).into_par_iter().filter_map(of_cell);
    let add = |a: (f64, f64, f64), b: (f64, f64, f64)| (a.0 + b.0, a.1 + b.1, a.2 + b.2);
    let (indirect, all, count) = cells.reduce(|| (0.0, 0.0, 0.0), add);
    if all > 0.0 { ((indirect / all).clamp(0.0, 1.0), all / count) } else { (0.0, 0.0) }
}
