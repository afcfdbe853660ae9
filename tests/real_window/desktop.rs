//! A desktop of one test's own: display, session bus, accessibility bus, home.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::screen_reader::ScreenReader;

/// Longer than any machine needs.
pub const PATIENCE: Duration = Duration::from_secs(180);
const SIZE: &str = "1280x800x24";

/// A process that ends with its test.
pub struct Running(pub Child);

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// What a window needs around it.
pub struct Desktop {
    display: String,
    bus_address: String,
    home: TempDir,
    _bus: Running,
    _screen: Running,
}

/// The program, running.
pub struct Program {
    pub child: Running,
    pub reader: ScreenReader,
}

impl Desktop {
    /// `None`, with a line that names the test and what to install, where one cannot be had.
    pub fn new(test: &str) -> Option<Self> {
        let skipped = |missing: &str| skip(test, missing);
        for (program, package) in [("Xvfb", "xvfb"), ("dbus-daemon", "dbus")] {
            if !is_installed(program) {
                skipped(&format!("no {program}: install {package}"));
                return None;
            }
        }
        let launcher = Path::new("/usr/share/dbus-1/services/org.a11y.Bus.service");
        if !launcher.is_file() {
            skipped("no accessibility bus: install at-spi2-core");
            return None;
        }
        let home = tempfile::tempdir().unwrap();
        let (screen, number) = answering(Command::new("Xvfb").args([
            "-displayfd",
            "1",
            "-screen",
            "0",
            SIZE,
            "-nolisten",
            "tcp",
            "-noreset",
        ]));
        let display = format!(":{number}");
        let mut bus = Command::new("dbus-daemon");
        bus.args(["--session", "--nofork", "--nopidfile", "--print-address=1"]);
        let (bus, bus_address) = answering(at_home(&mut bus, home.path()).env("DISPLAY", &display));
        Some(Self { display, bus_address, home, _bus: bus, _screen: screen })
    }

    /// Starts the program and waits for its window. `None`, with a line, where no graphics adapter can draw one.
    pub fn start(&self, test: &str, args: &[&str]) -> Option<Program> {
        let reader = ScreenReader::new(&self.bus_address);
        let mut command = Command::new(env!("CARGO_BIN_EXE_firstbounce"));
        at_home(&mut command, self.home.path()).args(args);
        command.env("DISPLAY", &self.display).env("DBUS_SESSION_BUS_ADDRESS", &self.bus_address);
        command.env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET").stderr(Stdio::piped());
        let mut program = Program { child: Running(command.spawn().unwrap()), reader };
        let since = Instant::now();
        while !program.reader.finds_program("firstbounce") {
            if let Some(said) = program.ended() {
                assert!(said.contains("no graphics driver can draw the window"), "{said}");
                skip(test, said.trim());
                return None;
            }
            assert!(since.elapsed() < PATIENCE, "the window did not open");
            std::thread::sleep(Duration::from_millis(50));
        }
        Some(program)
    }

    /// A program that acts on this display, `xdotool` for instance.
    pub fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("DISPLAY", &self.display);
        command
    }

    /// Where the program keeps what belongs to no set.
    pub fn config(&self) -> PathBuf {
        self.home.path().join("config/firstbounce")
    }

    /// A folder for the test.
    pub fn folder(&self) -> &Path {
        self.home.path()
    }
}

impl Program {
    /// What it said on its error output if it has ended.
    pub fn ended(&mut self) -> Option<String> {
        self.child.0.try_wait().unwrap()?;
        let mut said = String::new();
        self.child.0.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        Some(said)
    }

    /// How long it has worked on all cores, in hundredths of a second.
    pub fn ticks(&self) -> u64 {
        let stat = fs::read_to_string(format!("/proc/{}/stat", self.child.0.id())).unwrap();
        // After the name, which may hold spaces: utime and stime are fields 14 and 15 of all.
        let after_name = stat.rsplit(')').next().unwrap();
        after_name.split_whitespace().skip(11).take(2).map(|ticks| ticks.parse::<u64>().unwrap()).sum()
    }
}

/// Past the test's own captured output: a test that did not test must be seen.
fn skip(test: &str, missing: &str) {
    let _ = writeln!(std::io::stderr(), "{test}: skipped: {missing}");
}

fn is_installed(program: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(program).is_file())
}

fn at_home<'a>(command: &'a mut Command, home: &Path) -> &'a mut Command {
    for (variable, folder) in
        [("HOME", ""), ("XDG_CONFIG_HOME", "config"), ("XDG_DATA_HOME", "data"), ("XDG_RUNTIME_DIR", "run")]
    {
        let folder = home.join(folder);
        fs::create_dir_all(&folder).unwrap();
        command.env(variable, folder);
    }
    command.env("GSETTINGS_BACKEND", "memory").stdin(Stdio::null())
}

/// Starts a server and reads the line by which it tells where it is.
fn answering(command: &mut Command) -> (Running, String) {
    let mut server = Running(command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap());
    let mut line = String::new();
    BufReader::new(server.0.stdout.take().unwrap()).read_line(&mut line).unwrap();
    assert!(!line.trim().is_empty(), "{command:?} did not start");
    (server, line.trim().to_owned())
}
