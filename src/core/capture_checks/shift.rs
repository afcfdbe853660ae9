//! Shift between photos of one scene under different lamps: phase correlation of their edges (C. D. Kuglin and D. C. Hines,
//! "The phase correlation image alignment method", 1975).
//!
//! Shading changes from lamp to lamp; where paint, creases and outlines lie does not. Edges count by how much they stand out
//! of the picture, not by the light that they carry, so that each lamp shows the same ones.

use rayon::prelude::*;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use super::small::region;
use crate::image::gaussian::gaussian;
use crate::options::{OptionError, check_range};
use crate::{Mask, Plane, Watch};

/// How to look for photos that lie beside the others.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ShiftOptions {
    /// Shifts up to here are none, in pixels of the photo.
    pub max_rest_px: f64,
    /// And up to here in cells of the grid on which edges are compared, which is coarser for large photos.
    pub max_rest_cells: f64,
    /// A correlation whose peak is lower, in standard deviations of the correlation, says nothing.
    pub min_strength: f64,
    /// Photos that correlate so well without a shift, as a share of the peak, are at rest: edges that all run one way fit as
    /// well where they lie as along themselves.
    pub min_at_rest: f64,
}

impl Default for ShiftOptions {
    fn default() -> Self {
        Self { max_rest_px: 1.0, max_rest_cells: 0.5, min_strength: 10.0, min_at_rest: 0.7 }
    }
}

impl ShiftOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), OptionError> {
        let positive = |value: f64| value > 0.0 && value.is_finite();
        check_range("max_rest_px", self.max_rest_px, positive(self.max_rest_px), "a positive number")?;
        check_range("max_rest_cells", self.max_rest_cells, positive(self.max_rest_cells), "a positive number")?;
        let share = self.min_at_rest;
        check_range("min_at_rest", share, share > 0.0 && share < 1.0, "between 0 and 1")?;
        check_range("min_strength", self.min_strength, positive(self.min_strength), "a positive number")
    }
}

/// The largest side of the grid on which edges are compared; larger photos are averaged down to it.
const MAX_SIDE: usize = 512;
/// Fewer cells hold no edges to compare.
const MIN_SIDE: usize = 16;
/// Each photo is compared with as many before and after it: enough to say which one moved, few enough for a dome of lamps.
const MAX_PARTNERS: usize = 3;
/// Frequencies beyond this, in cycles a cell, count little.
const FINE_FREQUENCY: f32 = 0.35;
/// Standard deviation of the smoothing before slopes are taken, in cells.
const SMOOTHING: f64 = 0.7;
/// Standard deviation of the fading around the object, in cells.
const AROUND_OBJECT: f64 = 4.0;
/// Rows that one core transforms at a time.
const ROWS_OF_JOB: usize = 16;
/// No shift is so near to none as this share of it.
const NEAR_REST: f64 = 0.4;

/// Where and how finely the edges of a scene are looked at: the same for all its photos.
#[derive(Clone, Debug)]
pub struct EdgeWindow {
    size: (usize, usize),
    /// Left and top pixel.
    corner: [usize; 2],
    /// Pixels along a cell.
    step: usize,
    /// How much each cell counts, 0 to 1: fading out toward the border and away from the object.
    weight: Plane,
}

impl EdgeWindow {
    /// For photos of this size; where there is a mask, of the edges in and around it. `None` for pictures too small for edges.
    pub fn new(size: (usize, usize), mask: Option<&Mask>) -> Option<Self> {
        let mask = mask.filter(|mask| mask.size() == size);
        let [left, top, width, height] = region(size, mask)?;
        let step = width.max(height).div_ceil(MAX_SIDE).max(1);
        let (columns, rows) = (width / step, height / step);
        if columns.min(rows) < MIN_SIDE {
            return None;
        }
        Some(Self::of(size, [left, top], step, (columns, rows), mask))
    }

    /// For the part of a photo that begins at `corner`, of so many cells of `step` pixels.
    pub(super) fn of(
        size: (usize, usize),
        corner: [usize; 2],
        step: usize,
        (columns, rows): (usize, usize),
        mask: Option<&Mask>,
    ) -> Self {
        let mut window = Self { size, corner, step, weight: Plane::filled(columns, rows, 1.0) };
        let object = mask.map(|mask| gaussian(&window.cells(|x, y| f32::from(u8::from(mask.at(x, y)))), AROUND_OBJECT));
        let fade = |at: usize, of: usize| (std::f32::consts::PI * (at as f32 + 0.5) / of as f32).sin().min(0.25) * 4.0;
        window.weight = from_cells(columns, rows, |x, y| {
            let near = object.as_ref().map_or(1.0, |object| (20.0 * object.at(x, y)).min(1.0));
            near * fade(x, columns) * fade(y, rows)
        });
        window
    }

