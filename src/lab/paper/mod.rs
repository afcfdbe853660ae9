//! The synthetic experiments of Liao, Huang and Yang, CVPR 2011, section 4 and Figure 3, done again.
//!
//! The paper leaves open its lamps' directions, the first scene's albedos and the second scene's shape. Here three lamps
//! of one strength stand 20 degrees from the camera's axis, the corner has albedos 0.5 and 0.25 ("half of that"), and
//! the second scene, with the paper's four albedos, is [`Shape::Tray`].

mod figures;
mod plot;
mod rendered;
mod report;

use firstbounce_core::options::check_range;
use firstbounce_core::{Portion, Watch};
use serde::Serialize;

use crate::LabError;
use rendered::Experiment;

pub use report::{MADE_FOR_ALL_BOUNCES, PUBLISHED, PaperRecord, PaperRowRecord, PublishedRecord, paper_html};

/// How finely the scenes are rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperOptions {
    /// Side of the pictures.
    pub size_px: usize,
    /// Patches of the corner.
    pub corner_patches: usize,
    /// Patches of the tray.
    pub tray_patches: usize,
}

impl Default for PaperOptions {
    fn default() -> Self {
        Self { size_px: 96, corner_patches: 600, tray_patches: 1500 }
    }
}

impl PaperOptions {
    /// Whether every option is in its range; the shapes check their patches.
    pub fn check(&self) -> Result<(), LabError> {
        Ok(check_range("size_px", self.size_px as f64, (16..=4096).contains(&self.size_px), "16 to 4096")?)
    }
}

/// Mean errors over the pixels that all three lamps light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PaperErrors {
    /// Normals from the photos without separation.
    pub raw_deg: f64,
    /// Normals from bounce 1.
    pub separated_deg: f64,
    /// Normals from the true direct light: what photometric stereo itself costs where a pixel holds several surfaces or
    /// the edge of a shadow.
    pub true_direct_deg: f64,
    /// Bounce 1 against the true direct light, in grey levels of 8 bits.
    pub direct_error_levels: f64,
    /// The same relative to the mean of the true direct light.
    pub direct_error_percent: f64,
    /// By colours and shape together; `None` for light that is cut after m bounces, which the method is not made for.
    pub colours_and_shape: Option<ColoursAndShapeErrors>,
}

/// Mean errors of colours and shape together over the same pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ColoursAndShapeErrors {
    /// Normals from the direct light.
    pub normals_deg: f64,
    /// The direct light against the true, in grey levels of 8 bits.
    pub direct_error_levels: f64,
    /// The same relative to the mean of the true direct light.
    pub direct_error_percent: f64,
}

/// One scene under one kind of light.
#[derive(Clone, Debug, PartialEq)]
pub struct TableRow {
    /// "corner" or "tray".
    pub scene: &'static str,
    /// "two bounces", "four bounces" or "all bounces".
    pub light: &'static str,
    /// The order m that was separated.
    pub bounces: usize,
    /// The paint, reference first.
    pub albedos: Vec<f64>,
    /// The mean of the true direct light in grey levels of 8 bits: the paper's.
    pub mean_direct_level: f64,
    /// From pictures without noise or rounding.
    pub noiseless: PaperErrors,
    /// From pictures of 8 bits.
    pub eight_bit: PaperErrors,
}

/// A point of Figure 3.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figure3Point {
    /// beta: the second albedo over the first.
    pub ratio: f64,
    /// Bits of the pictures.
    pub bits: u32,
    /// Mean error of bounce 1 over the mean true direct light.
    pub error_percent: f64,
}

/// A point of Figure 3 for light that bounces without end: mean errors of the normals.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AllBouncesPoint {
    /// beta: the second albedo over the first.
    pub ratio: f64,
    /// Bits of the pictures.
    pub bits: u32,
    /// Of the photos without separation.
    pub raw_deg: f64,
    /// Of bounce 1 by the paper's method, m = 2.
    pub separated_deg: f64,
    /// Of the direct light by colours and shape together.
    pub colours_and_shape_deg: f64,
}

/// All results.
#[derive(Clone, Debug, PartialEq)]
pub struct Paper {
    /// The synthetic half of Table 1.
    pub table: Vec<TableRow>,
    /// Figure 3, by bits, then ratio.
    pub figure3: Vec<Figure3Point>,
    /// The same for all bounces, by bits, then ratio.
    pub figure3_all_bounces: Vec<AllBouncesPoint>,
}

