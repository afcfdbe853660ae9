//! Random sets and texts.

use std::path::Path;

use indexmap::IndexMap;
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::RngSeed;

use super::{FULL, parse};
use crate::set::{
    Calibration, Camera, CaptureSet, Circle, Colour, Encoding, Light, Projection, Reading, Separation, ShapeSettings,
    Shot, Sphere, Subject, Truth, Word, update_text, write_calibration,
};

fn word<W: Word + std::fmt::Debug>() -> impl Strategy<Value = W> {
    select(W::ALL)
}

fn text() -> impl Strategy<Value = String> {
    prop_oneof!["[a-z]{1,6}", "\\PC{0,8}", any::<String>()]
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-1e4..1e4, proptest::num::f64::NORMAL | proptest::num::f64::ZERO, (-9i32..9).prop_map(f64::from)]
}

fn vector() -> impl Strategy<Value = [f64; 3]> {
    [number(), number(), number()]
}

fn encoding() -> impl Strategy<Value = Encoding> {
    prop_oneof![Just(Encoding::Linear), Just(Encoding::Srgb), number().prop_map(Encoding::Gamma)]
}

fn camera() -> impl Strategy<Value = Camera> {
    let orthographic = option::of(number()).prop_map(|mm_per_pixel| Projection::Orthographic { mm_per_pixel });
    let perspective = (number(), option::of([number(), number()]), number()).prop_map(
        |(focal_length_px, principal_point, working_distance_mm)| Projection::Perspective {
            focal_length_px,
            principal_point,
            working_distance_mm,
        },
    );
    let projection = prop_oneof![orthographic, perspective];
    let projection = (projection, option::of([number(), number(), number(), number()]));
    let levels = (
        number(),
        option::of(number()),
        option::of(number()),
        option::of(number()),
        option::of(vec(vec(number(), 0..3), 0..3)),
    );
    (projection, option::of(encoding()), option::of(text()), levels).prop_map(
        |((projection, distortion), encoding, layer, (black_level, white_level, well, noise, crosstalk))| Camera {
            projection,
            distortion: distortion.filter(|_| matches!(projection, Projection::Perspective { .. })),
            encoding,
            layer,
            black_level,
            white_level,
            full_well_electrons: well,
            read_noise_electrons: noise,
            crosstalk,
        },
    )
}

fn shot() -> impl Strategy<Value = Shot> {
    let names = (option::of(text()), option::of(text()));
    let exposures = (option::of(number()), vec(number(), 0..3));
    (word::<Subject>(), names, vec(text(), 0..3), exposures, (option::of(encoding()), option::of(text()))).prop_map(
        |(subject, (light, colour), files, (exposure, exposures), (encoding, layer))| Shot {
            subject,
            light,
            colour,
            files,
            exposure,
            exposures,
            encoding,
            layer,
        },
    )
}

fn sphere() -> impl Strategy<Value = Sphere> {
    let outline = ([number(), number()], number());
    (word(), word(), outline, option::of(number())).prop_map(|(subject, kind, (centre, radius), diameter_mm)| Sphere {
        subject,
        kind,
        circle: Circle { centre, radius },
        diameter_mm,
    })
}

fn by_light<T: std::fmt::Debug>(value: impl Strategy<Value = T>) -> impl Strategy<Value = IndexMap<String, T>> {
    vec((text(), value), 0..3).prop_map(|pairs| pairs.into_iter().collect())
}

fn calibration() -> impl Strategy<Value = Calibration> {
    let numbers = || vec(number(), 0..3);
    let scale = (option::of(number()), option::of(number()));
    (option::of(numbers()), by_light(numbers()), by_light(vector()), by_light(number()), scale).prop_map(
        |(beta, alpha, direction, intensity, (grey_albedo, white_light))| Calibration {
            beta,
            alpha,
            direction,
            intensity,
            grey_albedo,
            white_light,
        },
    )
}

fn shape() -> impl Strategy<Value = ShapeSettings> {
    (vec(text(), 0..3), number(), number(), 0usize..200, 0usize..200, word()).prop_map(
        |(leave_out, shadow_share, misfit_share, rounds, indirect_window_px, paint)| ShapeSettings {
            paint,
            leave_out,
            shadow_share,
            misfit_share,
            rounds,
            indirect_window_px,
        },
    )
}

