//! The pixels of a ball that may be measured, and why the others may not.

use super::CalibrateError;
use crate::Photo;
use crate::image::photo::{CLIPPED, DARK};
use crate::interval::{quantile, robust_sd};
use crate::options::check_range;
use crate::sphere::{Ball, Circle};
use nalgebra::{Matrix4, Vector3, Vector4};
use rayon::prelude::*;

/// What became of a pixel in the square around a ball.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelUse {
    /// Not on the ball.
    Outside,
    /// Measured.
    Used,
    /// At the white level in a photo.
    Clipped,
    /// Within the noise of no light in a photo.
    Dark,
    /// So far out that the normal is uncertain.
    NearRim,
    /// Where the light ends, or beyond.
    NearTerminator,
    /// Brighter than matt paint can be: gloss.
    Highlight,
    /// Off for no known reason: dust, a scratch, a shadow.
    Outlier,
}

/// Pixels of a ball by what became of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct PixelCounts {
    /// [`PixelUse::Used`].
    pub used: usize,
    /// [`PixelUse::Clipped`].
    pub clipped: usize,
    /// [`PixelUse::Dark`].
    pub dark: usize,
    /// [`PixelUse::NearRim`].
    pub near_rim: usize,
    /// [`PixelUse::NearTerminator`].
    pub near_terminator: usize,
    /// [`PixelUse::Highlight`].
    pub highlight: usize,
    /// [`PixelUse::Outlier`].
    pub outlier: usize,
}

impl PixelCounts {
    /// All pixels of the ball.
    pub fn inside(&self) -> usize {
        self.used + self.clipped + self.dark + self.near_rim + self.near_terminator + self.highlight + self.outlier
    }
}

impl std::fmt::Display for PixelCounts {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "clipped {}, dark {}, near the rim {}, near the terminator {}, highlight {}, outlier {}",
            self.clipped, self.dark, self.near_rim, self.near_terminator, self.highlight, self.outlier
        )
    }
}

/// The square around a ball with the use of each of its pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct BallPixels {
    /// Column and row of the square's top left pixel in the photo.
    pub origin: (usize, usize),
    /// Pixels in a row of the square.
    pub width: usize,
    /// The use of each pixel, row by row.
    pub uses: Vec<PixelUse>,
}

impl BallPixels {
    /// How many pixels there are of each kind.
    pub fn counts(&self) -> PixelCounts {
        let mut counts = PixelCounts::default();
        for pixel in &self.uses {
            match pixel {
                PixelUse::Outside => {}
                PixelUse::Used => counts.used += 1,
                PixelUse::Clipped => counts.clipped += 1,
                PixelUse::Dark => counts.dark += 1,
                PixelUse::NearRim => counts.near_rim += 1,
                PixelUse::NearTerminator => counts.near_terminator += 1,
                PixelUse::Highlight => counts.highlight += 1,
                PixelUse::Outlier => counts.outlier += 1,
            }
        }
        counts
    }

    /// Column and row in the photo of a pixel of the square.
    fn position(&self, index: usize) -> (usize, usize) {
        (self.origin.0 + index % self.width, self.origin.1 + index / self.width)
    }

    /// All measured pixels, in order.
    pub(super) fn used(&self) -> Vec<BallPixel> {
        (0..self.uses.len())
            .into_par_iter()
            .filter(|&i| self.uses[i] == PixelUse::Used)
            .map(|i| self.pixel(i))
            .collect()
    }

    fn pixel(&self, index: usize) -> BallPixel {
        let (x, y) = self.position(index);
        let rows = self.uses.len() / self.width;
        let region = |at: usize, side: usize| (at * REGIONS_ACROSS / side).min(REGIONS_ACROSS - 1);
        let (column, row) = (index % self.width, index / self.width);
        BallPixel { index, x, y, region: region(row, rows) * REGIONS_ACROSS + region(column, self.width) }
    }
}

/// Regions along one side of the square that the jackknife leaves out in turn.
const REGIONS_ACROSS: usize = 8;
/// All regions.
pub(super) const REGIONS: usize = REGIONS_ACROSS * REGIONS_ACROSS;

/// A measured pixel: its index in the square, its column and row in the photo, and its region for the jackknife.
#[derive(Clone, Copy, Debug)]
pub(super) struct BallPixel {
    pub index: usize,
    pub x: usize,
    pub y: usize,
    pub region: usize,
}

