//! The light that arrives at one point of the surface from all patches (final gather).

use nalgebra::{Matrix3, Point3, Unit, Vector3};
use rayon::prelude::*;

use super::lamp::Receiver;
use crate::radiosity::{Patch, Patches, polygon::point_to_triangle};

/// Beyond this many radii the centre of a patch stands for it, with an error of about 1/4 (radius/distance)^2, 0.4 % of
/// that patch's light at worst. Nearer patches are cut up and their form factors exact.
const CENTRE_SUFFICES: f32 = 8.0;
/// A near patch is cut until its pieces are this many of their radii away, so that radiosity is even over each.
const PIECE_DISTANCE: f64 = 2.0;
/// But at most so many times into four.
const MAX_CUTS: usize = 5;
/// Patches whose form factors are computed together.
const BLOCK: usize = 256;

/// Patches and their radiosities, laid out for gathering. Over a patch, radiosity runs linearly with the gradient of its
/// smooth neighbours about the mean, so that no patch shows at creases.
pub(super) struct Gatherer<'a> {
    patches: &'a Patches,
    centres: [Vec<f32>; 3],
    normals: [Vec<f32>; 3],
    /// Area over pi.
    weights: Vec<f32>,
    near_squared: Vec<f32>,
    /// For each channel, a value for each patch.
    radiosities: Vec<Vec<f32>>,
    /// For each patch, the gradient of each channel.
    gradients: Vec<Vec<Vector3<f32>>>,
}

impl<'a> Gatherer<'a> {
    /// `channels` are radiosities, each a value for each patch.
    pub(super) fn new(patches: &'a Patches, channels: &[&[f64]]) -> Self {
        let all = patches.as_slice();
        let each = |value: &dyn Fn(&Patch) -> f64| all.iter().map(|patch| value(patch) as f32).collect::<Vec<f32>>();
        let neighbours = patches.smooth_neighbours();
        let gradient = |index: usize| gradients(all, index, &neighbours[index], channels);
        Self {
            patches,
            centres: [0, 1, 2].map(|k| each(&|patch| patch.centre[k])),
            normals: [0, 1, 2].map(|k| each(&|patch| patch.normal[k])),
            weights: each(&|patch| patch.area_mm2 / std::f64::consts::PI),
            near_squared: each(&|patch| (f64::from(CENTRE_SUFFICES) * patch.radius_mm).powi(2)),
            radiosities: channels.iter().map(|channel| channel.iter().map(|&b| b as f32).collect()).collect(),
            gradients: (0..all.len()).into_par_iter().map(gradient).collect(),
        }
    }

    /// Irradiance at the receiver for each channel: the sum over patches of form factor times radiosity.
    pub(super) fn irradiance(&self, receiver: &Receiver) -> Vec<f64> {
        let mut sums = vec![0.0; self.radiosities.len()];
        for start in (0..self.weights.len()).step_by(BLOCK) {
            let mut factors = [0.0; BLOCK];
            let len = BLOCK.min(self.weights.len() - start);
            self.far_factors(receiver, start, &mut factors[..len]);
            for (offset, factor) in factors[..len].iter_mut().enumerate() {
                let index = start + offset;
                if *factor < 0.0 {
                    *factor = 0.0;
                    let patch = &self.patches.as_slice()[index];
                    if index != receiver.patch && patch.height_mm(&receiver.point) > self.patches.flat_mm() {
                        self.add_near(receiver, index, patch.corners, 0, &mut sums);
                    }
                } else if *factor > 0.0 && !self.sees(receiver, index, &self.patches.as_slice()[index].centre) {
                    *factor = 0.0;
                }
            }
            for (sum, radiosities) in sums.iter_mut().zip(&self.radiosities) {
                *sum += f64::from(dot(&factors[..len], &radiosities[start..start + len]));
            }
        }
        sums
    }

    /// Form factors to the patches from `start` by their centres; -1 for those that are too near for it.
    fn far_factors(&self, receiver: &Receiver, start: usize, factors: &mut [f32]) {
        let [x, y, z] = [0, 1, 2].map(|k| receiver.point[k] as f32);
        let [nx, ny, nz] = [0, 1, 2].map(|k| receiver.normal[k] as f32);
        let range = start..start + factors.len();
        let [cx, cy, cz] = [0, 1, 2].map(|k| &self.centres[k][range.clone()]);
        let [mx, my, mz] = [0, 1, 2].map(|k| &self.normals[k][range.clone()]);
        let (weights, near_squared) = (&self.weights[range.clone()], &self.near_squared[range]);
        for (i, factor) in factors.iter_mut().enumerate() {
            let (dx, dy, dz) = (cx[i] - x, cy[i] - y, cz[i] - z);
            let squared = dx * dx + dy * dy + dz * dz;
            let arriving = (nx * dx + ny * dy + nz * dz).max(0.0);
            let leaving = (-(mx[i] * dx + my[i] * dy + mz[i] * dz)).max(0.0);
            let far = arriving * leaving * weights[i] / (squared * squared);
            *factor = if squared < near_squared[i] { -1.0 } else { far };
        }
    }

