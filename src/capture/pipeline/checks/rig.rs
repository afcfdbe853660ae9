//! What the balls show of the room and of the lamps' directions.

use super::CaptureWarning;
use crate::pipeline::Calibrated;
use crate::set::CaptureSet;

/// Warns of light that is not the lamps', and of directions that may be those of reflections.
pub(in crate::pipeline) fn of_rig(set: &CaptureSet, calibrated: &Calibrated) -> Vec<CaptureWarning> {
    let name = |l: usize| set.lights.get(l).map(|light| light.name.clone());
    let shares = calibrated.room_light.iter().enumerate();
    let lights: Vec<(String, f64)> = shares.filter_map(|(l, share)| Some((name(l)?, (*share)?))).collect();
    let room = (!lights.is_empty()).then_some(CaptureWarning::RoomLight { lights });
    let of_light = |(l, doubts): (usize, &Vec<_>)| {
        let light = name(l);
        let warning = move |doubt| Some(CaptureWarning::Direction { light: light.clone()?, doubt });
        doubts.clone().into_iter().filter_map(warning).collect::<Vec<_>>()
    };
    let directions = calibrated.direction_doubts.iter().enumerate().flat_map(of_light);
    room.into_iter().chain(directions).collect()
}
