//! The calibrated lights, for tools that relight.

use nalgebra::Vector3;

use super::{Files, OutputOptions, write_text};
use crate::light_file::{LightFile, LightLine};
use crate::pipeline::{Calibrated, Known, PipelineError};
use crate::set::{CaptureSet, Light, Subject};

/// Writes a light file for the reference colour, and for the others where they are asked for.
pub(super) fn write_lights(
    set: &CaptureSet,
    calibrated: &Calibrated,
    options: &OutputOptions,
    files: &mut Files,
) -> Result<(), PipelineError> {
    let wanted = if options.lights_per_colour { set.colours.len() } else { 1 };
    for (c, colour) in set.colours.iter().enumerate().take(wanted) {
        let lights = light_file(set, calibrated, &colour.name);
        if lights.lines.is_empty() {
            continue;
        }
        let name = if c == 0 { "lights.lp".to_owned() } else { format!("lights-{}.lp", colour.name) };
        let what = format!(
            "directions to the lights of the object's {} photos, which it names by paths from the set's folder",
            colour.name
        );
        write_text(&files.add(name, what)?, &lights.text())?;
    }
    Ok(())
}

/// The lights with the object's photos in a colour. A lamp at a known position has the direction in which the origin sees
/// it. Lights that nothing tells of are left out.
fn light_file(set: &CaptureSet, calibrated: &Calibrated, colour: &str) -> LightFile {
    let line = |(light, known): (&Light, &Option<Known<[f64; 3]>>)| {
        let to_light = light.position_mm.or(known.as_ref().map(|known| known.value))?;
        let shot = set.shot(Subject::Object, Some(&light.name), Some(colour))?;
        let direction_to_light = Vector3::from(to_light).try_normalize(0.0)?;
        Some(LightLine { file: shot.files.first()?.clone(), direction_to_light })
    };
    LightFile { lines: set.lights.iter().zip(&calibrated.direction).filter_map(line).collect() }
}
