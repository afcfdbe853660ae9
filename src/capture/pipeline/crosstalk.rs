//! Crosstalk between the channels of one RGB photo: what the file gives of it, or what shots under one lamp colour alone show.

use std::borrow::Cow;
use std::sync::Arc;

use firstbounce_core::Plane;
use firstbounce_core::calibrate::{CrosstalkOptions, CrosstalkReport, measure_crosstalk, pool_shares};
use firstbounce_core::image::mixing::Mixing;
use firstbounce_core::interval::Estimate;
use firstbounce_core::sphere::{Ball, Circle, CircleOptions, find_circle};
use rayon::prelude::*;

use super::calibrate::view;
use super::{Known, PhotoStore, PipelineError, PipelineWatch, Preference, Source};
use crate::image_file::LinearLight;
use crate::set::{CaptureSet, Shot, SphereKind, Subject};

/// By channel, then lamp: what the channel of each colour sees of the lamp of each colour; empty where nothing tells.
pub type KnownCrosstalk = Vec<Vec<Known<f64>>>;

/// The set with the crosstalk in force in its camera, and what is known of it.
///
/// # Errors
/// Photos that cannot be read or differ in size, a ball that is not found or cannot be used, and a matrix that cannot be undone.
pub fn with_crosstalk<'s>(
    set: &'s CaptureSet,
    preference: Preference,
    store: &PhotoStore,
    watch: &dyn PipelineWatch,
) -> Result<(Cow<'s, CaptureSet>, KnownCrosstalk), PipelineError> {
    let typed = set.camera.crosstalk.as_ref();
    let has_shots = set.shots_of(Subject::Crosstalk).next().is_some();
    if !has_shots || (typed.is_some() && preference == Preference::File) {
        let from_file = |row: &Vec<f64>| row.iter().copied().map(Known::from_file).collect();
        return Ok((Cow::Borrowed(set), typed.map_or_else(Vec::new, |rows| rows.iter().map(from_file).collect())));
    }
    let known = measured(set, store, watch)?;
    let rows: Vec<Vec<f64>> = values(&known);
    Mixing::new(&rows, set.colours.len()).map_err(PipelineError::Crosstalk)?;
    let mut set = set.clone();
    set.camera.crosstalk = Some(rows);
    Ok((Cow::Owned(set), known))
}

/// The numbers alone.
pub(super) fn values(known: &KnownCrosstalk) -> Vec<Vec<f64>> {
    known.iter().map(|row| row.iter().map(|known| known.value).collect()).collect()
}

/// A shot under one lamp colour alone, in every channel.
struct Lit<'a> {
    shot: &'a Shot,
    /// Index of the lamp's colour.
    lamp: usize,
    channels: Vec<Arc<LinearLight>>,
}

fn measured(set: &CaptureSet, store: &PhotoStore, watch: &dyn PipelineWatch) -> Result<KnownCrosstalk, PipelineError> {
    let colours = set.colours.len();
    let lit = read(set, store, watch)?;
    check_sizes(set, &lit)?;
    let ball = ball(set, &lit)?;
    let report = |lit: &Lit| {
        let channels: Vec<_> = lit.channels.iter().map(|light| &*light.photo).collect();
        let light = lit.shot.light.as_deref().unwrap_or_default();
        measure_crosstalk(&channels, lit.lamp, &ball, &CrosstalkOptions::default())
            .map_err(|reason| PipelineError::calibrate(light, SphereKind::Grey, reason))
    };
    let reports: Vec<(usize, CrosstalkReport)> =
        lit.par_iter().map(|lit| Ok((lit.lamp, report(lit)?))).collect::<Result<_, PipelineError>>()?;
    let share = |channel: usize, lamp: usize| {
        if channel == lamp {
            return Ok(Known::by_definition());
        }
        let of_lamp: Vec<&CrosstalkReport> =
            reports.iter().filter(|(of, _)| *of == lamp).map(|(_, report)| report).collect();
        let shares: Vec<Estimate> = of_lamp.iter().map(|report| report.shares[channel]).collect();
        let pooled =
            pool_shares(&shares).map_err(|reason| PipelineError::calibrate("of any name", SphereKind::Grey, reason))?;
        Ok(Known::measured(pooled, Source::GreyBall, of_lamp.first().map(|report| report.pixels.clone())))
    };
    (0..colours).map(|channel| (0..colours).map(|lamp| share(channel, lamp)).collect()).collect()
}

fn read<'a>(set: &'a CaptureSet, store: &PhotoStore, watch: &dyn PipelineWatch) -> Result<Vec<Lit<'a>>, PipelineError> {
    let of_lamps: Vec<(&Shot, usize)> = set
        .shots_of(Subject::Crosstalk)
        .filter_map(|shot| Some((shot, set.colour_index(shot.colour.as_deref()?)?)))
        .collect();
    // Read as if the shot were of each colour in turn: by its channel.
    let by_channel = |(shot, _): &(&Shot, usize)| {
        let colours = set.colours.iter();
        colours.map(|colour| Shot { colour: Some(colour.name.clone()), ..(*shot).clone() }).collect::<Vec<_>>()
    };
    let shots: Vec<Shot> = of_lamps.iter().flat_map(by_channel).collect();
    let lights = store.read(set, &shots.iter().collect::<Vec<_>>(), watch)?;
    let lights: Vec<_> = lights.into_iter().collect::<Result<_, _>>().map_err(PipelineError::Photo)?;
    let channels = lights.chunks(set.colours.len().max(1));
    Ok(of_lamps
        .into_iter()
        .zip(channels)
        .map(|((shot, lamp), row)| Lit { shot, lamp, channels: row.to_vec() })
        .collect())
}

fn check_sizes(set: &CaptureSet, lit: &[Lit]) -> Result<(), PipelineError> {
    let size = |lit: &Lit| lit.channels.first().map_or((0, 0), |light| light.photo.linear.size());
    let expected = lit.first().map_or((0, 0), size);
    match lit.iter().find(|lit| size(lit) != expected) {
        Some(other) => {
            let file = other.shot.files.first().map_or("", String::as_str);
            Err(PipelineError::PhotoSize { path: set.resolve(file), found: size(other), expected })
        }
        None => Ok(()),
    }
}

/// The grey ball: where the file says, if that lies in these photos, else where its edge shows.
fn ball(set: &CaptureSet, lit: &[Lit]) -> Result<Ball, PipelineError> {
    let own: Vec<&Plane> = lit.iter().map(|lit| &lit.channels[lit.lamp].photo.linear).collect();
    let size = own.first().map_or((0, 0), |plane| plane.size());
    let given = set.subject_with(SphereKind::Grey).and_then(|subject| set.circle(subject, SphereKind::Grey));
    let given =
        given.map(|circle| Circle { centre_px: (circle.centre[0], circle.centre[1]), radius_px: circle.radius });
    let circle = match given.filter(|circle| circle.lies_in(size)) {
        Some(circle) => circle,
        None => {
            find_circle(&own, None, &CircleOptions::default())
                .map_err(|reason| PipelineError::Ball { subject: Subject::Crosstalk, reason })?
                .circle
        }
    };
    Ok(Ball::new(circle, view(set, size)))
}