    /// The means of a picture's pixels over the cells.
    fn cells(&self, value: impl Fn(usize, usize) -> f32 + Sync) -> Plane {
        let ([left, top], step) = (self.corner, self.step);
        from_cells(self.weight.width(), self.weight.height(), |column, row| {
            let (x, y) = (left + column * step, top + row * step);
            let sum: f32 = (y..y + step).map(|y| (x..x + step).map(|x| value(x, y)).sum::<f32>()).sum();
            sum / (step * step) as f32
        })
    }

    /// How much each cell of a photo is an edge, 0 to 1, less the mean of all, as much as it counts.
    fn edges(&self, photo: &Plane) -> Plane {
        let smooth = gaussian(&self.cells(|x, y| photo.at(x, y)), SMOOTHING);
        let (columns, rows) = smooth.size();
        let slope = from_cells(columns, rows, |x, y| {
            if x == 0 || y == 0 || x + 1 == columns || y + 1 == rows {
                return 0.0;
            }
            let (across, down) = (smooth.at(x + 1, y) - smooth.at(x - 1, y), smooth.at(x, y + 1) - smooth.at(x, y - 1));
            across.hypot(down)
        });
        let sum = |of: &dyn Fn(usize) -> f32| (0..columns * rows).map(|cell| f64::from(of(cell))).sum::<f64>();
        let weak = (2.0 * sum(&|cell| slope.data()[cell]) / (columns * rows) as f64) as f32;
        let edge = slope.map(|slope| slope / (slope + weak.max(f32::MIN_POSITIVE)));
        let weight = self.weight.data();
        let mean = (sum(&|cell| edge.data()[cell] * weight[cell]) / sum(&|cell| weight[cell])) as f32;
        from_cells(columns, rows, |x, y| (edge.at(x, y) - mean) * self.weight.at(x, y))
    }

    /// The phases of a photo's edges; `None` for a photo of another size.
    pub fn spectrum(&self, photo: &Plane) -> Option<EdgeSpectrum> {
        if photo.size() != self.size {
            return None;
        }
        let edges = self.edges(photo);
        let side = edges.width().max(edges.height()).next_power_of_two();
        let mut phases = vec![Complex::default(); side * side];
        for (row, out) in phases.chunks_mut(side).take(edges.height()).enumerate() {
            out.iter_mut().zip(edges.row(row)).for_each(|(out, edge)| out.re = *edge);
        }
        transform(&mut phases, side, &*FftPlanner::new().plan_fft_forward(side));
        keep_phases(&mut phases, side);
        let reach = [edges.width() / 2, edges.height() / 2];
        Some(EdgeSpectrum { side, reach, cell_px: self.step as f64, phases })
    }
}

/// The phases of a photo's edges, by frequency.
#[derive(Clone, Debug)]
pub struct EdgeSpectrum {
    /// Cells along a side of the grid.
    side: usize,
    /// Half the columns and rows: photos that are shifted further share too little to say so.
    reach: [usize; 2],
    /// Pixels of the photo along a cell.
    cell_px: f64,
    phases: Vec<Complex<f32>>,
}

/// What the correlation of two photos says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairShift {
    /// From the first to the second, x right and y down, in pixels.
    pub shift_px: [f64; 2],
    /// Height of the peak in standard deviations of the correlation.
    pub strength: f64,
    /// The highest correlation near no shift, as a share of the peak.
    pub at_rest: f64,
}

/// The shift from one photo to another of the same size and mask; `None` where they cannot be compared.
pub fn pair_shift(first: &EdgeSpectrum, second: &EdgeSpectrum) -> Option<PairShift> {
    pair_shifts(&[(first, second)]).pop()?
}

/// The same of one or two pairs on one grid, by one transform: correlations are real, and one is put in the imaginary part.
pub(super) fn pair_shifts(pairs: &[(&EdgeSpectrum, &EdgeSpectrum)]) -> Vec<Option<PairShift>> {
    let Some(side) = pairs.first().map(|(first, _)| first.side) else { return Vec::new() };
    if pairs.iter().any(|(first, second)| first.side != side || second.side != side) {
        return vec![None; pairs.len()];
    }
    let mut values = vec![Complex::default(); side * side];
    for ((first, second), unit) in pairs.iter().zip([Complex::new(1.0, 0.0), Complex::i()]) {
        let phases = first.phases.iter().zip(&second.phases);
        values.iter_mut().zip(phases).for_each(|(value, (first, second))| *value += unit * second * first.conj());
    }
    transform(&mut values, side, &*FftPlanner::new().plan_fft_inverse(side));
    let parts: [fn(&Complex<f32>) -> f32; 2] = [|value| value.re, |value| value.im];
    let seen = pairs.iter().map(|(first, _)| first);
    seen.zip(parts).map(|(seen, part)| highest(&values.iter().map(part).collect::<Vec<f32>>(), seen)).collect()
}

