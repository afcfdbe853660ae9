//! Units as they are typed.

use clap::ValueEnum;
use firstbounce_capture::mesh_file::read::LengthScale;

/// What one unit of a mesh file is.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum Unit {
    /// 1 mm
    Mm,
    /// 10 mm
    Cm,
    /// 1000 mm
    M,
    /// 25.4 mm
    Inch,
}

impl From<Unit> for LengthScale {
    fn from(unit: Unit) -> Self {
        match unit {
            Unit::Mm => Self::Millimetre,
            Unit::Cm => Self::Centimetre,
            Unit::M => Self::Metre,
            Unit::Inch => Self::Inch,
        }
    }
}
