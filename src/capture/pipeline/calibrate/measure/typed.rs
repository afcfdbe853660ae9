//! Typed values beside what the balls say of them.

use super::super::Known;
use super::super::warning::Warning;
use super::Measuring;

impl Measuring<'_> {
    /// Typed values that the balls contradict; of directions, see the doubts about them.
    pub(super) fn warn_of_typed(&mut self) {
        let set = self.set;
        let mut warn = |what: String, known: &Known<f64>, typed: f64| {
            if let Some(off) = known.contradicted() {
                let (measured, half_width) =
                    (off.measured.value, off.measured.value * off.measured.relative_half_width());
                self.calibrated.warnings.push(Warning::Typed { what, typed, measured, half_width }.to_string());
            }
        };
        let given = &set.calibration;
        let beside = |typed: f64, known: &Known<f64>| Known::from_file(typed).beside(Some(known));
        for (light, (alpha, intensity)) in
            set.lights.iter().zip(self.calibrated.alpha.iter().zip(&self.calibrated.intensity))
        {
            let of_colours = given.alpha.get(&light.name).into_iter().flatten().zip(alpha.iter().flatten());
            for ((&typed, known), colour) in of_colours.zip(&set.colours) {
                warn(format!("alpha of light {} in {}", light.name, colour.name), &beside(typed, known), typed);
            }
            if let Some(&typed) = given.intensity.get(&light.name) {
                warn(format!("the intensity of light {}", light.name), &beside(typed, intensity), typed);
            }
        }
        let of_colours = given.beta.iter().flatten().zip(self.calibrated.beta.iter().flatten());
        for ((&typed, known), colour) in of_colours.zip(&set.colours) {
            warn(format!("beta in {}", colour.name), &beside(typed, known), typed);
        }
    }
}
