//! The normal of one pixel, from the lights that are usable there.

use nalgebra::{Matrix3, Point3, Vector3};

use super::{DirectLight, Lamp, NormalsOptions, REASONS, SHADOW_USED, SHADOWED, Surface};
use crate::Mask;
use crate::linear_algebra;
use crate::separate::UNSOLVED;

/// What all pixels share.
pub(super) struct Stage<'a> {
    pub lights: &'a [DirectLight<'a>],
    pub mask: &'a Mask,
    pub options: &'a NormalsOptions,
    surface: Surface<'a>,
    /// Intensity times direction, where all lamps are distant.
    pub distant: Option<Vec<Vector3<f64>>>,
}

/// The outcome at a pixel; `normal` is zero when `marks` has `UNSOLVED`.
pub(super) struct PixelNormal {
    pub normal: Vector3<f64>,
    pub albedo: f64,
    pub noise_deg: f64,
    pub marks: u8,
}

/// One usable light at a pixel.
#[derive(Clone, Copy)]
pub(super) struct Sample {
    /// What a white facet that faces the lamp would send back, as a vector to the lamp.
    pub toward: Vector3<f64>,
    pub light: f64,
    /// Its noise; zero where unknown.
    pub sigma: f64,
}

impl Sample {
    /// Light per unit of lamp strength: comparable between lamps.
    fn relative(&self) -> f64 {
        self.light / self.toward.norm()
    }
}

impl<'a> Stage<'a> {
    pub fn new(
        lights: &'a [DirectLight<'a>],
        mask: &'a Mask,
        surface: Surface<'a>,
        options: &'a NormalsOptions,
    ) -> Self {
        let all_distant = lights.iter().all(|light| matches!(light.lamp, Lamp::Distant(_)));
        let toward = |light: &DirectLight| light.intensity * light.lamp.irradiance_vector(Point3::origin());
        Self { lights, mask, options, surface, distant: all_distant.then(|| lights.iter().map(toward).collect()) }
    }

    /// Intensity times irradiance vector of light `l` at a pixel.
    fn toward(&self, l: usize, point_mm: Point3<f64>) -> Vector3<f64> {
        match &self.distant {
            Some(distant) => distant[l],
            None => self.lights[l].intensity * self.lights[l].lamp.irradiance_vector(point_mm),
        }
    }

    fn point_mm(&self, pixel: usize) -> Point3<f64> {
        let (x, y) = (pixel % self.mask.width(), pixel / self.mask.width());
        let z = self.surface.depth_mm.map_or(0.0, |depth| f64::from(depth.data()[pixel]));
        self.surface.camera.point_mm(x as f64 + 0.5, y as f64 + 0.5, z)
    }

    /// The lights that are usable at a pixel inside the mask.
    pub fn samples(&self, pixel: usize) -> Vec<Sample> {
        let point_mm = self.point_mm(pixel);
        let usable = |light: &&DirectLight| light.marks.data()[pixel] & UNSOLVED == 0;
        let sample = |(l, light): (usize, &DirectLight)| Sample {
            toward: self.toward(l, point_mm),
            light: f64::from(light.direct.data()[pixel]),
            sigma: light.noise.map_or(0.0, |noise| f64::from(noise.data()[pixel])),
        };
        self.lights.iter().enumerate().filter(|(_, light)| usable(light)).map(sample).collect()
    }

    /// The normal at a pixel inside the mask.
    pub fn solve(&self, pixel: usize) -> PixelNormal {
        let reasons = self.lights.iter().fold(0, |marks, light| marks | light.marks.data()[pixel]) & REASONS;
        let (samples, left_out, fit) = self.used(pixel, 3);
        match fit {
            Some(fit) => fit.into_normal(&samples, reasons | left_out),
            None => PixelNormal::none(reasons | left_out),
        }
    }

    /// The lights at a pixel without those in shadow, as long as `needed` remain, and those that do not fit; the mark that says
    /// what was left out; their fit.
    pub fn used(&self, pixel: usize, needed: usize) -> (Vec<Sample>, u8, Option<Fit>) {
        let mut samples = self.samples(pixel);
        let mut marks = self.leave_out_shadows(&mut samples, needed);
        let mut found = fit(&samples);
        while let Some(worst) = found.as_ref().and_then(|fit| self.worst_outlier(&samples, &fit.scaled)) {
            samples.swap_remove(worst);
            marks |= SHADOWED;
            found = fit(&samples);
        }
        (samples, marks, found)
    }

    /// Leaves shadowed lights out while at least `needed` remain; returns the mark that says what was done.
    fn leave_out_shadows(&self, samples: &mut Vec<Sample>, needed: usize) -> u8 {
        let brightest = samples.iter().map(Sample::relative).fold(0.0, f64::max);
        let lit = |sample: &Sample| sample.relative() >= self.options.shadow_fraction * brightest;
        match samples.iter().filter(|sample| lit(sample)).count() {
            count if count == samples.len() => 0,
            count if count >= needed => {
                samples.retain(lit);
                SHADOWED
            }
            _ => SHADOW_USED,
        }
    }

    /// The light that misses the fit the most, if by too much. With four lights all misfits are one number, so that
    /// it is not known which light is wrong.
    fn worst_outlier(&self, samples: &[Sample], scaled: &Vector3<f64>) -> Option<usize> {
        if samples.len() < 5 {
            return None;
        }
        let limit = self.options.outlier_fraction * samples.iter().map(Sample::relative).fold(0.0, f64::max);
        let misfit = |sample: &Sample| (sample.light - sample.toward.dot(scaled)).abs() / sample.toward.norm();
        let (worst, misfit) =
            samples.iter().map(misfit).enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b)).unwrap_or_default();
        (misfit > limit).then_some(worst)
    }
}

