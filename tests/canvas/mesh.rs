//! The 3D view against stored pictures, with a tolerance for other cards. `UPDATE_SNAPSHOTS=1` writes them anew.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::path::Path;
use std::sync::Arc;

use firstbounce::gpu::mesh::{
    Bounds, Camera, Geometry, LayerDrawing, Lens, PlaneDrawing, Scene, Shading, Shared, StandardView,
};
use firstbounce_core::Mesh;
use firstbounce_core::mesh::LengthUnit;
use image::RgbaImage;
use nalgebra::{Isometry3, Point3, Vector3};

use crate::card::card;

const SIZE: [u32; 2] = [128, 96];
/// Mean difference of a channel, of 255.
const MEAN_TOLERANCE: f64 = 2.0;
/// A pixel that differs by more than this, of 255, is another one; edges may be.
const PIXEL_TOLERANCE: u8 = 32;
const OTHER_PIXELS: f64 = 0.01;

/// A hill with a ring around it, 40 mm wide, striped.
fn hill() -> Mesh {
    hill_of(80)
}

/// The same with so many cells on a side.
fn hill_of(cells: u32) -> Mesh {
    let side = cells + 1;
    let at = |index: u32| {
        let pitch = 40.0 / f64::from(cells);
        let (x, y) = (f64::from(index % side) * pitch - 20.0, f64::from(index / side) * pitch - 20.0);
        let r = x.hypot(y);
        let z = 9.0 * (-r * r / 60.0).exp() + 2.0 * (-(r - 14.0).powi(2) / 6.0).exp() + 0.1 * x;
        Point3::new(x, y, z).cast::<f32>()
    };
    let positions: Vec<_> = (0..side * side).map(at).collect();
    let colours =
        positions.iter().map(|p| if (p.x / 4.0).floor() % 2.0 == 0.0 { [0.7, 0.3, 0.1] } else { [0.2, 0.4, 0.7] });
    let triangles = (0..cells * cells)
        .flat_map(|cell| {
            let corner = cell / cells * side + cell % cells;
            [[corner, corner + 1, corner + side + 1], [corner, corner + side + 1, corner + side]]
        })
        .collect();
    Mesh { colours: colours.collect(), positions, normals: vec![], triangles, unit: LengthUnit::Millimetre }
}

/// The hill from a named side.
fn scene(lens: Lens, view: StandardView) -> Scene {
    let geometry = Arc::new(Geometry::new(&hill()).unwrap());
    let bounds = geometry.bounds;
    scene_of(vec![LayerDrawing::new(geometry)], bounds, lens, view)
}

fn scene_of(layers: Vec<LayerDrawing>, bounds: Bounds, lens: Lens, view: StandardView) -> Scene {
    let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
    let camera = Camera::fitted(&bounds, view, lens, aspect);
    let frame = camera.frame(SIZE.map(f64::from), &bounds);
    Scene { size_px: SIZE, frame, layers, background: [0.1, 0.1, 0.12], plane: None }
}

fn shaded(shading: Shading) -> Scene {
    let mut scene = scene(Lens::Perspective, StandardView::Corner);
    scene.layers[0].shading = shading;
    scene
}

fn check(name: &str, scene: &Scene) {
    let Some(card) = card(name) else { return };
    let drawn = card.draw_scene(scene);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/canvas/pictures/{name}.png"));
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        drawn.save(&path).unwrap();
        return;
    }
    let stored = image::open(&path).expect("a stored picture; UPDATE_SNAPSHOTS=1 writes it").to_rgba8();
    let (mean, others) = difference(&drawn, &stored);
    if mean > MEAN_TOLERANCE || others > OTHER_PIXELS {
        let beside = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.png"));
        drawn.save(&beside).unwrap();
        panic!(
            "{name}: differs by {mean:.2} of 255 and in {:.1} % of its pixels: see {}",
            100.0 * others,
            beside.display()
        );
    }
}

/// The mean difference of a channel, and the part of the pixels that are others.
fn difference(one: &RgbaImage, other: &RgbaImage) -> (f64, f64) {
    assert_eq!(one.dimensions(), other.dimensions());
    let channels = || one.as_raw().iter().zip(other.as_raw()).map(|(a, b)| a.abs_diff(*b));
    let mean = channels().map(f64::from).sum::<f64>() / one.as_raw().len() as f64;
    let pixels = one.pixels().zip(other.pixels());
    let is_other = |a: &[u8; 4], b: &[u8; 4]| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > PIXEL_TOLERANCE);
    let others = pixels.filter(|(a, b)| is_other(&a.0, &b.0)).count();
    (mean, others as f64 / f64::from(one.width() * one.height()))
}

