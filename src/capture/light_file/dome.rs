//! Domes of Relight (`.dome`): JSON with the directions, or the positions, of the lights of a rig, and without names of
//! photos.

use nalgebra::Vector3;
use serde::Deserialize;

use super::read::unit;
use super::{LightFile, LightFileProblem, LightLine};

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Dome {
    #[serde(default)]
    directions: Vec<Point>,
    #[serde(default)]
    positions_sphere: Vec<Point>,
    #[serde(default, rename = "positions3d")]
    positions_3d: Vec<Point>,
    #[serde(default)]
    positions: Vec<Point>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Point {
    List([f64; 3]),
    Named { x: f64, y: f64, z: f64 },
}

/// Whether a text is JSON, as no light file is.
pub(super) fn is_dome(text: &str) -> bool {
    text.trim_start().starts_with('{')
}

/// Reads the text of a dome. Light n has the name n for its photo, which fits none: the order decides.
pub(super) fn parse(text: &str) -> Result<LightFile, LightFileProblem> {
    let dome: Dome =
        serde_json::from_str(text).map_err(|error| LightFileProblem::NotADome { reason: error.to_string() })?;
    let lists = [dome.directions, dome.positions_3d, dome.positions_sphere, dome.positions];
    let points = lists.into_iter().find(|points| !points.is_empty()).ok_or(LightFileProblem::Empty)?;
    let line = |(number, point): (usize, Point)| {
        let (Point::List([x, y, z]) | Point::Named { x, y, z }) = point;
        let file = format!("light {number}");
        match unit(&Vector3::new(x, y, z)) {
            Some(direction_to_light) => Ok(LightLine { file, direction_to_light }),
            None => Err(LightFileProblem::NoDirection { file, found: format!("{x} {y} {z}") }),
        }
    };
    Ok(LightFile { lines: (1..).zip(points).map(line).collect::<Result<_, _>>()? })
}
