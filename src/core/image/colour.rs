//! The sRGB curve, for colours that come from screens and 8-bit files.

/// Linear light of an sRGB-encoded value in 0..1 (IEC 61966-2-1). Below 0 the linear toe goes on, so that noise around
/// black keeps its mean.
pub fn linear_from_srgb(encoded: f32) -> f32 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

/// The sRGB-encoded value of linear light, the inverse of [`linear_from_srgb`].
pub fn srgb_from_linear(light: f32) -> f32 {
    if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
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

    #[test]
    fn encoding_undoes_decoding() {
        for encoded in [-0.01, 0.0, 0.02, 0.2, 0.7, 1.0] {
            assert!((srgb_from_linear(linear_from_srgb(encoded)) - encoded).abs() < 1e-6, "{encoded}");
        }
    }
}
