//! Bounces against an independent path tracer, on the rendered capture sets where they are at hand.

use std::error::Error;
use std::path::Path;

use exr::prelude::read_first_flat_layer_from_file;
use firstbounce_core::light::radiosity::{BounceOptions, FormFactorOptions, Patches, form_factors};
use firstbounce_core::light::scene::{Lamp, RenderOptions, Shape, render};
use firstbounce_core::{Camera, Plane, Projection, Unwatched};
use firstbounce_testing::shared_set;
use nalgebra::{Unit, Vector3};
use serde_json::Value;

/// Pixels of the set along each side of a rendered one.
const REDUCTION: usize = 4;
/// Pixels of the set along each side of a compared block: the path tracer's own noise is up to 8 % of the mean in single
/// pixels of bounce 3, and an eighth of that in the mean of a block.
const BLOCK: usize = 8;

/// One channel of an EXR file.
fn channel(path: &Path, name: &str) -> Result<Plane, Box<dyn Error>> {
    let layer = read_first_flat_layer_from_file(path)?.layer_data;
    let found = layer.channel_data.list.iter().find(|channel| channel.name.to_string() == name);
    let values = found.ok_or("no such channel")?.sample_data.values_as_f32().collect();
    Ok(Plane::from_vec(layer.size.width(), layer.size.height(), values).ok_or("short file")?)
}

/// A second, coarser look: noise of the path tracer falls with the block, a bias of either renderer would stay.
const LARGE_BLOCK: usize = 32;

/// Means over the blocks that lie wholly in the mask.
fn block_means(plane: &Plane, mask: &Plane, pixels: usize) -> Vec<Option<f64>> {
    let (columns, rows) = (plane.width() / pixels, plane.height() / pixels);
    let mean = |block: usize| {
        let (x0, y0) = (block % columns * pixels, block / columns * pixels);
        let all = (0..pixels * pixels).map(|k| (x0 + k % pixels, y0 + k / pixels));
        let sum: f64 = all.clone().map(|(x, y)| f64::from(plane.at(x, y))).sum();
        all.clone().all(|(x, y)| mask.at(x, y) > 0.0).then(|| sum / (pixels * pixels) as f64)
    };
    (0..columns * rows).map(mean).collect()
}

/// Mean absolute difference over the mean of the truth.
fn relative_difference(found: &[Option<f64>], truth: &[Option<f64>]) -> f64 {
    let both = || found.iter().zip(truth).filter_map(|(found, truth)| Some(((*found)?, (*truth)?)));
    both().map(|(found, truth)| (found - truth).abs()).sum::<f64>() / both().map(|(_, truth)| truth).sum::<f64>()
}

/// How much brighter all is than the truth, as a fraction of it.
fn relative_bias(found: &[Option<f64>], truth: &[Option<f64>]) -> f64 {
    let both = || found.iter().zip(truth).filter_map(|(found, truth)| Some(((*found)?, (*truth)?)));
    both().map(|(found, _)| found).sum::<f64>() / both().map(|(_, truth)| truth).sum::<f64>() - 1.0
}

fn mask(folder: &Path) -> Result<Plane, Box<dyn Error>> {
    let grey = image::open(folder.join("mask.png"))?.into_luma8();
    let (width, height) = (grey.width() as usize, grey.height() as usize);
    Ok(Plane::from_vec(width, height, grey.iter().map(|&value| f32::from(value)).collect()).ok_or("short file")?)
}

