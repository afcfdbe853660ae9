//! Capture warnings as data, and their words.

use std::fmt;

use firstbounce_core::capture_checks::{LampFault, Mistake, Proof};

use super::written;
use crate::image_file::FileFacts;
use crate::set::CaptureSet;

/// Something about a capture that makes normals wrong.
#[derive(Clone, Debug, PartialEq)]
pub enum CaptureWarning {
    /// One photo where there should be several.
    EqualFiles {
        /// The files, as the capture file writes them; one where several shots name the same.
        files: Vec<String>,
        /// The shots, in words.
        shots: Vec<String>,
    },
    /// Pixels pile up at a value below the white level: they are clipped, and do not count as clipped.
    ValuesEnd {
        /// The files.
        files: FilesOf,
        /// The stored value.
        value: f32,
        /// The largest share of a file's pixels that have it.
        share: f64,
        /// The white level in force, where the capture file gives one.
        white_level: Option<f64>,
    },
    /// A white level that files of this type cannot reach.
    WhiteLevelOutOfReach {
        /// The files.
        files: FilesOf,
        /// The white level of the capture file.
        white_level: f64,
        /// The largest value that the files hold.
        maximum: f32,
    },
    /// Photos that are averaged and do not show the same.
    RepeatsDiffer {
        /// The file that differs most.
        file: String,
        /// The repeats before it.
        before: Vec<String>,
        /// The difference as a share of their light, but for noise.
        change: f64,
    },
    /// Photos that lie beside those of the other lamps.
    Moved {
        /// Under which light.
        light: String,
        /// The files.
        files: FilesOf,
        /// How far, x right and y down, in pixels.
        shift_px: [f64; 2],
    },
    /// Lamps and photos that do not belong together.
    Lamps {
        /// Names of the lamps that were looked at.
        lights: Vec<String>,
        /// What is wrong, by their places there.
        fault: LampFault,
    },
    /// An object in several parts: the depth between them is not known.
    Islands {
        /// How many.
        islands: usize,
        /// The share of the pixels that lie beside the largest.
        share_beside: f64,
    },
}

/// The kind of a warning of two photos of one lamp.
pub(super) const ONE_LAMP_TWICE: &str = "one-lamp-twice";

/// Files of which one thing is said.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FilesOf {
    /// As the capture file writes them, each once; never empty.
    pub files: Vec<String>,
}

impl FilesOf {
    pub(super) fn of<'f>(set: &CaptureSet, files: impl Iterator<Item = &'f FileFacts>) -> Option<Self> {
        let mut names: Vec<String> = Vec::new();
        for file in files {
            let name = written(set, &file.path);
            if !names.contains(&name) {
                names.push(name);
            }
        }
        (!names.is_empty()).then_some(Self { files: names })
    }
}

impl fmt::Display for FilesOf {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.files.as_slice() {
            [] => Ok(()),
            [only] => f.write_str(only),
            [first, more @ ..] => write!(f, "{first} and {} more", more.len()),
        }
    }
}

impl CaptureWarning {
    /// Its kind, in one word for programs.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::EqualFiles { .. } => "equal-files",
            Self::ValuesEnd { .. } => "values-end",
            Self::WhiteLevelOutOfReach { .. } => "white-level",
            Self::RepeatsDiffer { .. } => "repeats-differ",
            Self::Moved { .. } => "moved",
            Self::Lamps { fault: LampFault::Doubled { .. }, .. } => ONE_LAMP_TWICE,
            Self::Lamps { .. } => "lamps",
            Self::Islands { .. } => "islands",
        }
    }

    /// The files that it is about, as the capture file writes them.
    pub fn files(&self) -> Vec<String> {
        match self {
            Self::EqualFiles { files, .. } => files.clone(),
            Self::ValuesEnd { files, .. } | Self::WhiteLevelOutOfReach { files, .. } | Self::Moved { files, .. } => {
                files.files.clone()
            }
            Self::RepeatsDiffer { file, .. } => vec![file.clone()],
            Self::Lamps { .. } | Self::Islands { .. } => Vec::new(),
        }
    }

    /// The lights that it is about.
    pub fn lights(&self) -> Vec<String> {
        match self {
            Self::Moved { light, .. } => vec![light.clone()],
            Self::Lamps { lights, fault } => lamps_of(fault).into_iter().map(|l| lights[l].clone()).collect(),
            _ => Vec::new(),
        }
    }

    /// How much it spoils: roughly the degrees by which normals are off.
    pub(super) fn badness(&self) -> f64 {
        match self {
            Self::EqualFiles { .. } => 40.0,
            Self::WhiteLevelOutOfReach { .. } => 30.0,
            Self::RepeatsDiffer { change, .. } => 15.0 * change.min(2.0),
            Self::ValuesEnd { share, .. } => 200.0 * share,
            Self::Lamps { fault: LampFault::Mistaken { proof: Proof::SlopesDeg(misfit, _), .. }, .. } => 20.0 + misfit,
            Self::Lamps { .. } => 20.0,
            Self::Moved { shift_px: [x, y], .. } => 0.3 * x.hypot(*y),
            Self::Islands { share_beside, .. } => *share_beside,
        }
    }
}