    fn add_near(&self, receiver: &Receiver, index: usize, piece: [Point3<f64>; 3], cuts: usize, sums: &mut [f64]) {
        let [a, b, c] = piece;
        if piece.iter().all(|corner| receiver.normal.dot(&(corner - receiver.point)) <= 0.0) {
            return;
        }
        let centre = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        let radius_squared = piece.iter().map(|corner| (corner - centre).norm_squared()).fold(0.0, f64::max);
        let distance_squared = (centre - receiver.point).norm_squared();
        if cuts < MAX_CUTS && distance_squared < PIECE_DISTANCE * PIECE_DISTANCE * radius_squared {
            let [ab, bc, ca] = [nalgebra::center(&a, &b), nalgebra::center(&b, &c), nalgebra::center(&c, &a)];
            for piece in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
                self.add_near(receiver, index, piece, cuts + 1, sums);
            }
            return;
        }
        if !self.sees(receiver, index, &centre) {
            return;
        }
        let factor = point_to_triangle(&receiver.point, &receiver.normal, &piece);
        let offset: Vector3<f32> = (centre - self.patches.as_slice()[index].centre).cast();
        for ((sum, radiosities), gradient) in sums.iter_mut().zip(&self.radiosities).zip(&self.gradients[index]) {
            *sum += factor * f64::from(radiosities[index] + gradient.dot(&offset));
        }
    }

    fn sees(&self, receiver: &Receiver, index: usize, target: &Point3<f64>) -> bool {
        self.patches.is_unoccluded()
            || !self.patches.occluders().blocked(&receiver.point, target, [Some(receiver.patch), Some(index)])
    }
}

fn dot(a: &[f32], b: &[f32]) -> f32 {
    // Eight sums side by side, which the compiler keeps in vector registers.
    let mut sums = [0.0_f32; 8];
    let (a, b) = (a.chunks_exact(8), b.chunks_exact(8));
    let rest: f32 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f32>() + rest
}

/// The gradient of every channel over one patch: least squares over its smooth neighbours, shortened where it would take
/// the radiosity of a corner below zero.
fn gradients(patches: &[Patch], index: usize, neighbours: &[usize], channels: &[&[f64]]) -> Vec<Vector3<f32>> {
    let patch = &patches[index];
    let offsets: Vec<Vector3<f64>> = neighbours.iter().map(|&other| patches[other].centre - patch.centre).collect();
    let normal = patch.normal.into_inner();
    // Nothing is known along the normal: the gradient shall be zero there.
    let mut matrix: Matrix3<f64> = normal * normal.transpose() * offsets.len() as f64;
    for offset in &offsets {
        matrix += offset * offset.transpose() / offset.norm_squared().max(f64::MIN_POSITIVE);
    }
    let inverse = (offsets.len() >= 2).then(|| matrix.try_inverse()).flatten().unwrap_or_else(Matrix3::zeros);
    let gradient = |channel: &&[f64]| {
        let own = channel[index];
        let pull = |(offset, &other): (&Vector3<f64>, &usize)| {
            offset * (channel[other] - own) / offset.norm_squared().max(f64::MIN_POSITIVE)
        };
        let gradient = inverse * offsets.iter().zip(neighbours).map(pull).sum::<Vector3<f64>>();
        let lowest = patch.corners.iter().map(|corner| gradient.dot(&(corner - patch.centre))).fold(0.0, f64::min);
        let keep = if own + lowest < 0.0 { own / -lowest } else { 1.0 };
        (gradient * keep).cast()
    };
    channels.iter().map(gradient).collect()
}

/// A receiver on the smooth surface a patch stands for, at the barycentric weights of its second and third corner: the
/// interpolated normal, and the point lifted out of the facet where the surface is convex, so that the facets around it
/// cast no shadow along the terminator (Hanika 2021).
pub(super) fn smooth_receiver(patches: &Patches, index: usize, (u, v): (f64, f64)) -> Receiver {
    let patch = &patches.as_slice()[index];
    let weights = [1.0 - u - v, u, v];
    let point = patch.point(u, v);
    let mut normal = Vector3::zeros();
    let mut lifted = point;
    for ((weight, corner), corner_normal) in weights.iter().zip(&patch.corners).zip(&patch.corner_normals) {
        normal += corner_normal * *weight;
        lifted -= corner_normal * (*weight * corner_normal.dot(&(point - corner)).min(0.0));
    }
    let normal = Unit::try_new(normal, 0.0).unwrap_or(patch.normal);
    Receiver { point: lifted, normal, patch: index }
}
