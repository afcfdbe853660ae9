//! Lamps, as the user writes them.

use std::ops::RangeInclusive;
use std::str::FromStr;

use firstbounce_core::light::scene::{Lamp, directions_on_ring};
use nalgebra::{Point3, Unit, Vector3};

use super::SimulateError;
use firstbounce_capture::set::{Number, is_vector, vector_words};

/// How much a lamp's balance between the colours strays from what the paint would want, as real lamps' do.
const BALANCE_SPREAD: f64 = 0.05;
/// What the side of an area lamp may be.
const SIDES_MM: RangeInclusive<f64> = 1e-3..=1e6;
/// Points along each side of an area lamp.
const POINTS_PER_AREA_SIDE: usize = 6;

/// Where a lamp is, or how it shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LampPlace {
    /// Far away: from the object to the light, of any length.
    Direction([f64; 3]),
    /// A small lamp at a position in mm.
    Point([f64; 3]),
    /// A square lamp that faces the object's origin.
    Area {
        /// Its middle, in mm.
        centre_mm: [f64; 3],
        /// Its side.
        side_mm: f64,
    },
}

/// A lamp of a simulated rig.
#[derive(Clone, Debug, PartialEq)]
pub struct LampOptions {
    /// Its name, also used in file names.
    pub name: String,
    /// Where it is.
    pub place: LampPlace,
    /// Strength in the reference colour.
    pub intensity: f64,
    /// By colour: intensity over the reference colour's. `None`: it makes up for the darker colours of the paint, a few
    /// percent differently from lamp to lamp.
    pub alpha: Option<Vec<f64>>,
}

impl LampOptions {
    /// `count` distant lamps evenly around the camera's axis, `tilt_deg` from it.
    pub fn ring(count: usize, tilt_deg: f64) -> Vec<Self> {
        let directions = directions_on_ring(count, tilt_deg);
        Self::named(directions.iter().map(|d| LampPlace::Direction([d.x, d.y, d.z])))
    }

    /// The same at a distance from the object: small lamps, or square ones of a side that face it.
    pub fn near_ring(count: usize, tilt_deg: f64, distance_mm: f64, side_mm: Option<f64>) -> Vec<Self> {
        let directions = directions_on_ring(count, tilt_deg);
        Self::named(directions.iter().map(|direction| {
            let centre_mm = (direction.into_inner() * distance_mm).into();
            match side_mm {
                None => LampPlace::Point(centre_mm),
                Some(side_mm) => LampPlace::Area { centre_mm, side_mm },
            }
        }))
    }

    /// Lamps light1, light2, .. that differ a little in strength, as real lamps do.
    pub fn named(places: impl IntoIterator<Item = LampPlace>) -> Vec<Self> {
        let lamp = |(l, place)| Self {
            name: format!("light{}", l + 1),
            place,
            intensity: [1.0, 1.05, 0.95][l % 3],
            alpha: None,
        };
        places.into_iter().enumerate().map(lamp).collect()
    }

    /// alpha for a paint, the lamp being the `index`-th of the rig.
    pub fn alpha_for(&self, albedos: &[f64], index: usize) -> Vec<f64> {
        if let Some(alpha) = &self.alpha {
            return alpha.clone();
        }
        let stray = |c: usize| if c == 0 { 0.0 } else { BALANCE_SPREAD * [0.0, 1.0, -1.0][(index + c - 1) % 3] };
        let reference = albedos.first().copied().unwrap_or(1.0);
        albedos.iter().enumerate().map(|(c, albedo)| reference / albedo * (1.0 + stray(c))).collect()
    }

    /// As the renderer takes it.
    pub fn lamp(&self) -> Lamp {
        let intensity = self.intensity;
        match self.place {
            LampPlace::Direction(direction) => {
                Lamp::Directional { direction_to_light: Unit::new_normalize(Vector3::from(direction)), intensity }
            }
            LampPlace::Point(position) => Lamp::Point { position_mm: Point3::from(position), intensity },
            LampPlace::Area { centre_mm, side_mm } => {
                let centre_mm = Point3::from(centre_mm);
                let toward_object = -Unit::new_normalize(centre_mm.coords);
                // Any direction across will do; y fails only for a lamp on the y axis.
                let up = if toward_object.y.abs() > 0.9 { Vector3::x() } else { Vector3::y() };
                let across = Unit::new_normalize(up.cross(&toward_object));
                let half_width_mm = across.into_inner() * (side_mm / 2.0);
                let half_height_mm = toward_object.cross(&across) * (side_mm / 2.0);
                let points_per_side = POINTS_PER_AREA_SIDE;
                Lamp::Area { centre_mm, half_width_mm, half_height_mm, intensity, points_per_side }
            }
        }
    }

    /// From its middle to its rim, seen from the object; small lamps count as a bulb of 1.5 degrees.
    pub(super) fn half_angle_deg(&self) -> f64 {
        match self.place {
            LampPlace::Area { centre_mm, side_mm } => {
                (side_mm / 2.0 / Vector3::from(centre_mm).norm()).atan().to_degrees().max(1.5)
            }
            _ => 1.5,
        }
    }

