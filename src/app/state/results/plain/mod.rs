//! Plain pictures: planes of single values that stages store. One row for each, with all that is asked of it; its stage puts
//! the plane, and menus, views, inspector and saved layouts follow the row. The object's mask lies over each of them.

mod table;

use std::collections::BTreeMap;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{Method, SurfaceName};
use serde::{Deserialize, Serialize};

use super::Step;
use crate::app::state::document::Document;
use crate::gpu::ColourMap;

pub use table::Plain;

/// All that is asked of a plain picture.
pub struct Row {
    /// What it is called; the surface, or method, light and colour, follow.
    pub title: &'static str,
    /// What there is one of it for.
    pub each: Each,
    /// Whether there is one for every colour but the reference, too.
    pub by_colour: bool,
    /// Where the menu of pictures has it, in the order of [`Plain::ALL`].
    pub place: Place,
    /// Its colours.
    pub map: ColourMap,
    /// The values at the two ends of the map.
    pub range: Range,
    /// What its numbers are.
    pub quantity: fn(&CaptureSet) -> Quantity,
    /// Why this set has none, and what to do; `None` where it can have one.
    pub impossible: fn(&CaptureSet) -> Option<&'static str>,
}

/// What there is a plain picture for.
#[derive(Clone, Copy)]
pub enum Each {
    /// Every surface.
    Surface,
    /// Every light, from the method in force, where it gives it.
    Light(fn(Method) -> bool),
    /// Every light, from every other method that gives it and is compared.
    LightBy(fn(Method) -> bool),
}

/// Where the menu of pictures has a plain picture.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Under the surface, after the normals.
    Surface,
    /// Under its light, first of all.
    BeforeBounces,
    /// Under its light, after the bounces.
    AfterBounces,
    /// Under its light, after the sum of the bounces.
    AfterSum,
}

/// The values at the two ends of a colour map.
#[derive(Clone, Copy)]
pub enum Range {
    /// Where most of its values lie.
    Own,
    /// From zero to its brightest values.
    FromZero,
    /// From zero to the brightest values of this picture of the same light, so that the two look alike.
    FromZeroTo(Plain),
}

/// What numbers are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// With the unit.
    pub words: &'static str,
    /// The words for the difference of two.
    pub difference: &'static str,
    /// The unit after a number, with a space before; empty where there is none.
    pub unit: &'static str,
}

impl Quantity {
    /// Photos and bounces.
    pub const LIGHT: Self = Self::light("Linear light, 1 = white level");

    /// Linear light, in other words.
    const fn light(words: &'static str) -> Self {
        Self { words, difference: "Difference of linear light", unit: "" }
    }
}

impl Plain {
    /// The picture of this surface, or light.
    pub fn of(self, of: impl Into<Of>) -> PlainPicture {
        PlainPicture { plain: self, of: of.into() }
    }

    /// Those at a place of the menu.
    pub fn at(place: Place) -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(move |plain| plain.row().place == place)
    }

    /// What the document has of it under a light, whether or not it is computed yet.
    pub fn under(self, light: &str, document: &Document) -> impl Iterator<Item = PlainPicture> {
        self.row().under(light, document).into_iter().map(move |of| self.of(of))
    }
}

impl Row {
    fn under(&self, light: &str, document: &Document) -> Vec<Of> {
        let methods = match self.each {
            Each::Surface => Vec::new(),
            Each::Light(gives) => [None].into_iter().filter(|_| gives(document.method())).collect(),
            Each::LightBy(gives) => document.compared().filter(|method| gives(*method)).map(Some).collect(),
        };
        let colours = match self.by_colour {
            true => document.set.colours.iter().skip(1).map(|colour| Some(colour.name.clone())).collect(),
            false => vec![None],
        };
        let of = |method, colour: &Option<String>| Of::Light { method, light: light.into(), colour: colour.clone() };
        methods.iter().flat_map(|method| colours.iter().map(|colour| of(*method, colour))).collect()
    }
}

/// What a plain picture is of.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Of {
    /// A surface.
    Surface(SurfaceName),
    /// A light.
    Light {
        /// The other method that finds it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        method: Option<Method>,
        /// The light's name.
        light: String,
        /// The colour's name, where there is one picture for each.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        colour: Option<String>,
    },
}

impl Of {
    /// A light.
    pub fn light(light: &str) -> Self {
        Self::Light { method: None, light: light.into(), colour: None }
    }

    /// A light in a colour.
    pub fn light_in(light: &str, colour: &str) -> Self {
        Self::Light { method: None, light: light.into(), colour: Some(colour.into()) }
    }

    /// A light, as another method finds it.
    pub fn light_by(method: Method, light: &str) -> Self {
        Self::Light { method: Some(method), light: light.into(), colour: None }
    }
}

impl From<SurfaceName> for Of {
    fn from(name: SurfaceName) -> Self {
        Self::Surface(name)
    }
}

