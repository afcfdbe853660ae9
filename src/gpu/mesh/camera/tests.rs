use nalgebra::Isometry3;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::*;

const SIZE: [f64; 2] = [640.0, 480.0];

fn bounds() -> Bounds {
    Bounds::new(Point3::new(-30.0, -45.0, 20.0), Point3::new(50.0, 35.0, 40.0))
}

fn lens() -> impl Strategy<Value = Lens> {
    prop_oneof![Just(Lens::Perspective), Just(Lens::Orthographic)]
}

prop_compose! {
    fn camera()(
        lens in lens(), yaw_deg in -180.0..180.0f64, pitch_deg in -90.0..90.0f64, distance in 40.0..900.0f64,
        target in prop::array::uniform3(-50.0..50.0f64),
    ) -> Camera {
        Camera { target, yaw_deg, pitch_deg, distance, lens }
    }
}

fn close(a: &Point3<f64>, b: &Point3<f64>) -> bool {
    (a - b).norm() < 1e-6
}

#[test]
fn the_named_views_look_along_the_axes() {
    let seen_from = |view| *Camera::fitted(&bounds(), view, Lens::Perspective, 1.5).axes()[2];
    let expected = [
        (StandardView::Front, Vector3::z()),
        (StandardView::Back, -Vector3::z()),
        (StandardView::Left, -Vector3::x()),
        (StandardView::Right, Vector3::x()),
        (StandardView::Top, Vector3::y()),
        (StandardView::Bottom, -Vector3::y()),
    ];
    for (view, direction) in expected {
        assert!((seen_from(view) - direction).norm() < 1e-12, "{view:?}");
    }
    let [right, up, _] = Camera::fitted(&bounds(), StandardView::Front, Lens::Perspective, 1.5).axes();
    assert!((*right - Vector3::x()).norm() < 1e-12 && (*up - Vector3::y()).norm() < 1e-12);
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn what_is_projected_and_unprojected_is_the_same_point(
        camera in camera(), x in 0.0..640.0f64, y in 0.0..480.0f64, depth in 0.0..1.0f64,
    ) {
        let frame = camera.frame(SIZE, &bounds());
        let point = frame.unproject([x, y], depth);
        let [x2, y2, depth2] = frame.project(&point).unwrap();
        prop_assert!((x2 - x).abs() < 1e-6 && (y2 - y).abs() < 1e-6 && (depth2 - depth).abs() < 1e-6);
        // The line of sight goes through it.
        let ray = frame.ray([x, y]);
        prop_assert!((point - ray.origin).cross(&ray.direction).norm() < 1e-6 * camera.distance);
    }

    #[test]
    fn orbiting_keeps_the_target_in_the_middle_and_the_eye_at_its_distance(
        camera in camera(), right in -400.0..400.0f64, up in -200.0..200.0f64,
    ) {
        let turned = camera.orbited(right, up);
        let frame = turned.frame(SIZE, &bounds());
        let [x, y, _] = frame.project(&turned.target()).unwrap();
        prop_assert!((x - 320.0).abs() < 1e-6 && (y - 240.0).abs() < 1e-6);
        prop_assert!(turned.target == camera.target && turned.distance == camera.distance);
        prop_assert!((-90.0..=90.0).contains(&turned.pitch_deg) && turned.axes()[0].y.abs() < 1e-12);
    }

    #[test]
    fn dollying_keeps_the_point_under_the_cursor(
        camera in camera(), x in 0.0..640.0f64, y in 0.0..480.0f64, depth in 0.05..0.95f64, factor in 0.5..2.0f64,
    ) {
        let before = camera.frame(SIZE, &bounds());
        let about = before.unproject([x, y], depth);
        let after = camera.dollied(factor, &about, &bounds());
        let [x2, y2, _] = after.frame(SIZE, &bounds()).project(&about).unwrap();
        prop_assert!((x2 - x).abs() < 1e-4 && (y2 - y).abs() < 1e-4, "{x2} {y2}");
        prop_assert!((after.distance / camera.distance - factor).abs() < 1e-9);
    }

    #[test]
    fn panning_moves_the_target_plane_with_the_hand(camera in camera(), dx in -200.0..200.0f64, dy in -200.0..200.0f64) {
        let held = camera.frame(SIZE, &bounds()).on_target_plane([320.0, 240.0]);
        let panned = camera.panned(dx / SIZE[1], -dy / SIZE[1]);
        let [x, y, _] = panned.frame(SIZE, &bounds()).project(&held).unwrap();
        prop_assert!((x - 320.0 - dx).abs() < 1e-6 && (y - 240.0 - dy).abs() < 1e-6);
    }

    #[test]
    fn what_is_fitted_is_all_in_sight_and_fills_the_view(lens in lens(), aspect in 0.4..2.5f64, view in 0..7usize) {
        let size = [480.0 * aspect, 480.0];
        let frame = Camera::fitted(&bounds(), StandardView::ALL[view], lens, aspect).frame(size, &bounds());
        let mut widest: f64 = 0.0;
        for corner in bounds().corners() {
            let [x, y, depth] = frame.project(&corner).unwrap();
            prop_assert!((0.0..=size[0]).contains(&x) && (0.0..=size[1]).contains(&y) && (0.0..=1.0).contains(&depth));
            let from_middle = |at: f64, length: f64| (2.0 * at / length - 1.0).abs();
            widest = widest.max(from_middle(x, size[0])).max(from_middle(y, size[1]));
        }
        prop_assert!((widest - FILLED).abs() < 1e-9, "{widest}");
    }

    #[test]
    fn the_box_around_what_was_moved_and_another_holds_both(
        shift in prop::array::uniform3(-50.0..50.0f64), turn in prop::array::uniform3(-3.0..3.0f64),
    ) {
        let motion = Isometry3::new(shift.into(), turn.into());
        let both = bounds().with(&bounds().moved(&motion));
        for corner in bounds().corners() {
            for point in [corner, motion * corner] {
                let outside = (point - both.centre()).abs() - (both.corners()[7] - both.centre());
                prop_assert!(outside.max() < 1e-9);
            }
        }
    }
}

#[test]
fn a_scale_bar_is_true_in_the_target_plane() {
    let camera = Camera::fitted(&bounds(), StandardView::Corner, Lens::Perspective, 1.5);
    let frame = camera.frame(SIZE, &bounds());
    let (left, right) = (frame.on_target_plane([100.0, 240.0]), frame.on_target_plane([200.0, 240.0]));
    assert!(((right - left).norm() - 100.0 * frame.unit_on_target()).abs() < 1e-9);
    assert!(close(&frame.on_target_plane([320.0, 240.0]), &camera.target()));
}
