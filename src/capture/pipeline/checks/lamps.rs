//! Whether the rig belongs to the photos: lamps and directions that were mixed up.

use firstbounce_core::Watch;
use firstbounce_core::capture_checks::{LampPhoto, SmallPhoto, judge_lamps};
use nalgebra::Vector3;

use super::{CaptureWarning, CheckOptions};
use crate::pipeline::{Calibrated, Source};
use crate::set::CaptureSet;

/// Warns of lamps and photos that do not belong together; `small` are the object's in the reference colour, by light.
pub(super) fn lamps(
    set: &CaptureSet,
    small: &[Option<SmallPhoto>],
    calibrated: &Calibrated,
    options: &CheckOptions,
    watch: &dyn Watch,
) -> Vec<CaptureWarning> {
    let mut names = Vec::new();
    let mut lamps = Vec::new();
    for (l, (light, photo)) in set.lights.iter().zip(small).enumerate() {
        let direction = calibrated.direction.get(l).and_then(Option::as_ref).map(|known| known.value);
        // A near lamp is seen from the middle of the object.
        let direction = light.position_mm.or(direction).and_then(|to| Vector3::from(to).try_normalize(0.0));
        let intensity = calibrated.intensity.get(l).map_or(1.0, |known| known.value);
        if let (Some(photo), Some(direction)) = (photo, direction) {
            names.push(light.name.clone());
            lamps.push(LampPhoto { photo, toward: intensity * direction });
        }
    }
    let knows_intensities = calibrated.intensity.iter().all(|known| known.source != Source::Assumed);
    // The options were checked when the check began.
    let faults = judge_lamps(&lamps, knows_intensities, &options.lamps, watch).unwrap_or_default();
    faults.into_iter().map(|fault| CaptureWarning::Lamps { lights: names.clone(), fault }).collect()
}
