//! A depth map as a few thousand patches that exchange light, and the way from pixels to patches and back.

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use crate::light::radiosity::{Patches, RadiosityError};
use crate::light::scene::{Linear, linear_over_patches};
use crate::stereo::shape::Shape;
use crate::{Camera, Mask, Mesh, Plane};

/// Below this many pixels along a patch, too few pixels lie in it to be averaged: its corners stand for it.
const FEW_PIXELS: usize = 3;
/// Outside the mask a node is found on the plane of the nearest pixel, unless the view grazes that plane.
const GRAZING: f64 = 0.05;
/// How many cells away a pixel beyond the last patch looks for one.
const REACH: usize = 2;

/// A corner of patches.
#[derive(Clone, Copy)]
struct Node {
    point: Point3<f64>,
    /// The pixel it lies on or, beyond the mask's edge, the nearest one.
    pixel: usize,
    island: u32,
}

/// Two patches between four nodes.
#[derive(Clone, Copy)]
struct Cell {
    /// The first of its two patches.
    first: usize,
    /// Whether they meet along the diagonal from top left to bottom right.
    falling: bool,
}

/// The facets of a depth map on a grid of `step_px` pixels. Cells that lie in the mask by half or more count whole: the
/// surface's area is right on the mean, and no patch joins two islands.
pub(super) struct Facets {
    step_px: usize,
    /// Cells in a row.
    columns: usize,
    cells: Vec<Option<Cell>>,
    mesh: Mesh,
    /// For each patch, the pixels of its corners.
    corner_pixels: Vec<[usize; 3]>,
    mask: Mask,
    points: PixelPoints,
}

/// Where the surface is in every pixel.
struct PixelPoints {
    camera: Camera,
    depth_mm: Plane,
}

impl PixelPoints {
    fn at(&self, x: usize, y: usize) -> Point3<f64> {
        self.camera.point_mm(x as f64 + 0.5, y as f64 + 0.5, f64::from(self.depth_mm.at(x, y)))
    }
}

impl Facets {
    /// Cuts the surface into about `patches`; `None` where there is not one.
    pub(super) fn new(shape: &Shape, camera: &Camera, patches: usize) -> Option<Self> {
        let mask = &shape.depth.mask;
        let step_px = (2.0 * mask.count() as f64 / patches as f64).sqrt().ceil().max(1.0) as usize;
        let points = PixelPoints { camera: *camera, depth_mm: shape.depth.depth_mm.clone() };
        let islands = if shape.depth.report.islands > 1 { Some(mask.islands()) } else { None };
        let (columns, rows) = (mask.width().div_ceil(step_px), mask.height().div_ceil(step_px));
        let node = |index: usize| {
            let (x, y) = (index % (columns + 1) * step_px, index / (columns + 1) * step_px);
            let pixel = nearest_inside(mask, x, y, step_px)?;
            let point = extrapolated(shape, &points, pixel, x, y);
            Some(Node { point, pixel, island: islands.as_ref().map_or(0, |islands| islands[pixel]) })
        };
        let nodes: Vec<Option<Node>> = (0..(columns + 1) * (rows + 1)).into_par_iter().map(node).collect();

        let mut facets = Self {
            step_px,
            columns,
            cells: Vec::with_capacity(columns * rows),
            mesh: Mesh {
                positions: nodes.iter().map(|node| node.map_or(Point3::origin(), |node| node.point.cast())).collect(),
                normals: Vec::new(),
                colours: Vec::new(),
                triangles: Vec::new(),
                unit: camera.unit(),
            },
            corner_pixels: Vec::new(),
            mask: mask.clone(),
            points,
        };
        for cell in 0..columns * rows {
            let cell = facets.cell(&nodes, cell % columns, cell / columns);
            facets.cells.push(cell);
        }
        (!facets.mesh.triangles.is_empty()).then_some(facets)
    }

    /// Pixels along a patch.
    pub(super) fn step_px(&self) -> usize {
        self.step_px
    }

    /// The facets, ready to exchange light.
    pub(super) fn patches(&self) -> Result<Patches, RadiosityError> {
        Patches::from_mesh(&self.mesh)
    }

    /// The two patches of a cell, unless too little of it is inside.
    fn cell(&mut self, nodes: &[Option<Node>], column: usize, row: usize) -> Option<Cell> {
        let node = |i: usize, j: usize| (row + j) * (self.columns + 1) + column + i;
        let numbers = [node(0, 0), node(1, 0), node(0, 1), node(1, 1)];
        let [a, b, c, d] = numbers.map(|number| nodes[number]);
        let corners = [a?, b?, c?, d?];
        let one_island = corners.iter().all(|corner| corner.island == corners[0].island);
        if !one_island || !self.is_half_inside(column, row) {
            return None;
        }
        // Across a crease the shorter diagonal lies along it.
        let [a, b, c, d] = corners;
        let falling = (d.point - a.point).norm() < (c.point - b.point).norm();
        let pieces = if falling { [[0, 2, 3], [0, 3, 1]] } else { [[0, 2, 1], [1, 2, 3]] };
        let first = self.mesh.triangles.len();
        for piece in pieces {
            self.mesh.triangles.push(piece.map(|k| numbers[k] as u32));
            self.corner_pixels.push(piece.map(|k| corners[k].pixel));
        }
        Some(Cell { first, falling })
    }

    fn is_half_inside(&self, column: usize, row: usize) -> bool {
        let (left, top) = (column * self.step_px, row * self.step_px);
        let inside = |x: usize, y: usize| x < self.mask.width() && y < self.mask.height() && self.mask.at(x, y);
        let side = self.step_px + 1;
        let count = (0..side * side).filter(|k| inside(left + k % side, top + k / side)).count();
        2 * count >= side * side
    }

