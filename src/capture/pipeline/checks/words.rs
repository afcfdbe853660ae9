//! Capture warnings in words: what, the number that proves it, what to do.

use std::fmt;

use firstbounce_core::capture_checks::{LampFault, Mistake, Proof};

use super::CaptureWarning;

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
            Self::ColourFringe { reference, colour, shift_px: [x, y], at_px: [left, top], is_uniform } => {
                write!(
                    f,
                    "edges in {colour} lie up to {:.1} px beside those in {reference} ({x:+.1} right, {y:+.1} down at x {left:.0}, y \
                     {top:.0}), which makes false bounces along them; ",
                    x.hypot(*y)
                )?;
                f.write_str(if *is_uniform {
                    "the camera or the object was moved between the colours: photograph one of them again"
                } else {
                    "undo the lens's lateral colour when the photos are exported, or close the aperture and keep the object in the \
                     middle of the picture"
                })
            }
            Self::Clipped { files, share } => write!(
                f,
                "{files}: {:.1} % of the object is clipped, and without normals where too few lamps are left; shorten the exposure",
                100.0 * share
            ),
            Self::Files { warnings, .. } => match warnings.as_slice() {
                [] => Ok(()),
                [only] => only.fmt(f),
                [first, more @ ..] => write!(f, "{first} (and {} more such files)", more.len()),
            },
            Self::RoomLight { lights } => {
                let words = lights.iter().map(|(light, share)| format!("{:.1} % under {light}", 100.0 * share));
                write!(
                    f,
                    "part of the light on the balls does not come from the lamp: {}. Darken the room, or photograph it with \
                     all lamps off and add that as a \"dark\" shot, which is subtracted; the intervals are widened until then",
                    words.collect::<Vec<_>>().join(", ")
                )
            }
            Self::Direction { light, doubt } => write!(f, "light {light}: {doubt}"),
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
