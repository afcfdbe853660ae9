//! Decoding in a process of its own, whose memory and time have an end.
//!
//! An allocation that fails ends a process, and no guard helps; so the decoders that no check of sizes can bound run in
//! a child: the program itself, started with [`DECODE_COMMAND`]. The child finds the file on its standard input, limits
//! itself, and writes one line of JSON and the samples of each plane, as little-endian f32, to its standard output.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Condvar, Mutex, OnceLock, PoisonError, mpsc};
use std::thread::{self, available_parallelism};
use std::time::Duration;

use firstbounce_core::Plane;
use serde::{Deserialize, Serialize};

use super::head::{Opened, PictureSize};
use super::raw::{self, Facts};
use super::read::{BYTE_LIMIT, Decoded, Source};
use super::{Channel, ImageError, Metadata, StoredRange};

/// The first argument of a child.
pub const DECODE_COMMAND: &str = "decode-picture";

/// What a program takes before it decodes anything, and more than the blocks of any picture need.
const SPARE_BYTES: u64 = 512 << 20;
/// For a picture of no size, and samples that the slowest decoder surely makes in a second.
const SPARE_SECONDS: u64 = 3;
const SAMPLES_PER_SECOND: u64 = 2_000_000;
/// The child's own limit counts the time that it computes; others may compute as well.
const WAITED_SECONDS_PER_SECOND: u64 = 4;
/// The longest first line of an answer.
const MAX_REPLY_BYTES: u64 = 64 << 10;

static PROGRAM: OnceLock<PathBuf> = OnceLock::new();

/// Names the program that decodes in a process of its own: it calls [`decode_for_parent`] for [`DECODE_COMMAND`].
/// Until it is named all pictures are decoded in this process.
pub fn decode_in(program: PathBuf) {
    // The first name stays: there is one program.
    let _ = PROGRAM.set(program);
}

pub(super) fn program() -> Option<&'static Path> {
    PROGRAM.get().map(PathBuf::as_path)
}

/// What a child may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DecodeLimits {
    /// The most memory that it may map.
    pub memory_bytes: u64,
    /// The most seconds that it may compute.
    pub seconds: u64,
}

impl DecodeLimits {
    fn of(source: &Source, PictureSize { width, height, channels }: PictureSize) -> Self {
        let samples = (width as u64).saturating_mul(height as u64).saturating_mul(channels as u64);
        Self {
            // The samples as they are stored, in between, and as f32.
            memory_bytes: SPARE_BYTES
                .saturating_add(2 * source.length as u64)
                .saturating_add(samples.saturating_mul(16)),
            seconds: SPARE_SECONDS + samples / SAMPLES_PER_SECOND,
        }
    }
}

/// The first line of an answer.
#[derive(Serialize, Deserialize)]
enum Reply {
    /// Grey, or red, green and blue follow.
    Planes {
        width: usize,
        height: usize,
        count: usize,
        maximum: Option<f32>,
    },
    /// Of a camera raw file.
    Facts {
        width: usize,
        height: usize,
        channels: usize,
        metadata: Metadata,
    },
    Damaged(String),
    Unsupported(String),
    TooLarge {
        width: usize,
        height: usize,
    },
    NoLayer {
        present: Vec<String>,
    },
}

/// Decodes a picture in a child. What becomes of the child is an error of the picture.
pub(super) fn decode(
    program: &Path,
    opened: &mut Opened,
    size: PictureSize,
    layer: Option<&str>,
) -> Result<Decoded, ImageError> {
    match ask(program, opened, size, &Wanted::Pixels { layer })? {
        (Reply::Planes { maximum, .. }, channels) => Ok(Decoded::of(channels, StoredRange { maximum })),
        (reply, _) => Err(refusal(opened, reply, layer)),
    }
}

