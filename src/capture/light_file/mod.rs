//! Light files (`.lp`) of reflectance transformation imaging: a line with the count, then a line `file x y z` for each
//! photo, with the direction to its light: x right, y up, z toward the camera, which is the object frame.
//!
//! RTIBuilder, RelightLab and the PTM tools read and write them. Relight's domes (`.dome`) are read as well.

mod assign;
mod dome;
mod encoding;
mod error;
mod read;

use std::fmt::Write;

use nalgebra::Vector3;

pub use assign::CarriedLights;
pub use error::{LightFileError, LightFileProblem};

/// A photo and the direction to its light.
#[derive(Clone, Debug, PartialEq)]
pub struct LightLine {
    /// The photo's path as the file writes it.
    pub file: String,
    /// Unit vector from the object to the light in the object frame.
    pub direction_to_light: Vector3<f64>,
}

/// What a light file says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightFile {
    /// In the order of the file.
    pub lines: Vec<LightLine>,
}

impl LightFile {
    /// The file's text.
    pub fn text(&self) -> String {
        let mut text = format!("{}\n", self.lines.len());
        for LightLine { file, direction_to_light: d } in &self.lines {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{file} {:.9} {:.9} {:.9}", d.x, d.y, d.z);
        }
        text
    }
}
