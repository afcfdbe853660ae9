//! The positions of near lamps, from mirror balls that lie apart: several in one picture, or one in two places.

use firstbounce_core::calibrate::{
    HighlightOptions, HighlightReport, PositionEstimate, Sighting, find_highlights, lamp_position,
};
use nalgebra::Vector3;

use super::balls::BallShots;
use super::warning::Warning;
use super::{Known, Source};
use crate::set::CaptureSet;

/// A position whose distance is known to this share is one; others are directions to lamps too far away for these balls.
const MAX_DISTANCE_SHARE: f64 = 0.25;

/// The further mirror balls that place lamps together with the first: those in its pictures, and the ball in its second place. What
/// keeps them from it is told.
pub(super) fn other_mirrors(
    set: &CaptureSet,
    first: Option<&BallShots>,
    moved: Option<BallShots>,
) -> (Vec<BallShots>, Vec<Warning<'static>>) {
    let Some(first) = first else { return (Vec::new(), Vec::new()) };
    let mut warnings = Vec::new();
    let is_of_one_camera = |moved: &BallShots| {
        let (expected, found) = (first.size(), moved.size());
        if found != expected {
            warnings.push(Warning::MovedBallSize { expected, found });
        }
        found == expected
    };
    let moved = moved.filter(is_of_one_camera);
    let in_second_place = moved.as_ref().map_or_else(Vec::new, |moved| moved.others(set));
    let others: Vec<_> = first.others(set).into_iter().chain(moved).chain(in_second_place).collect();
    if !others.is_empty() && set.mm_per_pixel().is_none() {
        warnings.push(Warning::NoScaleForPositions);
    }
    (others, warnings)
}

/// Where light `l` is, by its highlight on the first mirror ball, which is known, and those on the others; `None` where they
/// do not show it, or the lamp is too far away.
pub(super) fn measure_position(
    set: &CaptureSet,
    l: usize,
    first: (&BallShots, &HighlightReport),
    others: &[BallShots],
) -> Option<Known<[f64; 3]>> {
    let camera = first.0.camera(set)?;
    let sighting = |ball: &BallShots, report: &HighlightReport| {
        report.chosen().map(|highlight| Sighting::of(highlight, ball.ball, ball.circle_sd_px))
    };
    let expected = first.1.chosen().map(|highlight| highlight.direction.direction_to_light);
    let other_sighting = |ball: &BallShots| {
        let options = HighlightOptions { circle_sd_px: ball.circle_sd_px, expected, ..HighlightOptions::default() };
        let lights = ball.under_other_lights(l, set.lights.len());
        let report = find_highlights(ball.any_photo(l)?, &lights, &ball.ball, &options).ok()?;
        sighting(ball, &report)
    };
    let sightings: Vec<Sighting> =
        sighting(first.0, first.1).into_iter().chain(others.iter().filter_map(other_sighting)).collect();
    known(lamp_position(&sightings, &camera).ok()?)
}

fn known(found: PositionEstimate) -> Option<Known<[f64; 3]>> {
    let PositionEstimate { position_mm, interval_mm, .. } = found;
    let half_width = interval_mm.map(|interval| (interval.high - interval.low) / 2.0);
    let is_near = Vector3::from(half_width).norm() < MAX_DISTANCE_SHARE * position_mm.norm() && position_mm.z > 0.0;
    is_near.then(|| Known {
        interval: Some([interval_mm.map(|interval| interval.low), interval_mm.map(|interval| interval.high)]),
        ..Known::new(position_mm.into(), Source::MirrorBall)
    })
}
