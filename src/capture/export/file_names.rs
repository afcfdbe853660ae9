//! Names of output files by patterns: "bounces-{light}.exr". What a pattern makes and what a name read from a disk is
//! compared with is the same table, so that nothing but the program's own files is ever taken away.

use crate::mesh_file::OutputFormat;
use crate::set::is_usable_name;

/// Longer than any name with folders on the way; what is read from a disk may be of any length.
const MAX_BYTES: usize = 600;

/// What a surface's files are called after its name: the one after separation, and the one before.
pub(super) const SURFACES: [&str; 2] = ["", "-raw"];

/// The name that `pattern` makes of these values, by placeholder.
pub(super) fn filled(pattern: &str, values: &[(&str, &str)]) -> String {
    let value = |placeholder: &str| values.iter().find(|(name, _)| *name == placeholder).map_or("", |(_, value)| value);
    let pieces = pattern.split(['{', '}']).enumerate();
    pieces.map(|(index, piece)| if index % 2 == 0 { piece } else { value(piece) }).collect()
}

/// Whether one of these patterns can make `name`.
pub fn is_one_of(patterns: &[&str], name: &str) -> bool {
    name.len() <= MAX_BYTES && patterns.iter().any(|pattern| makes(pattern, name))
}

fn makes(pattern: &str, name: &str) -> bool {
    let Some((literal, rest)) = pattern.split_once('{') else { return pattern == name };
    let (Some(name), Some((placeholder, rest))) = (name.strip_prefix(literal), rest.split_once('}')) else {
        return false;
    };
    let mut ends = (0..=name.len()).filter(|&end| name.is_char_boundary(end));
    ends.any(|end| can_be(placeholder, &name[..end]) && makes(rest, &name[end..]))
}

fn can_be(placeholder: &str, value: &str) -> bool {
    match placeholder {
        "light" | "colour" => is_usable_name(value),
        "surface" => SURFACES.contains(&value),
        "format" => OutputFormat::ALL.iter().any(|format| format.extension() == value),
        _ => value.bytes().all(|digit| digit.is_ascii_digit()) && value.parse::<u32>().is_ok_and(|k| k > 0),
    }
}
