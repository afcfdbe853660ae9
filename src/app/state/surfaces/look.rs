//! The look of a 3D view: the user's choices, kept with the layout.

use std::collections::BTreeMap;

use std::ops::RangeInclusive;

use firstbounce_capture::pipeline::Method;
use serde::{Deserialize, Serialize};

use crate::app::state::results::SurfaceName;
use crate::gpu::mesh::{Bounds, Camera, Lens, StandardView};

/// The colours of before, after and a scan, sRGB: in 3D, plots and tables alike. Green, yellow and red are verdicts alone.
pub const BEFORE: [u8; 3] = [232, 164, 62];
/// See [`BEFORE`].
pub const AFTER: [u8; 3] = [64, 186, 178];
/// See [`BEFORE`].
pub const SCAN: [u8; 3] = [176, 180, 186];

/// A surface that can be shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum LayerName {
    /// A surface of the set.
    Surface(SurfaceName),
    /// A scan of the same object.
    Reference,
}

impl LayerName {
    /// From the direct light that the method in force finds.
    pub const AFTER: Self = Self::Surface(SurfaceName::After);
    /// From the photos with all their light.
    pub const BEFORE: Self = Self::Surface(SurfaceName::Before);

    /// All, in the order of the list.
    pub fn all() -> impl Iterator<Item = Self> {
        let others = Method::ALL.into_iter().map(|method| Self::Surface(SurfaceName::By(method)));
        [Self::AFTER, Self::BEFORE].into_iter().chain(others).chain([Self::Reference])
    }

    /// What it is called.
    pub fn title(self) -> &'static str {
        match self {
            Self::AFTER => "After",
            Self::Surface(SurfaceName::Before) => "Before",
            Self::Surface(SurfaceName::By(method)) => method.title(),
            Self::Reference => "Reference",
        }
    }

    /// The same within a sentence.
    pub fn in_sentence(self) -> &'static str {
        match self {
            Self::AFTER => "the surface after",
            Self::Surface(SurfaceName::Before) => "the surface before",
            Self::Surface(SurfaceName::By(method)) => method.title(),
            Self::Reference => "reference",
        }
    }
}

/// How colours come to a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Shade {
    /// A studio that turns with the eye: shows form best.
    #[default]
    Matcap,
    /// Lit from the eye.
    Headlight,
    /// Lit by one of the capture's lamps, as in its photo.
    Lamp,
    /// Lit by a lamp that is dragged.
    Drag,
    /// The normal as colour.
    Normals,
    /// The paint alone.
    Albedo,
    /// z through a colour map.
    Height,
    /// How far from the reference.
    Distance,
}

impl Shade {
    /// All, in the order of a menu.
    pub const ALL: [Self; 8] = [
        Self::Matcap,
        Self::Headlight,
        Self::Lamp,
        Self::Drag,
        Self::Normals,
        Self::Albedo,
        Self::Height,
        Self::Distance,
    ];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Matcap => "Studio",
            Self::Headlight => "Lit from the eye",
            Self::Lamp => "Lit by a lamp",
            Self::Drag => "Lamp to drag",
            Self::Normals => "Normals as colour",
            Self::Albedo => "Albedo",
            Self::Height => "Height",
            Self::Distance => "Distance to the reference",
        }
    }
}

/// When layers are shown in their own colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum LayerColours {
    /// When more than one is seen: alone a surface is plaster.
    #[default]
    Several,
    /// Always.
    Always,
    /// Never.
    Never,
}

/// One layer's share.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerLook {
    /// Whether it is seen.
    pub visible: bool,
    /// Whether it is lit; otherwise it is its colour everywhere.
    pub shaded: bool,
    /// Its own colour, sRGB.
    pub colour: [u8; 3],
}

/// The share of each layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layers {
    /// Teal.
    after: LayerLook,
    /// Amber.
    before: LayerLook,
    /// Other methods, until one is changed: violet.
    nayar: LayerLook,
    /// Those that were changed.
    others: BTreeMap<Method, LayerLook>,
    /// The scan: grey.
    reference: LayerLook,
}

impl Default for Layers {
    fn default() -> Self {
        let layer = |visible, colour| LayerLook { visible, shaded: true, colour };
        Self {
            after: layer(true, AFTER),
            before: layer(false, BEFORE),
            nayar: layer(false, [178, 140, 222]),
            others: BTreeMap::new(),
            reference: layer(true, SCAN),
        }
    }
}

/// A direction to a lamp, of any length but none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Dragged(pub [f32; 3]);

impl Default for Dragged {
    /// From the upper left, low enough that a relief shows.
    fn default() -> Self {
        Self([-0.6, 0.6, 0.53])
    }
}

