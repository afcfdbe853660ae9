//! Reads a light file.

use std::path::Path;

use nalgebra::Vector3;

use super::{LightFile, LightFileError, LightFileProblem, LightLine, dome, encoding};
use crate::image_file::Format;
use crate::open::{MAX_TEXT_BYTES, read_file};

impl LightFile {
    /// Reads a light file, or a dome of Relight. Blank lines and lines that begin with `#` are passed over; line ends and
    /// encodings of every system, names with spaces or in quotes, decimal commas, semicolons between the columns, and
    /// directions of any length are taken.
    ///
    /// # Errors
    /// The path, the line, and what is wrong there.
    pub fn read(path: &Path) -> Result<Self, LightFileError> {
        let at = |line, problem| LightFileError { path: path.to_owned(), line, problem };
        let unreadable = |reason: String| at(None, LightFileProblem::Unreadable { reason });
        let bytes = read_file(path, MAX_TEXT_BYTES).map_err(|error| unreadable(error.to_string()))?;
        let text = encoding::text_of(bytes).ok_or_else(|| at(None, LightFileProblem::NotText))?;
        let file = if dome::is_dome(&text) {
            dome::parse(&text).map_err(|problem| at(None, problem))?
        } else {
            Self::parse(&text).map_err(|(line, problem)| at(line, problem))?
        };
        if file.lines.iter().all(|line| line.direction_to_light.z < 0.0) {
            return Err(at(None, LightFileProblem::PointAway));
        }
        Ok(file)
    }

    /// Reads the text of a light file; an error comes with its line.
    fn parse(text: &str) -> Result<Self, (Option<usize>, LightFileProblem)> {
        // A file of an old Macintosh has carriage returns alone.
        let text = text.replace("\r\n", "\n").replace('\r', "\n");
        let said = (1..).zip(text.lines().map(str::trim));
        let mut said = said.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let (first, count) = said.next().ok_or((None, LightFileProblem::Empty))?;
        let promised: usize =
            count.parse().map_err(|_| (Some(first), LightFileProblem::NoCount { found: shortened(count) }))?;
        let lines = said
            .map(|(number, line)| parse_line(line).map_err(|problem| (Some(number), problem)))
            .collect::<Result<Vec<_>, _>>()?;
        match lines.len() {
            found if found != promised => Err((Some(first), LightFileProblem::WrongCount { promised, found })),
            0 => Err((Some(first), LightFileProblem::Empty)),
            _ => Ok(Self { lines }),
        }
    }
}

/// A line as it is, or else with semicolons between its columns, as a table program exports it.
fn parse_line(line: &str) -> Result<LightLine, LightFileProblem> {
    let parsed = parse_columns(line);
    match parsed {
        Err(LightFileProblem::NotALight { .. }) if line.contains(';') => {
            parse_columns(&line.replace(';', " ")).or(parsed)
        }
        parsed => parsed,
    }
}

fn parse_columns(line: &str) -> Result<LightLine, LightFileProblem> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let not_a_light = || LightFileProblem::NotALight { found: shortened(line) };
    let (name, last) = words.split_at_checked(words.len().wrapping_sub(3)).ok_or_else(not_a_light)?;
    let direction: Vec<f64> = last.iter().map(|word| number(word)).collect::<Option<_>>().ok_or_else(not_a_light)?;
    // The name may hold spaces: it is all before the last three words.
    let mut file = line;
    for word in last.iter().rev() {
        file = file.strip_suffix(word).unwrap_or(file).trim_end();
    }
    let is_quoted = file.ends_with('"');
    let file = file.trim_matches('"').trim_end_matches(',').to_owned();
    if name.is_empty() || file.is_empty() {
        return Err(LightFileProblem::NoFile { found: shortened(line) });
    }
    if !is_quoted && ends_with_number(name) {
        return Err(LightFileProblem::FourNumbers { found: shortened(line) });
    }
    match unit(&Vector3::from_row_slice(&direction)) {
        Some(direction_to_light) => Ok(LightLine { file, direction_to_light }),
        None => Err(LightFileProblem::NoDirection { file, found: last.join(" ") }),
    }
}

/// A number with a decimal point or a decimal comma; a comma may also part it from the next.
fn number(word: &str) -> Option<f64> {
    let word = word.strip_suffix(',').unwrap_or(word);
    word.parse().or_else(|_| word.replacen(',', ".", 1).parse()).ok()
}

