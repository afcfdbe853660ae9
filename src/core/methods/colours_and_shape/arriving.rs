//! The light that arrives at every cell from the rest of the surface: `K f (x)`, the sum over patches of form factor times the
//! light that leaves them.
//!
//! Tiles of cells share one list of patches, single cells nearby and groups farther away (J. Barnes, P. Hut, "A hierarchical
//! O(N log N) force-calculation algorithm", Nature 324, 1986), so that the work grows with the cells and not with their square.

use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::pyramid::{Level, Pyramid};
use super::visibility::Visibility;
use crate::{Mask, NormalMap, Plane, Watch};

/// Cells along a tile, and along a quarter of it: the cells of a quarter see the same patches or none of them does.
const TILE: usize = 8;
const QUARTER: usize = TILE / 2;
const LANES: usize = QUARTER * QUARTER;
/// A group of patches is taken as one from this many of its radii on. Errs by about a quarter of the squared reciprocal.
const GROUP_DISTANCE: f32 = 3.5;

/// By channel, the light that arrives at every cell of the mask, relative to what a facet that sees nothing but a surface of
/// light 1 receives. `None` when cancelled.
pub(super) fn arriving_light(
    pyramid: &Pyramid,
    normals: &NormalMap,
    mask: &Mask,
    visibility: Option<&Visibility>,
    watch: &dyn Watch,
) -> Option<Vec<Plane>> {
    let (width, height) = mask.size();
    let channels = pyramid.cells().light.len();
    let columns = width.div_ceil(TILE);
    let tiles = columns * height.div_ceil(TILE);
    let done = AtomicUsize::new(0);
    let of_tile = |tile: usize| {
        let receivers = Receivers::new(pyramid.cells(), normals, (tile % columns * TILE, tile / columns * TILE));
        let light = match &receivers {
            _ if watch.cancelled() => None,
            Some(receivers) => Some((tile, Senders::to(receivers, pyramid, visibility).light_at(receivers, channels))),
            None => None,
        };
        let finished = done.fetch_add(1, Ordering::Relaxed) + 1;
        if finished.is_multiple_of(columns) {
            watch.progress(finished as f32 / tiles as f32);
        }
        light
    };
    let found: Vec<_> = (0..tiles).into_par_iter().filter_map(of_tile).collect();
    if watch.cancelled() {
        return None;
    }
    let mut planes = vec![Plane::filled(width, height, 0.0); channels];
    for (channel, plane) in planes.iter_mut().enumerate() {
        let data = plane.data_mut();
        for (tile, light) in &found {
            let origin = (tile % columns * TILE, tile / columns * TILE);
            for (lane, value) in light[channel].iter().enumerate() {
                let (x, y) = place(origin, lane);
                if x < width && y < height {
                    data[y * width + x] = *value;
                }
            }
        }
    }
    Some(planes)
}

/// Where a lane of a tile lies: quarter by quarter, each row by row.
fn place((left, top): (usize, usize), lane: usize) -> (usize, usize) {
    let (quarter, cell) = (lane / LANES, lane % LANES);
    (left + quarter % 2 * QUARTER + cell % QUARTER, top + quarter / 2 * QUARTER + cell / QUARTER)
}

/// The cells of a tile. Those outside the object have no normal and receive nothing.
struct Receivers {
    point: [[f32; 4 * LANES]; 3],
    normal: [[f32; 4 * LANES]; 3],
    centre: Point3<f32>,
    radius: f32,
    /// By quarter, a point in its middle; `None` for a quarter outside the object.
    middles: [Option<Point3<f32>>; 4],
}

impl Receivers {
    /// `None` where no cell lies in the object.
    fn new(cells: &Level, normals: &NormalMap, origin: (usize, usize)) -> Option<Self> {
        let mut receivers = Self {
            point: [[0.0; 4 * LANES]; 3],
            normal: [[0.0; 4 * LANES]; 3],
            centre: Point3::origin(),
            radius: 0.0,
            middles: [None; 4],
        };
        let mut points = [const { Vec::new() }; 4];
        for lane in 0..4 * LANES {
            let (x, y) = place(origin, lane);
            if x >= cells.width || y >= cells.height || cells.area[y * cells.width + x] == 0.0 {
                continue;
            }
            let index = y * cells.width + x;
            let point = cells.centre_of(index);
            let Some(normal) = normals.at_index(index) else { continue };
            for axis in 0..3 {
                receivers.point[axis][lane] = point[axis];
                receivers.normal[axis][lane] = normal[axis];
            }
            points[lane / LANES].push(point);
        }
        let mean = |points: &[Point3<f32>]| {
            let sum: Vector3<f32> = points.iter().map(|point| point.coords).sum();
            (!points.is_empty()).then(|| Point3::from(sum / points.len() as f32))
        };
        receivers.middles = std::array::from_fn(|quarter| mean(&points[quarter]));
        let all = points.concat();
        receivers.centre = mean(&all)?;
        receivers.radius = all.iter().map(|point| (point - receivers.centre).norm()).fold(0.0, f32::max);
        Some(receivers)
    }
}