/// What the decoder of a camera raw file says before it decodes pixels.
pub(super) fn facts(program: &Path, opened: &mut Opened) -> Result<Facts, ImageError> {
    let size = opened.source.largest_raw();
    match ask(program, opened, size, &Wanted::Facts)? {
        (Reply::Facts { width, height, channels, metadata }, _) => {
            Ok(Facts::of(PictureSize { width, height, channels }, metadata))
        }
        (reply, _) => Err(refusal(opened, reply, None)),
    }
}

/// What a child is asked for.
enum Wanted<'a> {
    Pixels { layer: Option<&'a str> },
    Facts,
}

fn ask(
    program: &Path,
    opened: &mut Opened,
    size: PictureSize,
    wanted: &Wanted,
) -> Result<(Reply, Channels), ImageError> {
    let (source, format) = (opened.source, opened.format);
    let limits = DecodeLimits::of(&source, size);
    let file = opened.rewound()?.try_clone().map_err(|error| source.unreadable(error))?;
    let _turn = Turn::wait();
    let mut child = start(program, file, limits, wanted).map_err(|error| {
        source.unreadable(format_args!("its decoder {} does not start: {error}", program.display()))
    })?;
    let reply = answer(&mut child, size, Duration::from_secs(limits.seconds * WAITED_SECONDS_PER_SECOND));
    // It has answered, or never will.
    let _ = child.kill();
    let _ = child.wait();
    reply.ok_or_else(|| source.damaged(format, "its decoder took more memory or time than such a picture needs"))
}

fn refusal(opened: &Opened, reply: Reply, layer: Option<&str>) -> ImageError {
    let (source, format) = (opened.source, opened.format);
    match reply {
        Reply::Planes { .. } | Reply::Facts { .. } => source.damaged(format, "its decoder answers another question"),
        Reply::Damaged(reason) => source.damaged(format, reason),
        Reply::Unsupported(what) => source.unsupported(format, what),
        Reply::TooLarge { width, height } => source.too_large(width, height),
        Reply::NoLayer { present } => {
            ImageError::NoLayer { path: source.path.to_path_buf(), wanted: layer.map(str::to_string), present }
        }
    }
}

fn start(program: &Path, file: File, limits: DecodeLimits, wanted: &Wanted) -> io::Result<Child> {
    let mut command = Command::new(program);
    command.arg(DECODE_COMMAND).arg(limits.memory_bytes.to_string()).arg(limits.seconds.to_string());
    match wanted {
        Wanted::Pixels { layer } => command.args(layer.map(|layer| format!("--layer={layer}"))),
        Wanted::Facts => command.arg("--facts"),
    };
    // Each thread maps memory of its own.
    command.env("RAYON_NUM_THREADS", "1");
    command.stdin(file).stdout(Stdio::piped()).stderr(Stdio::null()).spawn()
}

type Channels = Vec<(Channel, Plane)>;

/// Waits for the child's answer; `None` if it makes none in time, or none that can be true.
fn answer(child: &mut Child, size: PictureSize, most: Duration) -> Option<(Reply, Channels)> {
    let stdout = child.stdout.take()?;
    let (done, wait) = mpsc::channel();
    thread::scope(|scope| {
        let reading = scope.spawn(move || {
            let answer = read_answer(stdout, size);
            // The other end waits, or has given up.
            let _ = done.send(());
            answer
        });
        if wait.recv_timeout(most).is_err() {
            let _ = child.kill();
        }
        reading.join().ok()?
    })
}

fn read_answer(output: impl Read, size: PictureSize) -> Option<(Reply, Channels)> {
    let mut output = BufReader::new(output);
    let mut line = Vec::new();
    output.by_ref().take(MAX_REPLY_BYTES).read_until(b'\n', &mut line).ok()?;
    let reply = serde_json::from_slice(&line).ok()?;
    let Reply::Planes { width, height, count, .. } = reply else { return Some((reply, vec![])) };
    let names: &[Channel] = if count == 1 { &[Channel::Grey] } else { &[Channel::R, Channel::G, Channel::B] };
    if width == 0 || count != names.len() || width.checked_mul(height)? > size.width * size.height {
        return None;
    }
    let read = |&name| Some((name, read_plane(&mut output, width, height)?));
    let channels = names.iter().map(read).collect::<Option<_>>()?;
    Some((reply, channels))
}

