//! Circles and calibration on the rendered sets and the real photos in ../shared/data, against what the render used.

mod shared_sets;

use firstbounce_core::ball::{Circle, CircleOptions, find_circle, refine_circle};
use shared_sets::{CAT_LAMPS, SETS, Set, cat_mirror, shared_data};

#[test]
fn balls_are_found_without_a_click() {
    let Some(data) = shared_data() else { return };
    for set in SETS {
        for subject in ["grey-sphere", "material-sphere"] {
            for colour in 0..set.colours.len() {
                let photos: Vec<_> = set.lights.iter().map(|light| set.photo(&data, subject, light, colour)).collect();
                let planes: Vec<_> = photos.iter().map(|p| &p.linear).collect();
                let mut sets = vec![planes.clone()];
                sets.extend(planes.iter().map(|p| vec![*p]));
                for planes in sets {
                    for click in [None, Some((set.centre_px + 30.0, set.centre_px - 20.0))] {
                        let t = std::time::Instant::now();
                        match find_circle(&planes, click, &CircleOptions::default()) {
                            Ok(found) => println!(
                                "{} {subject} {colour} n={} click {} c {:.3} {:.3} r {:.3} sd {:.3} rms {:.3} seen {:.2} used {} refused {} {:?}",
                                set.name,
                                planes.len(),
                                click.is_some(),
                                found.circle.centre_px.0 - set.centre_px,
                                found.circle.centre_px.1 - set.centre_px,
                                found.circle.radius_px - set.radius_px,
                                found.sd_px,
                                found.residual_rms_px,
                                found.rim_seen,
                                found.points_used,
                                found.points_refused,
                                t.elapsed()
                            ),
                            Err(e) => println!("{} {subject} {colour} n={} ERR {e}", set.name, planes.len()),
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn cat() {
    let Some(data) = shared_data() else { return };
    let photos: Vec<_> = (1..=CAT_LAMPS).map(|lamp| cat_mirror(&data, lamp)).collect();
    let all: Vec<_> = photos.iter().map(|p| &p.linear).collect();
    let mut sets = vec![all.clone()];
    sets.extend(all.iter().map(|p| vec![*p]));
    for s in &sets {
        for click in [None, Some((450.0, 600.0))] {
            let t = std::time::Instant::now();
            println!(
                "{} {:?} {:?} {:?}",
                s.len(),
                click,
                find_circle(s, click, &CircleOptions::default()).map(|f| (
                    f.circle,
                    f.sd_px,
                    f.residual_rms_px,
                    f.rim_seen,
                    f.points_used,
                    f.points_refused
                )),
                t.elapsed()
            );
        }
    }
    println!(
        "{:?}",
        refine_circle(&all, &Circle { centre_px: (560., 460.), radius_px: 390. }, &CircleOptions::default())
    );
}
