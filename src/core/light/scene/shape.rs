//! Built-in shapes with concave walls, as meshes of any fineness.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Point3, Rotation3, Unit, Vector3};

use super::SceneError;
use crate::Mesh;
use crate::mesh::LengthUnit;
use crate::options::check_range;

/// From a speck to a kilometre: beyond that the tree of a single-precision ray tracer breaks down.
const LENGTHS_MM: std::ops::RangeInclusive<f64> = 1e-3..=1e6;

/// A shape in the object frame, lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Three square walls at right angles that meet at the origin and open toward +z. Their normals lie at -15, 105 and
    /// 225 degrees about z, plus `roll_deg`.
    Corner {
        /// Side of a wall.
        wall_mm: f64,
        /// Turn about z.
        roll_deg: f64,
    },
    /// Two walls that meet in a crease along y through the origin and open toward +z.
    Groove {
        /// From the crease to the outer edge.
        wall_mm: f64,
        /// Along the crease.
        length_mm: f64,
        /// Between the walls.
        angle_deg: f64,
    },
    /// The inside of a spherical cap below a flat rim at z = 0; 90 degrees make a hemisphere.
    Bowl {
        /// Radius of the sphere.
        radius_mm: f64,
        /// From the axis to the cap's edge, seen from the sphere's centre.
        half_angle_deg: f64,
        /// Width of the rim; 0 for none.
        rim_mm: f64,
    },
    /// A tray with slanting walls, a ball and a turned block in it: walls, crevices and shadows, for bounces up to four.
    Tray {
        /// Side of the tray at its top.
        side_mm: f64,
    },
}

impl Shape {
    /// The shape in about `patches` triangles of similar size, with the smooth surface's normals at the vertices.
    ///
    /// Curved surfaces are inscribed: vertices lie on the sphere, so facets stand up to `h^2 / 8R` before it (h the
    /// facet's diameter) and the area falls short by the same order.
    pub fn mesh(&self, patches: usize) -> Result<Mesh, SceneError> {
        self.check(patches)?;
        let edge_mm = (2.0 * self.area_mm2() / patches as f64).sqrt();
        let mut mesh = MeshBuilder::new(edge_mm);
        match *self {
            Self::Corner { wall_mm, roll_deg } => mesh.corner(wall_mm, roll_deg),
            Self::Groove { wall_mm, length_mm, angle_deg } => mesh.groove(wall_mm, length_mm, angle_deg),
            Self::Bowl { radius_mm, half_angle_deg, rim_mm } => {
                mesh.bowl(radius_mm, half_angle_deg.to_radians(), rim_mm)
            }
            Self::Tray { side_mm } => mesh.tray(side_mm),
        }
        Ok(mesh.mesh)
    }

    fn check(&self, patches: usize) -> Result<(), SceneError> {
        let lengths: &[(&'static str, f64)] = match self {
            Self::Corner { wall_mm, .. } => &[("wall_mm", *wall_mm)],
            Self::Groove { wall_mm, length_mm, .. } => &[("wall_mm", *wall_mm), ("length_mm", *length_mm)],
            Self::Bowl { radius_mm, .. } => &[("radius_mm", *radius_mm)],
            Self::Tray { side_mm } => &[("side_mm", *side_mm)],
        };
        for &(option, mm) in lengths {
            check_range(option, mm, LENGTHS_MM.contains(&mm), "between 0.001 and 1000000 mm")?;
        }
        match *self {
            Self::Corner { roll_deg, .. } => check_range("roll_deg", roll_deg, roll_deg.is_finite(), "finite")?,
            Self::Groove { angle_deg, .. } => {
                check_range("angle_deg", angle_deg, angle_deg > 0.0 && angle_deg < 360.0, "between 0 and 360")?;
            }
            Self::Bowl { half_angle_deg: angle_deg, rim_mm, .. } => {
                let in_range = angle_deg > 0.0 && angle_deg <= 90.0;
                check_range("half_angle_deg", angle_deg, in_range, "above 0 and at most 90")?;
                check_range("rim_mm", rim_mm, rim_mm.is_finite() && rim_mm >= 0.0, "0 or more")?;
            }
            Self::Tray { .. } => {}
        }
        Ok(check_range("patches", patches as f64, (2..=4_000_000).contains(&patches), "between 2 and 4 million")?)
    }

    fn area_mm2(&self) -> f64 {
        match *self {
            Self::Corner { wall_mm, .. } => 3.0 * wall_mm * wall_mm,
            Self::Groove { wall_mm, length_mm, .. } => 2.0 * wall_mm * length_mm,
            Self::Bowl { radius_mm, half_angle_deg, rim_mm } => {
                let (sine, cosine) = half_angle_deg.to_radians().sin_cos();
                TAU * radius_mm * radius_mm * (1.0 - cosine) + PI * rim_mm * (2.0 * radius_mm * sine + rim_mm)
            }
            Self::Tray { side_mm } => 1.84 * side_mm * side_mm,
        }
    }
}

/// Puts surfaces together; each has its own vertices, so that normals break at creases.
struct MeshBuilder {
    mesh: Mesh,
    edge_mm: f64,
}

/// Points around the first ring about a pole; ring r has r times as many.
const SECTORS: usize = 6;

impl MeshBuilder {
    fn new(edge_mm: f64) -> Self {
        let unit = LengthUnit::Millimetre;
        let mesh = Mesh { positions: vec![], normals: vec![], colours: vec![], triangles: vec![], unit };
        Self { mesh, edge_mm }
    }

