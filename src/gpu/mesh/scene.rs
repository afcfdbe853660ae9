//! The scene of a 3D view, as plain values: two scenes that are equal give the same picture.

use std::sync::Arc;

use nalgebra::Isometry3;

use super::{Frame, Geometry, Shared};
use crate::gpu::{ColourMap, Display};

/// How a surface gets its colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shading {
    /// The base colour everywhere.
    Plain,
    /// Lit from the eye.
    Headlight,
    /// Lit by a lamp: its position and 1, or the direction to it and 0, in the object frame.
    Lamp([f32; 4]),
    /// The normal's x, y, z as red, green, blue.
    Normals,
    /// The vertices' colours.
    Albedo,
    /// z through the colour map, from one height to another.
    Height([f32; 2]),
    /// A studio that turns with the eye.
    Matcap,
    /// The vertices' values through the signed colour map, up to this magnitude.
    Distance(f32),
}

impl Shading {
    /// The number of the mode in `mesh.wgsl`.
    pub(super) fn number(self) -> u32 {
        match self {
            Self::Plain => 0,
            Self::Headlight => 1,
            Self::Lamp(_) => 2,
            Self::Normals => 3,
            Self::Albedo => 4,
            Self::Height(_) => 5,
            Self::Matcap => 6,
            Self::Distance(_) => 7,
        }
    }

    /// The legend of the colours, where they mean values.
    pub fn legend(self) -> Option<Display> {
        match self {
            Self::Height(range) => Some(Display { map: ColourMap::Viridis, range, ..Display::default() }),
            Self::Distance(largest) => Some(Display::signed(largest)),
            _ => None,
        }
    }
}

/// One surface of a scene.
#[derive(Clone, PartialEq)]
pub struct LayerDrawing {
    /// Its triangles.
    pub geometry: Shared<Geometry>,
    /// A value for each vertex, for [`Shading::Distance`]; NaN where there is none.
    pub values: Option<Shared<Vec<f32>>>,
    /// Where it lies.
    pub world_from_mesh: Isometry3<f64>,
    /// How it gets its colours.
    pub shading: Shading,
    /// Its own colour, 0 to 1 in gamma space, in the place of plaster or albedo.
    pub base: Option<[f32; 3]>,
    /// The colour of its edges, if they are drawn, and how much of the surface they cover.
    pub wire: Option<[f32; 4]>,
}

impl LayerDrawing {
    /// A surface where it is, as plaster lit from the eye.
    pub fn new(geometry: Arc<Geometry>) -> Self {
        Self {
            geometry: Shared(geometry),
            values: None,
            world_from_mesh: Isometry3::identity(),
            shading: Shading::Headlight,
            base: None,
            wire: None,
        }
    }
}

/// A plane whose cut with the surfaces is drawn as a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneDrawing {
    /// Unit normal.
    pub normal: [f64; 3],
    /// Distance from the origin along it.
    pub offset: f64,
    /// Of the line, 0 to 1 in gamma space.
    pub colour: [f32; 3],
    /// Half the line's width in pixels.
    pub half_width_px: f32,
}

/// A whole picture.
#[derive(Clone, PartialEq)]
pub struct Scene {
    /// Width and height of the picture in physical pixels.
    pub size_px: [u32; 2],
    /// The eye.
    pub frame: Frame,
    /// The surfaces.
    pub layers: Vec<LayerDrawing>,
    /// The colour behind them, 0 to 1 in gamma space.
    pub background: [f32; 3],
    /// A cut.
    pub plane: Option<PlaneDrawing>,
}