/// The ratios of Figure 3.
const RATIOS: [f64; 22] = [
    0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.94, 0.96, 0.98, 1.02, 1.04, 1.06, 1.1, 1.2, 1.35,
    1.5,
];
const FIGURE3_BITS: [u32; 2] = [8, 14];
/// Does all experiments.
pub fn paper(options: &PaperOptions, watch: &dyn Watch) -> Result<Paper, LabError> {
    options.check()?;
    let corner = Experiment { patches: options.corner_patches, ..Experiment::corner() };
    let tray = Experiment { patches: options.tray_patches, ..Experiment::tray() };
    let corner = corner.render(options.size_px, &Portion { watch, from: 0.0, to: 0.1 })?;
    let figure3 = corner.figure3(&Portion::still(watch, 0.1))?;
    let figure3_all_bounces = corner.figure3_all_bounces(&Portion { watch, from: 0.1, to: 0.4 })?;
    let mut table = corner.rows(&Portion::still(watch, 0.4))?;
    let tray = tray.render(options.size_px, &Portion { watch, from: 0.4, to: 0.9 })?;
    table.extend(tray.rows(&Portion::still(watch, 0.9))?);
    watch.progress(1.0);
    Ok(Paper { table, figure3, figure3_all_bounces })
}

#[cfg(test)]
mod tests {
    use firstbounce_core::Unwatched;

    use super::*;

    #[test]
    fn the_papers_claims_hold() {
        let options = PaperOptions { size_px: 48, corner_patches: 300, tray_patches: 500 };
        let Paper { table, figure3, figure3_all_bounces } = paper(&options, &Unwatched).unwrap();
        for row in &table {
            println!("{row:.2?}");
        }
        let corner = table[0].noiseless;
        assert!(corner.separated_deg <= 0.3 && corner.true_direct_deg <= 0.3 && corner.raw_deg > 3.0);
        // Where the model holds, separation costs nothing: what is left is photometric stereo's.
        for row in table.iter().filter(|row| row.light != "all bounces") {
            let PaperErrors { separated_deg, true_direct_deg, direct_error_percent, .. } = row.noiseless;
            assert!((separated_deg - true_direct_deg).abs() < 0.01 && direct_error_percent < 0.1, "{row:?}");
        }
        for row in &table {
            for errors in [row.noiseless, row.eight_bit] {
                assert!(errors.separated_deg < errors.raw_deg, "{row:?}");
            }
        }
        // Equation 5 scales the noise of bounce 1 by sqrt(1 + beta^4) / (beta (1 - beta)): the curve follows it where
        // rounding is fine enough to be noise.
        let error = |bits: u32, ratio: f64| {
            figure3.iter().find(|point| (point.bits, point.ratio) == (bits, ratio)).unwrap().error_percent
        };
        let gain = |beta: f64| (1.0 + beta.powi(4)).sqrt() / (beta * (1.0 - beta).abs());
        for ratio in RATIOS {
            let expected = error(14, 0.5) * gain(ratio) / gain(0.5);
            println!("{ratio}: {:.3} % at 8 bits, {:.4} % at 14 for {expected:.4}", error(8, ratio), error(14, ratio));
            assert!((0.5..2.0).contains(&(error(14, ratio) / expected)), "{ratio}");
        }
        for [far, near] in [[0.5, 0.8], [0.8, 0.9], [0.9, 0.98], [1.5, 1.2], [1.2, 1.06], [1.06, 1.02]] {
            assert!(error(8, far) < error(8, near), "{far} {near}");
        }
        for row in &table {
            for errors in [row.noiseless, row.eight_bit] {
                assert_eq!(errors.colours_and_shape.is_some(), row.light == "all bounces");
            }
            // Without rounding four colours tell four bounces better than the shape of the tray does.
            let together = row.eight_bit.colours_and_shape;
            assert!(together.is_none_or(|together| together.normals_deg < row.eight_bit.separated_deg), "{row:?}");
        }
        assert_eq!(figure3_all_bounces.len(), figure3.len());
        for point in &figure3_all_bounces {
            println!("{point:.2?}");
        }
        for point in &figure3_all_bounces {
            let AllBouncesPoint { ratio, bits, raw_deg, separated_deg, colours_and_shape_deg } = *point;
            assert!(colours_and_shape_deg < 0.2 * raw_deg, "{point:?}");
            // A second colour so dark that it hardly bounces needs no shape, if only the picture is fine enough.
            assert!(colours_and_shape_deg < separated_deg || (bits == 14 && ratio < 0.5), "{point:?}");
        }
    }
}
