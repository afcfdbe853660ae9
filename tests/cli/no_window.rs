//! Without a window the program says so in one line, and names what works.

use crate::run::without_display;

#[cfg_attr(any(not(unix), target_os = "macos"), ignore = "there a display has no variable")]
#[test]
fn without_a_window_or_a_display_for_it_there_is_one_line_and_exit_code_1() {
    let demo = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/demo");
    let reason = if cfg!(feature = "window") { "there is no display" } else { "this build has no window" };
    for args in [vec![], vec!["open", demo]] {
        let line = without_display(&args).failure().to_owned();
        assert!(line.contains(reason) && line.contains("firstbounce solve SET"), "{line}");
    }
}

#[cfg(not(feature = "window"))]
#[test]
fn a_demo_in_a_build_without_a_window_ends_with_its_results() {
    let place = tempfile::tempdir().unwrap();
    assert_eq!(crate::run::firstbounce(place.path(), ["demo"]).code, 0);
    assert!(place.path().join("out/demo/report.html").is_file());
}