    pub(super) fn check(&self, colours: usize) -> Result<(), SimulateError> {
        let (LampPlace::Direction(place) | LampPlace::Point(place) | LampPlace::Area { centre_mm: place, .. }) =
            self.place;
        let component = match self.place {
            LampPlace::Direction(_) => Number::Direction,
            LampPlace::Point(_) | LampPlace::Area { .. } => Number::PositionMm,
        };
        if !is_vector(component, &place) {
            return Err(SimulateError::LampPlace { light: self.name.clone(), expected: vector_words(component) });
        }
        let length = Vector3::from(place).norm();
        // Exactly sideways counts as behind: what faces the camera is not lit.
        if place[2] / length < 1e-6 {
            let elevation_deg = (place[2] / length).asin().to_degrees();
            return Err(SimulateError::LampBehind { light: self.name.clone(), elevation_deg });
        }
        let bad = |what, value, range: RangeInclusive<f64>| {
            let (low, high) = range.into_inner();
            Err(SimulateError::LampValue { light: self.name.clone(), what, value, low, high })
        };
        if let LampPlace::Area { side_mm, .. } = self.place
            && !SIDES_MM.contains(&side_mm)
        {
            return bad("side", side_mm, SIDES_MM);
        }
        if !Number::Intensity.allows(self.intensity) {
            return bad("intensity", self.intensity, Number::Intensity.range());
        }
        let Some(alpha) = &self.alpha else { return Ok(()) };
        if alpha.len() != colours {
            return Err(SimulateError::Count { what: "values of alpha", found: alpha.len(), expected: colours });
        }
        match alpha.iter().find(|alpha| !Number::Alpha.allows(**alpha)) {
            Some(&value) => bad("alpha", value, Number::Alpha.range()),
            None if (alpha[0] - 1.0).abs() > 1e-9 => {
                Err(SimulateError::ReferenceAlpha { light: self.name.clone(), value: alpha[0] })
            }
            None => Ok(()),
        }
    }
}

/// One or more lamps, as the user writes them: `ring:3:20`, `dir:0.3,0,1`, `point:-390,80,1400`, `area:0,0,900:80`.
#[derive(Clone, Debug, PartialEq)]
pub struct LampPlaces(pub Vec<LampPlace>);

/// Words that say no lamp.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
#[error(
    "\"{text}\" is no lamp; write ring:COUNT:TILT in degrees, dir:X,Y,Z, point:X,Y,Z in mm, or area:X,Y,Z:SIDE in mm"
)]
pub struct NoLamp {
    text: String,
}

impl FromStr for LampPlaces {
    type Err = NoLamp;

    fn from_str(text: &str) -> Result<Self, NoLamp> {
        let no_lamp = || NoLamp { text: text.to_owned() };
        let parts: Vec<&str> = text.trim().split(':').map(str::trim).collect();
        let number = |part: &str| part.trim().parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(no_lamp);
        let vector = |part: &str| {
            let numbers = part.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
            <[f64; 3]>::try_from(numbers).map_err(|_| no_lamp())
        };
        Ok(Self(match parts[..] {
            ["ring", count, tilt] => {
                let count = count.parse::<usize>().ok().filter(|count| (1..=1000).contains(count));
                let directions = directions_on_ring(count.ok_or_else(no_lamp)?, number(tilt)?);
                directions.iter().map(|d| LampPlace::Direction([d.x, d.y, d.z])).collect()
            }
            ["dir", direction] => vec![LampPlace::Direction(vector(direction)?)],
            ["point", position] => vec![LampPlace::Point(vector(position)?)],
            ["area", centre, side] => {
                vec![LampPlace::Area { centre_mm: vector(centre)?, side_mm: number(side)? }]
            }
            _ => return Err(no_lamp()),
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lamps_are_read_as_they_are_written() {
        let places = |text: &str| text.parse::<LampPlaces>().unwrap().0;
        assert_eq!(places("ring:4:30").len(), 4);
        assert_eq!(places("dir:-0.3, 0, 1"), [LampPlace::Direction([-0.3, 0.0, 1.0])]);
        assert_eq!(places("point:-390,83,1390"), [LampPlace::Point([-390.0, 83.0, 1390.0])]);
        let area = LampPlace::Area { centre_mm: [0.0, 10.0, 900.0], side_mm: 80.0 };
        assert_eq!(places("area:0,10,900:80"), [area]);
        for wrong in ["", "ring:3", "ring:0:20", "dir:1,2", "dir:1,2,x", "point:1,2,nan", "sun:1,2,3"] {
            assert!(wrong.parse::<LampPlaces>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn an_area_lamp_faces_the_object() {
        for centre_mm in [[0.0, 0.0, 500.0], [300.0, -200.0, 400.0], [0.0, 500.0, 50.0]] {
            let place = LampPlace::Area { centre_mm, side_mm: 60.0 };
            let lamp = &LampOptions::named([place])[0];
            lamp.check(2).unwrap();
            lamp.lamp().check().unwrap();
        }
    }

    #[test]
    fn lamps_make_up_for_the_paint_each_in_its_own_way() {
        let alpha: Vec<_> =
            LampOptions::ring(3, 20.0).iter().enumerate().map(|(l, o)| o.alpha_for(&[0.8, 0.4], l)).collect();
        assert!(alpha.iter().all(|alpha| alpha[0] == 1.0 && (alpha[1] / 2.0 - 1.0).abs() < 0.06));
        assert!(alpha[0] != alpha[1] && alpha[1] != alpha[2]);
    }

    #[test]
    fn a_lamp_behind_the_object_is_refused() {
        for z in [-1.0, 0.0] {
            let lamp = &LampOptions::named([LampPlace::Direction([1.0, 0.0, z])])[0];
            assert!(matches!(lamp.check(1), Err(SimulateError::LampBehind { .. })));
        }
    }
}
