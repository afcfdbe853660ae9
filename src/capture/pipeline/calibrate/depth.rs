//! Balls photographed with fewer levels than the object.

use std::fmt;
use std::path::PathBuf;

use super::super::{PhotoStore, PipelineError, PipelineWatch, SubjectPhotos};
use crate::image_file::ImageWarning;
use crate::set::{CaptureSet, Subject};

/// A ball's file of 8 bits beside an object in files of more.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct CoarseBall {
    file: PathBuf,
}

impl fmt::Display for CoarseBall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: 8 bits beside an object of more: such a file often holds sRGB, and black_level and white_level are those of \
             the object's files; export the ball as the object, or give its [[shot]] an encoding",
            self.file.display()
        )
    }
}

/// Balls whose values are probably not those of the object: 8 bits beside 16, without an encoding of their own.
pub(super) fn coarse_balls<'a>(
    set: &CaptureSet,
    balls: impl Iterator<Item = (Subject, &'a SubjectPhotos)>,
    store: &PhotoStore,
    watch: &dyn PipelineWatch,
) -> Result<Vec<CoarseBall>, PipelineError> {
    let own = balls.filter(|(subject, _)| *subject != Subject::Object);
    let coarse: Vec<_> = own.filter_map(|(subject, photos)| photos.coarse_file(set, subject)).collect();
    let (Some(shot), false) = (set.shots_of(Subject::Object).next(), coarse.is_empty()) else { return Ok(Vec::new()) };
    let object = store.read(set, &[shot], watch)?;
    let is_coarse = |warning: &ImageWarning| matches!(warning, ImageWarning::EightBit { .. });
    let is_fine = object.iter().flatten().any(|light| !light.warnings.iter().any(is_coarse));
    Ok(coarse.into_iter().filter(|_| is_fine).map(|file| CoarseBall { file: file.to_owned() }).collect())
}
