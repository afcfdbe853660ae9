//! The pictures that a view can show.

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::Method;
use firstbounce_capture::set::Subject;
use serde::{Deserialize, Serialize};

use crate::app::state::document::Document;
use crate::app::state::results::{Place, Plain, PlainPicture, Quantity, ShotName, Step, SurfaceName, stage_of};

/// A picture, by names that survive edits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Shown {
    /// A shot in linear light.
    Photo(ShotName),
    /// Bounce k of a light, computed from the photos while it is drawn; k counts from 1.
    Bounce {
        /// The light's name.
        light: String,
        /// From 1.
        k: usize,
    },
    /// The sum of all bounces of a light.
    Sum {
        /// The light's name.
        light: String,
    },
    /// The reference colour's photo with every marked pixel of the separation tinted.
    Marks {
        /// The light's name.
        light: String,
    },
    /// Bounce 1 in red, bounce 2 amplified in cyan (Liao, Huang, Yang, CVPR 2011, Figure 1).
    FigureOne {
        /// The light's name.
        light: String,
    },
    /// Normals.
    Normals(SurfaceName),
    /// Before, after and a reference in 3D.
    Surface,
    /// One picture of single values minus another.
    Difference(Box<Shown>, Box<Shown>),
    /// What a step has to show that is no picture.
    Pane(Pane),
    /// A row of the table of plain pictures, saved under its own name.
    #[serde(untagged)]
    Plain(PlainPicture),
}

/// What a step shows in the centre beside pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Pane {
    /// Every photo of the set, lights down, colours across.
    Photos,
    /// The lights on a dome.
    Dome,
    /// The values of the rig that are in force.
    Rig,
}

impl Pane {
    /// All, in the order of the menu.
    pub const ALL: [Self; 3] = [Self::Photos, Self::Dome, Self::Rig];

    /// What it is called.
    pub fn title(self) -> &'static str {
        match self {
            Self::Photos => "All photos",
            Self::Dome => "Lights on a dome",
            Self::Rig => "Values in force",
        }
    }
}

impl Default for Shown {
    /// Normals of the direct light: what the program is for.
    fn default() -> Self {
        Self::Normals(SurfaceName::After)
    }
}

impl From<PlainPicture> for Shown {
    fn from(picture: PlainPicture) -> Self {
        Self::Plain(picture)
    }
}

impl Shown {
    /// The object's photo under a light in a colour.
    pub fn object(light: &str, colour: &str) -> Self {
        Self::Photo(ShotName { subject: Subject::Object, light: Some(light.into()), colour: Some(colour.into()) })
    }

    /// One picture minus another.
    pub fn difference(a: impl Into<Self>, b: impl Into<Self>) -> Self {
        Self::Difference(Box::new(a.into()), Box::new(b.into()))
    }

    /// What people call it.
    pub fn title(&self) -> String {
        match self {
            Self::Photo(shot) => photo_title(shot),
            Self::Bounce { light, k } => format!("Bounce {k}, {light}"),
            Self::Sum { light } => format!("Sum of bounces, {light}"),
            Self::Marks { light } => format!("Marks, {light}"),
            Self::FigureOne { light } => format!("Bounces 1 and 2 in colour, {light}"),
            Self::Normals(name) => format!("Normals {}", name.words()),
            Self::Surface => "Surface in 3D".into(),
            Self::Pane(pane) => pane.title().into(),
            Self::Difference(a, b) => match (&**a, &**b) {
                (Self::Normals(a), Self::Normals(b)) => {
                    format!("Angle between normals {} and {}", a.words(), b.words())
                }
                _ => format!("{} minus {}", a.title(), b.title()),
            },
            Self::Plain(picture) => picture.title(),
        }
    }

    /// The light it belongs to.
    pub fn light(&self) -> Option<&str> {
        match self {
            Self::Photo(shot) => shot.light.as_deref(),
            Self::Bounce { light, .. } | Self::Sum { light } | Self::Marks { light } | Self::FigureOne { light } => {
                Some(light)
            }
            Self::Difference(a, _) => a.light(),
            Self::Normals(_) | Self::Surface | Self::Pane(_) => None,
            Self::Plain(picture) => picture.light(),
        }
    }

