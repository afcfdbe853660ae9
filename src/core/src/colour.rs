//! The sRGB curve, for colours that come from screens and 8-bit files.

/// Linear light of an sRGB-encoded value in 0..1 (IEC 61966-2-1).
pub fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn middle_grey_of_a_screen_is_a_fifth_of_its_light() {
        assert_eq!((linear_from_srgb(0.0), linear_from_srgb(1.0)), (0.0, 1.0));
        assert!((linear_from_srgb(0.5) - 0.2140).abs() < 1e-4);
        assert!((linear_from_srgb(0.040_449) - linear_from_srgb(0.040_451)).abs() < 1e-6, "the two parts meet");
    }
}