    fn corner(&mut self, wall_mm: f64, roll_deg: f64) {
        let diagonal = Unit::new_normalize(Vector3::repeat(1.0));
        // The two directions are never opposite, so the rotation between them exists.
        let upright = Rotation3::rotation_between(&diagonal, &Vector3::z()).unwrap_or_else(Rotation3::identity);
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), roll_deg.to_radians()) * upright;
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| turn * axis * wall_mm);
        for (u, v) in [(x, y), (y, z), (z, x)] {
            let origin = Point3::origin();
            self.quad([origin, origin + u, origin + u + v, origin + v]);
        }
    }

    fn groove(&mut self, wall_mm: f64, length_mm: f64, angle_deg: f64) {
        let (sine, cosine) = (angle_deg / 2.0).to_radians().sin_cos();
        let (near, far) = (-length_mm / 2.0, length_mm / 2.0);
        let at = |side: f64, y: f64| Point3::new(side * wall_mm * sine, y, wall_mm * cosine);
        let crease = |y: f64| Point3::new(0.0, y, 0.0);
        self.quad([crease(near), at(1.0, near), at(1.0, far), crease(far)]);
        self.quad([at(-1.0, near), crease(near), crease(far), at(-1.0, far)]);
    }

    fn bowl(&mut self, radius_mm: f64, half_angle: f64, rim_mm: f64) {
        let opening_mm = radius_mm * half_angle.sin();
        let centre = Point3::new(0.0, 0.0, radius_mm * half_angle.cos());
        let cap_area_mm2 = TAU * radius_mm * radius_mm * (1.0 - half_angle.cos());
        let rings = self.rings(cap_area_mm2);
        self.disc(rings, |fraction, turn| {
            let (sine, cosine) = polar_angle(fraction, half_angle).sin_cos();
            let inward = Vector3::new(-sine * turn.cos(), -sine * turn.sin(), cosine);
            (centre - inward * radius_mm, inward)
        });
        if rim_mm > 0.0 {
            let bands = (rim_mm / self.edge_mm).ceil() as usize;
            let around = SECTORS * rings;
            self.grid(around, bands, |u, v| {
                let (sine, cosine) = (TAU * u).sin_cos();
                let distance_mm = opening_mm + rim_mm * (1.0 - v);
                (Point3::new(cosine * distance_mm, sine * distance_mm, 0.0), Vector3::z())
            });
        }
    }

    fn tray(&mut self, side_mm: f64) {
        let at = |x: f64, y: f64, z: f64| Point3::new(x * side_mm, y * side_mm, z * side_mm);
        let square =
            |half: f64, z: f64| [(-half, -half), (half, -half), (half, half), (-half, half)].map(|(x, y)| at(x, y, z));
        let (floor, top) = (square(0.3, 0.0), square(0.5, 0.3));
        self.quad(floor);
        for k in 0..4 {
            let next = (k + 1) % 4;
            self.quad([floor[next], floor[k], top[k], top[next]]);
        }
        self.ball(at(-0.1, 0.07, 0.12), 0.12 * side_mm);
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 25f64.to_radians());
        let block =
            |half: f64, z: f64| square(half, z).map(|corner| turn * corner + Vector3::new(0.14, -0.13, 0.0) * side_mm);
        let (foot, lid) = (block(0.09, 0.0), block(0.09, 0.15));
        self.quad(lid);
        for k in 0..4 {
            let next = (k + 1) % 4;
            self.quad([foot[k], foot[next], lid[next], lid[k]]);
        }
    }

    fn ball(&mut self, centre: Point3<f64>, radius_mm: f64) {
        let rings = self.rings(TAU * radius_mm * radius_mm);
        for half in [1.0, -1.0] {
            self.disc(rings, |fraction, turn| {
                let (sine, cosine) = polar_angle(fraction, FRAC_PI_2).sin_cos();
                let outward = Vector3::new(sine * turn.cos(), sine * turn.sin(), half * cosine);
                (centre + outward * radius_mm, outward)
            });
        }
    }

    /// Rings about a pole so that a triangle covers half the square of the edge.
    fn rings(&self, area_mm2: f64) -> usize {
        let triangles = 2.0 * area_mm2 / (self.edge_mm * self.edge_mm);
        ((triangles / SECTORS as f64).sqrt().round() as usize).max(1)
    }

    /// A flat quadrilateral, its corners counter-clockwise seen from the front.
    fn quad(&mut self, [a, b, c, d]: [Point3<f64>; 4]) {
        let normal = (b - a).cross(&(d - a)).normalize();
        let steps = |length: f64| ((length / self.edge_mm).round() as usize).max(1);
        let along = steps(((b - a).norm() + (c - d).norm()) / 2.0);
        let across = steps(((d - a).norm() + (c - b).norm()) / 2.0);
        self.grid(along, across, |u, v| {
            let (low, high) = (a + (b - a) * u, d + (c - d) * u);
            (low + (high - low) * v, normal)
        });
    }

    /// `along` x `across` cells of the image of the unit square.
    fn grid(&mut self, along: usize, across: usize, place: impl Fn(f64, f64) -> (Point3<f64>, Vector3<f64>)) {
        let first = self.mesh.positions.len();
        for j in 0..=across {
            for i in 0..=along {
                self.vertex(place(i as f64 / along as f64, j as f64 / across as f64));
            }
        }
        for j in 0..across {
            for i in 0..along {
                let corner = first + j * (along + 1) + i;
                self.triangle([corner, corner + 1, corner + along + 2]);
                self.triangle([corner, corner + along + 2, corner + along + 1]);
            }
        }
    }

    /// Rings about a pole; `place` takes the distance from the pole in 0..1 and the angle around it.
    fn disc(&mut self, rings: usize, place: impl Fn(f64, f64) -> (Point3<f64>, Vector3<f64>)) {
        let first = self.mesh.positions.len();
        self.vertex(place(0.0, 0.0));
        for ring in 1..=rings {
            let around = SECTORS * ring;
            for k in 0..around {
                self.vertex(place(ring as f64 / rings as f64, TAU * k as f64 / around as f64));
            }
        }
        let index = |ring: usize, k: usize| match ring {
            0 => first,
            _ => first + 1 + SECTORS * ring * (ring - 1) / 2 + k % (SECTORS * ring),
        };
        for ring in 0..rings {
            for sector in 0..SECTORS {
                let (inner, outer) = (sector * ring, sector * (ring + 1));
                for k in 0..=ring {
                    self.triangle([index(ring, inner + k), index(ring + 1, outer + k), index(ring + 1, outer + k + 1)]);
                    if k < ring {
                        let next = index(ring, inner + k + 1);
                        self.triangle([index(ring, inner + k), index(ring + 1, outer + k + 1), next]);
                    }
                }
            }
        }
    }

    fn vertex(&mut self, (position, normal): (Point3<f64>, Vector3<f64>)) {
        self.mesh.positions.push(position.cast());
        self.mesh.normals.push(normal.cast());
    }

    /// Adds a triangle whose front is on the side of its normals.
    fn triangle(&mut self, [a, b, c]: [usize; 3]) {
        let mesh = &mut self.mesh;
        let across = (mesh.positions[b] - mesh.positions[a]).cross(&(mesh.positions[c] - mesh.positions[a]));
        let outward = mesh.normals[a] + mesh.normals[b] + mesh.normals[c];
        let triangle = if across.dot(&outward) < 0.0 { [a, c, b] } else { [a, b, c] };
        mesh.triangles.push(triangle.map(|vertex| vertex as u32));
    }
}

/// The polar angle at a fraction of the rings of a cap. Rings crowd toward its edge until triangles there are about
/// equilateral: a facet that ends at the edge errs in what it sees of the opening by as much as its centre lies off the
/// point where its plane is parallel to the sphere.
fn polar_angle(fraction: f64, half_angle: f64) -> f64 {
    let slope_at_edge = TAU / SECTORS as f64 * 0.75f64.sqrt() * half_angle.sin() / half_angle;
    fraction * half_angle * (1.0 + (1.0 - slope_at_edge) * (1.0 - fraction))
}
