//! The shader on the card against the same in plain Rust.

use std::sync::Arc;

use firstbounce::gpu::{
    CanvasMarks, CanvasPlane, ColourMap, Display, Drawing, Encoding, Layer, Output, Placement, Source, Twin, shade,
};
use firstbounce_core::image::photo;
use firstbounce_core::{Marks, Mask, Plane};

use crate::card::float_card;

const SIZE: (usize, usize) = (90, 61);
const TARGET: (u32, u32) = (160, 120);
const BACKGROUND: [f32; 3] = [0.1, 0.2, 0.3];

/// Crisp, blended, averaged, and cut off by the target's edges.
const PLACEMENTS: [Placement; 4] = [
    Placement { origin_px: [-40.0, -30.0], scale: 8.0 },
    Placement { origin_px: [3.0, 5.0], scale: 1.7 },
    Placement { origin_px: [10.0, 7.0], scale: 0.37 },
    Placement { origin_px: [100.0, 60.0], scale: 1.0 },
];

/// Light from about -0.2 to 1.3, different for every seed.
fn light(seed: u32) -> CanvasPlane {
    let phase = seed as f32;
    CanvasPlane::new(Arc::new(Plane::from_fn(SIZE.0, SIZE.1, |x, y| {
        let (x, y) = (x as f32, y as f32);
        0.55 + 0.4 * (0.21 * x + phase).sin() * (0.17 * y - 2.0 * phase).cos() + 0.004 * x - 0.003 * y
    })))
}

fn value(plane: CanvasPlane) -> Source {
    Source::plane(plane)
}

/// Compares colours to 1/255 and numbers to 1e-3 at every pixel of the target, for every placement.
fn hold_together(test: &str, source: &Source, display: &Display) {
    let Some(card) = float_card(test) else { return };
    for placement in PLACEMENTS {
        let drawing = Drawing { source, display, placement, background: BACKGROUND };
        let twin = Twin::new(drawing);
        let colours = card.draw(&drawing, Output::Colours, TARGET);
        let values = card.draw(&drawing, Output::Values, TARGET);
        for (index, (colour, value)) in colours.iter().zip(&values).enumerate() {
            let at = [index as u32 % TARGET.0, index as u32 / TARGET.0].map(|pixel| pixel as f32 + 0.5);
            for (channel, (card, twin)) in colour.iter().zip(twin.pixel(at)).enumerate() {
                assert!((card - twin).abs() <= 1.0 / 255.0, "{test}, {placement:?}, {at:?}, {channel}: {card} {twin}");
            }
            let known = twin.values(at);
            assert_eq!(value[3] == 1.0, known.is_some(), "{test}, {placement:?}, {at:?}");
            for (card, twin) in value.iter().zip(known.unwrap_or_default()) {
                let close = (card - twin).abs() <= 1e-3 * twin.abs().max(1.0) || known.is_none();
                assert!(close, "{test}, {placement:?}, {at:?}: {card} {twin}");
            }
        }
    }
}

#[test]
fn colour_maps() {
    for map in ColourMap::ALL {
        let display = Display { map, range: [-0.1, 1.1], exposure_stops: 0.5, ..Display::default() };
        hold_together("colour maps", &value(light(1)), &display);
    }
}

#[test]
fn gamma_and_linear_greys() {
    for gamma in [1.0, 2.2] {
        let display = Display { encoding: Encoding::Gamma(gamma), ..Display::default() };
        hold_together("gamma", &value(light(2)), &display);
    }
}

#[test]
fn clip_and_negative_zebra() {
    let display = Display { clip: Some(0.9), negative_zebra: true, ..Display::default() };
    hold_together("zebra", &value(light(3)), &display);
    let rgb = Source::colour([light(3), light(4), light(5)].map(Layer::from)).unwrap();
    hold_together("zebra on colours", &rgb, &display);
}

#[test]
fn marks_and_mask() {
    let mark =
        |i: usize| if i.is_multiple_of(7) { photo::CLIPPED } else { photo::DARK * u8::from(i.is_multiple_of(5)) };
    let marks = Marks::from_fn(SIZE.0, SIZE.1, |x, y| mark(y * SIZE.0 + x));
    let mask = Mask::from_fn(SIZE.0, SIZE.1, |x, y| x.abs_diff(45) + y.abs_diff(30) < 28);
    let source = value(light(6)).with_marks(CanvasMarks::new(marks)).unwrap();
    hold_together("marks and mask", &source.with_mask(CanvasMarks::of_mask(&mask)).unwrap(), &Display::default());
}

#[test]
fn bounce_planes_are_what_the_operator_says() {
    // Light that bounced once and twice, photographed in two colours: N1 = L1 + L2, N2 / alpha = beta L1 + beta^2 L2.
    let (alpha, beta) = (0.8_f32, 0.4_f32);
    let (first, second) = (light(7), light(8));
    let photo = |share: f32, gain: f32| {
        let planes = first.plane.data().iter().zip(second.plane.data());
        let data = planes.map(|(one, two)| gain * (share * one + share * share * two)).collect();
        CanvasPlane::new(Arc::new(Plane::from_vec(SIZE.0, SIZE.1, data).unwrap()))
    };
    let photos = [photo(1.0, 1.0), photo(beta, alpha)];
    let scale = beta * (1.0 - beta);
    let rows = [[-beta * beta / scale, 1.0 / (alpha * scale)], [beta / scale, -1.0 / (alpha * scale)]];
    let bounce = |row: usize| Source::value(Layer::combination(&photos, &rows[row]).unwrap()).unwrap();
    hold_together("bounce 1", &bounce(0), &Display::default());
    hold_together("bounce 2", &bounce(1), &Display::default());

    let Some(card) = float_card("bounce planes") else { return };
    let placement = Placement { origin_px: [0.0, 0.0], scale: 1.0 };
    for (row, truth) in [first, second].iter().enumerate() {
        let (source, display) = (bounce(row), Display::default());
        let drawing = Drawing { source: &source, display: &display, placement, background: BACKGROUND };
        let drawn = card.draw(&drawing, Output::Values, (96, 64));
        for y in 0..SIZE.1 {
            for x in 0..SIZE.0 {
                assert!((drawn[96 * y + x][0] - truth.plane.at(x, y)).abs() < 1e-3);
            }
        }
    }
}

