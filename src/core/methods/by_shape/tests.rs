//! Light that was simulated forward is taken back, and the shape with it.

use nalgebra::Vector3;

use super::*;
use crate::light::radiosity::{BounceOptions, Patches, bounces};
use crate::light::scene::{RenderOptions, Rendering, Shape as Scene, directions_on_ring, framed, render};
use crate::{Marks, NormalMap, Unwatched};

const ALBEDO: f64 = 0.75;
const WHITE_LIGHT: f64 = 0.6;
const SIZE_PX: usize = 60;

/// A scene of one paint as a camera without errors sees it.
struct Staged {
    camera: Camera,
    directions: Vec<Unit<Vector3<f64>>>,
    rendering: Rendering,
    marks: Marks,
    /// All bounces, by lamp, in linear light.
    light: Vec<Plane>,
}

impl Staged {
    fn new(scene: &Scene) -> Self {
        let (mesh, camera) = framed(scene.mesh(700).unwrap(), SIZE_PX).unwrap();
        let (factors, _) =
            form_factors(Patches::from_mesh(&mesh).unwrap(), &FormFactorOptions::default(), &Unwatched).unwrap();
        let directions = directions_on_ring(3, 18.0);
        let lamp = |direction: &Unit<Vector3<f64>>| scene::Lamp::Directional {
            direction_to_light: *direction,
            intensity: 1.0,
        };
        let lamps: Vec<_> = directions.iter().map(lamp).collect();
        let bounces = BounceOptions { albedos: vec![ALBEDO], bounces: 1, ..Default::default() };
        let options = RenderOptions { bounces, samples_per_pixel_side: 2, ..Default::default() };
        let (rendering, _) = render(&factors, &lamps, &camera, &options, &Unwatched).unwrap();
        let light = rendering.lights.iter().map(|lit| scaled(&lit.all[0])).collect();
        Self { camera, directions, marks: Marks::filled(SIZE_PX, SIZE_PX, 0), rendering, light }
    }

    fn lights<'a>(&'a self, light: &'a [Plane]) -> Vec<DirectLight<'a>> {
        let light_of = |(direct, direction): (&'a Plane, &Unit<Vector3<f64>>)| DirectLight {
            direct,
            noise: None,
            marks: &self.marks,
            lamp: Lamp::Distant(direction.into_inner()),
            intensity: 1.0,
        };
        light.iter().zip(&self.directions).map(light_of).collect()
    }

    fn shape(&self, light: &[Plane]) -> Shape {
        let options = ShapeOptions::default();
        recover_shape(&self.lights(light), &self.rendering.mask, &self.camera, &options, &Unwatched).unwrap()
    }

    /// Normal errors of every shape on the way, and the outcome.
    fn solve(&self, options: &ByShapeOptions) -> (Vec<f64>, ByShape) {
        let lights = self.lights(&self.light);
        let photographed = Photographed {
            lights: &lights,
            mask: &self.rendering.mask,
            camera: &self.camera,
            white_light: WHITE_LIGHT,
        };
        let mut errors_deg = Vec::new();
        let mut on_step = |_: &ByShapeStep, shape: &Shape| errors_deg.push(self.error_deg(&shape.normals.map));
        let pseudo = self.shape(&self.light);
        let shape_options = ShapeOptions::default();
        let found =
            separate_by_shape(&photographed, &pseudo, options, &shape_options, &Unwatched, &mut on_step).unwrap();
        (errors_deg, found)
    }

    fn error_deg(&self, normals: &NormalMap) -> f64 {
        normals.angular_error(&self.rendering.normals, &self.rendering.mask).unwrap().mean_deg
    }
}

fn scaled(plane: &Plane) -> Plane {
    Plane::from_fn(plane.width(), plane.height(), |x, y| plane.at(x, y) * WHITE_LIGHT as f32)
}

fn few_patches() -> ByShapeOptions {
    ByShapeOptions { patches: 300, max_iterations: 5, ..ByShapeOptions::default() }
}

#[test]
fn a_groove_grows_better_with_each_of_the_first_iterations() {
    let staged = Staged::new(&Scene::Groove { wall_mm: 30.0, length_mm: 45.0, angle_deg: 90.0 });
    let (errors_deg, found) = staged.solve(&few_patches());
    assert!(errors_deg[1..4].iter().all(|error| *error < errors_deg[0]), "{errors_deg:?}");
    assert!(errors_deg.last().unwrap() < &(0.35 * errors_deg[0]), "{errors_deg:?}");
    // The pseudo albedo is too bright, the last one is the paint's.
    let (first, last) = (found.report.steps[0], found.report.steps[found.report.chosen]);
    assert!(first.mean_albedo > 1.03 * ALBEDO, "{first:?}");
    assert!((last.mean_albedo / ALBEDO - 1.0).abs() < 0.03, "{last:?}");
    assert!(last.residual < 0.5 * first.residual, "{first:?} {last:?}");
}

#[test]
fn a_corner_grows_better_with_each_of_the_first_iterations() {
    let staged = Staged::new(&Scene::Corner { wall_mm: 40.0, roll_deg: 20.0 });
    let (errors_deg, _) = staged.solve(&ByShapeOptions { max_iterations: 3, ..few_patches() });
    assert!(errors_deg[1..4].windows(2).all(|pair| pair[1] < pair[0]) && errors_deg[1] < errors_deg[0]);
    assert!(errors_deg.last().unwrap() < &(0.4 * errors_deg[0]), "{errors_deg:?}");
}