impl BallPixel {
    pub fn value(&self, photo: &Photo) -> f64 {
        f64::from(photo.linear.at(self.x, self.y))
    }

    pub fn normal(&self, ball: &Ball) -> Option<Vector3<f64>> {
        ball.surface_at(self.x as f64 + 0.5, self.y as f64 + 0.5).map(|point| point.normal)
    }
}

/// Which pixels are good enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelOptions {
    /// Pixels farther out are refused, in ball radii.
    pub max_radii: f64,
    /// Pixels lit more obliquely are refused: cosine between normal and light.
    pub min_cosine: f64,
    /// Pixels off the matt ball by more standard deviations are refused, and pixels brighter by as much are gloss.
    pub max_deviations: f64,
    /// The largest fraction of the lit part that may be clipped.
    pub max_clipped: f64,
    /// The least number of pixels to measure on.
    pub min_pixels: usize,
}

impl Default for PixelOptions {
    fn default() -> Self {
        Self { max_radii: 0.95, min_cosine: 0.2, max_deviations: 5.0, max_clipped: 0.25, min_pixels: 100 }
    }
}

impl PixelOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), CalibrateError> {
        check_range("max_radii", self.max_radii, (0.2..=1.0).contains(&self.max_radii), "between 0.2 and 1")?;
        check_range("min_cosine", self.min_cosine, (0.0..0.9).contains(&self.min_cosine), "between 0 and 0.9")?;
        check_range("max_deviations", self.max_deviations, self.max_deviations >= 2.0, "2 or more")?;
        check_range("max_clipped", self.max_clipped, (0.0..=1.0).contains(&self.max_clipped), "between 0 and 1")?;
        Ok(check_range("min_pixels", self.min_pixels as f64, self.min_pixels >= 20, "20 or more")?)
    }
}

/// I = b.n + ambient on the lit part of a ball; b points to the light and is as long as the light is strong.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shading {
    pub light: Vector3<f64>,
    pub ambient: f64,
}

/// Chooses the pixels that are good in every photo; the shading is judged on the first.
pub(super) fn choose_pixels(
    photos: &[&Photo],
    ball: &Ball,
    options: &PixelOptions,
) -> Result<BallPixels, CalibrateError> {
    options.check()?;
    let Some(first) = photos.first() else {
        return Err(CalibrateError::NothingMeasured { quantity: "a ball" });
    };
    let size = first.linear.size();
    if let Some(other) = photos.iter().map(|photo| photo.linear.size()).find(|&other| other != size) {
        return Err(CalibrateError::SizesDiffer { first: size, other });
    }
    if !ball.circle().lies_in(size) {
        return Err(CalibrateError::LeavesImage { circle: ball.circle(), size });
    }
    let mut pixels = mark_pixels(photos, &ball.circle(), options.max_radii);
    check_exposure(&pixels, first, options)?;
    refuse_by_shading(&mut pixels, first, ball, options);
    require_enough(&pixels, options)?;
    Ok(pixels)
}

pub(super) fn require_enough(pixels: &BallPixels, options: &PixelOptions) -> Result<(), CalibrateError> {
    let counts = pixels.counts();
    if counts.used < options.min_pixels {
        return Err(CalibrateError::TooFewPixels { counts, needed: options.min_pixels });
    }
    Ok(())
}

fn mark_pixels(photos: &[&Photo], circle: &Circle, max_radii: f64) -> BallPixels {
    let (width, height) = photos[0].linear.size();
    let ((cx, cy), r) = (circle.centre_px, circle.radius_px);
    let span = |centre: f64, side: usize| {
        ((centre - r).floor().max(0.0) as usize)..((centre + r).ceil().max(0.0) as usize).min(side)
    };
    let (columns, rows) = (span(cx, width), span(cy, height));
    let (origin, across) = ((columns.start, rows.start), columns.len());
    let uses = rows
        .into_par_iter()
        .flat_map_iter(|y| {
            columns.clone().map(move |x| {
                let radii = circle.radii_from_centre(x as f64 + 0.5, y as f64 + 0.5);
                let marks = photos.iter().fold(0, |marks, photo| marks | photo.marks.at(x, y));
                let finite = photos.iter().all(|photo| photo.linear.at(x, y).is_finite());
                match () {
                    _ if radii > 1.0 => PixelUse::Outside,
                    _ if radii > max_radii => PixelUse::NearRim,
                    _ if marks & CLIPPED != 0 => PixelUse::Clipped,
                    _ if marks & DARK != 0 => PixelUse::Dark,
                    _ if !finite => PixelUse::Outlier,
                    _ => PixelUse::Used,
                }
            })
        })
        .collect();
    BallPixels { origin, width: across, uses }
}