fn compare(name: &str, shape: &Shape, patches: usize, mm_per_pixel: f64) -> Result<(), Box<dyn Error>> {
    let Some(folder) = shared_set(name) else { return Ok(()) };
    let rig: Value = serde_json::from_str(&std::fs::read_to_string(folder.join("truth/rig.json"))?)?;
    let number = |value: &Value| value.as_f64().expect("a number");
    let mask = mask(&folder)?;
    let names: Vec<&String> = rig["direction"].as_object().expect("directions by light").keys().collect();
    let lamp = |light: &&String| {
        let direction = &rig["direction"][*light];
        let direction = Vector3::from_fn(|k, _| number(&direction[k]));
        let intensity = number(&rig["intensity"][*light]);
        Lamp::Directional { direction_to_light: Unit::new_normalize(direction), intensity }
    };
    let lamps: Vec<Lamp> = names.iter().map(lamp).collect();
    let projection = Projection::Orthographic { mm_per_pixel: Some(mm_per_pixel * REDUCTION as f64) };
    let camera = Camera { projection, size: (mask.width() / REDUCTION, mask.height() / REDUCTION) };
    let albedos = vec![number(&rig["albedo"][0])];
    let options = RenderOptions {
        bounces: BounceOptions { albedos, bounces: 3, ..Default::default() },
        samples_per_pixel_side: 4,
        ..Default::default()
    };
    let patches = Patches::from_mesh(&shape.mesh(patches)?)?;
    let (factors, _) = form_factors(patches, &FormFactorOptions::default(), &Unwatched)?;
    let (rendering, _) = render(&factors, &lamps, &camera, &options, &Unwatched)?;

    let scale = number(&rig["radiance_to_linear"]);
    let everywhere = Plane::filled(camera.size.0, camera.size.1, 1.0);
    for (light, planes) in names.iter().zip(&rendering.lights) {
        for (k, found) in planes.bounces.iter().enumerate() {
            let truth = channel(&folder.join(format!("truth/bounce{}-{light}.exr", k + 1)), "Y")?;
            let blocks = |pixels: usize| {
                let mut found = block_means(found, &everywhere, pixels / REDUCTION);
                found.iter_mut().flatten().for_each(|value| *value *= scale);
                (found, block_means(&truth, &mask, pixels))
            };
            let (found_means, true_means) = blocks(BLOCK);
            let difference = relative_difference(&found_means, &true_means);
            let (found_large, true_large) = blocks(LARGE_BLOCK);
            let coarse = relative_difference(&found_large, &true_large);
            let bias = relative_bias(&found_means, &true_means);
            println!(
                "{name} {light} bounce {}: {:.2} %, in large blocks {:.2} %, of the mean {:+.2} %",
                k + 1,
                100.0 * difference,
                100.0 * coarse,
                100.0 * bias
            );
            assert!(difference < 0.02, "{name} {light} bounce {}: {difference}", k + 1);
            assert!(coarse < 0.015, "{name} {light} bounce {}: {coarse} in large blocks", k + 1);
            assert!(bias.abs() < 0.01, "{name} {light} bounce {}: {bias} of the mean", k + 1);
        }
    }
    let depth = block_means(&channel(&folder.join("truth/depth.exr"), "Y")?, &mask, BLOCK);
    let found = block_means(&rendering.depth_mm, &everywhere, BLOCK / REDUCTION);
    let differences: Vec<f64> = depth.iter().zip(&found).filter_map(|(a, b)| Some(((*a)? - (*b)?).abs())).collect();
    let difference_mm = differences.iter().sum::<f64>() / differences.len() as f64;
    println!("{name} depth: {difference_mm:.4} mm");
    assert!(difference_mm < 0.1, "{name}: {difference_mm} mm");
    Ok(())
}

#[test]
fn corner_bounces_match_the_path_tracer() -> Result<(), Box<dyn Error>> {
    // The set's normals lie at -25, 95 and 215 degrees about z.
    compare("corner-blue", &Shape::Corner { wall_mm: 60.0, roll_deg: -10.0 }, 1500, 0.197_916_67)
}

#[test]
fn groove_bounces_match_the_path_tracer() -> Result<(), Box<dyn Error>> {
    compare("groove-rgb", &Shape::Groove { wall_mm: 60.0, length_mm: 90.0, angle_deg: 90.0 }, 1500, 0.2)
}

#[test]
fn bowl_bounces_match_the_path_tracer() -> Result<(), Box<dyn Error>> {
    compare("bowl-four", &Shape::Bowl { radius_mm: 40.0, half_angle_deg: 90.0, rim_mm: 12.0 }, 2500, 88.0 / 360.0)
}
