//! Without a display the program says so in one line, and names what works.

use std::process::Command;

fn without_display(args: &[&str]) -> (Option<i32>, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_firstbounce"));
    for variable in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(variable);
    }
    let output = command.args(args).output().expect("the program runs");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
#[cfg(all(unix, not(target_os = "macos")))]
fn a_window_without_a_display_is_one_line_and_exit_code_1() {
    let demo = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/demo");
    for args in [vec![], vec!["open", demo]] {
        let (code, said) = without_display(&args);
        assert_eq!(code, Some(1), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(said.contains("no display") && said.contains("firstbounce solve SET"), "{said}");
    }
}
