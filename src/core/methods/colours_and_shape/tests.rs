//! Light that was simulated forward is told apart, against the truth.

use nalgebra::{Point3, Unit, Vector3};
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

use super::*;
use crate::image::evaluate::relative_error;
use crate::image::noise::NoiseModel;
use crate::light::radiosity::{BounceOptions, FormFactorOptions, Patches, form_factors};
use crate::light::scene::{self, RenderOptions, Shape as Scene, directions_on_ring, framed, render};
use crate::separate::{SeparateOptions, UNSOLVED, separate};
use crate::stereo::normals::{DirectLight, Normals, NormalsOptions, Paint};
use crate::{NormalMap, Photo, Projection, Unwatched};

const ALBEDOS: [f64; 2] = [0.75, 0.38];
const SIZE_PX: usize = 96;

/// An object under three lamps in two colours, and its truth.
struct Staged {
    camera: Camera,
    mask: Mask,
    lamps: Vec<Option<(Lamp, f64)>>,
    normals: NormalMap,
    /// By light, direct light.
    direct: Vec<Plane>,
    /// By light, then colour.
    photos: Vec<Vec<Photo>>,
    noise: Vec<NoiseModel>,
    beta: Vec<f64>,
}

impl Staged {
    /// All bounces of one paint, with the noise of a camera.
    fn new(scene: &Scene) -> Self {
        Self::under(scene, &directions_on_ring(3, 18.0))
    }

    fn under(scene: &Scene, directions: &[Unit<Vector3<f64>>]) -> Self {
        let (mesh, camera) = framed(scene.mesh(900).unwrap(), SIZE_PX).unwrap();
        let patches = Patches::from_mesh(&mesh).unwrap();
        let (factors, _) = form_factors(patches, &FormFactorOptions::default(), &Unwatched).unwrap();
        let lamp = |direction: &Unit<Vector3<f64>>| scene::Lamp::Directional {
            direction_to_light: *direction,
            intensity: 1.0,
        };
        let lamps: Vec<_> = directions.iter().map(lamp).collect();
        let bounces = BounceOptions { albedos: ALBEDOS.to_vec(), bounces: 1, ..Default::default() };
        let options = RenderOptions { bounces, samples_per_pixel_side: 2, ..Default::default() };
        let (rendering, _) = render(&factors, &lamps, &camera, &options, &Unwatched).unwrap();
        let direct = rendering.lights.iter().map(|lit| lit.bounces[0].clone()).collect();
        let light = rendering.lights.into_iter().map(|lit| lit.all).collect();
        let placed = directions.iter().map(|direction| Some((Lamp::Distant(direction.into_inner()), 1.0))).collect();
        Self::with_light(camera, rendering.mask, placed, rendering.normals, direct, light)
    }

    fn with_light(
        camera: Camera,
        mask: Mask,
        lamps: Vec<Option<(Lamp, f64)>>,
        normals: NormalMap,
        direct: Vec<Plane>,
        light: Vec<Vec<Plane>>,
    ) -> Self {
        let noise = NoiseModel::of_camera(40_000.0, 4.0, 16, 1.0);
        let mut random = StdRng::seed_from_u64(5);
        let mut noisy = |plane: Plane| {
            let mut plane = plane;
            for light in plane.data_mut() {
                *light += (noise.sigma(f64::from(*light)) * random.sample::<f64, _>(StandardNormal)) as f32;
            }
            Photo::unmarked(plane)
        };
        let photos = light.into_iter().map(|colours| colours.into_iter().map(&mut noisy).collect()).collect();
        let beta = ALBEDOS.map(|albedo| albedo / ALBEDOS[0]).to_vec();
        Self { camera, mask, lamps, normals, direct, photos, noise: vec![noise; ALBEDOS.len()], beta }
    }

