//! The light that arrives at one point of the surface from all patches (final gather).

use nalgebra::{Point3, Unit, Vector3};

use super::{
    lamp::Receiver,
    linear::{Linear, linear_over_patches},
};
use crate::light::radiosity::{Patch, Patches, polygon::point_to_triangle};

/// Beyond this many radii the centre of a patch stands for it, with an error of about 1/4 (radius/distance)^2, 0.4 % of
/// that patch's light at worst. Nearer patches are cut up and their form factors exact.
const CENTRE_SUFFICES: f32 = 8.0;
/// A near patch is cut until its pieces are this many of their radii away, so that radiosity is even over each.
const PIECE_DISTANCE: f64 = 2.0;
/// But at most so many times into four.
const MAX_CUTS: usize = 5;
/// Patches whose form factors are computed together.
const BLOCK: usize = 256;

/// Patches and their radiosities, laid out for gathering. Far patches send their mean; near ones a radiosity that runs
/// linearly and without a step to their neighbours, so that no patch shows at creases.
pub(super) struct Gatherer<'a> {
    patches: &'a Patches,
    centres: [Vec<f32>; 3],
    normals: [Vec<f32>; 3],
    /// Area over pi.
    weights: Vec<f32>,
    near_squared: Vec<f32>,
    /// For each channel, a value for each patch.
    radiosities: Vec<Vec<f32>>,
    /// For each patch, how each channel runs over it.
    linear: Vec<Vec<Linear>>,
}

impl<'a> Gatherer<'a> {
    /// `channels` are radiosities, each a value for each patch.
    pub(super) fn new(patches: &'a Patches, channels: &[&[f64]]) -> Self {
        let all = patches.as_slice();
        let each = |value: &dyn Fn(&Patch) -> f64| all.iter().map(|patch| value(patch) as f32).collect::<Vec<f32>>();
        Self {
            patches,
            centres: [0, 1, 2].map(|k| each(&|patch| patch.centre[k])),
            normals: [0, 1, 2].map(|k| each(&|patch| patch.normal[k])),
            weights: each(&|patch| patch.area_mm2 / std::f64::consts::PI),
            near_squared: each(&|patch| (f64::from(CENTRE_SUFFICES) * patch.radius_mm).powi(2)),
            radiosities: channels.iter().map(|channel| channel.iter().map(|&b| b as f32).collect()).collect(),
            linear: linear_over_patches(patches, channels),
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
        for (sum, linear) in sums.iter_mut().zip(&self.linear[index]) {
            *sum += factor * f64::from(linear.at(&offset));
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

/// A receiver on the smooth surface a patch stands for, at the barycentric weights of its second and third corner: the
/// interpolated normal, and the point lifted out of the facet where the surface is convex, so that the facets around it
/// cast no shadow along the terminator (Hanika 2021).
pub(super) fn smooth_receiver(patches: &Patches, index: usize, (u, v): (f64, f64)) -> Receiver {
    // On a crease itself a point would be neither before nor behind the other wall: stay a hair inside the facet.
    const INSET: f64 = 1e-3;
    let [w, u, v] = [1.0 - u - v, u, v].map(|weight| weight.max(INSET));
    let (u, v) = (u / (w + u + v), v / (w + u + v));
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
