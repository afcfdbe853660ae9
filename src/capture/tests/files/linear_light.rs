//! Stored values become the light that they were made from.

use std::path::PathBuf;

use firstbounce_capture::image_file::{
    Corrections, Format, ImageError, ImageFile, LinearOptions, Metadata, StoredRange, dark_frame, flat_field,
    linearise, linearise_files,
};
use firstbounce_capture::set::{Channel, Encoding};
use firstbounce_core::Plane;
use firstbounce_core::image::photo::{CLIPPED, DARK};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use tiff::encoder::Compression;

use crate::pictures::{Folder, grey16_tiff};

/// A grey file of one row.
fn grey(stored: &[f32], maximum: Option<f32>) -> ImageFile {
    rgb(&[stored], maximum)
}

fn rgb(stored: &[&[f32]], maximum: Option<f32>) -> ImageFile {
    let names: &[Channel] = if stored.len() == 1 { &[Channel::Grey] } else { &[Channel::R, Channel::G, Channel::B] };
    let plane = |values: &[f32]| Plane::from_vec(values.len(), 1, values.to_vec()).unwrap();
    ImageFile {
        path: PathBuf::from("object/left.png"),
        format: Format::Png,
        channels: names.iter().zip(stored).map(|(&name, values)| (name, plane(values))).collect(),
        stored: StoredRange { maximum },
        metadata: Metadata::default(),
        warnings: vec![],
    }
}

fn files(images: &[ImageFile]) -> impl Iterator<Item = Result<&ImageFile, ImageError>> {
    images.iter().map(Ok)
}

fn assert_light(light: &[f32], expected: &[f32]) {
    for (light, expected) in light.iter().zip(expected) {
        assert!((light - expected).abs() <= 2e-6 * expected.abs().max(0.1), "{light} is not {expected}");
    }
}

#[test]
fn the_equation_of_the_capture_format() {
    let options =
        LinearOptions { black_level: 512.0, white_level: Some(16383.0), exposure: 0.5, ..LinearOptions::default() };
    let light = linearise(
        files(&[grey(&[512.0, 8447.5, 16382.0, 16383.0, 500.0], Some(65535.0))]),
        &options,
        &Corrections::default(),
    );
    let photo = light.unwrap().photo;
    assert_light(photo.linear.data(), &[0.0, 1.0, 2.0 * 15870.0 / 15871.0, 2.0, -2.0 * 12.0 / 15871.0]);
    assert_eq!(photo.marks.data(), [DARK, 0, 0, CLIPPED, DARK]);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, rng_seed: RngSeed::Fixed(2011), ..ProptestConfig::default() })]

    /// A camera that encodes black + light (white - black), whatever the levels and the curve, is undone.
    #[test]
    fn a_camera_is_undone(
        light in 0.01_f32..0.99,
        black in 0.0_f32..20.0,
        white in 200.0_f32..255.0,
        exposure in 0.1_f32..10.0,
        encoding in prop_oneof![Just(Encoding::Linear), Just(Encoding::Srgb), (1.0..3.0).prop_map(Encoding::Gamma)],
    ) {
        let (dark, bright) = (encoding.decode(black / 255.0), encoding.decode(white / 255.0));
        let stored = 255.0 * encoding.encode(dark + light * (bright - dark));
        let options = LinearOptions { encoding: Some(encoding), black_level: black, white_level: Some(white), exposure, ..LinearOptions::default() };
        let photo = linearise(files(&[grey(&[stored], Some(255.0))]), &options, &Corrections::default()).unwrap().photo;
        prop_assert!((photo.linear.at(0, 0) - light / exposure).abs() < 1e-4 * (light + 1.0) / exposure);
        prop_assert_eq!(photo.marks.data()[0], 0);
    }
}

#[test]
fn ten_bits_of_srgb_in_a_sixteen_bit_file_decode_by_their_own_scale() {
    let options =
        LinearOptions { encoding: Some(Encoding::Srgb), white_level: Some(1023.0), ..LinearOptions::default() };
    let photo = linearise(files(&[grey(&[511.5], Some(65535.0))]), &options, &Corrections::default()).unwrap().photo;
    assert_light(photo.linear.data(), &[0.214_041]);
}