    fn with_lights<T>(&self, work: impl FnOnce(&[LightPhotos]) -> T) -> T {
        let photos: Vec<Vec<&Photo>> = self.photos.iter().map(|row| row.iter().collect()).collect();
        let light =
            |photos| LightPhotos { photos, noise: &self.noise, alpha: &[1.0, 1.0], beta: &self.beta, mask: &self.mask };
        let lights: Vec<_> = photos.iter().map(|row| light(row)).collect();
        work(&lights)
    }

    fn solve(&self, options: &ColoursAndShapeOptions) -> Result<ColoursAndShape, ColoursAndShapeError> {
        self.with_lights(|lights| {
            let photographed =
                Photographed { lights, lamps: &self.lamps, mask: &self.mask, camera: &self.camera, white_light: None };
            separate_by_colours_and_shape(&photographed, options, &shape_options(Paint::Auto), &Unwatched, &mut |_| {})
        })
    }

    /// The normals that direct light shows.
    fn shape(&self, direct: &[(&Plane, Option<&Plane>, &Marks)], paint: Paint) -> Shape {
        let lights: Vec<_> = direct
            .iter()
            .zip(&self.lamps)
            .filter_map(|(&(direct, noise, marks), lamp)| {
                let (lamp, intensity) = (*lamp)?;
                Some(DirectLight { direct, noise, marks, lamp, intensity })
            })
            .collect();
        recover_shape(&lights, &self.mask, &self.camera, &shape_options(paint), &Unwatched).unwrap()
    }

    fn shape_of(&self, found: &ColoursAndShape, paint: Paint) -> Shape {
        let direct: Vec<_> =
            found.lights.iter().map(|light| (&light.direct, Some(&light.noise), &light.marks)).collect();
        self.shape(&direct, paint)
    }

    /// By the paper's two bounces.
    fn shape_by_colours(&self) -> Shape {
        let separations = self.with_lights(|lights| {
            let of_light = |light| separate(light, &SeparateOptions { bounces: 2 }, &Unwatched).unwrap().0;
            lights.iter().map(of_light).collect::<Vec<_>>()
        });
        let direct: Vec<_> = separations.iter().map(|light| (&light.bounces[0], None, &light.marks)).collect();
        self.shape(&direct, Paint::Any)
    }

    fn error_deg(&self, normals: &Normals) -> f64 {
        normals.map.angular_error(&self.normals, &self.mask).unwrap().mean_deg
    }
}

fn shape_options(paint: Paint) -> ShapeOptions {
    ShapeOptions { normals: NormalsOptions { paint, ..Default::default() }, ..Default::default() }
}

fn corner() -> Staged {
    Staged::new(&Scene::Corner { wall_mm: 40.0, roll_deg: 20.0 })
}

#[test]
fn a_corner_comes_back_several_times_better_than_by_two_bounces() {
    let staged = corner();
    let step_0 = staged.solve(&ColoursAndShapeOptions { rounds: 0, ..Default::default() }).unwrap();
    let found = staged.solve(&ColoursAndShapeOptions::default()).unwrap();
    let colours = staged.error_deg(&staged.shape_by_colours().normals);
    let even = staged.error_deg(&staged.shape_of(&step_0, Paint::Any).normals);
    let shape = staged.shape_of(&found, Paint::Auto);
    let both = staged.error_deg(&shape.normals);
    assert!(both < 0.3 * colours && both < 0.6 * even && even < colours, "{colours} {even} {both}");
    assert!(shape.report.normals.paint.is_some_and(|paint| paint.one));
    for (light, truth) in found.lights.iter().zip(&staged.direct) {
        let error = relative_error(&light.direct, truth, &staged.mask).unwrap();
        assert!(error < 0.012, "{error}");
    }
    assert_eq!(found.report.no_shape, None);
}