    /// The other method whose results it shows.
    pub fn by_method(&self) -> Option<Method> {
        match self {
            Self::Normals(name) => name.other_method(),
            Self::Difference(a, b) => a.by_method().or_else(|| b.by_method()),
            Self::Plain(picture) => picture.by_method(),
            _ => None,
        }
    }

    /// Whose pixels it has: pictures of one subject lie on each other.
    pub fn subject(&self) -> Subject {
        match self {
            Self::Photo(shot) => shot.subject,
            Self::Difference(a, _) => a.subject(),
            _ => Subject::Object,
        }
    }

    /// The same of another light, where it is of one.
    pub fn with_light(&self, name: &str) -> Self {
        let mut other = self.clone();
        match &mut other {
            Self::Photo(shot) => {
                if let Some(light) = &mut shot.light {
                    *light = name.into();
                }
            }
            Self::Bounce { light, .. } | Self::Sum { light } | Self::Marks { light } | Self::FigureOne { light } => {
                *light = name.into();
            }
            Self::Difference(a, b) => (*a, *b) = (Box::new(a.with_light(name)), Box::new(b.with_light(name))),
            Self::Plain(picture) => picture.put_light(name),
            Self::Normals(_) | Self::Surface | Self::Pane(_) => {}
        }
        other
    }

    /// The colour that it is of.
    pub fn colour(&self) -> Option<&str> {
        match self {
            Self::Photo(shot) => shot.colour.as_deref(),
            Self::Plain(picture) => picture.colour(),
            _ => None,
        }
    }

    /// The same in another colour, where it is of one.
    pub fn with_colour(&self, name: &str) -> Self {
        let mut other = self.clone();
        match &mut other {
            Self::Photo(ShotName { colour: Some(colour), .. }) => *colour = name.into(),
            Self::Plain(picture) => picture.put_colour(name),
            _ => {}
        }
        other
    }

    /// The stage that it comes from. Bounces are computed of the photos while they are drawn.
    pub fn step(&self) -> Step {
        match self {
            Self::Photo(_) | Self::Bounce { .. } | Self::Sum { .. } | Self::FigureOne { .. } => Step::Load,
            Self::Marks { .. } => Step::Separate,
            Self::Normals(name) => stage_of(*name),
            Self::Surface => Step::Mesh,
            Self::Pane(_) => Step::Load,
            Self::Difference(a, b) => a.step().max(b.step()),
            Self::Plain(picture) => picture.step(),
        }
    }

    /// What its numbers are.
    pub fn quantity(&self, set: &CaptureSet) -> Quantity {
        let plain = |words| Quantity { words, difference: "", unit: "" };
        match self {
            Self::Photo(_) | Self::Bounce { .. } | Self::Sum { .. } | Self::Marks { .. } => Quantity::LIGHT,
            Self::FigureOne { .. } => plain("Bounce 1 red, bounce 2 times 3 cyan"),
            Self::Normals(_) => plain("Normal x, y, z as red, green, blue"),
            Self::Surface | Self::Pane(_) => plain(""),
            Self::Difference(a, _) if matches!(**a, Self::Normals(_)) => {
                Quantity { unit: " degrees", ..plain("Angle between normals, degrees") }
            }
            Self::Difference(a, _) => {
                let of = a.quantity(set);
                Quantity { words: of.difference, ..of }
            }
            Self::Plain(picture) => (picture.plain.row().quantity)(set),
        }
    }

    /// The pictures to choose from, by group: what this set has, whether or not it is computed yet.
    pub fn offered(document: &Document) -> Vec<(String, Vec<Self>)> {
        let set = &document.set;
        let mut groups = vec![("Surface".to_owned(), of_surfaces(document))];
        groups
            .extend(set.lights.iter().map(|light| (format!("Light {}", light.name), of_light(&light.name, document))));
        groups.extend(set.subjects().into_iter().map(|subject| {
            let shots = set.shots_of(subject).map(|shot| Self::Photo(ShotName::of(shot)));
            (format!("Photos, {subject}"), shots.collect())
        }));
        groups
    }
}