#[test]
fn eight_photos_of_one_light() {
    let photos: Vec<_> = (10..18).map(light).collect();
    let weights = [2.1, -1.7, 0.9, 0.4, -0.8, 0.35, -0.2, 0.05];
    let first = Layer::combination(&photos, &weights).unwrap();
    let second = Layer::combination(&photos, &weights.map(|weight: f32| 0.3 - 0.5 * weight)).unwrap();
    hold_together("eight photos", &Source::value(first.clone()).unwrap(), &Display::default());
    hold_together("the composite", &Source::figure_one(first, second, 4.0).unwrap(), &Display::default());
}

#[test]
fn differences_and_ratios() {
    let photos = [light(20), light(21)];
    let bounce = Layer::combination(&photos, &[1.4, -0.6]).unwrap();
    let difference = Source::difference(bounce.clone(), light(22).into()).unwrap();
    hold_together("difference", &difference, &Display::signed(0.5));
    let brighter = CanvasPlane::new(Arc::new(Plane::from_fn(SIZE.0, SIZE.1, |x, _| 1.0 + 0.01 * x as f32)));
    let display = Display { map: ColourMap::Turbo, range: [0.0, 2.0], ..Display::default() };
    hold_together("ratio", &Source::ratio(bounce, brighter.into()).unwrap(), &display);
}

#[test]
fn normals_and_pixels_without_a_value() {
    let normal = |component: usize| {
        CanvasPlane::new(Arc::new(Plane::from_fn(SIZE.0, SIZE.1, |x, y| {
            let (across, up) = (x as f32 / 45.0 - 1.0, 1.0 - y as f32 / 30.5);
            let out = (1.0 - across * across - up * up).max(0.0).sqrt();
            // Outside the ball there is no normal.
            if out == 0.0 { f32::NAN } else { [across, up, out][component] }
        })))
    };
    hold_together("normals", &Source::normals([0, 1, 2].map(normal)).unwrap(), &Display::default());
}

#[test]
fn a_picture_larger_than_the_textures_is_shown_at_a_stated_resolution() {
    let Some(card) = float_card("larger than the textures") else { return };
    let (source, display) = (value(light(30)), Display::default());
    let placement = Placement { origin_px: [0.0, 0.0], scale: 0.5 };
    let drawing = Drawing { source: &source, display: &display, placement, background: BACKGROUND };
    let (limited, resolution) = card.draw_limited(&drawing, (48, 32), 64);
    assert_eq!((resolution.divisor, resolution.loading), (2, false));
    // At half size the picture is the same: the copy at half the resolution is what is drawn anyway.
    assert_eq!(limited, card.draw(&drawing, Output::Values, (48, 32)));
}

#[test]
fn the_old_numbers_of_a_large_picture_stay_until_the_new_ones_are_complete() {
    let Some(card) = float_card("a large picture") else { return };
    let filled = |value: f32| Arc::new(Plane::filled(1400, 1000, value));
    let old = CanvasPlane::new(filled(0.25));
    let new = CanvasPlane { key: old.key.next_version(), plane: filled(0.75) };
    let display = Display::default();
    let placement = Placement { origin_px: [0.0, 0.0], scale: 1.0 };
    let all_are = |drawn: &[[f32; 4]], value: f32| drawn.iter().all(|pixel| pixel[0] == value && pixel[3] == 1.0);
    let drawings = |plane: &CanvasPlane| {
        let source = Source::plane(plane.clone());
        let drawing = Drawing { source: &source, display: &display, placement, background: BACKGROUND };
        card.draw_until_loaded(&drawing, (48, 32))
    };
    assert!(drawings(&old).iter().all(|(drawn, _)| all_are(drawn, 0.25)));
    for (drawn, resolution) in drawings(&new) {
        assert!(all_are(&drawn, if resolution.loading { 0.25 } else { 0.75 }));
    }
}

#[test]
fn a_whole_pixel_has_the_colour_that_the_card_gives_it() {
    let Some(card) = float_card("a whole pixel") else { return };
    let (source, display) = (value(light(31)), Display { map: ColourMap::Viridis, ..Display::default() });
    let placement = Placement { origin_px: [0.0, 0.0], scale: 1.0 };
    let drawing = Drawing { source: &source, display: &display, placement, background: [0.0; 3] };
    let drawn = card.draw(&drawing, Output::Colours, (96, 64));
    for (x, y) in [(0, 0), (17, 40), (89, 60), (90, 60)] {
        for (card, twin) in drawn[96 * y + x].iter().zip(shade(&source, &display, (x, y), [0.0; 3])) {
            assert!((255.0 * card - f32::from(twin)).abs() <= 1.0);
        }
    }
}
