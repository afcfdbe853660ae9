//! Camera calibrations of OpenCV: focal length, principal point and distortion, as its FileStorage writes them (YAML, JSON, XML).

use std::path::{Path, PathBuf};

use serde_json::Value;
use thiserror::Error;

use crate::image_file::picture_size;
use crate::open::{OpenError, read_text};
use crate::set::{CaptureSet, Number, Projection, Subject};

/// Focal lengths of both axes that differ by less, as a share, are one.
const MAX_FOCAL_DIFFERENCE: f64 = 0.01;
/// The centre of the top left pixel: (0, 0) in OpenCV, (0.5, 0.5) here.
const PIXEL_CENTRE: f64 = 0.5;
/// A higher coefficient below this is none.
const NO_COEFFICIENT: f64 = 1e-9;

/// What a calibration file says of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraFile {
    /// Focal length in pixels, the mean of both axes.
    pub focal_length_px: f64,
    /// Where the optical axis meets the picture, in pixels of this program.
    pub principal_point: [f64; 2],
    /// k1, k2, p1 and p2.
    pub distortion: [f64; 4],
    /// Width and height of the pictures it was calibrated with, where the file says.
    pub size: Option<(usize, usize)>,
}

/// Why a calibration file cannot be used.
#[derive(Debug, Error)]
pub enum CameraFileError {
    /// The file.
    #[error("{}: {reason}", path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: OpenError,
    },
    /// Something else than a calibration.
    #[error("{}: no camera calibration: expected camera_matrix (9 numbers) and distortion_coefficients as OpenCV's FileStorage writes them, in YAML, JSON or XML", path.display())]
    NotOne {
        /// The file.
        path: PathBuf,
    },
    /// A camera that is none.
    #[error("{}: {what} is {found:?}, expected {expected}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// Which number.
        what: &'static str,
        /// What it is.
        found: f64,
        /// What it may be.
        expected: String,
    },
    /// Focal lengths that differ.
    #[error("{}: focal lengths of {x:.1} and {y:.1} px across and down: pixels are taken for square; resample the photos", path.display())]
    Focal {
        /// The file.
        path: PathBuf,
        /// Across.
        x: f64,
        /// Down.
        y: f64,
    },
    /// A model of more coefficients.
    #[error("{}: a distortion of more than k1, k2, p1, p2 ({found:?} is not 0): calibrate with CALIB_FIX_K3 and without the rational model", path.display())]
    Higher {
        /// The file.
        path: PathBuf,
        /// The coefficient.
        found: f64,
    },
    /// Pictures of another size.
    #[error("{}: calibrated with pictures of {} x {} pixels, the photos of the object have {} x {}: calibrate with the camera as it is", path.display(), of_file.0, of_file.1, of_set.0, of_set.1)]
    Size {
        /// The file.
        path: PathBuf,
        /// Its size in pixels.
        of_file: (usize, usize),
        /// The size of the object's photos.
        of_set: (usize, usize),
    },
    /// A set whose camera sees along parallel rays.
    #[error("{}: it describes a perspective camera: type projection = \"perspective\", focal_length_px and working_distance_mm under [camera] first", path.display())]
    Orthographic {
        /// The file.
        path: PathBuf,
    },
}

impl CameraFile {
    /// Reads a calibration file.
    ///
    /// # Errors
    /// One line: a file that cannot be read or is no calibration, and a camera that this program has no model of.
    pub fn read(path: &Path) -> Result<Self, CameraFileError> {
        let text = read_text(path).map_err(|reason| CameraFileError::Open { path: path.to_owned(), reason })?;
        Self::parse(&text, path)
    }

