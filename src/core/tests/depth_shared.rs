//! Depth from the true normals of the rendered capture sets.

#![allow(clippy::unwrap_used)]

use std::path::Path;

use exr::prelude::read_first_flat_layer_from_file;
use firstbounce_core::stereo::depth::{DepthOptions, integrate};
use firstbounce_core::{Camera, Mask, NormalMap, Plane, Projection, Unwatched};
use firstbounce_testing::shared_set;

/// The channels of an EXR image by the order of `names`.
fn channels(path: &Path, names: &[&str]) -> Vec<Plane> {
    let layer = read_first_flat_layer_from_file(path).unwrap().layer_data;
    let (width, height) = (layer.size.width(), layer.size.height());
    let named = |name: &&str| layer.channel_data.list.iter().find(|channel| channel.name.eq(name)).unwrap();
    let plane = |name| Plane::from_vec(width, height, named(name).sample_data.values_as_f32().collect()).unwrap();
    names.iter().map(plane).collect()
}

/// Integrates the true normals of a set. Returns the difference to the true depth, less its mean, at each pixel that
/// has a true normal: elsewhere on the mask, at creases and rims, the truth is not known.
fn errors_mm(folder: &Path, projection: Projection) -> Vec<f64> {
    let [x, y, z]: [Plane; 3] = channels(&folder.join("truth/normals.exr"), &["R", "G", "B"]).try_into().unwrap();
    let truth = channels(&folder.join("truth/depth.exr"), &["Y"]).remove(0);
    let mask = image::open(folder.join("mask.png")).unwrap().into_luma8();
    let mask = Mask::from_fn(truth.width(), truth.height(), |x, y| mask.get_pixel(x as u32, y as u32).0[0] > 0);
    let camera = Camera { projection, size: truth.size() };
    let normals = NormalMap::from_planes(x, y, z).unwrap();
    let depth = integrate(&normals, &mask, None, &camera, &DepthOptions::default(), &Unwatched).unwrap();

    let known = |i: &usize| mask.data()[*i] && normals.at_index(*i).is_some();
    let difference = |i| f64::from(depth.depth_mm.data()[i] - truth.data()[i]);
    let mut errors: Vec<f64> = (0..truth.data().len()).filter(known).map(difference).collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    errors.iter_mut().for_each(|error| *error -= mean);
    println!("{}: rmse {:.4} mm, {:?}", folder.display(), rmse(&errors), depth.report);
    errors
}

fn rmse(errors: &[f64]) -> f64 {
    (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt()
}

fn orthographic(mm_per_pixel: f64) -> Projection {
    Projection::Orthographic { mm_per_pixel: Some(mm_per_pixel) }
}

#[test]
fn corner_blue() {
    let Some(folder) = shared_set("corner-blue") else { return };
    assert!(rmse(&errors_mm(&folder, orthographic(0.197917))) <= 0.15);
}

#[test]
fn groove_rgb() {
    let Some(folder) = shared_set("groove-rgb") else { return };
    assert!(rmse(&errors_mm(&folder, orthographic(0.2))) <= 0.15);
}

// The bowl is 40 mm deep and drops into its plate along a vertical rim; only the step across the rim is uncertain.
#[test]
fn bowl_four() {
    let Some(folder) = shared_set("bowl-four") else { return };
    assert!(rmse(&errors_mm(&folder, orthographic(0.244444))) <= 1.0);
}

// Parts of the bird bath hide others, and no normal tells how far one lies behind the other.
#[test]
fn birdbath_dslr() {
    let Some(folder) = shared_set("birdbath-dslr") else { return };
    let projection = Projection::Perspective {
        focal_length_px: 3400.0,
        principal_point_px: (240.0, 240.0),
        working_distance_mm: 1200.0,
    };
    assert!(rmse(&errors_mm(&folder, projection)) <= 4.0);
}
