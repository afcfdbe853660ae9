//! The pictures that a view can show.

use firstbounce_capture::pipeline::Method;
use firstbounce_capture::set::Subject;
use serde::{Deserialize, Serialize};

use crate::app::state::results::{ShotName, SurfaceName};

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
    /// What the bounces leave of the photos, root mean square over the colours.
    Residual {
        /// The light's name.
        light: String,
    },
    /// Predicted noise of bounce 1.
    Noise {
        /// The light's name.
        light: String,
    },
    /// Bounce 1 with less noise: what the surface is recovered from.
    Direct {
        /// The light's name.
        light: String,
    },
    /// Direct light of a light, as another method finds it.
    #[serde(alias = "NayarDirect")]
    DirectBy {
        /// Which method; that of Nayar in what earlier versions kept.
        #[serde(default = "nayar")]
        method: Method,
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
    /// Albedo.
    Albedo(SurfaceName),
    /// Predicted noise of the normals in degrees.
    NormalNoise(SurfaceName),
    /// Depth.
    Depth(SurfaceName),
    /// Before, after and a reference in 3D.
    Surface,
    /// One picture of single values minus another.
    Difference(Box<Shown>, Box<Shown>),
}

impl Default for Shown {
    /// Normals from bounce 1: what the program is for.
    fn default() -> Self {
        Self::Normals(SurfaceName::AFTER)
    }
}

impl Shown {
    /// The object's photo under a light in a colour.
    pub fn object(light: &str, colour: &str) -> Self {
        Self::Photo(ShotName { subject: Subject::Object, light: Some(light.into()), colour: Some(colour.into()) })
    }

    /// What people call it.
    pub fn title(&self) -> String {
        match self {
            Self::Photo(shot) => photo_title(shot),
            Self::Bounce { light, k } => format!("Bounce {k}, {light}"),
            Self::Sum { light } => format!("Sum of bounces, {light}"),
            Self::Residual { light } => format!("Residual, {light}"),
            Self::Noise { light } => format!("Noise of bounce 1, {light}"),
            Self::Direct { light } => format!("Bounce 1 with less noise, {light}"),
            Self::DirectBy { method, light } => format!("Direct light by {}, {light}", method.title()),
            Self::Marks { light } => format!("Marks, {light}"),
            Self::FigureOne { light } => format!("Bounces 1 and 2 in colour, {light}"),
            Self::Normals(when) => format!("Normals {}", when.words()),
            Self::Albedo(when) => format!("Albedo {}", when.words()),
            Self::NormalNoise(when) => format!("Noise of the normals {}", when.words()),
            Self::Depth(when) => format!("Depth {}", when.words()),
            Self::Surface => "Surface in 3D".into(),
            Self::Difference(a, b) => match (&**a, &**b) {
                (Self::Normals(a), Self::Normals(b)) => {
                    format!("Angle between normals {} and {}", a.words(), b.words())
                }
                _ => format!("{} minus {}", a.title(), b.title()),
            },
        }
    }

    /// The light it belongs to.
    pub fn light(&self) -> Option<&str> {
        match self {
            Self::Photo(shot) => shot.light.as_deref(),
            Self::Bounce { light, .. }
            | Self::Sum { light }
            | Self::Residual { light }
            | Self::Noise { light }
            | Self::Direct { light }
            | Self::DirectBy { light, .. }
            | Self::Marks { light }
            | Self::FigureOne { light } => Some(light),
            Self::Difference(a, _) => a.light(),
            Self::Normals(_) | Self::Albedo(_) | Self::NormalNoise(_) | Self::Depth(_) | Self::Surface => None,
        }
    }

    /// The other method whose results it shows.
    pub fn by_method(&self) -> Option<Method> {
        match self {
            Self::DirectBy { method, .. } => Some(*method),
            Self::Normals(when) | Self::Albedo(when) | Self::NormalNoise(when) | Self::Depth(when) => match *when {
                SurfaceName::Before | SurfaceName::AFTER => None,
                SurfaceName::After(method) => Some(method),
            },
            Self::Difference(a, b) => a.by_method().or_else(|| b.by_method()),
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
}

fn nayar() -> Method {
    Method::Shape
}

fn photo_title(shot: &ShotName) -> String {
    let subject = match shot.subject {
        Subject::Object => "Photo",
        subject => subject.title(),
    };
    let words = [Some(subject), shot.light.as_deref(), shot.colour.as_deref()];
    words.into_iter().flatten().collect::<Vec<_>>().join(", ")
}