/// The least-squares solution of `light_l = toward_l . scaled`.
pub(super) struct Fit {
    /// Albedo times normal.
    scaled: Vector3<f64>,
    inverse: Matrix3<f64>,
}

/// `None` for fewer than three lights or lights in a plane.
fn fit(samples: &[Sample]) -> Option<Fit> {
    if samples.len() < 3 {
        return None;
    }
    let matrix: Matrix3<f64> = samples.iter().map(|sample| sample.toward * sample.toward.transpose()).sum();
    let right: Vector3<f64> = samples.iter().map(|sample| sample.toward * sample.light).sum();
    let inverse = linear_algebra::inverse(&matrix)?;
    // The norms bound the condition number without an eigenvalue; only doubtful cases need the exact one.
    let doubtful = matrix.norm() * inverse.norm() > super::MIN_SPREAD.powi(-2);
    if doubtful {
        let eigenvalues = linear_algebra::symmetric_eigen(matrix)?.eigenvalues;
        if eigenvalues.min() < super::MIN_SPREAD.powi(2) * eigenvalues.max() {
            return None;
        }
    }
    Some(Fit { scaled: inverse * right, inverse })
}

/// How each light moves the solution; `None` for fewer than three lights or lights in a plane.
pub(super) fn effects(samples: &[Sample]) -> Option<Vec<Vector3<f64>>> {
    let fit = fit(samples)?;
    Some(samples.iter().map(|sample| fit.inverse * sample.toward).collect())
}

impl Fit {
    fn into_normal(self, samples: &[Sample], marks: u8) -> PixelNormal {
        let albedo = self.scaled.norm();
        if albedo.is_nan() || albedo <= 0.0 {
            return PixelNormal::none(marks);
        }
        let normal = self.scaled / albedo;
        // Noise along the normal changes the albedo only; the rest turns the normal.
        let turn = |sample: &Sample| {
            let effect = self.inverse * sample.toward;
            sample.sigma.powi(2) * (effect.norm_squared() - effect.dot(&normal).powi(2))
        };
        let noise_deg = (samples.iter().map(turn).sum::<f64>().max(0.0).sqrt() / albedo).to_degrees();
        PixelNormal { normal, albedo, noise_deg, marks }
    }
}

impl PixelNormal {
    pub fn none(marks: u8) -> Self {
        Self { normal: Vector3::zeros(), albedo: 0.0, noise_deg: 0.0, marks: marks | UNSOLVED }
    }
}
