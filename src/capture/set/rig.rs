//! One rig for many objects: calibration carried from one set into another by the names of lights and colours.

use super::model::{Calibration, CaptureSet};

/// What was carried over, and what was not.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CarriedRig {
    /// Lights whose calibration was taken over.
    pub lights: Vec<String>,
    /// Lights of this set that the other does not know: still to be measured.
    pub unknown_lights: Vec<String>,
    /// Colours of this set that the other does not know: alpha and beta could not be taken over.
    pub unknown_colours: Vec<String>,
    /// Lights of the other set that this one does not have.
    pub unused_lights: Vec<String>,
    /// Whether beta was taken over.
    pub beta: bool,
}

impl CarriedRig {
    /// Lines for the user; the first says what was done.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![match self.lights.as_slice() {
            [] => "nothing was taken over: no light of this set has the name of one of the other's".into(),
            lights => format!("taken over for {}{}", lights.join(", "), if self.beta { ", with beta" } else { "" }),
        }];
        let mut report = |names: &[String], what: &str| {
            if !names.is_empty() {
                lines.push(format!("{}: {what}", names.join(", ")));
            }
        };
        report(&self.unknown_lights, "a light that the other set does not know; measure or type its values");
        report(
            &self.unknown_colours,
            "a colour that the other set does not know; alpha and beta were left as they are",
        );
        report(&self.unused_lights, "a light of the other set that this one does not have");
        lines
    }
}

impl CaptureSet {
    /// Takes over alpha, intensities and directions that `other` was calibrated to (`values`), for lights and colours of
    /// the same names; with `same_paint` beta too. Where the sets count by different reference colours or first lights,
    /// the values are converted.
    pub fn use_rig(&mut self, other: &Self, values: &Calibration, same_paint: bool) -> CarriedRig {
        let columns: Vec<Option<usize>> = self.colours.iter().map(|colour| other.colour_index(&colour.name)).collect();
        let mut carried = CarriedRig::default();
        for (colour, column) in self.colours.iter().zip(&columns) {
            if column.is_none() {
                carried.unknown_colours.push(colour.name.clone());
            }
        }
        let columns: Option<Vec<usize>> = columns.into_iter().collect();
        let reference = columns.as_ref().and_then(|columns| columns.first().copied());

        // The camera belongs to the rig. Of a part of the colours alone crosstalk cannot be undone.
        let rows = other.camera.crosstalk.as_ref().zip(columns.as_ref());
        if let Some((rows, columns)) = rows.filter(|(rows, columns)| rows.len() == columns.len()) {
            self.camera.crosstalk = columns.iter().map(|row| picked(rows.get(*row)?, columns)).collect();
        }

        let mut strengths = Vec::new();
        for light in &mut self.lights {
            let Some(theirs) = other.lights.iter().find(|theirs| theirs.name == light.name) else {
                carried.unknown_lights.push(light.name.clone());
                continue;
            };
            let alpha = values.alpha.get(&light.name);
            if let Some(alpha) = columns.as_ref().zip(alpha).and_then(|(columns, alpha)| chosen(alpha, columns)) {
                self.calibration.alpha.insert(light.name.clone(), alpha);
            }
            match (theirs.position_mm, other.given_direction(&light.name)) {
                (Some(position), None) => {
                    (light.position_mm, light.direction) = (Some(position), None);
                    self.calibration.direction.shift_remove(&light.name);
                }
                (_, given) => {
                    if let Some(direction) = given.or_else(|| values.direction.get(&light.name).copied()) {
                        (light.position_mm, light.direction) = (theirs.position_mm, None);
                        self.calibration.direction.insert(light.name.clone(), direction);
                    }
                }
            }
            // Strength in this set's reference colour.
            let balance = match reference {
                Some(0) | None => Some(1.0),
                Some(column) => alpha.and_then(|alpha| alpha.get(column).copied()),
            };
            let strength =
                values.intensity.get(&light.name).zip(balance).map(|(intensity, balance)| intensity * balance);
            strengths.push((light.name.clone(), strength));
            carried.lights.push(light.name.clone());
        }
        // Intensities are relative to the first light: they count only together.
        let first = self.lights.first().map(|light| &light.name);
        let unit = strengths.iter().find(|(name, _)| Some(name) == first).and_then(|(_, strength)| *strength);
        if let Some(unit) = unit.filter(|unit| *unit > 0.0) {
            let relative = strengths.into_iter().filter_map(|(name, strength)| Some((name, strength? / unit)));
            self.calibration.intensity.extend(relative);
        }
        // The ball stays the same; the light of white depends on this set's exposure.
        self.calibration.grey_albedo = self.calibration.grey_albedo.or(values.grey_albedo);
        let beta = columns.zip(values.beta.as_ref()).and_then(|(columns, beta)| chosen(beta, &columns));
        if let Some(beta) = beta.filter(|_| same_paint && !carried.lights.is_empty()) {
            self.calibration.beta = Some(beta);
            carried.beta = true;
        }
        let unused = other.lights.iter().filter(|theirs| self.light_index(&theirs.name).is_none());
        carried.unused_lights = unused.map(|light| light.name.clone()).collect();
        carried
    }