/// What a correlation says, by its highest value.
fn highest(values: &[f32], seen: &EdgeSpectrum) -> Option<PairShift> {
    let side = seen.side;
    let power = values.iter().map(|value| f64::from(*value).powi(2)).sum::<f64>() / values.len() as f64;
    // What lies beyond half the grid is a shift to the other side.
    let signed = |index: usize| if index > side / 2 { index as f64 - side as f64 } else { index as f64 };
    let is_within = |index: &usize| {
        let cells = [index % side, index / side].map(signed);
        cells.iter().zip(seen.reach).all(|(cells, reach)| cells.abs() <= reach as f64)
    };
    let peaks = values.iter().copied().enumerate().filter(|(index, _)| is_within(index));
    let (peak, value) = peaks.max_by(|(_, a), (_, b)| a.total_cmp(b))?;
    let at = |x: usize, y: usize| f64::from(values[(y % side) * side + x % side]);
    let (x, y) = (peak % side, peak / side);
    let between = |before: f64, after: f64| {
        let curvature = 2.0 * f64::from(value) - before - after;
        if curvature > 0.0 { (after - before) / (2.0 * curvature) } else { 0.0 }
    };
    let fraction = [between(at(x + side - 1, y), at(x + 1, y)), between(at(x, y + side - 1), at(x, y + 1))];
    let cells = [x, y].map(signed);
    let reach = NEAR_REST * length(cells);
    let near = |offset: &usize| signed(*offset).abs() <= reach;
    let beside = (0..side).filter(near).flat_map(|y| (0..side).filter(near).map(move |x| (x, y)));
    let highest = beside.filter(|(x, y)| length([signed(*x), signed(*y)]) <= reach).map(|(x, y)| at(x, y));
    Some(PairShift {
        shift_px: [0, 1].map(|axis| (cells[axis] + fraction[axis]) * seen.cell_px),
        at_rest: highest.fold(0.0, f64::max) / f64::from(value).max(f64::MIN_POSITIVE),
        strength: f64::from(value) / power.sqrt().max(f64::MIN_POSITIVE),
    })
}

/// A photo that lies beside the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moved {
    /// Which one.
    pub photo: usize,
    /// How far from where the others lie, x right and y down, in pixels.
    pub shift_px: [f64; 2],
    /// Height of the peak that says so, in standard deviations of the correlation.
    pub strength: f64,
}

/// The photos that lie beside the others, which are most of them.
///
/// The strongest pairs that join all photos say where each lies: lamps from opposite sides share few edges, and the edges of
/// their shadows lie elsewhere, but there is a way from one to the other over lamps between them.
///
/// # Errors
/// An option out of its range.
pub fn find_moved(
    spectra: &[Option<EdgeSpectrum>],
    options: &ShiftOptions,
    watch: &dyn Watch,
) -> Result<Vec<Moved>, OptionError> {
    options.check()?;
    let count = spectra.len();
    let partners = |a: usize| (a + 1..count).filter(move |b| (b - a).min(a + count - b) <= MAX_PARTNERS);
    let pairs: Vec<_> = (0..count).flat_map(|a| partners(a).map(move |b| (a, b))).collect();
    let cell_px = spectra.iter().flatten().next().map_or(1.0, |spectrum| spectrum.cell_px);
    let rest_px = options.max_rest_px.max(options.max_rest_cells * cell_px);
    let known = |&(a, b): &(usize, usize)| Some((spectra[a].as_ref()?, spectra[b].as_ref()?));
    let pairs: Vec<_> = pairs.into_iter().filter(|pair| known(pair).is_some()).collect();
    let shifts = |two: &[(usize, usize)]| {
        let seen: Vec<_> = two.iter().filter_map(known).collect();
        if watch.cancelled() { vec![None; two.len()] } else { pair_shifts(&seen) }
    };
    let shifts: Vec<Option<PairShift>> = pairs.par_chunks(2).flat_map_iter(shifts).collect();
    let join = |(&(a, b), pair): (&(usize, usize), Option<PairShift>)| {
        let pair = pair.filter(|pair| pair.strength >= options.min_strength)?;
        let is_at_rest = pair.at_rest >= options.min_at_rest && length(pair.shift_px) > rest_px;
        let shift_px = if is_at_rest { [0.0; 2] } else { pair.shift_px };
        Some(Joined { a, b, pair: PairShift { shift_px, ..pair } })
    };
    let mut joined: Vec<Joined> = pairs.iter().zip(shifts).filter_map(join).collect();
    joined.sort_by(|one, other| other.pair.strength.total_cmp(&one.pair.strength));
    let placed = places(count, &joined);

    let from = |origin: &Place, place: &Place| [0, 1].map(|axis| place.shift_px[axis] - origin.shift_px[axis]);
    let lies_at = |origin: &Place, place: &Place| place.group == origin.group && length(from(origin, place)) <= rest_px;
    let most = |place: &Place| placed.iter().filter(|other| lies_at(place, other)).count();
    let Some(origin) = placed.iter().rev().max_by_key(|place| most(place)) else { return Ok(Vec::new()) };
    // Steps from photo to photo may add up to more than any two of them can show.
    let reach_px =
        spectra.iter().flatten().next().map_or([0.0; 2], |seen| seen.reach.map(|cells| cells as f64 * cell_px));
    let is_seen = |place: &Place| from(origin, place).iter().zip(reach_px).all(|(shift, reach)| shift.abs() <= reach);
    let moved = placed.iter().enumerate().filter(|(_, place)| place.group == origin.group && !lies_at(origin, place));
    let moved = moved.filter(|(_, place)| is_seen(place));
    let moved = moved.map(|(photo, place)| Moved { photo, shift_px: from(origin, place), strength: place.strength });
    Ok(moved.collect())
}

