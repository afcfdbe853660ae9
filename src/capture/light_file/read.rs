//! Reads a light file.

use std::path::Path;

use nalgebra::Vector3;

use super::{LightFile, LightFileError, LightFileProblem, LightLine};
use crate::open::{OpenError, read_text};

impl LightFile {
    /// Reads a light file. Blank lines and lines that begin with `#` are passed over; line ends of every system, a byte
    /// order mark, names with spaces or in quotes, and directions of any length are taken.
    ///
    /// # Errors
    /// The path, the line, and what is wrong there.
    pub fn read(path: &Path) -> Result<Self, LightFileError> {
        let at = |line, problem| LightFileError { path: path.to_owned(), line, problem };
        let text = read_text(path).map_err(|error| match error {
            OpenError::NotText => at(None, LightFileProblem::NotText),
            error => at(None, LightFileProblem::Unreadable { reason: error.to_string() }),
        })?;
        if text.contains('\0') {
            return Err(at(None, LightFileProblem::NotText));
        }
        Self::parse(&text).map_err(|(line, problem)| at(line, problem))
    }

    /// Reads the text of a light file; an error comes with its line.
    fn parse(text: &str) -> Result<Self, (Option<usize>, LightFileProblem)> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
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

fn parse_line(line: &str) -> Result<LightLine, LightFileProblem> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let numbers = |words: &[&str]| words.iter().map(|word| word.parse::<f64>().ok()).collect::<Option<Vec<_>>>();
    let not_a_light = || LightFileProblem::NotALight { found: shortened(line) };
    let (name, last) = words.split_at_checked(words.len().wrapping_sub(3)).ok_or_else(not_a_light)?;
    let direction = numbers(last).ok_or_else(not_a_light)?;
    // The name may hold spaces: it is all before the last three words.
    let mut file = line;
    for word in last.iter().rev() {
        file = file.strip_suffix(word).unwrap_or(file).trim_end();
    }
    let file = file.trim_matches('"').to_owned();
    if name.is_empty() || file.is_empty() {
        return Err(LightFileProblem::NoFile { found: shortened(line) });
    }
    let direction = Vector3::from_row_slice(&direction);
    // Divided first, so that the square of a huge number stays finite.
    let unit = (direction / direction.amax()).try_normalize(0.0).filter(|unit| unit.iter().all(|x| x.is_finite()));
    match unit {
        Some(direction_to_light) => Ok(LightLine { file, direction_to_light }),
        None => Err(LightFileProblem::NoDirection { file, found: last.join(" ") }),
    }
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
            format!("\u{feff}{}", plain.replace('\n', "\r\n")),
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
            ("1\na 0,1 0,2 0,9\n", Some(2), "expected 'file x y z'"),
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
