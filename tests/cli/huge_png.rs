//! A picture that is small as a file and huge in memory.

use std::fs::File;
use std::io::Write;
use std::path::Path;

/// Width and height in pixels.
pub const SIDE_PX: u32 = 17_000;

/// Writes a black PNG of 8 bits, row by row.
pub fn write(path: &Path) {
    let mut encoder = png::Encoder::new(File::create(path).unwrap(), SIDE_PX, SIDE_PX);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().unwrap();
    let mut rows = writer.stream_writer().unwrap();
    let row = [0; SIDE_PX as usize];
    for _ in 0..SIDE_PX {
        rows.write_all(&row).unwrap();
    }
    rows.finish().unwrap();
}
