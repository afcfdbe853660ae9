//! The range check that the options of all stages share.

use thiserror::Error;

/// An option outside its range.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{option} is {value}; it must be {range}")]
pub struct OptionError {
    /// The field of the options.
    pub option: &'static str,
    /// Its value.
    pub value: f64,
    /// What it may be.
    pub range: &'static str,
}

/// Refuses a `value` that is not `in_range`.
///
/// # Errors
/// An [`OptionError`] of the three others.
pub fn check_range(option: &'static str, value: f64, in_range: bool, range: &'static str) -> Result<(), OptionError> {
    if in_range { Ok(()) } else { Err(OptionError { option, value, range }) }
}