/// K of even light over a spherical cap is the part of the sphere that the cap covers, at every point of it.
#[test]
fn a_spherical_cap_receives_even_light() {
    let half_angle_deg = 60_f64;
    let (shape, camera) = cap(half_angle_deg, 160);
    let mask = shape.depth.mask.clone();
    let ones = vec![1.0; mask.data().len()];
    let pyramid = Pyramid::new(&shape, &camera, &mask, &[&ones]);
    let light = arriving_light(&pyramid, &shape.normals.map, &mask, None, &Unwatched).unwrap();
    let expected = (1.0 - half_angle_deg.to_radians().cos()) / 2.0;
    for (value, _) in light[0].data().iter().zip(mask.data()).filter(|(_, inside)| **inside) {
        assert!((f64::from(*value) / expected - 1.0).abs() < 0.03, "{value} for {expected}");
    }
    assert!(Visibility::new(&pyramid, &camera, &shape.depth.depth_mm).is_none(), "nothing stands in a cap");
}

/// The inside of a spherical cap of radius 100 px, exactly.
fn cap(half_angle_deg: f64, size_px: usize) -> (Shape, Camera) {
    let camera = Camera { projection: Projection::Orthographic { mm_per_pixel: Some(1.0) }, size: (size_px, size_px) };
    let radius = 0.49 * size_px as f64 / half_angle_deg.to_radians().sin();
    let height = |p: Point3<f64>| (radius * radius - p.x * p.x - p.y * p.y).max(0.0).sqrt();
    let at = |x: usize, y: usize| camera.point_mm(x as f64 + 0.5, y as f64 + 0.5, 0.0);
    let mask = Mask::from_fn(size_px, size_px, |x, y| at(x, y).coords.norm() < 0.49 * size_px as f64);
    let component = |axis: usize| {
        Plane::from_fn(size_px, size_px, |x, y| {
            let p = at(x, y);
            let normal = Vector3::new(-p.x, -p.y, height(p)) / radius;
            if mask.at(x, y) { normal[axis] as f32 } else { 0.0 }
        })
    };
    let mut normals = Normals::empty(size_px, size_px);
    normals.map = NormalMap::from_planes(component(0), component(1), component(2)).unwrap();
    let depth_mm = Plane::from_fn(size_px, size_px, |x, y| -height(at(x, y)) as f32);
    let slope_residual = Plane::filled(size_px, size_px, 0.0);
    let depth = crate::stereo::depth::Depth { depth_mm, mask, slope_residual, report: Default::default() };
    let report = crate::stereo::shape::ShapeReport { normals: Default::default(), depth_changes: Vec::new() };
    (Shape { normals, depth, report }, camera)
}

/// Light of the cap's own bounces, by `N = rho (E + K N)` until it stands; `albedo` by pixel, then colour.
fn cap_of(albedo: impl Fn(usize, usize) -> [f64; 2]) -> Staged {
    let (shape, camera) = cap(60.0, SIZE_PX);
    let mask = shape.depth.mask.clone();
    let directions = directions_on_ring(3, 18.0);
    let lit = |direction: &Unit<Vector3<f64>>| {
        Plane::from_fn(SIZE_PX, SIZE_PX, |x, y| {
            shape.normals.map.at(x, y).map_or(0.0, |normal| normal.dot(&direction.cast::<f32>()).max(0.0))
        })
    };
    let irradiance: Vec<Plane> = directions.iter().map(lit).collect();
    let reflected = |arriving: &Plane, colour: usize| {
        Plane::from_fn(SIZE_PX, SIZE_PX, |x, y| albedo(x, y)[colour] as f32 * arriving.at(x, y))
    };
    let direct: Vec<Plane> = irradiance.iter().map(|light| reflected(light, 0)).collect();
    let mut light: Vec<Plane> =
        irradiance.iter().flat_map(|light| [0, 1].map(|colour| reflected(light, colour))).collect();
    for _ in 0..25 {
        let channels: Vec<&[f32]> = light.iter().map(|plane| plane.data()).collect();
        let pyramid = Pyramid::new(&shape, &camera, &mask, &channels);
        let arriving = arriving_light(&pyramid, &shape.normals.map, &mask, None, &Unwatched).unwrap();
        for (channel, plane) in light.iter_mut().enumerate() {
            let all =
                Plane::from_fn(SIZE_PX, SIZE_PX, |x, y| irradiance[channel / 2].at(x, y) + arriving[channel].at(x, y));
            *plane = reflected(&all, channel % 2);
        }
    }
    let light = light.chunks(2).map(<[Plane]>::to_vec).collect();
    let lamps = directions.iter().map(|direction| Some((Lamp::Distant(direction.into_inner()), 1.0))).collect();
    Staged::with_light(camera, mask, lamps, shape.normals.map, direct, light)
}

