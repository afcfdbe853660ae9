//! The points of the moving mesh that take part, and where they meet the reference.

use nalgebra::{Isometry3, Point3, Vector3};
use rayon::prelude::*;

use super::cells::first_in_cell;
use super::surface::{Surface, box_of, centre_and_diagonal};
use super::{CompareError, Side, check_mesh, check_points};
use crate::Mesh;

/// Points of the moving mesh, relative to the middle of its bounding box, with their normals.
pub(super) struct Samples {
    points: Vec<(Point3<f64>, Vector3<f64>)>,
    /// The middle of the bounding box, in the mesh's frame.
    pub centre: Point3<f64>,
}

/// A point of the moving mesh (where the pose puts it), its closest point on the reference, and the normal there.
#[derive(Clone, Copy)]
pub(super) struct Pair {
    pub from: Point3<f64>,
    pub to: Point3<f64>,
    pub normal: Vector3<f64>,
}

impl Pair {
    /// Distance from the tangent plane at `to`.
    pub fn residual_mm(&self) -> f64 {
        self.normal.dot(&(self.to - self.from))
    }
}

/// Which pairs count.
#[derive(Clone, Copy)]
pub(super) struct Gate {
    /// The longest pair.
    pub reach_mm: f64,
    /// The smallest cosine between the normals.
    pub least_cosine: f64,
}

/// The pairs of one iteration.
pub(super) struct Pairs {
    /// All pairs within the gate.
    pub kept: Vec<Pair>,
    /// Samples asked.
    pub asked: usize,
    /// Samples close enough whose normals point the other way.
    pub facing_away: usize,
}

impl Pairs {
    /// Fraction of the samples that have a counterpart.
    pub fn overlap(&self) -> f64 {
        self.kept.len() as f64 / self.asked.max(1) as f64
    }

    /// Leaves out the given fraction with the largest residuals (Chetverikov, Svirko, Stepanov and Krsek 2002).
    pub fn trim(&mut self, fraction: f64) {
        let keep = ((self.kept.len() as f64) * (1.0 - fraction)).ceil() as usize;
        if keep > 0 && keep < self.kept.len() {
            let size = |pair: &Pair| pair.residual_mm().abs();
            self.kept.select_nth_unstable_by(keep - 1, |one, other| size(one).total_cmp(&size(other)));
            self.kept.truncate(keep);
        }
    }

    /// Root mean square of the residuals, in mm.
    pub fn rms_mm(&self) -> f64 {
        let sum: f64 = self.kept.iter().map(|pair| pair.residual_mm().powi(2)).sum();
        (sum / self.kept.len().max(1) as f64).sqrt()
    }
}

impl Samples {
    /// About `wanted` vertices, spread evenly over the surface: the first one in each cell of a grid whose cells hold
    /// one each on average. All of them where the mesh has fewer.
    pub fn of_mesh(mesh: &Mesh, wanted: usize) -> Result<Self, CompareError> {
        check_points(mesh, Side::Moving)?;
        if mesh.triangles.is_empty() {
            return Self::of_cloud(mesh, wanted);
        }
        check_mesh(mesh, Side::Moving)?;
        let (mesh, _) = mesh.welded();
        let (centre, _) = centre_and_diagonal(&mesh, Side::Moving)?;
        let normals = if mesh.normals.is_empty() { mesh.area_weighted_normals() } else { mesh.normals.clone() };
        let mut chosen: Vec<usize> = (0..mesh.positions.len()).collect();
        if chosen.len() > wanted {
            let first = first_in_cell(&mesh, wanted);
            chosen.retain(|&index| first[index] as usize == index);
        }
        let point = |index: usize| Point3::from(mesh.positions[index].cast::<f64>() - centre);
        let points = chosen.into_iter().map(|index| (point(index), normals[index].cast())).collect();
        Ok(Self { points, centre })
    }

    /// About `wanted` points of a cloud; without normals in the file every direction fits.
    fn of_cloud(cloud: &Mesh, wanted: usize) -> Result<Self, CompareError> {
        let (centre, _) = box_of(cloud).ok_or(CompareError::NoExtent { side: Side::Moving })?;
        let normal = |index: usize| cloud.normals.get(index).map_or_else(Vector3::zeros, |normal| normal.cast());
        let step = (cloud.positions.len() / wanted.max(1)).max(1);
        let chosen = (0..cloud.positions.len()).step_by(step);
        let points = chosen.map(|index| (Point3::from(cloud.positions[index].cast::<f64>() - centre), normal(index)));
        Ok(Self { points: points.collect(), centre })
    }

    /// Every `step`-th sample.
    pub fn every(&self, step: usize) -> Self {
        Self { points: self.points.iter().copied().step_by(step.max(1)).collect(), centre: self.centre }
    }

    /// The samples by themselves, relative to the centre.
    pub fn points(&self) -> impl Iterator<Item = Vector3<f64>> {
        self.points.iter().map(|(point, _)| point.coords)
    }

    /// How many samples there are.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// The pairs at `pose`, which takes centred samples to the centred surface.
    pub fn pairs(&self, surface: &Surface, pose: &Isometry3<f64>, gate: Gate) -> Pairs {
        let met: Vec<(Pair, f64)> = self
            .points
            .par_iter()
            .filter_map(|(point, normal)| {
                let from = pose * point;
                let foot = surface.closest(&from, gate.reach_mm)?;
                let faces_anywhere = *normal == Vector3::zeros();
                let cosine = if faces_anywhere { 1.0 } else { foot.normal.dot(&(pose.rotation * normal)) };
                (!foot.beyond_border).then_some((Pair { from, to: foot.point, normal: foot.normal }, cosine))
            })
            .collect();
        let facing_away = met.iter().filter(|(_, cosine)| *cosine < 0.0).count();
        let kept = met.into_iter().filter(|(_, cosine)| *cosine >= gate.least_cosine).map(|(pair, _)| pair).collect();
        Pairs { kept, asked: self.len(), facing_away }
    }
}