#[test]
fn repeats_are_averaged_in_linear_light_and_clip_if_one_does() {
    let options = LinearOptions { encoding: Some(Encoding::Gamma(2.0)), ..LinearOptions::default() };
    let shots = [grey(&[51.0, 255.0], Some(255.0)), grey(&[153.0, 0.0], Some(255.0))];
    let light = linearise(files(&shots), &options, &Corrections::default()).unwrap();
    assert_light(light.photo.linear.data(), &[(0.04 + 0.36) / 2.0, 0.5]);
    assert_eq!((light.photo.marks.data(), light.repeats), ([0, CLIPPED].as_slice(), 2));
}

#[test]
fn channels_are_picked_or_their_light_is_averaged() {
    let image = rgb(&[&[51.0], &[102.0], &[255.0]], Some(255.0));
    let light = |channel| {
        let options = LinearOptions { channel, ..LinearOptions::default() };
        linearise([Ok(&image)], &options, &Corrections::default()).unwrap().photo
    };
    assert_light(light(Channel::R).linear.data(), &[0.2]);
    assert_light(light(Channel::G).linear.data(), &[0.4]);
    assert_light(light(Channel::Grey).linear.data(), &[1.6 / 3.0]);
    assert_eq!(light(Channel::Grey).marks.data(), [CLIPPED], "one clipped channel spoils the mean");
    let options = LinearOptions { channel: Channel::B, ..LinearOptions::default() };
    let error = linearise(files(&[grey(&[1.0], None)]), &options, &Corrections::default()).unwrap_err();
    assert!(error.to_string().contains("no channel \"b\", only \"grey\""), "{error}");
}

#[test]
fn floats_clip_only_at_a_level_that_was_given() {
    let image = [grey(&[0.5, 1.0, 7.0], None)];
    let free = linearise(files(&image), &LinearOptions::default(), &Corrections::default()).unwrap().photo;
    assert_eq!((free.linear.data(), free.marks.count(CLIPPED)), ([0.5, 1.0, 7.0].as_slice(), 0));
    let options = LinearOptions { white_level: Some(2.0), ..LinearOptions::default() };
    let limited = linearise(files(&image), &options, &Corrections::default()).unwrap().photo;
    assert_eq!((limited.linear.at(1, 0), limited.marks.data()), (0.5, [0, 0, CLIPPED].as_slice()));
}

#[test]
fn dark_frames_and_flat_fields_are_taken_out() {
    // A sensor of four pixels: its own glow, a lens that dims the right, a scene of light 0.4, then an exposure of 2.
    let (glow, lens) = ([10.0, 20.0, 30.0, 255.0], [1.0, 0.8, 0.6, 0.4]);
    let sensor = |light: f32| -> Vec<f32> {
        glow.iter().zip(lens).map(|(glow, lens)| (glow + 200.0 * light * lens).min(255.0)).collect()
    };
    let options = LinearOptions { exposure: 2.0, ..LinearOptions::default() };
    let dark = dark_frame(files(&[grey(&glow, Some(255.0))]), &options).unwrap();
    let flat = flat_field(files(&[grey(&sensor(1.0), Some(255.0))]), &options, Some(&dark)).unwrap();
    let corrections = Corrections { dark: Some(&dark), flat: Some(&flat) };
    let photo = linearise(files(&[grey(&sensor(0.4), Some(255.0))]), &options, &corrections).unwrap().photo;
    let mean_lens = (1.0 + 0.8 + 0.6) / 3.0;
    assert_light(&photo.linear.data()[..3], &[200.0 / 255.0 * 0.4 * mean_lens / 2.0; 3]);
    assert_eq!(photo.marks.data()[..3], [0; 3]);
    assert!(photo.marks.data()[3] & CLIPPED != 0, "a pixel that clips in the dark is never good");
}

#[test]
fn a_flat_field_that_is_mostly_black_corrects_nothing() {
    let mut values = vec![0.0; 10];
    values[0] = 100.0;
    let error = flat_field(files(&[grey(&values, Some(255.0))]), &LinearOptions::default(), None).unwrap_err();
    assert!(matches!(error, ImageError::UnusableFlat { percent, .. } if (percent - 90.0).abs() < 1e-9));
}