impl Dragged {
    /// Whether there is a direction.
    fn is_usable(self) -> bool {
        let square: f32 = self.0.iter().map(|x| x * x).sum();
        (1e-6..1e6).contains(&square)
    }
}

/// How a 3D view shows the surfaces.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SurfaceLook {
    /// How colours come to the surfaces.
    pub shade: Shade,
    /// The lamp of [`Shade::Lamp`], by its light's name; the first where that is gone.
    pub lamp: Option<String>,
    /// The lamp of [`Shade::Drag`]: to it in the object's frame.
    pub dragged: Dragged,
    /// The distance at the ends of the heat map in mm; `None` for that which 95 % stay below.
    pub distance_mm: Option<f32>,
    /// Whether edges are drawn.
    pub wireframe: bool,
    /// The share of each layer.
    #[serde(flatten)]
    pub layers: Layers,
    /// When the layers are shown in their own colours.
    pub colours: LayerColours,
    /// How distance shows.
    pub lens: Lens,
    /// The eye; `None` for everything in sight from the front and the right.
    pub camera: Option<Camera>,
    /// Whether the object turns by itself.
    #[serde(skip)]
    pub turntable: bool,
}

impl SurfaceLook {
    /// What `distance_mm` may be.
    pub const DISTANCES_MM: RangeInclusive<f32> = 1e-4..=1e6;

    /// The same without choices beyond their ranges, which a file may hold.
    pub fn within_ranges(&self) -> Self {
        Self {
            distance_mm: self.distance_mm.filter(|distance| Self::DISTANCES_MM.contains(distance)),
            camera: self.camera.filter(Camera::is_usable),
            dragged: Some(self.dragged).filter(|lamp| lamp.is_usable()).unwrap_or_default(),
            ..self.clone()
        }
    }

    /// A layer's share.
    pub fn layer(&self, name: LayerName) -> &LayerLook {
        match name {
            LayerName::AFTER => &self.layers.after,
            LayerName::Surface(SurfaceName::Before) => &self.layers.before,
            LayerName::Surface(SurfaceName::By(method)) => {
                self.layers.others.get(&method).unwrap_or(&self.layers.nayar)
            }
            LayerName::Reference => &self.layers.reference,
        }
    }

    /// The same, to be changed.
    pub fn layer_mut(&mut self, name: LayerName) -> &mut LayerLook {
        match name {
            LayerName::AFTER => &mut self.layers.after,
            LayerName::Surface(SurfaceName::Before) => &mut self.layers.before,
            LayerName::Surface(SurfaceName::By(method)) => {
                self.layers.others.entry(method).or_insert(self.layers.nayar)
            }
            LayerName::Reference => &mut self.layers.reference,
        }
    }

    /// Shows one surface and no other, and the scan where there is one.
    pub fn show_only(&mut self, only: LayerName) {
        for name in LayerName::all() {
            self.layer_mut(name).visible = name == only || name == LayerName::Reference;
        }
        self.colours = LayerColours::Always;
    }

    /// What is seen, in a few words.
    pub fn title(&self) -> String {
        let seen: Vec<_> = LayerName::all().filter(|name| self.layer(*name).visible).map(LayerName::title).collect();
        match seen.as_slice() {
            [] => "Nothing".into(),
            // A scan is drawn where there is one.
            [one] | [one, "Reference"] => (*one).into(),
            several => several.join(" and "),
        }
    }

    /// The eye in force for what is in the bounds.
    pub fn camera(&self, bounds: &Bounds, aspect: f64) -> Camera {
        match self.camera {
            Some(camera) => Camera { lens: self.lens, ..camera },
            None => Camera::fitted(bounds, StandardView::Corner, self.lens, aspect),
        }
    }

    /// Perspective becomes orthographic and the other way round.
    pub fn other_lens(&mut self) {
        self.lens = match self.lens {
            Lens::Perspective => Lens::Orthographic,
            Lens::Orthographic => Lens::Perspective,
        };
    }

    /// Takes the eye to a named side, everything in sight.
    pub fn look_from(&mut self, view: StandardView, bounds: &Bounds, aspect: f64) {
        self.camera = Some(Camera::fitted(bounds, view, self.lens, aspect));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layer_keeps_its_place_in_the_settings_of_a_view() {
        let mut look = SurfaceLook::default();
        look.layer_mut(LayerName::Reference).visible = false;
        look.layer_mut(LayerName::Surface(SurfaceName::By(Method::Shape))).colour = [1, 2, 3];
        let kept = serde_json::to_value(&look).unwrap();
        assert_eq!(kept["reference"]["visible"], false);
        assert_eq!(serde_json::from_value::<SurfaceLook>(kept).unwrap(), look);
    }
}
