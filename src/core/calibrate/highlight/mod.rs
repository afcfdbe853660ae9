//! The direction to a lamp from its highlight on a mirror ball.

mod centre;
mod view;

use super::{
    CalibrateError, DirectionEstimate,
    direction::{check_circle_sd, check_lamp_distance},
};
use crate::image::photo::CLIPPED;
use crate::options::check_range;
use crate::sphere::{Ball, seen_from_centre};
use crate::{Photo, Plane};
use centre::centre_of;
use nalgebra::{Matrix3, Vector3};
use std::collections::HashSet;
use view::{BallView, components, outstanding_peak};

/// How to look for highlights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HighlightOptions {
    /// Spots at least this bright, as a fraction of the brightest, are candidates.
    pub min_peak: f64,
    /// Highlights farther out are not looked for, in ball radii.
    pub max_radii: f64,
    /// The most candidates to report.
    pub max_candidates: usize,
    /// Standard deviation of the circle's centre (each axis) and radius in pixels;
    /// [`crate::sphere::CircleReport::sd_px`].
    pub circle_sd_px: f64,
    /// Distance from the ball's centre to the lamp in ball radii, for a near lamp; absent for a distant one.
    pub lamp_distance_radii: Option<f64>,
    /// Unit vector to the lamp by another source, as the shading of a grey ball: candidates near it go first.
    pub expected: Option<Vector3<f64>>,
}

impl Default for HighlightOptions {
    fn default() -> Self {
        Self {
            min_peak: 0.5,
            max_radii: 0.95,
            max_candidates: 12,
            circle_sd_px: 0.1,
            lamp_distance_radii: None,
            expected: None,
        }
    }
}

/// Candidates within this angle of the direction that is expected are near it, degrees: a grey ball's shading is never
/// that far off, and a reflection in a wall seldom that close.
const NEAR_DEG: f64 = 10.0;
/// A spot whose core has this share of its light under another lamp is seen there too.
const SEEN_SHARE: f64 = 0.7;
/// Another candidate with these shares of the peak and of the core of the first may be the lamp as well. Dust glitters as
/// brightly as a lamp, in fewer pixels.
const RIVAL_PEAK: f64 = 0.7;
const RIVAL_AREA: f64 = 0.1;
/// Where both are clipped, which of them is brighter cannot be seen, and the lamp may be the far smaller one: this share of
/// the first, or of the ball, as a lamp of 0.7 degrees from its centre to its rim covers.
const CLIPPED_RIVAL_AREA: f64 = 0.02;
const CLIPPED_RIVAL_BALL_SHARE: f64 = 4e-5;
/// The core of a spot that may be smaller than a pixel.
const SUBPIXEL_CORE_PX: usize = 4;
/// A lamp with less than this share of the light of a reflection that stays is outshone by it.
const OUTSHONE_SHARE: f64 = 0.3;
/// How often the light that turns out to stay is taken away to look for a fainter lamp.
const MAX_ROUNDS: usize = 4;
/// What is seen under some other lamps may be a reflection, or the highlight of a lamp beside them: it loses in score.
const SEEN_WEIGHT: f64 = 0.1;
/// What is seen under most lamps, and what is far from the expected direction, comes after all others.
const LASTING_WEIGHT: f64 = 1e-4;
const FAR_WEIGHT: f64 = 1e-8;

impl HighlightOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), CalibrateError> {
        check_range("min_peak", self.min_peak, (0.05..=0.95).contains(&self.min_peak), "between 0.05 and 0.95")?;
        check_range("max_radii", self.max_radii, (0.2..=1.0).contains(&self.max_radii), "between 0.2 and 1")?;
        check_range("max_candidates", self.max_candidates as f64, self.max_candidates >= 1, "1 or more")?;
        check_circle_sd(self.circle_sd_px)?;
        check_lamp_distance(self.lamp_distance_radii)
    }
}

/// A bright spot on a mirror ball.
#[derive(Clone, Debug, PartialEq)]
pub struct Highlight {
    /// Its centre in pixels.
    pub position_px: (f64, f64),
    /// Standard deviation of the centre, each axis, in pixels.
    pub position_sd_px: f64,
    /// Pixels of its core, at least 0.9 of its peak.
    pub area_px: usize,
    /// Linear light of its brightest pixel.
    pub peak: f64,
    /// Whether the peak is clipped, so that only the shape of the core gives the centre.
    pub clipped: bool,
    /// How many of the other lamps' photos show the same spot nearly as bright.
    pub seen_under_other_lamps: usize,
    /// Whether most of them do, or show one close by: a reflection of the room, not of the lamp.
    pub lasting: bool,
    /// Whether a reflection that other lamps show too lies against it, so that part of it may be hidden.
    pub beside_lasting: bool,
    /// Whether it lies near [`HighlightOptions::expected`]; true where nothing is expected.
    pub near_expected: bool,
    /// Rank of the candidate; the sum of all candidates' scores is 1.
    pub score: f64,
    /// The direction to the light if this is its highlight.
    pub direction: DirectionEstimate,
}