#[test]
fn each_shading_looks_as_it_did() {
    check("mesh-headlight", &shaded(Shading::Headlight));
    check("mesh-lamp", &shaded(Shading::Lamp([-0.8, 0.3, 0.5, 0.0])));
    check("mesh-near-lamp", &shaded(Shading::Lamp([8.0, 0.0, 16.0, 1.0])));
    check("mesh-normals", &shaded(Shading::Normals));
    check("mesh-albedo", &shaded(Shading::Albedo));
    check("mesh-height", &shaded(Shading::Height([-2.0, 9.0])));
    check("mesh-matcap", &shaded(Shading::Matcap));
}

#[test]
fn the_heat_map_is_red_outside_blue_inside_and_grey_where_there_is_nothing() {
    let mut scene = shaded(Shading::Distance(0.5));
    let values = hill().positions.iter().map(|p| if p.x.hypot(p.y) > 18.0 { f32::NAN } else { p.x / 20.0 }).collect();
    scene.layers[0].values = Some(Shared(Arc::new(values)));
    check("mesh-distance", &scene);
}

#[test]
fn layers_hide_each_other_by_depth_and_wear_wire_and_section() {
    let geometry = Arc::new(Geometry::new(&hill()).unwrap());
    let mut after = LayerDrawing::new(geometry.clone());
    (after.base, after.shading) = (Some([0.4, 0.75, 0.4]), Shading::Matcap);
    let mut before = LayerDrawing::new(geometry.clone());
    before.world_from_mesh = Isometry3::new(Vector3::new(0.0, 0.0, 1.0), Vector3::new(0.25, 0.0, 0.0));
    (before.base, before.shading) = (Some([0.3, 0.75, 0.85]), Shading::Matcap);
    let mut scene = scene_of(vec![after, before], geometry.bounds, Lens::Orthographic, StandardView::Corner);
    check("mesh-layers", &scene);
    scene.layers = vec![LayerDrawing::new(Arc::new(Geometry::new(&hill_of(12)).unwrap()))];
    scene.layers[0].wire = Some([0.0, 0.0, 0.0, 0.8]);
    scene.plane =
        Some(PlaneDrawing { normal: [0.0, 1.0, 0.0], offset: 3.0, colour: [1.0, 0.6, 0.1], half_width_px: 1.0 });
    check("mesh-wire-and-section", &scene);
}

#[test]
fn the_middle_of_the_front_view_has_the_colour_of_its_normal() {
    let Some(card) = card("the colour of a normal") else { return };
    let mut scene = scene(Lens::Orthographic, StandardView::Front);
    scene.layers[0].shading = Shading::Normals;
    let drawn = card.draw_scene(&scene);
    // In the corner, beyond hill and ring, the surface is flat and rises by 0.1 to the right.
    let expected = Vector3::new(-0.1, 0.0, 1.0).normalize().map(|component: f64| 127.5 + 127.5 * component);
    let bounds = scene.layers[0].geometry.bounds;
    let [x, y, _] = scene.frame.project(&Point3::new(18.5, 18.5, 1.85)).unwrap();
    let pixel = drawn.get_pixel(x as u32, y as u32).0;
    for (shown, expected) in pixel.iter().zip(expected.iter()) {
        assert!((f64::from(*shown) - expected).abs() < 4.0, "{pixel:?} {expected}");
    }
    // Seen from behind the same surface shows the other side, a little darker.
    let frame =
        Camera::fitted(&bounds, StandardView::Back, Lens::Orthographic, 4.0 / 3.0).frame(SIZE.map(f64::from), &bounds);
    let behind = card.draw_scene(&Scene { frame, ..scene }).get_pixel(SIZE[0] / 2, SIZE[1] / 2).0;
    assert!(behind[2] < 40, "{behind:?}");
}

#[test]
fn a_scene_is_drawn_once_and_again_when_it_changes() {
    let Some(card) = card("drawn once") else { return };
    let scene = scene(Lens::Perspective, StandardView::Front);
    let mut other = scene.clone();
    other.background = [1.0; 3];
    assert_eq!(card.draws(&[&scene, &scene, &other, &other, &scene]), [true, false, true, false, true]);
}
