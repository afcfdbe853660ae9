//! Runs the program as the user would.

use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

/// What a run printed, and its exit code.
pub struct Ran {
    pub code: i32,
    pub out: String,
    pub err: String,
}

/// Runs `firstbounce` with these arguments in the folder `place`.
pub fn firstbounce<I: AsRef<OsStr>>(place: &Path, arguments: impl IntoIterator<Item = I>) -> Ran {
    ran(program().args(arguments).current_dir(place))
}

/// Runs `firstbounce` with these arguments where there is no display.
pub fn without_display(arguments: &[&str]) -> Ran {
    let mut program = program();
    for variable in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        program.env_remove(variable);
    }
    ran(program.args(arguments))
}

/// The same where it, and each process that it starts, may map `max_mib` of memory, where the system can hold it to that.
pub fn firstbounce_within<I: AsRef<OsStr>>(place: &Path, max_mib: u64, arguments: impl IntoIterator<Item = I>) -> Ran {
    if !cfg!(target_os = "linux") {
        return firstbounce(place, arguments);
    }
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("ulimit -v {}; exec \"$0\" \"$@\"", max_mib << 10), env!("CARGO_BIN_EXE_firstbounce")]);
    // Each thread maps memory that it does not use.
    ran(shell.args(arguments).env("RAYON_NUM_THREADS", "2").current_dir(place))
}

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_firstbounce"))
}

fn ran(command: &mut Command) -> Ran {
    let Output { status, stdout, stderr } = command.output().expect("the program starts");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("the program prints UTF-8");
    Ran { code: status.code().expect("the program ends by itself"), out: text(stdout), err: text(stderr) }
}

impl Ran {
    /// The JSON object that was printed.
    pub fn json(&self) -> Value {
        assert_eq!(self.code, 0, "{}", self.err);
        serde_json::from_str(&self.out).expect("one JSON object")
    }

    /// The one line that says why it failed.
    pub fn failure(&self) -> &str {
        assert_eq!(self.code, 1, "{}{}", self.out, self.err);
        let lines: Vec<_> = self.err.lines().filter(|line| !line.starts_with("warning: ")).collect();
        assert_eq!(lines.len(), 1, "one line, not {lines:?}");
        assert!(lines[0].starts_with("firstbounce: "), "{}", lines[0]);
        lines[0]
    }
}