fn of_surfaces(document: &Document) -> Vec<Shown> {
    let others = document.compared().map(SurfaceName::By);
    let names: Vec<_> = [SurfaceName::After, SurfaceName::Before].into_iter().chain(others).collect();
    let mut shown: Vec<_> = names.iter().copied().map(Shown::Normals).collect();
    for plain in Plain::at(Place::Surface) {
        shown.extend(names.iter().map(|name| plain.of(*name).into()));
    }
    shown
}

fn of_light(light: &str, document: &Document) -> Vec<Shown> {
    let name = || light.to_owned();
    let plain = |place| Plain::at(place).flat_map(|plain| plain.under(light, document)).map(Shown::Plain);
    let bounces = document.set.bounces();
    let mut shown: Vec<_> = plain(Place::BeforeBounces).collect();
    shown.extend((1..=bounces).map(|k| Shown::Bounce { light: name(), k }));
    shown.extend(plain(Place::AfterBounces));
    if bounces > 1 {
        shown.push(Shown::FigureOne { light: name() });
    }
    shown.push(Shown::Sum { light: name() });
    shown.extend(plain(Place::AfterSum));
    shown.push(Shown::Marks { light: name() });
    shown
}

fn photo_title(shot: &ShotName) -> String {
    let subject = match shot.subject {
        Subject::Object => "Photo",
        subject => subject.title(),
    };
    let words = [Some(subject), shot.light.as_deref(), shot.colour.as_deref()];
    words.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use serde_json::{from_value, json, to_value};

    use super::*;
    use crate::app::state::results::Of;

    #[test]
    fn saved_layouts_name_pictures_as_earlier_versions_did() {
        for (saved, shown) in [
            (json!({"Photo": {"subject": "object", "light": "left", "colour": "blue"}}), Shown::object("left", "blue")),
            (json!({"Bounce": {"light": "left", "k": 1}}), Shown::Bounce { light: "left".into(), k: 1 }),
            (json!({"Direct": {"light": "left"}}), Plain::Direct.of(Of::light("left")).into()),
            (json!({"Residual": {"light": "left"}}), Plain::Residual.of(Of::light("left")).into()),
            (
                json!({"IndirectRatio": {"light": "left", "colour": "green"}}),
                Plain::IndirectRatio.of(Of::light_in("left", "green")).into(),
            ),
            (json!({"Noise": {"light": "left"}}), Plain::Noise.of(Of::light("left")).into()),
            (
                json!({"DirectBy": {"method": "shape", "light": "left"}}),
                Plain::DirectBy.of(Of::light_by(Method::Shape, "left")).into(),
            ),
            (json!({"Normals": "After"}), Shown::default()),
            (json!({"Albedo": "Before"}), Plain::Albedo.of(SurfaceName::Before).into()),
            (json!({"NormalNoise": "shape"}), Plain::NormalNoise.of(SurfaceName::By(Method::Shape)).into()),
            (json!("Surface"), Shown::Surface),
            (
                json!({"Difference": [{"Depth": "After"}, {"Depth": "Before"}]}),
                Shown::difference(Plain::Depth.of(SurfaceName::After), Plain::Depth.of(SurfaceName::Before)),
            ),
        ] {
            assert_eq!(to_value(&shown).unwrap(), saved);
            assert_eq!(from_value::<Shown>(saved).unwrap(), shown);
        }
    }

    #[test]
    fn saved_layouts_that_know_one_other_method_mean_nayars() {
        let direct = Shown::from(Plain::DirectBy.of(Of::light_by(Method::Shape, "left")));
        for saved in [
            json!({"NayarDirect": {"light": "left"}}),
            json!({"DirectBy": {"light": "left"}}),
            json!({"DirectBy": {"method": "nayar", "light": "left"}}),
        ] {
            assert_eq!(from_value::<Shown>(saved).unwrap(), direct);
        }
        let normals = Shown::Normals(SurfaceName::By(Method::Shape));
        assert_eq!(from_value::<Shown>(json!({"Normals": "nayar"})).unwrap(), normals);
        assert!(from_value::<Shown>(json!({"Nothing": {"light": "left"}})).is_err());
    }
}
