//! Depth as a 16-bit PNG, for programs that read no float picture.

use firstbounce_core::{Mask, Plane};
use serde::Serialize;

use super::ImageError;

/// The largest stored value.
const WHITE: f64 = u16::MAX as f64;

/// How stored values become depth: `offset + scale * stored`, toward the camera; 0 is stored where there is none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DepthScale {
    /// Depth of the stored value 0, in `unit`.
    pub offset: f64,
    /// Depth between two stored values, in `unit`.
    pub scale: f64,
    /// "mm" or "px".
    pub unit: &'static str,
}

impl DepthScale {
    /// The line that the file carries too.
    pub fn words(&self) -> String {
        let Self { offset, scale, unit } = self;
        format!("depth toward the camera in {unit} = {offset} + {scale} * stored value (1 to 65535); 0 is no depth")
    }
}

/// The depth inside `mask` as a grey 16-bit PNG over its whole range, from 1 (farthest) to 65535, with text chunks that
/// say how to undo it.
///
/// # Errors
/// [`ImageError::UnequalPlanes`] for a depth without pixels, or of another size than the mask.
pub fn depth_png(depth: &Plane, mask: &Mask, unit: &'static str) -> Result<(Vec<u8>, DepthScale), ImageError> {
    let unequal = || ImageError::UnequalPlanes { what: "depth".into() };
    let (width, height) = depth.size();
    let (Ok(png_width), Ok(png_height)) = (u32::try_from(width), u32::try_from(height)) else { return Err(unequal()) };
    if width * height == 0 || mask.size() != depth.size() {
        return Err(unequal());
    }
    let known = |(&depth, &inside): (&f32, &bool)| (inside && depth.is_finite()).then_some(f64::from(depth));
    let depths = || depth.data().iter().zip(mask.data()).map(known);
    let (low, high) = depths().flatten().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
    let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
    // A flat surface has one depth: any scale will do.
    let scale = if high > low { (high - low) / (WHITE - 1.0) } else { 1.0 };
    let offset = low - scale;
    let store = |depth: f64| ((depth - offset) / scale).round().clamp(1.0, WHITE) as u16;
    let samples: Vec<u8> = depths().flat_map(|depth| depth.map_or(0, store).to_be_bytes()).collect();

    let scale = DepthScale { offset, scale, unit };
    let mut file = Vec::new();
    let texts = [
        ("Description", scale.words()),
        ("DepthOffset", offset.to_string()),
        ("DepthScale", scale.scale.to_string()),
        ("DepthUnit", unit.to_owned()),
    ];
    let encode = || {
        let mut encoder = png::Encoder::new(&mut file, png_width, png_height);
        encoder.set_color(png::ColorType::Grayscale);
        encoder.set_depth(png::BitDepth::Sixteen);
        texts.into_iter().try_for_each(|(keyword, text)| encoder.add_text_chunk(keyword.to_owned(), text))?;
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&samples)?;
        writer.finish()
    };
    encode().map_err(|_: png::EncodingError| unequal())?;
    Ok((file, scale))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(file: &[u8]) -> (Vec<u16>, Vec<(String, String)>) {
        let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        let texts = &reader.info().uncompressed_latin1_text;
        let texts = texts.iter().map(|chunk| (chunk.keyword.clone(), chunk.text.clone())).collect();
        (bytes.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect(), texts)
    }

    #[test]
    fn the_text_chunks_undo_what_the_samples_hold() {
        let depth = Plane::from_fn(40, 30, |x, y| 3.0 * (x as f32 * 0.2).sin() - 0.1 * y as f32);
        let mask = Mask::from_fn(40, 30, |x, y| x + y > 9);
        let (file, scale) = depth_png(&depth, &mask, "mm").unwrap();
        let (samples, texts) = decoded(&file);
        let text = |keyword: &str| &texts.iter().find(|(found, _)| found == keyword).unwrap().1;
        let (offset, step): (f64, f64) = (text("DepthOffset").parse().unwrap(), text("DepthScale").parse().unwrap());
        assert_eq!((offset, step, text("DepthUnit").as_str()), (scale.offset, scale.scale, "mm"));
        assert!(text("Description").contains("toward the camera in mm"));
        for ((&stored, &depth), &inside) in samples.iter().zip(depth.data()).zip(mask.data()) {
            assert_eq!(stored > 0, inside);
            assert!(!inside || (offset + step * f64::from(stored) - f64::from(depth)).abs() <= 0.51 * step);
        }
        assert_eq!((samples.iter().max(), samples.iter().filter(|&&s| s > 0).min()), (Some(&65535), Some(&1)));
    }

    #[test]
    fn a_flat_depth_and_an_empty_mask_are_pictures_too() {
        let flat = Plane::filled(3, 2, 7.5);
        let (file, scale) = depth_png(&flat, &Mask::filled(3, 2, true), "px").unwrap();
        assert!(decoded(&file).0.iter().all(|&stored| scale.offset + scale.scale * f64::from(stored) == 7.5));
        let (file, _) = depth_png(&flat, &Mask::filled(3, 2, false), "px").unwrap();
        assert_eq!(decoded(&file).0, [0; 6]);
        assert!(depth_png(&flat, &Mask::filled(2, 2, true), "px").is_err());
    }
}