/// Two photos that can be compared.
#[derive(Debug)]
struct Joined {
    a: usize,
    b: usize,
    pair: PairShift,
}

/// Where a photo lies with respect to the others of its group.
#[derive(Clone, Copy, Debug)]
struct Place {
    group: usize,
    shift_px: [f64; 2],
    /// The weakest pair that joins it to the others.
    strength: f64,
}

/// Joins photos by their pairs, the strongest first.
fn places(count: usize, joined: &[Joined]) -> Vec<Place> {
    let alone = |group| Place { group, shift_px: [0.0; 2], strength: f64::INFINITY };
    let mut placed: Vec<Place> = (0..count).map(alone).collect();
    for Joined { a, b, pair } in joined {
        let (kept, other) = (placed[*a], placed[*b]);
        if kept.group == other.group {
            continue;
        }
        let by = [0, 1].map(|axis| kept.shift_px[axis] + pair.shift_px[axis] - other.shift_px[axis]);
        for place in placed.iter_mut().filter(|place| [kept.group, other.group].contains(&place.group)) {
            place.strength = place.strength.min(pair.strength);
            if place.group == other.group {
                *place =
                    Place { group: kept.group, shift_px: [0, 1].map(|axis| place.shift_px[axis] + by[axis]), ..*place };
            }
        }
    }
    placed
}

fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

fn from_cells(columns: usize, rows: usize, value: impl Fn(usize, usize) -> f32 + Sync) -> Plane {
    let cells = (0..columns * rows).into_par_iter().map(|index| value(index % columns, index / columns));
    Plane::from_vec(columns, rows, cells.collect()).unwrap_or_else(|| Plane::filled(columns, rows, 0.0))
}

/// A square of values to or from frequencies; those are transposed.
fn transform(values: &mut Vec<Complex<f32>>, side: usize, fft: &dyn Fft<f32>) {
    let mut turned = vec![Complex::default(); values.len()];
    for _ in 0..2 {
        values.par_chunks_mut(side * ROWS_OF_JOB).for_each(|rows| fft.process(rows));
        transpose::transpose(values, &mut turned, side, side);
        std::mem::swap(values, &mut turned);
    }
}

/// Leaves of each frequency its phase alone, and counts finer frequencies less, which are mostly noise.
fn keep_phases(values: &mut [Complex<f32>], side: usize) {
    let frequency = |index: usize| if index > side / 2 { index as f32 - side as f32 } else { index as f32 };
    let fine = FINE_FREQUENCY * side as f32;
    values.par_iter_mut().enumerate().for_each(|(index, value)| {
        let [x, y] = [index % side, index / side].map(frequency);
        let weight = (-(x * x + y * y) / (2.0 * fine * fine)).exp();
        let size = value.norm();
        // The mean is that of the window, which is the same for all photos.
        *value = if size > 0.0 && index > 0 { *value * (weight / size) } else { Complex::default() };
    });
}
