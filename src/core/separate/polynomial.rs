//! One pixel's light as a polynomial of the albedo: what the photos measured, and the bounces it is made of.

/// N(beta) = sum of L_k beta^k at one pixel under one light (Liao, Huang and Yang, CVPR 2011, equation 12 in the words
/// of the reference colour).
#[derive(Clone, Debug, PartialEq)]
pub struct PixelPolynomial {
    /// For each colour, beta and the measured N / alpha.
    pub measured: Vec<[f64; 2]>,
    /// L_1 .. L_m.
    pub bounces: Vec<f64>,
}

impl PixelPolynomial {
    /// Of a pixel with these photo values, one for each colour as in `alpha` and `beta`.
    pub fn new(photos: &[f64], alpha: &[f64], beta: &[f64], bounces: Vec<f64>) -> Self {
        let measured =
            photos.iter().zip(alpha).zip(beta).map(|((light, alpha), beta)| [*beta, light / alpha]).collect();
        Self { measured, bounces }
    }

    /// N at this beta when only bounces 1 to `highest` count.
    pub fn sum_to(&self, highest: usize, beta: f64) -> f64 {
        // Horner, from the highest bounce down.
        self.bounces.iter().take(highest).rev().fold(0.0, |sum, bounce| (sum + bounce) * beta)
    }

    /// N at this beta.
    pub fn at(&self, beta: f64) -> f64 {
        self.sum_to(self.bounces.len(), beta)
    }

    /// For each colour, what the bounces leave of the measured light.
    pub fn residuals(&self) -> impl Iterator<Item = f64> + '_ {
        self.measured.iter().map(|&[beta, light]| light - self.at(beta))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounces_stack_up_to_what_was_measured() {
        let (alpha, beta) = ([1.0, 3.0], [1.0, 0.5]);
        // L = 0.4, 0.1: N_1 = 0.5 and N_2 = 3 (0.2 + 0.025).
        let pixel = PixelPolynomial::new(&[0.5, 0.675], &alpha, &beta, vec![0.4, 0.1]);
        assert!(pixel.residuals().all(|left| left.abs() < 1e-12));
        assert_eq!(pixel.sum_to(1, 0.5), 0.2);
        assert_eq!(pixel.sum_to(0, 0.5), 0.0);
    }
}