fn read_plane(output: &mut impl Read, width: usize, height: usize) -> Option<Plane> {
    let mut plane = Plane::filled(width, height, 0.0);
    let mut bytes = vec![0; width * size_of::<f32>()];
    for row in plane.data_mut().chunks_exact_mut(width) {
        output.read_exact(&mut bytes).ok()?;
        row.iter_mut().zip(bytes.as_chunks().0).for_each(|(value, bytes)| *value = f32::from_le_bytes(*bytes));
    }
    Some(plane)
}

/// The child's work: decodes the picture that is `input`, or reads no more than the `facts` of a camera raw file, and writes
/// the answer to `output`. The limits are the caller's to set before.
///
/// # Errors
/// What the system says where the answer cannot be read or written.
pub fn decode_for_parent(layer: Option<&str>, facts: bool, input: impl Read, mut output: impl Write) -> io::Result<()> {
    let mut bytes = Vec::new();
    input.take(BYTE_LIMIT as u64).read_to_end(&mut bytes)?;
    let source = Source { path: Path::new(""), length: bytes.len() };
    let answer = if facts { raw_facts(&source, &bytes) } else { pixels(&source, &bytes, layer) };
    let (reply, channels) = answer.unwrap_or_else(|error| (refused(error), Vec::new()));
    serde_json::to_writer(&mut output, &reply)?;
    output.write_all(b"\n")?;
    for (_, plane) in &channels {
        for row in plane.data().chunks(plane.width()) {
            output.write_all(row.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<_>>().as_slice())?;
        }
    }
    output.flush()
}

fn raw_facts(source: &Source, bytes: &[u8]) -> Result<(Reply, Channels), ImageError> {
    let Facts { size: PictureSize { width, height, channels }, metadata } = raw::facts(source, bytes)?;
    Ok((Reply::Facts { width, height, channels, metadata }, Vec::new()))
}

fn pixels(source: &Source, bytes: &[u8], layer: Option<&str>) -> Result<(Reply, Channels), ImageError> {
    let format = source.format(io::Cursor::new(bytes))?;
    let Decoded { channels, stored, .. } = format.read(source, bytes, layer)?;
    let (width, height) = channels.first().map_or((0, 0), |(_, plane)| plane.size());
    Ok((Reply::Planes { width, height, count: channels.len(), maximum: stored.maximum }, channels))
}

/// An error as an answer.
fn refused(error: ImageError) -> Reply {
    match error {
        ImageError::Unsupported { what, .. } => Reply::Unsupported(what),
        ImageError::Damaged { reason, .. } => Reply::Damaged(reason),
        ImageError::TooLarge { width, height, .. } => Reply::TooLarge { width, height },
        ImageError::NoLayer { present, .. } => Reply::NoLayer { present },
        other => Reply::Damaged(other.to_string()),
    }
}

/// The children at work: at most as many as there are cores.
static AT_WORK: Mutex<usize> = Mutex::new(0);
static ENDED: Condvar = Condvar::new();

/// Leave to run a child; the next may once it is dropped.
struct Turn;

impl Turn {
    fn wait() -> Self {
        let most = available_parallelism().map_or(1, usize::from);
        let at_work = AT_WORK.lock().unwrap_or_else(PoisonError::into_inner);
        let mut at_work = ENDED.wait_while(at_work, |at_work| *at_work >= most).unwrap_or_else(PoisonError::into_inner);
        *at_work += 1;
        Self
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        *AT_WORK.lock().unwrap_or_else(PoisonError::into_inner) -= 1;
        ENDED.notify_one();
    }
}
