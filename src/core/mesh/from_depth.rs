//! The mesh of a depth map: a vertex for each pixel, two triangles between four of them.

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;
use thiserror::Error;

use super::Mesh;
use crate::options::{OptionError, check_range};
use crate::{Camera, Mask, NormalMap, Plane, Projection};

/// How to join the pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct MeshOptions {
    /// Where z changes by more than this per unit to the side, the surface is torn instead of joined; `None` joins all.
    pub max_slope: Option<f64>,
}

impl MeshOptions {
    /// Whether every option is in its range.
    ///
    /// # Errors
    /// `MeshError::Option` names the first that is not.
    pub fn check(&self) -> Result<(), MeshError> {
        let slope = self.max_slope.unwrap_or(1.0);
        Ok(check_range("max_slope", slope, slope > 0.0 && slope.is_finite(), "a positive number")?)
    }
}

/// Why there is no mesh.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MeshError {
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// The camera's geometry cannot be.
    #[error("the camera's lengths must be positive numbers, not {projection:?}; correct [camera]")]
    Camera {
        /// What it was set to.
        projection: Projection,
    },
    /// Two inputs differ in size.
    #[error("the {what} has {found:?} pixels, but the depth has {depth:?}; use pictures of one size")]
    Size {
        /// The input that differs.
        what: &'static str,
        /// Its width and height.
        found: (usize, usize),
        /// Width and height of the depth.
        depth: (usize, usize),
    },
    /// More pixels than a mesh can number.
    #[error("{pixels} pixels are more than a mesh can number (4294967295); crop the pictures")]
    TooLarge {
        /// Pixels of the depth.
        pixels: usize,
    },
    /// Nowhere do three pixels of the mask meet.
    #[error("no three of the mask's {pixels} pixels make a triangle; check the mask and max_slope")]
    NoTriangle {
        /// Pixels inside the mask with a depth.
        pixels: usize,
    },
}

/// What became of the pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshReport {
    /// Vertices.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// Triangles left out because they are steeper than `max_slope`.
    pub torn_triangles: usize,
    /// Pixels of the mask that no triangle uses, or whose depth is not finite.
    pub unused_pixels: usize,
}

/// Joins the pixels of `mask` to a surface that faces the camera, with a vertex at the centre of each pixel.
///
/// `depth_mm` is z toward the camera, in pixels where the camera has no scale. A vertex takes its normal from `normals`
/// or, where there is none, from its triangles weighted by area. `albedo` becomes a grey, clamped to 0..1.
///
/// # Errors
/// `MeshError`: options, camera or sizes out of range, or nothing to join.
pub fn from_depth(
    depth_mm: &Plane,
    mask: &Mask,
    camera: &Camera,
    normals: Option<&NormalMap>,
    albedo: Option<&Plane>,
    options: &MeshOptions,
) -> Result<(Mesh, MeshReport), MeshError> {
    options.check()?;
    check_inputs(depth_mm, mask, camera, normals, albedo)?;

    // Triangles between pixels, row by row.
    let surface = Surface { depth_mm, mask, camera, max_slope: options.max_slope };
    let rows: Vec<(Vec<[u32; 3]>, usize)> = (1..mask.height()).into_par_iter().map(|y| surface.row(y - 1)).collect();
    let torn_triangles = rows.iter().map(|(_, torn)| torn).sum();
    let mut triangles: Vec<[u32; 3]> = rows.into_iter().flat_map(|(row, _)| row).collect();
    let pixels = mask.count();
    if triangles.is_empty() {
        return Err(MeshError::NoTriangle { pixels });
    }

    // Number the pixels that a triangle uses.
    let mut used = vec![false; mask.data().len()];
    triangles.iter().flatten().for_each(|&pixel| used[pixel as usize] = true);
    let vertices: Vec<usize> = (0..used.len()).into_par_iter().filter(|&pixel| used[pixel]).collect();
    let mut number = vec![0_u32; used.len()];
    (0..).zip(&vertices).for_each(|(vertex, &pixel)| number[pixel] = vertex);
    triangles.par_iter_mut().flatten().for_each(|corner| *corner = number[*corner as usize]);

    let positions: Vec<Point3<f32>> = vertices.par_iter().map(|&pixel| surface.point(pixel).cast()).collect();
    let geometric = triangle_normals(&positions, &triangles);
    let known = |pixel| normals.and_then(|normals| normals.at_index(pixel));
    let normals = vertices
        .par_iter()
        .zip(&geometric)
        .map(|(&pixel, &normal)| known(pixel).unwrap_or(normal).normalize())
        .collect();
    let grey = |plane: &Plane| vertices.par_iter().map(|&pixel| [plane.data()[pixel].clamp(0.0, 1.0); 3]).collect();
    let report = MeshReport {
        vertices: vertices.len(),
        triangles: triangles.len(),
        torn_triangles,
        unused_pixels: pixels - vertices.len(),
    };
    let colours = albedo.map_or_else(Vec::new, grey);
    Ok((Mesh { positions, normals, colours, triangles, unit: camera.unit() }, report))
}