    /// Reads the text of the file at `path`.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, CameraFileError> {
        let path = path.to_owned();
        let found = matrix_in(text, "camera_matrix").zip(matrix_in(text, "distortion_coefficients"));
        let Some((matrix, coefficients)) = found.filter(|(matrix, d)| matrix.len() == 9 && (4..=14).contains(&d.len()))
        else {
            return Err(CameraFileError::NotOne { path });
        };
        let (x, y) = (matrix[0], matrix[4]);
        let in_range = |what: &'static str, number: Number, found: f64| {
            if number.allows(found) {
                return Ok(found);
            }
            let (low, high) = number.range().into_inner();
            Err(CameraFileError::Value { path: path.clone(), what, found, expected: format!("from {low} to {high}") })
        };
        in_range("the focal length across", Number::FocalLengthPx, x)?;
        in_range("the focal length down", Number::FocalLengthPx, y)?;
        if (x / y - 1.0).abs() > MAX_FOCAL_DIFFERENCE {
            return Err(CameraFileError::Focal { path, x, y });
        }
        let mut principal_point = [0.0; 2];
        for (value, found) in principal_point.iter_mut().zip([matrix[2], matrix[5]]) {
            *value = in_range("the principal point", Number::PrincipalPoint, found)? + PIXEL_CENTRE;
        }
        let mut distortion = [0.0; 4];
        for (value, found) in distortion.iter_mut().zip(&coefficients) {
            *value = in_range("a distortion coefficient", Number::Distortion, *found)?;
        }
        if let Some(found) = coefficients[4..].iter().copied().find(|found| found.abs() > NO_COEFFICIENT) {
            return Err(CameraFileError::Higher { path, found });
        }
        let size = whole_in(text, "image_width").zip(whole_in(text, "image_height"));
        Ok(Self { focal_length_px: (x + y) / 2.0, principal_point, distortion, size })
    }

    /// Puts the camera into a set whose camera is a perspective one.
    ///
    /// # Errors
    /// A camera with parallel rays, or photos of another size than the file's pictures.
    pub fn put_into(&self, set: &mut CaptureSet, path: &Path) -> Result<(), CameraFileError> {
        let file = set.shots_of(Subject::Object).flat_map(|shot| &shot.files).next();
        let of_set = file.and_then(|file| picture_size(&set.resolve(file)).ok()).map(|size| (size.width, size.height));
        if let Some((of_file, of_set)) = self.size.zip(of_set).filter(|(of_file, of_set)| of_file != of_set) {
            return Err(CameraFileError::Size { path: path.to_owned(), of_file, of_set });
        }
        match &mut set.camera.projection {
            Projection::Perspective { focal_length_px, principal_point, .. } => {
                (*focal_length_px, *principal_point) = (self.focal_length_px, Some(self.principal_point));
            }
            Projection::Orthographic { .. } => return Err(CameraFileError::Orthographic { path: path.to_owned() }),
        }
        set.camera.distortion = Some(self.distortion);
        Ok(())
    }
}

/// The numbers of a matrix of this name.
fn matrix_in(text: &str, name: &str) -> Option<Vec<f64>> {
    if let Ok(json) = serde_json::from_str::<Value>(text) {
        let data = json.get(name)?.get("data")?.as_array()?;
        return data.iter().map(Value::as_f64).collect();
    }
    let inner = if text.trim_start().starts_with("<?xml") {
        let matrix = between(text, &format!("<{name} "), &format!("</{name}>"))?;
        between(matrix, "<data>", "</data>")?
    } else {
        let start =
            text.lines().find(|line| line.starts_with(name) && line[name.len()..].trim_start().starts_with(':'))?;
        let rest = &text[start.as_ptr() as usize - text.as_ptr() as usize..];
        between(rest, "data:", "]")?.trim_start().strip_prefix('[')?
    };
    let numbers = inner.split(|letter: char| letter == ',' || letter.is_whitespace()).filter(|word| !word.is_empty());
    numbers.map(|word| word.parse::<f64>().ok().filter(|number| number.is_finite())).collect()
}

fn whole_in(text: &str, name: &str) -> Option<usize> {
    if let Ok(json) = serde_json::from_str::<Value>(text) {
        return json.get(name)?.as_u64().and_then(|number| usize::try_from(number).ok());
    }
    if text.trim_start().starts_with("<?xml") {
        return between(text, &format!("<{name}>"), &format!("</{name}>"))?.trim().parse().ok();
    }
    let line = text.lines().find_map(|line| line.strip_prefix(name)?.trim_start().strip_prefix(':'))?;
    line.trim().parse().ok()
}