    fn cell_at(&self, column: usize, row: usize) -> Option<Cell> {
        if column < self.columns { *self.cells.get(row * self.columns + column)? } else { None }
    }

    /// The patch that a pixel lies in; beyond the last patch, the nearest within reach.
    fn patch_at(&self, x: usize, y: usize) -> Option<usize> {
        let (column, row) = (x / self.step_px, y / self.step_px);
        if let Some(cell) = self.cell_at(column, row) {
            return Some(cell.first + self.half_of(cell, x - column * self.step_px, y - row * self.step_px));
        }
        let around = (row.saturating_sub(REACH)..=row + REACH)
            .flat_map(|j| (column.saturating_sub(REACH)..=column + REACH).map(move |i| (i, j)));
        let near = around.filter_map(|(i, j)| self.cell_at(i, j)).flat_map(|cell| [cell.first, cell.first + 1]);
        let point = self.points.at(x, y);
        let distance = |patch: usize| (self.centre(patch) - point).norm_squared();
        near.map(|patch| (patch, distance(patch))).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(patch, _)| patch)
    }

    fn centre(&self, patch: usize) -> Point3<f64> {
        let corners = self.mesh.triangles[patch].map(|corner| self.mesh.positions[corner as usize].cast::<f64>());
        Point3::from((corners[0].coords + corners[1].coords + corners[2].coords) / 3.0)
    }

    /// For each patch, the mean of a plane over the pixels in it.
    pub(super) fn means(&self, plane: &Plane) -> Vec<f64> {
        let corners = |pixels: &[usize; 3]| pixels.iter().map(|&p| f64::from(plane.data()[p])).sum::<f64>() / 3.0;
        let mut means: Vec<f64> = self.corner_pixels.iter().map(corners).collect();
        if self.step_px < FEW_PIXELS {
            return means;
        }
        let of_cell = |(index, cell): (usize, &Option<Cell>)| Some(((*cell)?, self.sums(index, plane)));
        for (cell, sums) in self.cells.par_iter().enumerate().filter_map(of_cell).collect::<Vec<_>>() {
            for (mean, (sum, count)) in means[cell.first..].iter_mut().zip(sums).filter(|(_, (_, count))| *count > 0) {
                *mean = sum / count as f64;
            }
        }
        means
    }

    /// Sum and count of a plane's pixels in the two patches of a cell.
    fn sums(&self, cell: usize, plane: &Plane) -> [(f64, usize); 2] {
        let (left, top) = (cell % self.columns * self.step_px, cell / self.columns * self.step_px);
        let mut sums = [(0.0, 0); 2];
        for y in top..(top + self.step_px).min(self.mask.height()) {
            for x in (left..(left + self.step_px).min(self.mask.width())).filter(|&x| self.mask.at(x, y)) {
                if let Some(cell) = self.cells[cell] {
                    let (sum, count) = &mut sums[self.half_of(cell, x - left, y - top)];
                    *sum += f64::from(plane.at(x, y));
                    *count += 1;
                }
            }
        }
        sums
    }

    /// Which of a cell's patches a pixel lies in, `right` and `down` from the cell's top left node.
    fn half_of(&self, cell: Cell, right: usize, down: usize) -> usize {
        usize::from(if cell.falling { right > down } else { right + down > self.step_px })
    }

    /// Values of the patches as fields that run without a step over smooth parts of the surface.
    pub(super) fn fields(&self, patches: &Patches, values: &[Vec<f64>]) -> Vec<Vec<Linear>> {
        linear_over_patches(patches, &values.iter().map(Vec::as_slice).collect::<Vec<_>>())
    }

    /// Field `channel` at a pixel; `None` where no patch is near.
    pub(super) fn field_at(&self, fields: &[Vec<Linear>], channel: usize, x: usize, y: usize) -> Option<f32> {
        let patch = self.patch_at(x, y)?;
        let offset: Vector3<f32> = (self.points.at(x, y) - self.centre(patch)).cast();
        Some(fields[patch][channel].at(&offset).max(0.0))
    }
}

/// The pixel of the mask nearest to a node, at most a step away.
fn nearest_inside(mask: &Mask, x: usize, y: usize, step_px: usize) -> Option<usize> {
    let (width, height) = mask.size();
    if x < width && y < height && mask.at(x, y) {
        return Some(y * width + x);
    }
    let columns = x.saturating_sub(step_px)..(x + step_px + 1).min(width);
    let rows = y.saturating_sub(step_px)..(y + step_px + 1).min(height);
    let around = rows.flat_map(|row| columns.clone().map(move |column| (column, row)));
    let inside = around.filter(|&(column, row)| mask.at(column, row));
    let nearest = inside.min_by_key(|&(column, row)| column.abs_diff(x).pow(2) + row.abs_diff(y).pow(2));
    nearest.map(|(column, row)| row * width + column)
}

/// The point seen at the centre of pixel `(x, y)`, on the surface or on the plane of the given pixel.
fn extrapolated(shape: &Shape, points: &PixelPoints, pixel: usize, x: usize, y: usize) -> Point3<f64> {
    let width = shape.depth.mask.width();
    let known = points.at(pixel % width, pixel / width);
    if (pixel % width, pixel / width) == (x, y) {
        return known;
    }
    let (x_px, y_px) = (x as f64 + 0.5, y as f64 + 0.5);
    let beside = points.camera.point_mm(x_px, y_px, known.z);
    let direction = points.camera.view_ray(x_px, y_px);
    let normal = shape.normals.map.at_index(pixel).map_or(Vector3::z(), |normal| normal.cast::<f64>());
    let facing = -normal.dot(&direction);
    if facing > GRAZING { beside - direction.into_inner() * (normal.dot(&(known - beside)) / facing) } else { beside }
}