fn check_inputs(
    depth_mm: &Plane,
    mask: &Mask,
    camera: &Camera,
    normals: Option<&NormalMap>,
    albedo: Option<&Plane>,
) -> Result<(), MeshError> {
    if !camera.is_valid() {
        return Err(MeshError::Camera { projection: camera.projection });
    }
    let sizes = [
        ("mask", Some(mask.size())),
        ("camera", Some(camera.size)),
        ("normal map", normals.map(NormalMap::size)),
        ("albedo", albedo.map(Plane::size)),
    ];
    for (what, found) in sizes {
        if let Some(found) = found.filter(|&found| found != depth_mm.size()) {
            return Err(MeshError::Size { what, found, depth: depth_mm.size() });
        }
    }
    let pixels = depth_mm.data().len();
    if u32::try_from(pixels).is_err() { Err(MeshError::TooLarge { pixels }) } else { Ok(()) }
}

struct Surface<'a> {
    depth_mm: &'a Plane,
    mask: &'a Mask,
    camera: &'a Camera,
    max_slope: Option<f64>,
}

impl Surface<'_> {
    /// The triangles between row `y` and the next, as pixels, and how many were torn.
    fn row(&self, y: usize) -> (Vec<[u32; 3]>, usize) {
        let width = self.mask.width();
        let mut triangles = Vec::new();
        for x in 1..width {
            let upper_right = y * width + x;
            triangles.extend(self.block([upper_right - 1, upper_right, upper_right + width - 1, upper_right + width]));
        }
        let all = triangles.len();
        triangles.retain(|&triangle| !self.is_torn(triangle));
        let torn = all - triangles.len();
        (triangles.into_iter().map(|triangle| triangle.map(|pixel| pixel as u32)).collect(), torn)
    }

    /// Up to two triangles on the pixels upper left, upper right, lower left, lower right, counter-clockwise seen from
    /// the camera. Of the two diagonals, that along which the depth changes less.
    fn block(&self, corners: [usize; 4]) -> impl Iterator<Item = [usize; 3]> {
        let depth = |pixel: usize| self.depth_mm.data()[pixel];
        let holds = |pixel: usize| self.mask.data()[pixel] && depth(pixel).is_finite();
        let [a, b, c, d] = corners;
        let (left, right) = match corners.map(holds) {
            [true, true, true, true] if (depth(a) - depth(d)).abs() < (depth(b) - depth(c)).abs() => {
                (Some([a, c, d]), Some([a, d, b]))
            }
            [true, true, true, true] => (Some([a, c, b]), Some([b, c, d])),
            [false, true, true, true] => (None, Some([b, c, d])),
            [true, false, true, true] => (Some([a, c, d]), None),
            [true, true, false, true] => (None, Some([a, d, b])),
            [true, true, true, false] => (Some([a, c, b]), None),
            _ => (None, None),
        };
        left.into_iter().chain(right)
    }

    fn is_torn(&self, [a, b, c]: [usize; 3]) -> bool {
        let Some(max_slope) = self.max_slope else { return false };
        [(a, b), (b, c), (c, a)].into_iter().any(|(from, to)| {
            let step = self.point(to) - self.point(from);
            step.z.abs() > max_slope * step.xy().norm()
        })
    }

    fn point(&self, pixel: usize) -> Point3<f64> {
        let (x, y) = (pixel % self.mask.width(), pixel / self.mask.width());
        self.camera.point_mm(x as f64 + 0.5, y as f64 + 0.5, f64::from(self.depth_mm.data()[pixel]))
    }
}

