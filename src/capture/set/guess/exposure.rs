//! Exposures in the names of files: `left-blue-1-60`, `left-blue_0.5s`, `left-blue_+2EV`.

use std::sync::LazyLock;

use regex::Regex;

/// Denominators of the exposure times that cameras have.
const DENOMINATORS: [u32; 47] = [
    2, 3, 4, 5, 6, 8, 10, 13, 15, 20, 25, 30, 40, 45, 50, 60, 80, 90, 100, 120, 125, 160, 180, 200, 240, 250, 320, 350,
    400, 500, 640, 750, 800, 1000, 1250, 1500, 1600, 2000, 2500, 3000, 3200, 4000, 5000, 6000, 6400, 8000, 16000,
];

/// Repeats are counted without gaps, but for one that was left out.
const LARGEST_GAP: u64 = 2;

/// Two numbers at the end of a name: a fraction of a second, or a light and a repeat.
static PAIR: LazyLock<Option<Regex>> =
    LazyLock::new(|| Regex::new(r"(?:^|[-_ ,])(?<written>(?<first>\d+)[-_](?<second>\d+))$").ok());

/// What can be nothing but an exposure, between separators.
static CERTAIN: LazyLock<Option<Regex>> = LazyLock::new(|| {
    let number = r"\d+(?:[.,]\d+)?";
    let forms = [
        r"1[-_]\d+ ?s(?:ec)?".to_owned(),
        format!("{number} ?(?:s|sec|ms|us|µs)"),
        format!("[-+]?{number} ?ev|ev ?[-+]?{number}"),
        r"\+\d+".into(),
        r"(?:exp|exposure|hdr|bracket|belichtung)[-_ ]?\d+".into(),
        r"iso ?\d+".into(),
    ];
    Regex::new(&format!(r"(?i)(?:^|[-_ ,])(?<written>{})(?:$|[-_ ,])", forms.join("|"))).ok()
});

/// Whether the pairs of numbers that end some names are fractions of a second, as cameras have them.
pub(super) fn pairs_are_exposures<'s>(stems: impl Iterator<Item = &'s str>) -> bool {
    let mut pairs = stems.filter_map(|stem| PAIR.as_ref()?.captures(stem)).peekable();
    let is_exposure = |pair: regex::Captures<'_>| {
        let second = pair["second"].parse::<u32>();
        pair["first"] == *"1" && second.is_ok_and(|second| DENOMINATORS.contains(&second))
    };
    pairs.peek().is_some() && pairs.all(is_exposure)
}

/// The exposure that a name states, as it is written, and the name without it. `pairs` says whether two numbers at the
/// end are one.
pub(super) fn exposure_in(stem: &str, pairs: bool) -> Option<(String, String)> {
    let found = CERTAIN.as_ref().and_then(|certain| certain.captures(stem));
    let found = found.or_else(|| PAIR.as_ref().filter(|_| pairs)?.captures(stem))?;
    let written = found.name("written")?;
    Some((written.as_str().to_owned(), super::words::without(stem, &written.range())))
}

/// Whether the numbers of one shot's files are exposure times and no count of repeats: 60, 125, 250.
pub(super) fn numbers_are_exposures(mut numbers: Vec<u64>) -> bool {
    numbers.sort_unstable();
    let is_denominator = |number: &u64| DENOMINATORS.iter().any(|known| u64::from(*known) == *number);
    numbers.windows(2).any(|pair| pair[1] - pair[0] > LARGEST_GAP)
        && numbers.iter().all(|n| *n == 1 || is_denominator(n))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposures_in_names_are_found_in_every_form() {
        let cases = [
            ("left-blue-1-60", "1-60", "left-blue"),
            ("left_blue_1_1000", "1_1000", "left_blue"),
            ("left-blue-1-60s", "1-60s", "left-blue"),
            ("left-blue 0.5s", "0.5s", "left-blue"),
            ("left-blue-100ms", "100ms", "left-blue"),
            ("left_20ms_blue", "20ms", "left_blue"),
            ("left-blue_+2EV", "+2EV", "left-blue"),
            ("left-blue_EV-1", "EV-1", "left-blue"),
            ("left-blue_exp3", "exp3", "left-blue"),
            ("left-blue-ISO200", "ISO200", "left-blue"),
        ];
        for (stem, written, rest) in cases {
            assert_eq!(exposure_in(stem, true), Some((written.into(), rest.into())), "{stem}");
        }
        for stem in ["left-blue", "left-blue-2", "lamps-blue", "left-blue-1-60-x"] {
            assert_eq!(exposure_in(stem, true), None, "{stem}");
        }
        assert_eq!(exposure_in("blue-1-2", false), None);
    }

    #[test]
    fn two_numbers_are_an_exposure_where_all_of_them_can_be_one() {
        assert!(pairs_are_exposures(["left-blue-1-60", "left-blue-1-125", "top-blue"].into_iter()));
        assert!(!pairs_are_exposures(["blue-1-2", "blue-2-2"].into_iter()), "light and repeat");
        assert!(!pairs_are_exposures(["blue-1-1", "blue-1-2"].into_iter()), "no camera has 1/1");
        assert!(!pairs_are_exposures(["left-blue"].into_iter()));
        assert!(numbers_are_exposures(vec![250, 60, 125]));
        assert!(!numbers_are_exposures(vec![1, 2, 4]), "a repeat was left out");
        assert!(!numbers_are_exposures(vec![17, 21]));
    }
}
