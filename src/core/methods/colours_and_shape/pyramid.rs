//! The surface as patches of one cell, of 2 x 2 cells, 4 x 4 and so on: near ones count in detail, far ones in groups.

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use crate::stereo::shape::Shape;
use crate::{Camera, Mask};

/// A facet seen more obliquely than this is taken as if it were seen so, or its area would have no end.
const GRAZING: f64 = 0.02;

/// The patches of one size, row by row; the area of those outside the object is zero.
pub(super) struct Level {
    pub width: usize,
    pub height: usize,
    /// Centre, by axis.
    pub centre: [Vec<f32>; 3],
    /// Normal times area, by axis: what the patch shows to one who sees all of it from in front.
    pub facing: [Vec<f32>; 3],
    pub area: Vec<f32>,
    /// From the centre to the farthest part.
    pub radius: Vec<f32>,
    /// By channel, the mean light that leaves the patch.
    pub light: Vec<Vec<f32>>,
}

/// All sizes, single cells first.
pub(super) struct Pyramid {
    pub levels: Vec<Level>,
}

impl Pyramid {
    /// The surface under `mask`, whose cells shine with `channels`, row by row.
    pub(super) fn new(shape: &Shape, camera: &Camera, mask: &Mask, channels: &[&[f32]]) -> Self {
        let mut levels = vec![Level::of_cells(shape, camera, mask, channels)];
        while let Some(coarser) = levels.last().filter(|level| level.width * level.height > 1).map(Level::halved) {
            levels.push(coarser);
        }
        Self { levels }
    }

    pub(super) fn cells(&self) -> &Level {
        &self.levels[0]
    }
}

impl Level {
    fn empty(width: usize, height: usize, channels: usize) -> Self {
        let zeros = || vec![0.0; width * height];
        Self {
            width,
            height,
            centre: [zeros(), zeros(), zeros()],
            facing: [zeros(), zeros(), zeros()],
            area: zeros(),
            radius: zeros(),
            light: (0..channels).map(|_| zeros()).collect(),
        }
    }

    fn of_cells(shape: &Shape, camera: &Camera, mask: &Mask, channels: &[&[f32]]) -> Self {
        let (width, height) = mask.size();
        let mut level = Self::empty(width, height, 0);
        level.light = channels.iter().map(|channel| channel.to_vec()).collect();
        let facet = |cell: usize| {
            let normal = shape.normals.map.at_index(cell).filter(|_| mask.data()[cell])?.cast::<f64>();
            let (x_px, y_px) = ((cell % width) as f64 + 0.5, (cell / width) as f64 + 0.5);
            let point = camera.point_mm(x_px, y_px, f64::from(shape.depth.depth_mm.data()[cell]));
            // Of the plane z = const through the point the cell shows a square; the facet lies obliquely to it.
            let side = (camera.point_mm(x_px + 1.0, y_px, point.z) - point).norm();
            let view = camera.view_ray(x_px, y_px);
            let area = side * side * view.z.abs() / (-view.dot(&normal)).max(GRAZING);
            Some((point, normal, area))
        };
        let facets: Vec<_> = (0..width * height).into_par_iter().map(facet).collect();
        for (cell, (point, normal, area)) in facets.into_iter().enumerate().filter_map(|(i, facet)| Some((i, facet?))) {
            for axis in 0..3 {
                level.centre[axis][cell] = point[axis] as f32;
                level.facing[axis][cell] = (normal[axis] * area) as f32;
            }
            level.area[cell] = area as f32;
            level.radius[cell] = (0.5 * area).sqrt() as f32;
        }
        level
    }

    /// Groups of 2 x 2 patches.
    fn halved(&self) -> Self {
        let mut coarse = Self::empty(self.width.div_ceil(2), self.height.div_ceil(2), self.light.len());
        for index in 0..coarse.area.len() {
            let (x, y) = (index % coarse.width * 2, index / coarse.width * 2);
            let children = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| (x + i, y + j));
            let inside = |&(x, y): &(usize, usize)| x < self.width && y < self.height;
            let children = children.into_iter().filter(inside).map(|(x, y)| y * self.width + x);
            let children: Vec<usize> = children.filter(|&child| self.area[child] > 0.0).collect();
            let area: f32 = children.iter().map(|&child| self.area[child]).sum();
            if area == 0.0 {
                continue;
            }
            let mean = |values: &[f32]| children.iter().map(|&c| values[c] * self.area[c]).sum::<f32>() / area;
            for axis in 0..3 {
                coarse.centre[axis][index] = mean(&self.centre[axis]);
                coarse.facing[axis][index] = children.iter().map(|&child| self.facing[axis][child]).sum();
            }
            coarse.area[index] = area;
            let centre = coarse.centre_of(index);
            let reach = |&child: &usize| (self.centre_of(child) - centre).norm() + self.radius[child];
            coarse.radius[index] = children.iter().map(reach).fold(0.0, f32::max);
            for (coarse, fine) in coarse.light.iter_mut().zip(&self.light) {
                coarse[index] = mean(fine);
            }
        }
        coarse
    }

    pub(super) fn centre_of(&self, index: usize) -> Point3<f32> {
        Point3::new(self.centre[0][index], self.centre[1][index], self.centre[2][index])
    }

    pub(super) fn facing_of(&self, index: usize) -> Vector3<f32> {
        Vector3::new(self.facing[0][index], self.facing[1][index], self.facing[2][index])
    }
}
