//! What every stage's options say of a value that is out of its range.

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
