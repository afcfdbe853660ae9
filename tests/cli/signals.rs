//! Ctrl-C, and a second one.

use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process};

/// Longer than any machine needs.
const PATIENCE: Duration = Duration::from_secs(60);
/// Long enough for a process to begin its work, and to see a signal.
const A_MOMENT: Duration = Duration::from_millis(700);

struct Running(Child);

impl Running {
    fn start(place: &Path, arguments: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_firstbounce"));
        command.args(arguments).current_dir(place).stdout(Stdio::piped()).stderr(Stdio::piped());
        let running = Self(command.spawn().unwrap());
        std::thread::sleep(A_MOMENT);
        running
    }

    fn signal(&self, signal: Signal) {
        kill_process(Pid::from_child(&self.0), signal).unwrap();
    }

    fn is_at_work(&mut self) -> bool {
        self.0.try_wait().unwrap().is_none()
    }

    /// Its exit code and its error output; the code is `None` where a signal killed it.
    fn ended(mut self) -> (Option<i32>, String) {
        let since = Instant::now();
        while self.is_at_work() {
            assert!(since.elapsed() < PATIENCE, "it did not end");
            std::thread::sleep(Duration::from_millis(20));
        }
        let said = std::io::read_to_string(self.0.stderr.take().unwrap()).unwrap();
        (self.0.wait().unwrap().code(), said)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn the_first_ctrl_c_cancels_in_order_whatever_runs_long() {
    let long: [&[&str]; 2] = [
        &["paper", "--size", "1500", "--out", "paper.html"],
        &["simulate", "corner", "--patches", "20000", "--pixels", "2000", "--out", "set"],
    ];
    for arguments in long {
        for signal in [Signal::INT, Signal::TERM] {
            let place = tempfile::tempdir().unwrap();
            let mut run = Running::start(place.path(), arguments);
            assert!(run.is_at_work(), "{arguments:?} is over too soon for this test");
            run.signal(signal);
            let (code, said) = run.ended();
            assert_eq!((code, said.lines().count()), (Some(1), 1), "{arguments:?}: {said}");
            assert!(said.contains("cancelled"), "{arguments:?}: {said}");
            assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 0, "{arguments:?} left something behind");
        }
    }
}

/// A set of so many shots that `info` prints more than a pipe holds, and waits for its reader for ever.
fn set_of_many_shots(place: &Path) {
    let mut file = std::fs::File::create(place.join("capture.toml")).unwrap();
    writeln!(file, "schema = 1\n\n[camera]\nprojection = \"orthographic\"\n\n[[colour]]\nname = \"blue\"").unwrap();
    // As many lights as a set may have, with long names.
    for light in (0..1000).map(|light| format!("{light:060}")) {
        writeln!(file, "\n[[light]]\nname = \"{light}\"").unwrap();
        writeln!(
            file,
            "\n[[shot]]\nsubject = \"object\"\nlight = \"{light}\"\ncolour = \"blue\"\nfiles = [\"none.png\"]"
        )
        .unwrap();
    }
}

#[test]
fn a_second_ctrl_c_ends_a_run_that_is_deaf_to_the_first() {
    for second in [Signal::INT, Signal::TERM] {
        let place = tempfile::tempdir().unwrap();
        set_of_many_shots(place.path());
        let mut run = Running::start(place.path(), &["info", ".", "--json"]);
        run.signal(Signal::INT);
        std::thread::sleep(A_MOMENT);
        assert!(run.is_at_work(), "{:?}", run.ended());
        run.signal(second);
        let (code, said) = run.ended();
        assert_eq!(code, Some(130), "{said}");
    }
}
