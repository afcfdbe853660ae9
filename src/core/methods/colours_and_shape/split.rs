//! One pixel or cell of one light: `N_c' = beta_c L_1 + beta_c r_c I` over the colours, weighted by noise.

/// The sums of the least-squares fit for direct light L_1 and indirect light I.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Split {
    direct_direct: f64,
    direct_indirect: f64,
    indirect_indirect: f64,
    direct_light: f64,
    indirect_light: f64,
}

/// Two colours whose ratios differ less than this, relative, say nothing about I.
const MIN_INDEPENDENCE: f64 = 1e-9;

impl Split {
    /// Adds the light of one colour, `N_c / alpha_c`, with one over its variance.
    pub(super) fn add(&mut self, light: f64, precision: f64, beta: f64, ratio: f64) {
        let (of_direct, of_indirect) = (beta, beta * ratio);
        self.direct_direct += precision * of_direct * of_direct;
        self.direct_indirect += precision * of_direct * of_indirect;
        self.indirect_indirect += precision * of_indirect * of_indirect;
        self.direct_light += precision * of_direct * light;
        self.indirect_light += precision * of_indirect * light;
    }

    /// Whether any colour was usable.
    pub(super) fn has_light(&self) -> bool {
        self.direct_direct > 0.0
    }

    fn determinant(&self) -> Option<f64> {
        let all = self.direct_direct * self.indirect_indirect;
        let determinant = all - self.direct_indirect.powi(2);
        (determinant > MIN_INDEPENDENCE * all).then_some(determinant)
    }

    /// L_1 and its variance where I is not known otherwise; `None` where the colours do not tell them apart.
    pub(super) fn direct(&self) -> Option<(f64, f64)> {
        let determinant = self.determinant()?;
        let sum = self.indirect_indirect * self.direct_light - self.direct_indirect * self.indirect_light;
        Some((sum / determinant, self.indirect_indirect / determinant))
    }

    /// One over the variance of I, and I times that.
    pub(super) fn indirect(&self) -> (f64, f64) {
        match self.determinant() {
            Some(determinant) => {
                let share = self.direct_indirect / self.direct_direct;
                (determinant / self.direct_direct, self.indirect_light - share * self.direct_light)
            }
            None => (0.0, 0.0),
        }
    }

    /// L_1 and its variance where I and its variance are known.
    pub(super) fn direct_given(&self, indirect: f64, variance: f64) -> (f64, f64) {
        let share = self.direct_indirect / self.direct_direct;
        let direct = self.direct_light / self.direct_direct - share * indirect;
        (direct, self.direct_direct.recip() + share * share * variance)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn split(direct: f64, indirect: f64, ratios: &[f64]) -> Split {
        let mut split = Split::default();
        for (beta, ratio) in [1.0, 0.6, 0.3].into_iter().zip(ratios) {
            split.add(beta * direct + beta * ratio * indirect, 1.0 / (0.1 + beta), beta, *ratio);
        }
        split
    }

    proptest! {
        #[test]
        fn light_that_was_mixed_is_split(direct in 0.0..1.0_f64, indirect in 0.0..1.0_f64, r in 0.3..0.9_f64) {
            let split = split(direct, indirect, &[1.0, r, r * r]);
            prop_assert!((split.direct().unwrap().0 - direct).abs() < 1e-9);
            let (precision, weighted) = split.indirect();
            prop_assert!((weighted / precision - indirect).abs() < 1e-9);
            prop_assert!((split.direct_given(indirect, 0.0).0 - direct).abs() < 1e-9);
        }
    }

    /// Known indirect light leaves the noise of a mean, not of a difference.
    #[test]
    fn a_known_amount_lowers_the_noise() {
        let split = split(0.5, 0.2, &[1.0, 0.7, 0.5]);
        assert!(split.direct_given(0.2, 0.0).1 < 0.1 * split.direct().unwrap().1);
    }

    #[test]
    fn one_colour_does_not_tell_indirect_light() {
        let split = split(0.5, 0.2, &[1.0]);
        assert!(split.has_light());
        assert_eq!((split.direct(), split.indirect()), (None, (0.0, 0.0)));
        assert!((split.direct_given(0.2, 0.0).0 - 0.5).abs() < 1e-12);
    }
}