/// All bright spots, the likeliest first.
#[derive(Clone, Debug, PartialEq)]
pub struct HighlightReport {
    /// Candidates; never empty. The first is the lamp unless the user chooses another.
    pub candidates: Vec<Highlight>,
    /// Linear light of the brightest spot of the ball, whatever it reflects.
    pub brightest: f64,
    /// Pixels of the whole ball.
    pub ball_px: f64,
}

impl HighlightReport {
    /// The likeliest candidate.
    pub fn chosen(&self) -> Option<&Highlight> {
        self.candidates.first()
    }

    /// Whether another candidate is nearly as likely, so that the user should look: of bright spots that do not stay the
    /// lamp need not be the largest.
    pub fn is_ambiguous(&self) -> bool {
        let Some((first, others)) = self.candidates.split_first() else { return false };
        let is_rival = |other: &Highlight| {
            // The light of a lamp that is smaller than a pixel is spread over some.
            let may_clip = other.clipped || other.area_px <= SUBPIXEL_CORE_PX;
            let both_clip = first.clipped && may_clip;
            let first_px = first.area_px as f64;
            let enough_px = match both_clip {
                true => (CLIPPED_RIVAL_AREA * first_px).min(CLIPPED_RIVAL_BALL_SHARE * self.ball_px),
                false => RIVAL_AREA * first_px,
            };
            (other.near_expected, other.lasting) == (first.near_expected, first.lasting)
                && other.peak > RIVAL_PEAK * first.peak
                && other.area_px as f64 > enough_px
        };
        others.iter().any(|other| other.score > 0.5 * first.score || is_rival(other))
    }

    /// Whether a reflection that stays is so much brighter than the first candidate that it may hide the lamp.
    pub fn is_outshone(&self) -> bool {
        self.chosen().is_some_and(|first| first.peak < OUTSHONE_SHARE * self.brightest)
    }
}

/// Finds the highlights on a mirror ball and the directions d = 2 (n.v) n - v they stand for.
///
/// `other_lamps` are photos of the same ball in the same place under the other lamps, or none: what all of them show is
/// taken off first, and spots that most of them show are ranked behind those that only this lamp makes. A lamp's
/// highlight is ranked by the light of its core: reflections of lit things are dimmer, their highlights smaller. A large
/// core is centred on its smoothed top, so that streaks of light on the ball's surface do not draw it away.
pub fn find_highlights(
    photo: &Photo,
    other_lamps: &[&Photo],
    ball: &Ball,
    options: &HighlightOptions,
) -> Result<HighlightReport, CalibrateError> {
    options.check()?;
    let size = photo.linear.size();
    if let Some(other) = other_lamps.iter().map(|p| p.linear.size()).find(|&other| other != size) {
        return Err(CalibrateError::SizesDiffer { first: size, other });
    }
    if !ball.circle().lies_in(size) {
        return Err(CalibrateError::LeavesImage { circle: ball.circle(), size });
    }
    let view = BallView::new(photo, other_lamps, ball, options.max_radii);
    let brightest = outstanding_peak(&view.light).map_err(|peak| CalibrateError::NoHighlight { peak })?;
    let search = Search { photo, other_lamps, ball, options, view: &view };
    let mut found = search.own_spots();
    let lasting = components(&view.light, options.min_peak * brightest);
    let known: HashSet<(usize, usize)> = found.iter().flat_map(|(spot, _)| spot).copied().collect();
    let new = lasting.into_iter().filter(|spot| !spot.iter().any(|pixel| known.contains(pixel)));
    found.extend(new.filter_map(|spot| search.described(spot, &view.light)));
    let mut candidates: Vec<Highlight> = found.into_iter().map(|(_, highlight)| highlight).collect();
    let total: f64 = candidates.iter().map(|c| c.score).sum();
    candidates.iter_mut().for_each(|candidate| candidate.score /= total);
    candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
    candidates.truncate(options.max_candidates);
    if candidates.is_empty() {
        return Err(CalibrateError::NoHighlight { peak: brightest });
    }
    let ball_px = std::f64::consts::PI * ball.circle().radius_px.powi(2);
    Ok(HighlightReport { candidates, brightest, ball_px })
}

/// The pixels of a bright spot.
type Spot = Vec<(usize, usize)>;

/// What all spots of a photo are judged by.
struct Search<'a> {
    photo: &'a Photo,
    other_lamps: &'a [&'a Photo],
    ball: &'a Ball,
    options: &'a HighlightOptions,
    view: &'a BallView<'a>,
}