impl fmt::Display for CaptureWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::EqualFiles { files, shots } => match files.as_slice() {
                [only] => {
                    write!(f, "{only}: one photo is given as {}; name the right file for each", shots.join(" and as "))
                }
                files => write!(
                    f,
                    "{}: the same photo under {} names, given as {}; name the right file for each",
                    files.join(" and "),
                    files.len(),
                    shots.join(" and as ")
                ),
            },
            Self::ValuesEnd { files, value, share, white_level } => {
                let percent = 100.0 * share;
                write!(
                    f,
                    "{files}: {percent:.1} % of the pixels are at {value}, where the camera's values end, and do not count as clipped; "
                )?;
                match white_level {
                    Some(level) => write!(f, "set white_level = {value} under [camera] in place of {level}"),
                    None => write!(f, "set white_level = {value} under [camera]"),
                }
            }
            Self::WhiteLevelOutOfReach { files, white_level, maximum } => write!(
                f,
                "{files}: white_level is {white_level}, and the file holds {maximum} at most, so that nothing counts as \
                 clipped and all light as dim; set white_level = {maximum} under [camera], or leave it out"
            ),
            Self::RepeatsDiffer { file, before, change } => write!(
                f,
                "{file}: differs from {}, which it is averaged with, by {:.0} % of their light, beyond all noise; make it a \
                 shot of its own, or take it out",
                before.join(" and "),
                100.0 * change
            ),
            Self::Moved { light, files, shift_px: [x, y] } => write!(
                f,
                "light {light}: {files}: {:.1} px beside the other lamps' photos ({x:+.1} right, {y:+.1} down): the camera or the \
                 object was moved; photograph this lamp again",
                x.hypot(*y)
            ),
            Self::Lamps { lights, fault } => f.write_str(&words_of(fault, lights)),
            Self::Islands { islands, share_beside } => write!(
                f,
                "the object is in {islands} parts, and the depth between them is not known ({:.1} % of its pixels lie beside \
                 the largest); join them in the mask, or measure nothing across them",
                100.0 * share_beside
            ),
        }
    }
}

/// The lamps that a fault is about; none where it is about all.
fn lamps_of(fault: &LampFault) -> Vec<usize> {
    match fault {
        LampFault::Doubled { lamps, .. } => lamps.to_vec(),
        LampFault::Mistaken { like, .. } => match like.first() {
            Some(Mistake::Exchanged(a, b)) => vec![*a, *b],
            Some(Mistake::Odd(lamp)) => vec![*lamp],
            _ => Vec::new(),
        },
        LampFault::Unexplained { .. } | LampFault::NoSurface { .. } => Vec::new(),
    }
}

fn words_of(fault: &LampFault, lights: &[String]) -> String {
    let percent = |share: &f64| format!("{:.2} %", 100.0 * share);
    match fault {
        LampFault::Mistaken { like, proof } => {
            let mistakes: Vec<_> = like.iter().map(|mistake| mistake_words(*mistake, lights)).collect();
            let proof = match proof {
                Proof::SlopesDeg(found, best) => {
                    format!("normals miss any surface by {found:.1} degrees, and by {best:.1} without this mistake")
                }
                Proof::LightShare(found, best) => {
                    format!(
                        "{} of the light fits no normal, and {} without this mistake",
                        percent(found),
                        percent(best)
                    )
                }
            };
            format!(
                "lamps and photos do not belong together: {} ({proof}); correct the directions or the photos' lights",
                mistakes.join(", or ")
            )
        }
        LampFault::Doubled { lamps: [a, b], difference } => format!(
            "lights {} and {}: their photos differ by {} of their light, as those of one lamp do; photograph {} again under \
             its own lamp",
            lights[*a],
            lights[*b],
            percent(difference),
            lights[*b]
        ),
        LampFault::Unexplained { share } => format!(
            "lamps and photos do not belong together: {} of the light fits no normal; check which photo was taken under which \
             lamp, and the lamps' directions",
            percent(share)
        ),
        LampFault::NoSurface { misfit_deg } => format!(
            "lamps and photos do not belong together: normals miss any surface by {misfit_deg:.1} degrees; check which photo \
             was taken under which lamp, and the lamps' directions"
        ),
    }
}

fn mistake_words(mistake: Mistake, lights: &[String]) -> String {
    match mistake {
        Mistake::Flipped => "y of the directions points down, or x to the left: change the sign of one".into(),
        Mistake::Swapped => "x and y of the directions are swapped".into(),
        Mistake::SwappedAndFlipped => "x and y of the directions are swapped, and one has the wrong sign".into(),
        Mistake::Exchanged(a, b) => format!("lights {} and {} are exchanged", lights[a], lights[b]),
        Mistake::Shifted => "each light has the direction of the one before or after it".into(),
        Mistake::Odd(lamp) => format!("light {} fits none of the others", lights[lamp]),
    }
}
