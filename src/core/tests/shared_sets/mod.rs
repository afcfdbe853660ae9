//! What the capture sets in ../shared/data hold, as far as calibration needs it.

use firstbounce_core::image::photo::{CLIPPED, DARK};
use firstbounce_core::{Marks, Photo, Plane};
use image::DynamicImage;
use nalgebra::Vector3;
use std::path::Path;

/// A rendered set: one file a light and colour, or one RGB file a light.
pub struct Set {
    pub name: &'static str,
    pub lights: &'static [&'static str],
    /// Name and exposure; in an RGB set colour k is channel k.
    pub colours: &'static [(&'static str, f32)],
    pub rgb: bool,
    pub black_level: f32,
    pub centre_px: f64,
    pub radius_px: f64,
    /// Near lamps only: the ball's size in the lamps' unit.
    pub ball_radius_mm: f64,
    pub lamp_distance_radii: Option<f64>,
}

pub const SETS: [Set; 4] = [
    Set {
        name: "corner-blue",
        lights: &["left", "top", "right"],
        colours: &[("blue", 1.0), ("green", 1.0)],
        rgb: false,
        black_level: 0.0,
        centre_px: 100.0,
        radius_px: 83.333,
        ball_radius_mm: 0.0,
        lamp_distance_radii: None,
    },
    Set {
        name: "groove-rgb",
        lights: &["north", "east", "south", "west"],
        colours: &[("red", 1.0), ("green", 1.0), ("blue", 1.0)],
        rgb: true,
        black_level: 512.0,
        centre_px: 100.0,
        radius_px: 83.333,
        ball_radius_mm: 0.0,
        lamp_distance_radii: None,
    },
    Set {
        name: "bowl-four",
        lights: &["left", "top", "right"],
        colours: &[("c1", 1.0), ("c2", 1.0), ("c3", 1.0), ("c4", 1.0)],
        rgb: false,
        black_level: 0.0,
        centre_px: 100.0,
        radius_px: 83.333,
        ball_radius_mm: 0.0,
        lamp_distance_radii: None,
    },
    Set {
        name: "birdbath-dslr",
        lights: &["left", "top", "right"],
        colours: &[("blue", 1.0), ("green", 0.5)],
        rgb: false,
        black_level: 512.0,
        centre_px: 120.0,
        radius_px: 100.0,
        // 100 px at 1200 mm with a focal length of 3400 px.
        ball_radius_mm: 35.294,
        lamp_distance_radii: Some(1500.0 / 35.294),
    },
];

/// What a set was rendered with, by light in the set's order.
pub struct Truth {
    pub alpha: Vec<Vec<f64>>,
    pub beta: Vec<f64>,
    pub intensity: Vec<f64>,
    pub direction: Vec<Vector3<f64>>,
    /// Empty for distant lamps.
    pub position_mm: Vec<Vector3<f64>>,
}

impl Set {
    pub fn truth(&self, data: &Path) -> Truth {
        let text = std::fs::read_to_string(data.join(self.name).join("truth/rig.json")).unwrap();
        let rig: serde_json::Value = serde_json::from_str(&text).unwrap();
        let numbers = |value: &serde_json::Value| -> Vec<f64> {
            value.as_array().into_iter().flatten().map(|v| v.as_f64().unwrap()).collect()
        };
        let vectors = |key: &str| -> Vec<Vector3<f64>> {
            let of_light = |light: &&str| numbers(&rig[key][*light]);
            self.lights.iter().map(of_light).filter(|v| v.len() == 3).map(|v| Vector3::new(v[0], v[1], v[2])).collect()
        };
        Truth {
            alpha: self.lights.iter().map(|light| numbers(&rig["alpha"][*light])).collect(),
            beta: numbers(&rig["beta"]),
            intensity: self.lights.iter().map(|light| rig["intensity"][*light].as_f64().unwrap()).collect(),
            direction: vectors("direction"),
            position_mm: vectors("position_mm"),
        }
    }

    /// The photo of a grey or material ball under a light, in the colour of this index.
    pub fn photo(&self, data: &Path, subject: &str, light: &str, colour: usize) -> Photo {
        let (name, exposure) = self.colours[colour];
        let file = if self.rgb { format!("{light}.png") } else { format!("{light}-{name}.png") };
        let path = data.join(self.name).join(subject).join(file);
        self.linear(&path, self.rgb.then_some(colour), exposure)
    }

    /// The photo of the mirror ball under a light.
    pub fn mirror(&self, data: &Path, light: &str) -> Photo {
        self.linear(&data.join(self.name).join("mirror-sphere").join(format!("{light}.png")), None, 1.0)
    }

    fn linear(&self, path: &Path, channel: Option<usize>, exposure: f32) -> Photo {
        let picture = image::open(path).unwrap();
        let size = (picture.width() as usize, picture.height() as usize);
        let stored: Vec<u16> = match channel {
            Some(channel) => picture.to_rgb16().pixels().map(|p| p[channel]).collect(),
            None => picture.to_luma16().into_raw(),
        };
        let span = 65535.0 - self.black_level;
        let linear = stored.iter().map(|&v| (f32::from(v) - self.black_level) / span / exposure).collect();
        photo(size, linear, stored.iter().map(|&v| (v == u16::MAX, f32::from(v) < self.black_level + 32.0)))
    }
}

/// Lamps of the real photos.
pub const CAT_LAMPS: usize = 12;

/// The mirror ball of the real photos under lamp 1 to 12: 8-bit sRGB, grey as the mean of the channels.
pub fn cat_mirror(data: &Path, lamp: usize) -> Photo {
    let picture = image::open(data.join(format!("psbox-cat/mirror-sphere/Image_{lamp:02}.JPG"))).unwrap();
    let DynamicImage::ImageRgb8(rgb) = picture else { panic!("the photo is 8-bit RGB") };
    let decoded = |v: u8| {
        let v = f32::from(v) / 255.0;
        if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
    };
    let size = (rgb.width() as usize, rgb.height() as usize);
    let linear = rgb.pixels().map(|p| p.0.into_iter().map(decoded).sum::<f32>() / 3.0).collect();
    photo(size, linear, rgb.pixels().map(|p| (p.0.contains(&255), p.0.into_iter().all(|v| v < 3))))
}

/// Directions to the lamps of the real photos as another toolbox found them: rows x, y, z, one column a lamp.
pub fn cat_directions(data: &Path) -> Vec<Vector3<f64>> {
    let text = std::fs::read_to_string(data.join("psbox-cat/reference_directions.txt")).unwrap();
    let numbers: Vec<f64> = text.split_whitespace().map(|word| word.parse().unwrap()).collect();
    let row = |axis: usize, lamp: usize| numbers[axis * CAT_LAMPS + lamp];
    (0..CAT_LAMPS).map(|lamp| Vector3::new(row(0, lamp), row(1, lamp), row(2, lamp))).collect()
}

fn photo((width, height): (usize, usize), linear: Vec<f32>, bad: impl Iterator<Item = (bool, bool)>) -> Photo {
    let marks = bad.map(|(clipped, dark)| u8::from(clipped) * CLIPPED + u8::from(dark) * DARK).collect();
    let marks = Marks::from_vec(width, height, marks).unwrap();
    Photo { linear: Plane::from_vec(width, height, linear).unwrap(), marks }
}