#[test]
fn the_amount_in_a_cap_is_even_and_the_albedo() {
    let staged = cap_of(|_, _| ALBEDOS);
    let found = staged.solve(&ColoursAndShapeOptions::default()).unwrap();
    let amount = found.report.amount.unwrap();
    assert!((amount.mean / ALBEDOS[0] - 1.0).abs() < 0.05 && !amount.is_uneven(), "{amount:?}");
}

#[test]
fn two_paints_are_noticed_and_solved_no_worse_than_by_two_bounces() {
    for other in [[0.4, 0.2], [0.6, 0.45]] {
        let staged = cap_of(|x, _| if 3 * x < SIZE_PX { other } else { ALBEDOS });
        let found = staged.solve(&ColoursAndShapeOptions::default()).unwrap();
        let amount = found.report.amount.unwrap();
        assert_eq!(amount.has_other_paint(), other[1] / other[0] > 0.6, "{amount:?}");
        let shape = staged.shape_of(&found, Paint::Auto);
        assert!(shape.report.normals.paint.is_some_and(|paint| !paint.one), "{:?}", shape.report.normals.paint);
        let (both, colours) = (staged.error_deg(&shape.normals), staged.error_deg(&staged.shape_by_colours().normals));
        assert!(both <= colours, "{both} {colours}");
    }
}

/// Where no wall sees another, the light is that of the photos, averaged over the colours.
#[test]
fn a_convex_object_keeps_its_light() {
    let mut staged = cap_of(|_, _| ALBEDOS);
    let lit = |(colour, light): (usize, &Plane)| {
        let mut plane = light.clone();
        plane.data_mut().iter_mut().for_each(|light| *light *= staged.beta[colour] as f32);
        Photo::unmarked(plane)
    };
    // The outside of the cap: normals turned over, direct light alone.
    let flipped = |plane: &Plane| plane.map(|value| -value);
    let (x, y) = (flipped(staged.normals.x()), flipped(staged.normals.y()));
    let normals = NormalMap::from_planes(x, y, staged.normals.z().clone()).unwrap();
    let direct = |lamp: &Option<(Lamp, f64)>| {
        let toward = lamp.unwrap().0.irradiance_vector(Point3::origin()).cast::<f32>();
        Plane::from_fn(SIZE_PX, SIZE_PX, |x, y| normals.at(x, y).map_or(0.0, |n| 0.75 * n.dot(&toward).max(0.0)))
    };
    let light: Vec<Plane> = staged.lamps.iter().map(direct).collect();
    staged.photos = light.iter().map(|light| [light; 2].into_iter().enumerate().map(lit).collect()).collect();
    staged.normals = normals;
    let found = staged.solve(&ColoursAndShapeOptions::default()).unwrap();
    let error = staged.error_deg(&staged.shape_of(&found, Paint::Any).normals);
    assert!(error < 0.03, "{error}");
}

#[test]
fn without_three_lamps_each_light_has_one_ratio_and_the_report_says_why() {
    let mut staged = corner();
    staged.lamps[1] = None;
    let found = staged.solve(&ColoursAndShapeOptions::default()).unwrap();
    let even = staged.solve(&ColoursAndShapeOptions { rounds: 0, ..Default::default() }).unwrap();
    assert_eq!(found.lights, even.lights);
    assert!(found.report.no_shape.is_some() && even.report.no_shape.is_none());
}