/// Any set at all, right or wrong.
fn set() -> impl Strategy<Value = CaptureSet> {
    let colour = (text(), word()).prop_map(|(name, channel)| Colour { name, channel });
    let light = (text(), option::of(vector()), option::of(vector())).prop_map(|(name, direction, position_mm)| Light {
        name,
        direction,
        position_mm,
    });
    let lists = (vec(colour, 0..3), vec(light, 0..3), vec(shot(), 0..5), vec(sphere(), 0..3));
    let truth = (text(), text(), text()).prop_map(|(normals, depth, bounce)| Truth { normals, depth, bounce });
    let separation =
        (option::of(word()), option::of(0usize..9)).prop_map(|(method, bounces)| Separation { method, bounces });
    let rest = (calibration(), separation, shape(), truth);
    (text(), option::of(text()), camera(), lists, rest).prop_map(
        |(name, mask, camera, (colours, lights, shots, spheres), (calibration, separation, shape, truth))| CaptureSet {
            folder: "set".into(),
            name,
            mask,
            camera,
            colours,
            lights,
            shots,
            spheres,
            calibration,
            separation,
            shape,
            truth,
        },
    )
}

fn read(text: &str) -> Reading {
    Reading::of(text, Path::new("set/capture.toml"))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, rng_seed: RngSeed::Fixed(20), ..ProptestConfig::default() })]

    #[test]
    fn what_is_written_is_what_is_read(set in set()) {
        let reading = read(&set.to_toml());
        prop_assert!(reading.complete, "{:?}", reading.problems);
        prop_assert_eq!(&reading.set, &set);
        prop_assert_eq!(reading.problems.len(), set.check().len());
    }

    #[test]
    fn a_save_over_any_other_set_says_the_new_one(old in set(), new in set()) {
        let text = update_text(&old.to_toml(), &new);
        prop_assert_eq!(&read(&text).set, &new);
        prop_assert_eq!(update_text(&text, &new), text);
    }

    #[test]
    fn a_shuffled_thinned_set_keeps_what_it_says(
        order in Just((0..9usize).collect::<Vec<_>>()).prop_shuffle(), keep in 0..9usize,
    ) {
        let mut set = parse(FULL);
        set.shots = order.iter().take(keep).map(|index| set.shots[*index].clone()).collect();
        let text = update_text(FULL, &set);
        prop_assert_eq!(read(&text).set, set);
        prop_assert!(text.contains("# A second lamp colour"));
    }

    #[test]
    fn any_text_is_read_or_refused(text in any::<String>()) {
        let _ = read(&text);
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in vec(any::<u8>(), 0..200)) {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("capture.toml"), bytes).unwrap();
        prop_assert!(CaptureSet::open(folder.path()).is_err());
    }

    #[test]
    fn a_file_with_a_piece_cut_out_or_put_elsewhere_is_read_or_refused_with_lines(
        from in any::<Index>(), length in 0..80usize, to in any::<Index>(), insert in any::<bool>(),
    ) {
        let mut characters: Vec<char> = FULL.chars().collect();
        let from = from.index(characters.len());
        let piece: Vec<char> = characters.drain(from..(from + length).min(characters.len())).collect();
        if insert {
            let to = to.index(characters.len());
            characters.splice(to..to, piece);
        }
        let text: String = characters.into_iter().collect();
        let lines = text.lines().count();
        let reading = read(&text);
        for problem in &reading.problems {
            prop_assert!(!problem.to_string().contains('\n'));
            prop_assert!(problem.position.is_none_or(|position| (1..=lines + 1).contains(&position.line)));
        }
        prop_assert_eq!(read(&update_text(&text, &reading.set)).set, reading.set);
        let _ = write_calibration(&text, &parse(FULL).calibration, &[]);
    }
}

#[test]
fn a_text_nested_without_end_is_refused() {
    for (open, close) in [("[", "]"), ("{ a = ", " }"), ("a.", "")] {
        let deep = 20_000;
        let text = if open == "a." {
            format!("{}a = 1", open.repeat(deep))
        } else {
            format!("schema = {}1{}", open.repeat(deep), close.repeat(deep))
        };
        let reading = read(&text);
        assert!(!reading.problems.is_empty());
        assert_eq!(read(&update_text(&text, &parse(FULL))).set, parse(FULL));
    }
    let header = format!("[{}a]\n", "a.".repeat(20_000));
    assert!(!read(&header).problems.is_empty());
}