/// One plain picture, by names that survive edits.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "BTreeMap<Plain, Of>", try_from = "BTreeMap<Plain, Of>")]
pub struct PlainPicture {
    /// Which.
    pub plain: Plain,
    /// Of what.
    pub of: Of,
}

impl PlainPicture {
    /// The surface it is of.
    pub fn surface(&self) -> Option<SurfaceName> {
        match &self.of {
            Of::Surface(name) => Some(*name),
            Of::Light { .. } => None,
        }
    }

    /// The colour it is of, where there is one picture for each.
    pub fn colour(&self) -> Option<&str> {
        match &self.of {
            Of::Light { colour, .. } => colour.as_deref(),
            Of::Surface(_) => None,
        }
    }

    /// Makes it that of another colour, where there is one picture for each.
    pub fn put_colour(&mut self, name: &str) {
        if let Of::Light { colour: Some(colour), .. } = &mut self.of {
            *colour = name.into();
        }
    }

    /// Makes it that of another light, where it is of one.
    pub fn put_light(&mut self, name: &str) {
        if let Of::Light { light, .. } = &mut self.of {
            *light = name.into();
        }
    }

    /// What people call it.
    pub fn title(&self) -> String {
        let title = self.plain.row().title;
        match &self.of {
            Of::Surface(name) => format!("{title} {}", name.words()),
            Of::Light { method, light, colour } => {
                let by = method.map(|method| format!(" by {}", method.title())).unwrap_or_default();
                let colour = colour.as_ref().map(|colour| format!(", {colour}")).unwrap_or_default();
                format!("{title}{by}, {light}{colour}")
            }
        }
    }

    /// The light it belongs to.
    pub fn light(&self) -> Option<&str> {
        match &self.of {
            Of::Surface(_) => None,
            Of::Light { light, .. } => Some(light),
        }
    }

    /// The other method whose results it shows.
    pub fn by_method(&self) -> Option<Method> {
        match self.of {
            Of::Surface(name) => name.other_method(),
            Of::Light { method, .. } => method,
        }
    }

    /// The stage that gives it.
    pub fn step(&self) -> Step {
        let step = match self.plain.row().each {
            Each::Light(_) => Step::Separate,
            Each::Surface | Each::LightBy(_) => Step::Shape,
        };
        self.by_method().map_or(step, Step::ByMethod)
    }
}

impl From<PlainPicture> for BTreeMap<Plain, Of> {
    fn from(PlainPicture { plain, of }: PlainPicture) -> Self {
        Self::from([(plain, of)])
    }
}

impl TryFrom<BTreeMap<Plain, Of>> for PlainPicture {
    type Error = &'static str;

    fn try_from(saved: BTreeMap<Plain, Of>) -> Result<Self, &'static str> {
        let mut saved = saved.into_iter();
        let (Some((plain, mut of)), None) = (saved.next(), saved.next()) else { return Err("not one picture") };
        if let (Each::LightBy(_), Of::Light { method, .. }) = (plain.row().each, &mut of) {
            // Earlier versions knew one other method, and did not write which.
            method.get_or_insert(Method::Shape);
        }
        Ok(plain.of(of))
    }
}

#[cfg(test)]
mod tests {
    use firstbounce_capture::set::{Colour, Light};

    use super::*;

    #[test]
    fn a_picture_by_colour_is_offered_once_for_every_method_and_colour() {
        let mut document = Document::default();
        document.set.lights = vec![Light { name: "left".into(), ..Light::default() }];
        let colours = ["blue", "green", "red"].map(|name| Colour { name: name.into(), ..Colour::default() });
        document.set.colours = colours.into();
        let row = Row { by_colour: true, ..Plain::DirectBy.row() };
        assert_eq!(row.under("left", &document), []);
        document.settings.compare(Method::Shape, true);
        let titles: Vec<_> =
            row.under("left", &document).into_iter().map(|of| Plain::DirectBy.of(of).title()).collect();
        assert_eq!(titles, ["green", "red"].map(|colour| format!("Direct light by Nayar's method, left, {colour}")));
        let row = Row { each: Each::LightBy(|method| method == Method::Colours), ..row };
        assert_eq!(row.under("left", &document), []);
    }

    #[test]
    fn a_picture_is_offered_where_the_method_in_force_gives_it() {
        let mut document = Document::default();
        document.set.separation.method = Some(Method::Shape);
        assert_eq!(Plain::Indirect.under("left", &document).count(), 0);
        document.set.separation.method = Some(Method::ColoursAndShape);
        let titles: Vec<_> = Plain::Indirect.under("left", &document).map(|picture| picture.title()).collect();
        assert_eq!(titles, ["Indirect light, left"]);
        // The method in force is not compared with itself.
        document.settings.compare(Method::ColoursAndShape, true);
        assert_eq!(Plain::DirectBy.under("left", &document).count(), 0);
    }
}