/// One patch that may send light to a tile.
struct Sender {
    centre: [f32; 3],
    facing: [f32; 3],
    area: f32,
    level: usize,
    index: usize,
    /// By quarter of the tile, whether it is seen.
    is_seen: [bool; 4],
}

struct Senders<'a> {
    pyramid: &'a Pyramid,
    all: Vec<Sender>,
}

impl<'a> Senders<'a> {
    fn to(receivers: &Receivers, pyramid: &'a Pyramid, visibility: Option<&Visibility>) -> Self {
        let top = pyramid.levels.len() - 1;
        let mut open = vec![(top, 0, 0)];
        let mut all = Vec::with_capacity(1024);
        while let Some((level, x, y)) = open.pop() {
            let patches = &pyramid.levels[level];
            if x >= patches.width || y >= patches.height {
                continue;
            }
            let index = y * patches.width + x;
            if patches.area[index] == 0.0 {
                continue;
            }
            let centre = patches.centre_of(index);
            let distance = (centre - receivers.centre).norm() - receivers.radius;
            if level > 0 && distance < GROUP_DISTANCE * patches.radius[index] {
                open.extend([(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| (level - 1, 2 * x + i, 2 * y + j)));
                continue;
            }
            let seen = |middle: &Option<Point3<f32>>| match (middle, visibility) {
                (None, _) => false,
                (Some(_), None) => true,
                // Patches that touch see each other.
                (Some(_), Some(_)) if distance < patches.radius[index] + receivers.radius => true,
                (Some(middle), Some(visibility)) => visibility.is_clear(middle, &centre),
            };
            let facing = patches.facing_of(index);
            all.push(Sender {
                centre: centre.into(),
                facing: facing.into(),
                area: patches.area[index],
                level,
                index,
                is_seen: receivers.middles.each_ref().map(seen),
            });
        }
        Self { pyramid, all }
    }

    /// By channel, then lane.
    fn light_at(&self, receivers: &Receivers, channels: usize) -> Vec<[f32; 4 * LANES]> {
        let mut light = vec![[0.0; 4 * LANES]; channels];
        for sender in &self.all {
            let channels = &self.pyramid.levels[sender.level].light;
            for quarter in (0..4).filter(|&quarter| sender.is_seen[quarter]) {
                let lanes = quarter * LANES..(quarter + 1) * LANES;
                let mut factors = [0.0; LANES];
                sender.form_factors(receivers, lanes.clone(), &mut factors);
                for (sum, channel) in light.iter_mut().zip(channels) {
                    let leaving = channel[sender.index];
                    for (sum, factor) in sum[lanes.clone()].iter_mut().zip(&factors) {
                        *sum += factor * leaving;
                    }
                }
            }
        }
        light
    }
}

impl Sender {
    /// From each receiver to this patch, taken as a disc (J. R. Wallace, K. A. Elmquist, E. A. Haines, "A ray tracing algorithm
    /// for progressive radiosity", SIGGRAPH 1989), so that it stays below 1 where patches touch.
    fn form_factors(&self, receivers: &Receivers, lanes: std::ops::Range<usize>, factors: &mut [f32; LANES]) {
        const TINY: f32 = 1e-30;
        let [x, y, z] = receivers.point.each_ref().map(|axis| &axis[lanes.clone()]);
        let [nx, ny, nz] = receivers.normal.each_ref().map(|axis| &axis[lanes.clone()]);
        let ([qx, qy, qz], [ax, ay, az], area) = (self.centre, self.facing, self.area);
        for i in 0..LANES {
            let (dx, dy, dz) = (qx - x[i], qy - y[i], qz - z[i]);
            let squared = dx * dx + dy * dy + dz * dz;
            let arriving = nx[i] * dx + ny[i] * dy + nz[i] * dz;
            let leaving = -(ax * dx + ay * dy + az * dz);
            let (arriving, leaving) = (arriving.max(0.0), leaving.max(0.0));
            factors[i] = arriving * leaving / (squared * (std::f32::consts::PI * squared + area) + TINY);
        }
    }
}