/// Uniform noise around `mean` with the standard deviation `sigma`, from a fixed seed.
fn noisy(pixels: usize, mean: impl Fn(usize) -> f32, sigma: impl Fn(usize) -> f32, seed: u64) -> Vec<f32> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut uniform = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 40) as f32 / (1 << 24) as f32 - 0.5
    };
    (0..pixels).map(|i| mean(i) + sigma(i) * 12_f32.sqrt() * uniform()).collect()
}

#[test]
fn the_differences_between_repeats_tell_the_noise() {
    let pixels = 60_000;
    let signal = |i: usize| 0.05 + 0.9 * (i % 50) as f32 / 50.0;
    let variance = |signal: f32| 1e-5 + 4e-4 * signal;
    let shot = |seed| grey(&noisy(pixels, signal, |i| variance(signal(i)).sqrt(), seed), None);
    let light = linearise(files(&[shot(1), shot(2), shot(3)]), &LinearOptions::default(), &Corrections::default());
    let noise = light.unwrap().noise.unwrap();
    assert_eq!(noise.bins.iter().map(|bin| bin.pixels).sum::<usize>(), pixels);
    for bin in noise.bins.iter().filter(|bin| bin.pixels > 500) {
        let expected = f64::from(variance(bin.signal as f32));
        assert!((bin.variance / expected - 1.0).abs() < 0.12, "{bin:?}, expected {expected}");
    }
}

#[test]
fn repeated_dark_frames_set_where_dark_begins() {
    let sigma = 0.01;
    let dark = |seed| grey(&noisy(20_000, |_| 0.05, |_| sigma, seed), None);
    let dark = dark_frame(files(&[dark(1), dark(2)]), &LinearOptions::default()).unwrap();
    assert!((dark.noise_floor.unwrap() / sigma - 1.0).abs() < 0.03);
    let photo = grey(&vec![0.5; 20_000], None);
    let corrections = Corrections { dark: Some(&dark), flat: None };
    let light = linearise(files(&[photo.clone(), photo]), &LinearOptions::default(), &corrections).unwrap();
    assert!((light.dark_below - 3.0 * sigma / 2_f32.sqrt()).abs() < 0.001);
}

#[test]
fn options_and_sizes_are_checked() {
    let bad = |options: LinearOptions| matches!(options.check(), Err(ImageError::Option { .. }));
    let default = LinearOptions::default();
    assert!(default.check().is_ok());
    assert!(bad(LinearOptions { exposure: 0.0, ..default }));
    assert!(bad(LinearOptions { white_level: Some(5.0), black_level: 5.0, ..default }));
    assert!(bad(LinearOptions { encoding: Some(Encoding::Gamma(f64::NAN)), ..default }));
    assert!(bad(LinearOptions { dark_below: 1.0, ..default }));
    let sizes = [grey(&[1.0, 2.0], None), grey(&[1.0], None)];
    let error = linearise(files(&sizes), &default, &Corrections::default()).unwrap_err();
    assert!(matches!(error, ImageError::SizeMismatch { size: (1, 1), expected: (2, 1), .. }), "{error}");
    let none = linearise::<ImageFile>([], &default, &Corrections::default());
    assert!(matches!(none, Err(ImageError::NoFiles)));
    // A black level above what eight bits hold.
    let black = LinearOptions { black_level: 512.0, ..default };
    assert!(linearise(files(&[grey(&[1.0], Some(255.0))]), &black, &Corrections::default()).is_err());
}

#[test]
fn files_are_read_one_after_the_other() {
    let folder = Folder::new();
    let file = |name: &str, value: u16| folder.file(name, grey16_tiff(&[value; 21 * 14], Compression::Lzw));
    let paths = [file("1.tif", 13107), file("2.tif", 26214)];
    let light = linearise_files(&paths, &LinearOptions::default(), &Corrections::default()).unwrap();
    assert_light(light.photo.linear.data(), &[0.3; 21 * 14]);
}
