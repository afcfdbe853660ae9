//! The tiles that each step begins with, made of what the set holds.

use firstbounce_capture::pipeline::Method;
use firstbounce_capture::set::{SphereKind, Subject, Word};

use super::{Pane, Shown};
use crate::app::state::document::Document;
use crate::app::state::panel::PanelName;
use crate::app::state::results::{Of, Plain, ShotName, SurfaceName};
use crate::app::state::surfaces::LayerName;

/// Tiles beside and below each other.
#[derive(Clone, Debug, PartialEq)]
pub enum Arrangement {
    /// One view.
    One(Shown),
    /// A view of this surface in 3D.
    Surface(LayerName),
    /// From left to right.
    Row(Vec<Self>),
    /// From top to bottom.
    Column(Vec<Self>),
}

impl Arrangement {
    /// What a step begins with.
    pub fn of(step: PanelName, document: &Document) -> Self {
        if document.set.shots.is_empty() {
            return Self::One(Shown::default());
        }
        match step {
            PanelName::Captures => Self::Row(vec![Self::One(Shown::Pane(Pane::Photos)), Self::One(photo(document))]),
            PanelName::Calibrate => calibrate(document),
            PanelName::Separate => separate(document),
            PanelName::Shape => Self::Row([LayerName::BEFORE, LayerName::AFTER].map(Self::Surface).into()),
            PanelName::Export => Self::Surface(LayerName::AFTER),
        }
    }

    /// The view that commands act on first, by its place in the order of all: what most of the step is about.
    pub fn main(step: PanelName) -> usize {
        match step {
            PanelName::Calibrate | PanelName::Export => 0,
            PanelName::Captures | PanelName::Separate | PanelName::Shape => 1,
        }
    }
}

/// The first photo of the object.
fn photo(document: &Document) -> Shown {
    let set = &document.set;
    match (set.lights.first(), set.colours.first()) {
        (Some(light), Some(colour)) => Shown::object(&light.name, &colour.name),
        _ => set.shots.first().map_or_else(Shown::default, |shot| Shown::Photo(ShotName::of(shot))),
    }
}

/// The balls above, what they say below.
fn calibrate(document: &Document) -> Arrangement {
    let first = |subject: Subject| Some(Shown::Photo(ShotName::of(document.set.shots_of(subject).next()?)));
    let ball = |kind: &SphereKind| first(document.set.subject_with(*kind)?).map(Arrangement::One);
    let mut balls: Vec<_> = SphereKind::ALL.iter().filter_map(ball).collect();
    balls.dedup();
    let below = [Pane::Dome, Pane::Rig].map(|pane| Arrangement::One(Shown::Pane(pane)));
    if balls.is_empty() {
        balls.push(Arrangement::One(photo(document)));
    }
    Arrangement::Column(vec![Arrangement::Row(balls), Arrangement::Row(below.into())])
}

/// The photo, what of it is direct light, what is indirect, and what that does to the normals.
fn separate(document: &Document) -> Arrangement {
    let turned = Shown::difference(Shown::Normals(SurfaceName::After), Shown::Normals(SurfaceName::Before));
    let mut shown = vec![photo(document)];
    if let Some(light) = document.set.lights.first() {
        let of = || Of::light(&light.name);
        let bounce = |k| Shown::Bounce { light: light.name.clone(), k };
        match document.method() {
            Method::Colours => shown.extend([bounce(1), bounce(2)]),
            Method::ColoursAndShape | Method::Shape => {
                shown.extend([Plain::Direct.of(of()).into(), Plain::Indirect.of(of()).into()]);
            }
        }
        if document.method() == Method::Colours && document.set.bounces() < 2 {
            shown.pop();
        }
    }
    shown.push(turned);
    let rows = shown.chunks(2).map(|pair| Arrangement::Row(pair.iter().cloned().map(Arrangement::One).collect()));
    Arrangement::Column(rows.collect())
}