/// Clipped pixels are counted against those that are lit at all, a quarter as bright as the bright ones.
fn check_exposure(pixels: &BallPixels, photo: &Photo, options: &PixelOptions) -> Result<(), CalibrateError> {
    let clipped = pixels.counts().clipped as f64;
    let level = lit_level(pixels, photo);
    let lit = pixels.used().par_iter().filter(|pixel| pixel.value(photo) > level).count() as f64;
    let share = clipped / (clipped + lit).max(1.0);
    if share > options.max_clipped {
        return Err(CalibrateError::Clipped { clipped: share, allowed: options.max_clipped });
    }
    Ok(())
}

fn lit_level(pixels: &BallPixels, photo: &Photo) -> f64 {
    let mut values: Vec<f64> = pixels.used().par_iter().map(|pixel| pixel.value(photo)).collect();
    0.25 * quantile(&mut values, 0.95)
}

/// Fits matt shading a few times over, each time leaving out what the last fit showed to be something else.
fn refuse_by_shading(pixels: &mut BallPixels, photo: &Photo, ball: &Ball, options: &PixelOptions) {
    let candidates: Vec<(BallPixel, Vector3<f64>, f64)> =
        pixels.used().into_par_iter().filter_map(|p| Some((p, p.normal(ball)?, p.value(photo)))).collect();
    let level = lit_level(pixels, photo);
    let mut judged: Vec<PixelUse> = candidates
        .par_iter()
        .map(|&(_, _, value)| if value > level { PixelUse::Used } else { PixelUse::NearTerminator })
        .collect();
    for _ in 0..4 {
        let kept = || candidates.iter().zip(&judged).filter(|&(_, &judgement)| judgement == PixelUse::Used);
        let Some(fit) = fit_shading(kept().map(|((_, normal, value), _)| (*normal, *value))) else { return };
        let strength = fit.light.norm();
        let residual = |normal: &Vector3<f64>, value: f64| value - normal.dot(&fit.light) - fit.ambient;
        // Paint and light are never perfect to a part in two hundred; less is no reason to refuse a pixel.
        let sd = robust_sd(kept().map(|((_, n, v), _)| residual(n, *v))).max(0.005 * strength);
        let judge = |normal: &Vector3<f64>, value: f64| match residual(normal, value) / sd {
            _ if normal.dot(&fit.light) < options.min_cosine * strength => PixelUse::NearTerminator,
            off if off > options.max_deviations => PixelUse::Highlight,
            off if off < -options.max_deviations => PixelUse::Outlier,
            _ => PixelUse::Used,
        };
        judged = candidates.par_iter().map(|(_, normal, value)| judge(normal, *value)).collect();
    }
    for ((pixel, ..), judgement) in candidates.iter().zip(judged) {
        pixels.uses[pixel.index] = judgement;
    }
}

/// Least squares of matt shading; `None` where the normals do not span it.
pub(super) fn fit_shading(samples: impl Iterator<Item = (Vector3<f64>, f64)>) -> Option<Shading> {
    let mut sums = ShadingSums::default();
    samples.for_each(|(normal, value)| sums.add(normal.push(1.0), value));
    let fit = sums.solve()?;
    Some(Shading { light: fit.xyz(), ambient: fit.w })
}

/// Normal equations of the shading fit.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ShadingSums {
    matrix: Matrix4<f64>,
    right: Vector4<f64>,
}

impl ShadingSums {
    pub fn add(&mut self, row: Vector4<f64>, value: f64) {
        self.matrix += row * row.transpose();
        self.right += row * value;
    }

    pub fn merge(&mut self, other: &Self) {
        self.matrix += other.matrix;
        self.right += other.right;
    }

    pub fn solve(&self) -> Option<Vector4<f64>> {
        let solution = self.matrix.cholesky()?.solve(&self.right);
        solution.iter().all(|v| v.is_finite()).then_some(solution)
    }
}