#[test]
fn a_convex_shape_is_left_as_it_is() {
    let mut staged = Staged::new(&Scene::Groove { wall_mm: 30.0, length_mm: 45.0, angle_deg: 90.0 });
    // A ridge under the same lamps: no wall sees the other.
    let tilt = 25_f32.to_radians();
    let normal = |x: usize| Vector3::new(if 2 * x < SIZE_PX { -tilt.sin() } else { tilt.sin() }, 0.0, tilt.cos());
    let light = |direction: &Unit<Vector3<f64>>| {
        Plane::from_fn(SIZE_PX, SIZE_PX, |x, _| 0.5 * normal(x).dot(&direction.cast::<f32>()).max(0.0))
    };
    staged.light = staged.directions.iter().map(light).collect();
    staged.rendering.mask = Mask::filled(SIZE_PX, SIZE_PX, true);
    let pseudo = staged.shape(&staged.light);
    let (_, found) = staged.solve(&few_patches());
    let change = found.shape.normals.map.angular_error(&pseudo.normals.map, &staged.rendering.mask).unwrap();
    assert!(change.mean_deg < 1e-3, "{change:?}");
    assert_eq!((found.report.ending, found.report.chosen), (Ending::Converged, 1));
    assert!(found.report.steps[1].indirect_fraction < 1e-4);
}

#[test]
fn the_light_of_all_bounces_less_what_arrives_and_is_reflected_is_the_direct_light() {
    let scene = Scene::Groove { wall_mm: 30.0, length_mm: 45.0, angle_deg: 90.0 };
    let staged = Staged::new(&scene);
    // On the true shape, one correction is exact but for the patches' size.
    let direct: Vec<_> = staged.rendering.lights.iter().map(|lit| scaled(&lit.bounces[0])).collect();
    let true_shape = staged.shape(&direct);
    let lights = staged.lights(&staged.light);
    let photographed = Photographed {
        lights: &lights,
        mask: &staged.rendering.mask,
        camera: &staged.camera,
        white_light: WHITE_LIGHT,
    };
    let simulated = Simulated::new(&photographed, true_shape, &few_patches(), &Unwatched).unwrap();
    let (corrected, _) = simulated.corrected(&photographed, &Unwatched).unwrap();
    for (found, truth) in corrected.iter().zip(&direct) {
        let error = crate::image::evaluate::relative_error(found, truth, &staged.rendering.mask).unwrap();
        assert!(error < 0.03, "{error}");
    }
    // The residual of the true shape is that of its patches.
    assert!(simulated.residual < 0.05, "{}", simulated.residual);

    // And patch by patch the equation holds to the solver's tolerance: (I - P K) L = L_s.
    let factors = &simulated.factors;
    let source: Vec<f64> = (0..factors.patches().len()).map(|i| 0.2 + 0.1 * (i % 7) as f64).collect();
    let options = BounceOptions { albedos: vec![ALBEDO], bounces: 1, relative_residual: 1e-10, ..Default::default() };
    let (lit, _) = bounces(factors, std::slice::from_ref(&source), &options, &Unwatched).unwrap();
    let arriving = factors.irradiance(&lit[0].all[..1], &Unwatched).unwrap();
    for ((all, arriving), source) in lit[0].all[0].iter().zip(&arriving[0]).zip(&source) {
        assert!((all - ALBEDO * arriving - ALBEDO * source).abs() < 1e-7);
    }
}

#[test]
fn islands_exchange_no_light_through_a_patch_between_them() {
    let mut staged = Staged::new(&Scene::Groove { wall_mm: 30.0, length_mm: 45.0, angle_deg: 90.0 });
    let mask = Mask::from_fn(SIZE_PX, SIZE_PX, |x, y| staged.rendering.mask.at(x, y) && x != SIZE_PX / 2);
    staged.rendering.mask = mask;
    let shape = staged.shape(&staged.light);
    assert_eq!(shape.depth.report.islands, 2);
    let facets = Facets::new(&shape, &staged.camera, 300).unwrap();
    let all = facets.patches().unwrap();
    let gap_mm = staged.camera.point_mm(SIZE_PX as f64 / 2.0 + 0.5, 0.5, 0.0).x;
    // No patch spans the gap by more than the node that stands beyond the mask's edge.
    for patch in all.as_slice() {
        let left = patch.corners.iter().filter(|corner| corner.x < gap_mm - 0.5).count();
        let right = patch.corners.iter().filter(|corner| corner.x > gap_mm + 0.5).count();
        assert!(left == 0 || right == 0 || left + right < 3, "{:?}", patch.corners);
    }
}

#[test]
fn what_cannot_be_is_refused_in_words() {
    let staged = Staged::new(&Scene::Groove { wall_mm: 30.0, length_mm: 45.0, angle_deg: 120.0 });
    let lights = staged.lights(&staged.light);
    let photographed =
        Photographed { lights: &lights, mask: &staged.rendering.mask, camera: &staged.camera, white_light: 0.0 };
    let pseudo = staged.shape(&staged.light);
    let run = |photographed: &Photographed, options: ByShapeOptions, watch: &dyn Watch| {
        separate_by_shape(photographed, &pseudo, &options, &ShapeOptions::default(), watch, &mut |_, _| {}).unwrap_err()
    };
    let error = run(&photographed, few_patches(), &Unwatched);
    assert_eq!(error.to_string(), "the light of a white facet is 0; it must be a positive number");
    let photographed = Photographed { white_light: WHITE_LIGHT, ..photographed };
    let error = run(&photographed, ByShapeOptions { patches: 3, ..few_patches() }, &Unwatched);
    assert_eq!(error.to_string(), "patches is 3; it must be from 16 to 20000");

    struct Impatient;
    impl Watch for Impatient {
        fn progress(&self, _: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    assert_eq!(run(&photographed, few_patches(), &Impatient), ByShapeError::Cancelled);
}