    /// Puts the direction to a light in force: it replaces one that is typed at the light.
    pub fn put_direction(&mut self, light: &str, direction: [f64; 3]) {
        if let Some(light) = self.lights.iter_mut().find(|other| other.name == light) {
            light.direction = None;
        }
        self.calibration.direction.insert(light.to_owned(), direction);
    }
}

fn picked(values: &[f64], columns: &[usize]) -> Option<Vec<f64>> {
    columns.iter().map(|&column| values.get(column).copied()).collect()
}

/// The ratios of some colours, over the first of them.
fn chosen(ratios: &[f64], columns: &[usize]) -> Option<Vec<f64>> {
    let picked = picked(ratios, columns)?;
    let reference = picked.first().copied().filter(|reference| *reference > 0.0)?;
    Some(picked.iter().map(|ratio| ratio / reference).collect())
}

#[cfg(test)]
mod tests {
    use super::super::model::{Colour, Light};
    use super::*;

    fn set(lights: &[&str], colours: &[&str]) -> CaptureSet {
        let light = |name: &&str| Light { name: (*name).into(), ..Light::default() };
        let colour = |name: &&str| Colour { name: (*name).into(), ..Colour::default() };
        CaptureSet {
            lights: lights.iter().map(light).collect(),
            colours: colours.iter().map(colour).collect(),
            ..CaptureSet::default()
        }
    }

    fn rig() -> (CaptureSet, Calibration) {
        let values = Calibration {
            beta: Some(vec![1.0, 0.5, 0.8]),
            alpha: [("left".into(), vec![1.0, 2.0, 4.0]), ("top".into(), vec![1.0, 3.0, 5.0])].into(),
            direction: [("left".into(), [0.0, 0.6, 0.8]), ("top".into(), [0.6, 0.0, 0.8])].into(),
            intensity: [("left".into(), 1.0), ("top".into(), 1.5)].into(),
            grey_albedo: Some(0.5),
            white_light: None,
        };
        (set(&["left", "top"], &["blue", "green", "red"]), values)
    }

    #[test]
    fn the_same_names_take_everything_over() {
        let (other, values) = rig();
        let mut set = set(&["left", "top"], &["blue", "green", "red"]);
        let carried = set.use_rig(&other, &values, true);
        assert_eq!(set.calibration, values);
        assert_eq!(carried.lights, ["left", "top"]);
        assert_eq!(carried.lines().len(), 1);
    }

    #[test]
    fn another_paint_keeps_its_own_beta() {
        let (other, values) = rig();
        let mut set = set(&["left", "top"], &["blue", "green", "red"]);
        set.calibration.beta = Some(vec![1.0, 0.3, 0.2]);
        assert!(!set.use_rig(&other, &values, false).beta);
        assert_eq!(set.calibration.beta, Some(vec![1.0, 0.3, 0.2]));
    }

    /// Lamp intensities a_lc = intensity_l alpha_lc keep their ratios whatever colour and light come first.
    #[test]
    fn another_reference_keeps_the_lamps_strengths() {
        let (other, values) = rig();
        let strength = |set: &CaptureSet, calibration: &Calibration, light: &str, colour: &str| {
            calibration.intensity[light] * calibration.alpha[light][set.colour_index(colour).unwrap()]
        };
        let mut set = set(&["top", "left"], &["green", "blue"]);
        set.use_rig(&other, &values, true);
        let scale = strength(&other, &values, "top", "green");
        for (light, colour) in [("top", "green"), ("top", "blue"), ("left", "green"), ("left", "blue")] {
            let expected = strength(&other, &values, light, colour) / scale;
            assert!((strength(&set, &set.calibration, light, colour) - expected).abs() < 1e-12, "{light} {colour}");
        }
        assert_eq!(set.calibration.beta, Some(vec![1.0, 2.0]));
        assert_eq!(set.check().iter().filter(|problem| problem.message.contains("expected")).count(), 0);
    }

    #[test]
    fn what_does_not_match_is_told() {
        let (mut other, values) = rig();
        other.lights[0].position_mm = Some([1.0, 2.0, 3.0]);
        let mut set = set(&["left", "right"], &["blue", "amber"]);
        set.lights[0].direction = Some([0.0, 0.0, 1.0]);
        let carried = set.use_rig(&other, &values, true);
        assert_eq!(carried.unknown_lights, ["right"]);
        assert_eq!(carried.unknown_colours, ["amber"]);
        assert_eq!(carried.unused_lights, ["top"]);
        assert!(!carried.beta && set.calibration.alpha.is_empty());
        assert_eq!((set.lights[0].position_mm, set.lights[0].direction), (Some([1.0, 2.0, 3.0]), None));
        assert_eq!(carried.lines().len(), 4);
    }
}