/// Whether the words before the direction end with a number that is no part of the file's name: "photo 12" is one.
fn ends_with_number(name: &[&str]) -> bool {
    let Some((last, before)) = name.split_last().filter(|(_, before)| !before.is_empty()) else { return false };
    let has_ending = before.last().is_some_and(|word| Format::of_name(Path::new(word)).is_some());
    let is_count = last.bytes().all(|byte| byte.is_ascii_digit());
    number(last).is_some() && (has_ending || !is_count)
}

/// The direction at length 1; `None` where it points nowhere.
pub(super) fn unit(direction: &Vector3<f64>) -> Option<Vector3<f64>> {
    // Divided first, so that the square of a huge number stays finite.
    (direction / direction.amax()).try_normalize(0.0).filter(|unit| unit.iter().all(|x| x.is_finite()))
}

/// Enough of a line to find it again.
fn shortened(line: &str) -> String {
    match line.char_indices().nth(60) {
        Some((end, _)) => format!("{} ...", &line[..end]),
        None => line.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    use super::*;

    #[test]
    fn a_file_of_any_editor_is_read() {
        let plain = "2\nleft.png -0.6 0 0.8\nmy photos/top 1.png 0 3 4\n";
        let expected = LightFile {
            lines: vec![
                LightLine { file: "left.png".into(), direction_to_light: Vector3::new(-0.6, 0.0, 0.8) },
                LightLine { file: "my photos/top 1.png".into(), direction_to_light: Vector3::new(0.0, 0.6, 0.8) },
            ],
        };
        for text in [
            plain.to_owned(),
            plain.replace('\n', "\r\n"),
            plain.replace('\n', "\r"),
            format!("# lights of a dome\n\n{}\n# end", plain.replace("left", "  left").replace(' ', "\t ")),
            plain.trim_end().replace("my photos/top 1.png", "\"my photos/top 1.png\""),
        ] {
            let read = LightFile::parse(&text).unwrap();
            assert_eq!(read.lines.len(), 2, "{text:?}");
            for (read, expected) in read.lines.iter().zip(&expected.lines) {
                assert_eq!(read.file.replace("\t ", " "), expected.file);
                assert!((read.direction_to_light - expected.direction_to_light).norm() < 1e-15);
            }
        }
    }

    fn read_bytes(name: &str, bytes: &[u8]) -> Result<LightFile, LightFileError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        LightFile::read(&path)
    }

    #[test]
    fn decimal_commas_and_columns_of_a_table_program_are_taken() {
        for text in [
            "2\na.png 0,6 0 0,8\nb 2.png 0,0 0,6 0,8\n",
            "2\na.png;0,6;0;0,8\nb 2.png;0,0;0,6;0,8\n",
            "2\na.png, 0.6, 0, 0.8\nb 2.png, 0.0, 0.6, 0.8\n",
        ] {
            let read = LightFile::parse(text).unwrap();
            let names: Vec<_> = read.lines.iter().map(|line| line.file.as_str()).collect();
            assert_eq!(names, ["a.png", "b 2.png"], "{text}");
            assert!((read.lines[0].direction_to_light - Vector3::new(0.6, 0.0, 0.8)).norm() < 1e-12);
            assert!((read.lines[1].direction_to_light - Vector3::new(0.0, 0.6, 0.8)).norm() < 1e-12);
        }
    }

    #[test]
    fn a_number_that_belongs_to_the_name_is_no_fourth_one() {
        for name in ["photo 12", "12", "\"photo 0.5\"", "photo 0.5.png"] {
            let read = LightFile::parse(&format!("1\n{name} 0 0.6 0.8\n")).unwrap();
            assert_eq!(read.lines[0].file, name.trim_matches('"'));
        }
    }

    #[test]
    fn files_of_old_windows_editors_are_read_in_their_encoding() {
        let text = "1\ngr\u{f6}\u{df}e \u{201e}1\u{201c}.png 0 0 1\n";
        let wide: Vec<u8> = [0xfeff].into_iter().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
        let cp1252 = b"1\r\ngr\xf6\xdfe \x841\x93.png 0 0 1\r\n".to_vec();
        let with_mark = format!("\u{feff}{text}").into_bytes();
        for bytes in [wide, cp1252, with_mark] {
            assert_eq!(read_bytes("lights.lp", &bytes).unwrap().lines[0].file, "gr\u{f6}\u{df}e \u{201e}1\u{201c}.png");
        }
        let refused = read_bytes("lights.lp", b"1\na\0b 0 0 1\n").unwrap_err();
        assert_eq!(refused.problem, LightFileProblem::NotText);
    }

    #[test]
    fn directions_that_all_point_away_from_the_camera_are_refused_with_the_remedy() {
        let refused = read_bytes("lights.lp", b"2\na 0.1 0 -0.9\nb 0 0.2 -0.9\n").unwrap_err().to_string();
        assert!(refused.contains("point away") && refused.contains("turn them"), "{refused}");
        assert!(read_bytes("lights.lp", b"2\na 0.1 0 -0.9\nb 0 0.2 0.9\n").is_ok(), "one may come from below");
    }

    #[test]
    fn a_dome_of_relight_is_read_in_its_order() {
        let dome = r#"{"label": "d", "lightConfiguration": "directional", "directions":
            [{"x": 0.6, "y": 0, "z": 0.8}, {"x": 0, "y": -0.6, "z": 0.8}]}"#;
        let read = read_bytes("my.dome", dome.as_bytes()).unwrap();
        assert_eq!(read.lines.len(), 2);
        assert!((read.lines[1].direction_to_light - Vector3::new(0.0, -0.6, 0.8)).norm() < 1e-12);
        // Written by hand, or by an older version: lists of three, positions alone.
        let positions = r#"{"positions": [[3, 0, 4], [0, 30, 40]]}"#;
        let read = read_bytes("my.dome", positions.as_bytes()).unwrap();
        assert!((read.lines[0].direction_to_light - Vector3::new(0.6, 0.0, 0.8)).norm() < 1e-12);
        for (text, words) in [
            ("{", "is no dome"),
            ("{}", "holds no light"),
            (r#"{"directions": [[0, 0, 0]]}"#, "points nowhere"),
            (r#"{"directions": [[0, "a", 1]]}"#, "is no dome"),
        ] {
            let refused = read_bytes("my.dome", text.as_bytes()).unwrap_err().to_string();
            assert!(refused.contains(words), "{text}: {refused}");
        }
    }

    #[test]
    fn bad_lines_are_named() {
        let problem = |text: &str| LightFile::parse(text).unwrap_err();
        let cases = [
            ("", None, "holds no light"),
            ("# only words\n", None, "holds no light"),
            ("0\n", Some(1), "holds no light"),
            ("left.png 0 0 1\n", Some(1), "expected the count"),
            ("# note\n3\na 0 0 1\nb 0 0 1\n", Some(2), "the count says 3, and 2 lights follow"),
            ("1\na 0 0 1\nb 0 0 1\n", Some(1), "the count says 1, and 2"),
            ("2\na 0 0 1\nb 0 0 0\n", Some(3), "the direction of b is 0 0 0, which points nowhere"),
            ("1\na nan 0 1\n", Some(2), "points nowhere"),
            ("1\n0.1 0.2 0.9\n", Some(2), "the file name is missing before '0.1 0.2 0.9'"),
            ("1\n\"\" 0.1 0.2 0.9\n", Some(2), "the file name is missing"),
            ("1\na 0.1 0.9\n", Some(2), "expected 'file x y z', found 'a 0.1 0.9'"),
            ("1\na.png 0.1 0.2 0.9 1.5\n", Some(2), "four numbers"),
            ("1\na.png 1 0 0 1\n", Some(2), "four numbers"),
            ("1\nphoto 0.3 0.1 0.2 0.9\n", Some(2), "four numbers"),
            ("1\na\n", Some(2), "expected 'file x y z'"),
        ];
        for (text, line, words) in cases {
            let (found, problem) = problem(text);
            assert!(problem.to_string().contains(words), "{text:?}: {problem}");
            assert_eq!(found, line, "{text:?}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]
        #[test]
        fn what_is_written_is_read(
            lines in prop::collection::vec(("[a-z0-9/_. -]{0,20}[a-z]", prop::array::uniform3(-1.0..1.0f64)), 1..20),
        ) {
            let line = |(file, d): (String, [f64; 3])| {
                let direction_to_light = Vector3::from(d).try_normalize(1e-3).unwrap_or_else(Vector3::z);
                LightLine { file: format!("x{file}"), direction_to_light }
            };
            let file = LightFile { lines: lines.into_iter().map(line).collect() };
            let read = LightFile::parse(&file.text()).unwrap();
            for (read, written) in read.lines.iter().zip(&file.lines) {
                prop_assert_eq!(&read.file, &written.file);
                prop_assert!((read.direction_to_light - written.direction_to_light).norm() < 1e-8);
            }
        }
    }
}