/// Low lamps leave most of a bowl to fewer than three: its shape is a guess there, and one ratio a light is better.
#[test]
fn a_shape_that_low_lamps_leave_unknown_is_left_out() {
    let staged = Staged::under(
        &Scene::Bowl { radius_mm: 40.0, half_angle_deg: 80.0, rim_mm: 8.0 },
        &directions_on_ring(8, 58.0),
    );
    let found = staged.solve(&ColoursAndShapeOptions::default()).unwrap();
    assert!(matches!(found.report.no_shape, Some(NoShape::Misfit { .. })), "{:?}", found.report);
    let even = staged.solve(&ColoursAndShapeOptions { rounds: 0, ..Default::default() }).unwrap();
    assert_eq!(found.lights, even.lights);
}

/// Half a bowl sends half of the light on the other half: the walls in view do not explain it.
#[test]
fn a_bowl_of_which_half_is_masked_away_is_out_of_view() {
    let mut staged = Staged::new(&Scene::Bowl { radius_mm: 40.0, half_angle_deg: 80.0, rim_mm: 8.0 });
    let (mask, half) = (staged.mask.clone(), SIZE_PX / 2);
    staged.mask = Mask::from_fn(SIZE_PX, SIZE_PX, |x, y| mask.at(x, y) && x < half);
    let found = staged.solve(&ColoursAndShapeOptions::default()).unwrap();
    assert!(matches!(found.report.no_shape, Some(NoShape::OutOfView { .. })), "{:?}", found.report);
}

#[test]
fn a_pixel_with_one_usable_colour_is_solved_and_one_without_is_not() {
    let mut staged = corner();
    let (one, none) = (40 * SIZE_PX + 48, 44 * SIZE_PX + 48);
    let clip = |photo: &mut Photo, pixel: usize| {
        photo.linear.data_mut()[pixel] = 1.0;
        photo.marks.data_mut()[pixel] = crate::image::photo::CLIPPED;
    };
    clip(&mut staged.photos[0][0], one);
    staged.photos[0].iter_mut().for_each(|photo| clip(photo, none));
    let found = staged.solve(&ColoursAndShapeOptions::default()).unwrap();
    let light = &found.lights[0];
    let truth = staged.direct[0].data()[one];
    assert!((light.direct.data()[one] / truth - 1.0).abs() < 0.05, "{} {truth}", light.direct.data()[one]);
    assert_eq!(light.marks.data()[none], UNSOLVED | crate::image::photo::CLIPPED);
    let report = &found.report.lights[0];
    assert_eq!((report.reduced_pixels, report.unsolved_clipped_pixels), (1, 1));
}

#[test]
fn a_coarse_grid_is_still_better_than_two_bounces() {
    let staged = corner();
    let fine = staged.solve(&ColoursAndShapeOptions::default()).unwrap();
    let coarse = staged.solve(&ColoursAndShapeOptions { cells: 1000, ..Default::default() }).unwrap();
    assert_eq!((fine.report.step_px, coarse.report.step_px), (1, 3));
    let error = |found: &ColoursAndShape| staged.error_deg(&staged.shape_of(found, Paint::Auto).normals);
    let colours = staged.error_deg(&staged.shape_by_colours().normals);
    assert!(error(&coarse) < 0.5 * colours, "{} {} {colours}", error(&coarse), error(&fine));
}

#[test]
fn what_cannot_be_separated_is_refused() {
    let mut staged = corner();
    staged.beta = vec![1.0, 1.01];
    let refused = staged.solve(&ColoursAndShapeOptions::default()).unwrap_err();
    assert!(matches!(refused, ColoursAndShapeError::Photos(SeparateError::SameAlbedo { .. })), "{refused}");
    let refused = ColoursAndShapeOptions { amount_window_px: 0.0, ..Default::default() }.check().unwrap_err();
    assert_eq!(refused.to_string(), "amount_window_px is 0; it must be from 0.5 to 100");
}