impl Search<'_> {
    /// The spots of the light that this lamp adds. Where all of them are seen under most lamps, as windows are whose light
    /// varies, they are taken away to look for fainter ones.
    fn own_spots(&self) -> Vec<(Spot, Highlight)> {
        let mut own = self.view.own.clone();
        let mut found = Vec::new();
        for _ in 0..MAX_ROUNDS {
            let Ok(brightest) = outstanding_peak(&own) else { break };
            let spots = components(&own, self.options.min_peak * brightest);
            let described: Vec<_> = spots.iter().filter_map(|spot| self.described(spot.clone(), &own)).collect();
            let is_done = described.iter().any(|(_, highlight)| !highlight.lasting);
            found.extend(described);
            if is_done {
                break;
            }
            let width = own.width();
            spots.iter().flatten().for_each(|&(x, y)| own.data_mut()[y * width + x] = 0.0);
        }
        found
    }

    /// A spot of `light`, which lies in the ball's square, and what it would be as a lamp's highlight.
    fn described(&self, spot: Spot, light: &Plane) -> Option<(Spot, Highlight)> {
        let (view, options) = (self.view, self.options);
        let value = |&(x, y): &(usize, usize)| f64::from(light.at(x, y));
        let peak = spot.iter().map(value).fold(0.0, f64::max);
        let core: Vec<(usize, usize)> = spot.iter().copied().filter(|pixel| value(pixel) >= 0.9 * peak).collect();
        let (centre, mut sd) = centre_of(&spot, light, core.len());
        let beside_lasting = view.is_beside_lasting(&spot, peak);
        if beside_lasting {
            // Any part of it may be hidden.
            sd = sd.hypot((spot.len() as f64 / std::f64::consts::PI).sqrt());
        }
        let position_px = (centre.0 + view.origin.0 as f64, centre.1 + view.origin.1 as f64);
        let in_photo = |&(x, y): &(usize, usize)| (x + view.origin.0, y + view.origin.1);

        let clipped = core.iter().map(in_photo).any(|(x, y)| self.photo.marks.at(x, y) & CLIPPED != 0);
        let core_light =
            |photo: &Photo| core.iter().map(in_photo).map(|(x, y)| f64::from(photo.linear.at(x, y))).sum::<f64>();
        let enough = SEEN_SHARE * core_light(self.photo);
        let seen_under_other_lamps = self.other_lamps.iter().filter(|other| core_light(other) > enough).count();
        let direction = direction_of(position_px, sd, self.ball, options)?;
        let off_deg =
            options.expected.map_or(0.0, |expected| expected.angle(&direction.direction_to_light).to_degrees());
        let pixel = (centre.0 as usize, centre.1 as usize);
        let lasting = 2 * seen_under_other_lamps > self.other_lamps.len() || view.is_nearby_too(pixel, peak);
        let seen_weight = match seen_under_other_lamps {
            0 => 1.0,
            _ if lasting => LASTING_WEIGHT,
            _ => SEEN_WEIGHT,
        };
        let far_weight = if off_deg < NEAR_DEG { 1.0 } else { FAR_WEIGHT * (-off_deg / 2.0).exp() };
        let highlight = Highlight {
            position_px,
            position_sd_px: sd,
            area_px: core.len(),
            peak,
            clipped,
            seen_under_other_lamps,
            lasting,
            beside_lasting,
            near_expected: off_deg < NEAR_DEG,
            score: seen_weight * far_weight * core.iter().map(value).sum::<f64>(),
            direction,
        };
        Some((spot, highlight))
    }
}

/// The direction to a lamp whose highlight lies at a position, with the errors of the position and the circle.
fn direction_of(
    (x, y): (f64, f64),
    position_sd_px: f64,
    ball: &Ball,
    options: &HighlightOptions,
) -> Option<DirectionEstimate> {
    let direction = |ball: &Ball, x: f64, y: f64| {
        let point = ball.surface_at(x, y)?;
        let seen = point.direction_mirrored();
        Some(options.lamp_distance_radii.map_or(seen, |distance| seen_from_centre(point.normal, seen, distance)))
    };
    let found = direction(ball, x, y)?;
    let centre_sd = position_sd_px.hypot(options.circle_sd_px);
    let shifted = [
        direction(ball, x + centre_sd, y).or_else(|| direction(ball, x - centre_sd, y)),
        direction(ball, x, y + centre_sd).or_else(|| direction(ball, x, y - centre_sd)),
        direction(&ball.perturbed((0.0, 0.0), options.circle_sd_px), x, y),
    ];
    let shifts = shifted.into_iter().flatten().map(|moved: Vector3<f64>| moved - found);
    let covariance: Matrix3<f64> = shifts.map(|shift| shift * shift.transpose()).sum();
    Some(DirectionEstimate::new(found, &covariance, usize::MAX))
}