/// For each vertex the sum of its triangles' normals times twice their area.
fn triangle_normals(positions: &[Point3<f32>], triangles: &[[u32; 3]]) -> Vec<Vector3<f32>> {
    let mut sums = vec![Vector3::zeros(); positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| positions[corner as usize]);
        let normal = (b - a).cross(&(c - a));
        triangle.iter().for_each(|&corner| sums[corner as usize] += normal);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::LengthUnit;

    fn orthographic(size: (usize, usize), mm_per_pixel: Option<f64>) -> Camera {
        Camera { projection: Projection::Orthographic { mm_per_pixel }, size }
    }

    fn join(depth: &Plane, mask: &Mask) -> (Mesh, MeshReport) {
        let camera = orthographic(mask.size(), Some(0.5));
        from_depth(depth, mask, &camera, None, None, &MeshOptions::default()).unwrap()
    }

    fn doubled_areas(mesh: &Mesh) -> impl Iterator<Item = Vector3<f32>> {
        mesh.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
            (b - a).cross(&(c - a))
        })
    }

    /// Vertices - edges + triangles.
    fn euler_characteristic(mesh: &Mesh) -> i64 {
        let edges: std::collections::HashSet<(u32, u32)> = mesh
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
            .map(|(from, to)| (from.min(to), from.max(to)))
            .collect();
        mesh.positions.len() as i64 - edges.len() as i64 + mesh.triangles.len() as i64
    }

    fn ring(inner: f32) -> Mask {
        Mask::from_fn(41, 37, |x, y| (inner..17.0).contains(&(x as f32 - 20.0).hypot(y as f32 - 18.0)))
    }

    #[test]
    fn a_disc_has_no_hole_and_a_ring_has_one() {
        let waves = Plane::from_fn(41, 37, |x, y| (x as f32).sin() + (y as f32 * 0.7).cos());
        assert_eq!(euler_characteristic(&join(&waves, &ring(0.0)).0), 1);
        assert_eq!(euler_characteristic(&join(&waves, &ring(6.0)).0), 0);
    }

    #[test]
    fn every_triangle_faces_the_camera() {
        let waves = Plane::from_fn(41, 37, |x, y| 3.0 * (x as f32).sin() + (y as f32 * 0.7).cos());
        let (mesh, report) = join(&waves, &ring(4.5));
        assert!(doubled_areas(&mesh).all(|area| area.z > 0.0));
        assert_eq!((report.vertices, report.triangles), (mesh.positions.len(), mesh.triangles.len()));
    }

    #[test]
    fn a_tilted_plane_has_its_area_and_its_normal() {
        // z = 0.75 x - y in mm over 10 mm by 5 mm, pixel centre to pixel centre.
        let plane = Plane::from_fn(21, 11, |x, y| 0.5 * (0.75 * x as f32 + y as f32));
        let (mesh, _) = join(&plane, &Mask::filled(21, 11, true));
        let area: f32 = doubled_areas(&mesh).map(|area| area.norm() / 2.0).sum();
        let slope = (1.0_f32 + 0.75 * 0.75 + 1.0).sqrt();
        assert!((area - 50.0 * slope).abs() < 1e-3);
        let normal = Vector3::new(-0.75, 1.0, 1.0) / slope;
        assert!(mesh.normals.iter().all(|found| (found - normal).norm() < 1e-5));
    }

    #[test]
    fn the_diagonal_runs_along_the_ridge() {
        // The upper right and the lower left pixel lie on a ridge.
        let depth = Plane::from_vec(2, 2, vec![0.0, 5.0, 5.0, 0.1]).unwrap();
        let (mesh, _) = join(&depth, &Mask::filled(2, 2, true));
        assert!(mesh.triangles.iter().all(|triangle| triangle.contains(&1) && triangle.contains(&2)));
    }

    #[test]
    fn normals_and_albedo_follow_their_pixels_and_unused_pixels_are_left_out() {
        let mask = Mask::from_vec(4, 2, vec![true, true, false, true, true, false, false, false]).unwrap();
        let (zero, one) = (Plane::filled(4, 2, 0.0), Plane::filled(4, 2, 1.0));
        let albedo = Plane::from_fn(4, 2, |x, y| 0.1 * (1 + x + 4 * y) as f32);
        let normals = NormalMap::from_planes(one, zero.clone(), zero.clone()).unwrap();
        let camera = orthographic((4, 2), None);
        let (mesh, report) =
            from_depth(&zero, &mask, &camera, Some(&normals), Some(&albedo), &MeshOptions::default()).unwrap();
        assert_eq!((report.vertices, report.unused_pixels), (3, 1));
        assert_eq!(mesh.unit, LengthUnit::Pixel);
        assert_eq!(mesh.positions[2], Point3::new(-1.5, -0.5, 0.0));
        assert_eq!(mesh.colours, [[0.1; 3], [0.2; 3], [0.5; 3]]);
        assert!(mesh.normals.iter().all(|&normal| normal == Vector3::x()));
    }

    #[test]
    fn a_step_is_torn_when_asked() {
        let step = Plane::from_fn(8, 5, |x, _| if x < 4 { 0.0 } else { 20.0 });
        let mask = Mask::filled(8, 5, true);
        let options = MeshOptions { max_slope: Some(10.0) };
        let (mesh, report) = from_depth(&step, &mask, &orthographic((8, 5), None), None, None, &options).unwrap();
        assert_eq!(report.torn_triangles, 8);
        assert_eq!(euler_characteristic(&mesh), 2);
    }

    #[test]
    fn what_cannot_be_joined_is_refused() {
        let depth = Plane::filled(4, 4, 0.0);
        let camera = orthographic((4, 4), None);
        let options = MeshOptions::default();
        let line = Mask::from_fn(4, 4, |_, y| y == 1);
        assert_eq!(from_depth(&depth, &line, &camera, None, None, &options), Err(MeshError::NoTriangle { pixels: 4 }));
        let small = Mask::filled(3, 4, true);
        let refused = from_depth(&depth, &small, &camera, None, None, &options);
        assert_eq!(refused, Err(MeshError::Size { what: "mask", found: (3, 4), depth: (4, 4) }));
        assert!(MeshOptions { max_slope: Some(f64::NAN) }.check().is_err());
    }
}