fn between<'t>(text: &'t str, start: &str, end: &str) -> Option<&'t str> {
    let inner = text.split_once(start)?.1;
    Some(inner.split_once(end)?.0)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    use super::*;

    const YAML: &str = "%YAML 1.2\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   \
                        dt: d\n   data: [ 1000., 0., 320., 0., 1000., 240., 0., 0., 1. ]\ndistortion_coefficients: \
                        !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ -0.25, 0.080000000000000002, 0.001,\n       \
                        -0.0015, 0. ]\n";
    const JSON: &str = r#"{ "image_width": 640, "image_height": 480,
        "camera_matrix": { "type_id": "opencv-matrix", "rows": 3, "cols": 3, "dt": "d",
            "data": [ 1000.0, 0.0, 320.0, 0.0, 1000.0, 240.0, 0.0, 0.0, 1.0 ] },
        "distortion_coefficients": { "type_id": "opencv-nd-matrix", "sizes": [ 4 ], "dt": "d",
            "data": [ -0.25, 0.080000000000000002, 0.001, -0.0015 ] } }"#;
    const XML: &str = "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>640</image_width>\n<image_height>480</image_height>\n\
                       <camera_matrix type_id=\"opencv-matrix\">\n  <rows>3</rows>\n  <cols>3</cols>\n  <dt>d</dt>\n  <data>\n    1000. \
                       0. 320. 0. 1000. 240. 0. 0. 1.</data></camera_matrix>\n<distortion_coefficients type_id=\"opencv-matrix\">\n  \
                       <rows>1</rows>\n  <cols>4</cols>\n  <dt>d</dt>\n  <data>\n    -0.25 0.080000000000000002 0.001 \
                       -0.0015</data></distortion_coefficients>\n</opencv_storage>\n";

    fn read(text: &str) -> Result<CameraFile, CameraFileError> {
        CameraFile::parse(text, Path::new("camera.yml"))
    }

    #[test]
    fn a_calibration_of_opencv_is_read_in_each_of_its_formats() {
        let expected = CameraFile {
            focal_length_px: 1000.0,
            principal_point: [320.5, 240.5],
            distortion: [-0.25, 0.08, 0.001, -0.0015],
            size: Some((640, 480)),
        };
        for text in [YAML, JSON, XML] {
            assert_eq!(read(text).unwrap(), expected, "{text}");
            assert_eq!(read(&text.replace('\n', "\r\n")).unwrap(), expected);
        }
    }

    #[test]
    fn what_is_no_calibration_or_of_another_model_is_one_clear_line() {
        let refused = |text: &str| {
            let words = read(text).unwrap_err().to_string();
            assert!(words.starts_with("camera.yml: ") && !words.contains('\n'), "{words}");
            words
        };
        for text in [
            "",
            "{}",
            "[1, 2]",
            "camera_matrix: 3",
            "<?xml version=\"1.0\"?>",
            &YAML.replace("320.", "nan"),
            &JSON[..200],
        ] {
            assert!(refused(text).contains("no camera calibration"), "{text}");
        }
        assert!(refused(&YAML.replace("-0.0015, 0.", "-0.0015, 0.3")).contains("0.3 is not 0"));
        assert!(refused(&YAML.replace("0., 1000., 240.", "0., 1200., 240.")).contains("1000.0 and 1200.0 px"));
        assert!(refused(&YAML.replace("[ 1000.,", "[ -1000.,")).contains("focal length across"));
        assert!(refused(&YAML.replace("[ -0.25", "[ 1e9")).contains("distortion coefficient"));
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 64, rng_seed: RngSeed::Fixed(4), ..ProptestConfig::default() })]

        #[test]
        fn a_damaged_calibration_is_read_or_refused(from in 0..400usize, length in 0..60usize, letter in any::<char>()) {
            for text in [YAML, JSON, XML] {
                let mut letters: Vec<char> = text.chars().collect();
                let from = from.min(letters.len());
                let to = (from + length).min(letters.len());
                letters.splice(from..to, [letter]);
                let _ = read(&letters.into_iter().collect::<String>());
            }
        }
    }
}
