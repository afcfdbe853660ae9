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
        let of_cell = |cell: usize| {
            let split = indirect.split(light, cell);
            let direct = match &indirect.amount {
                _ if !grid.mask.data()[cell] || !split.has_light() => None,
                None => split.direct(),
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
