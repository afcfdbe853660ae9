//! The curve that a colour profile or a PNG states, and whether it can be undone.

use moxcms::{ColorProfile, ProfileText, ToneCurveEvaluator, ToneReprCurve};
use png::Info;

use super::read::one_line;
use super::{Encoding, StatedCurve};
use crate::guard::guarded;

/// The gammas that are believed.
const GAMMA_RANGE: std::ops::RangeInclusive<f64> = 0.1..=10.0;
/// The transfer functions of ITU-T H.273 that are one of ours: linear, and sRGB.
const H273_LINEAR: u8 = 8;
const H273_SRGB: u8 = 13;

impl StatedCurve {
    /// Stored = light ^ (1 / gamma).
    pub(super) fn of_gamma(gamma: f64) -> Self {
        if !GAMMA_RANGE.contains(&gamma) {
            Self::Unknown(format!("a gamma of {gamma}"))
        } else if Encoding::Gamma(gamma).is_near(Encoding::Linear) {
            Self::Known(Encoding::Linear)
        } else {
            Self::Known(Encoding::Gamma(gamma))
        }
    }

    /// Of an ICC profile.
    pub(super) fn of_icc(profile: &[u8]) -> Self {
        // The crate indexes into what a profile states.
        guarded(|| of_icc(profile)).unwrap_or_else(|_| Self::Unknown("a damaged colour profile".into()))
    }

    /// Of the chunks of a PNG, the strongest first.
    pub(super) fn of_png(info: &Info) -> Self {
        if let Some(code) = info.coding_independent_code_points {
            return match code.transfer_function {
                H273_LINEAR => Self::Known(Encoding::Linear),
                H273_SRGB => Self::Known(Encoding::Srgb),
                other => Self::Unknown(format!("transfer function {other} of H.273")),
            };
        }
        if let Some(profile) = &info.icc_profile {
            return Self::of_icc(profile);
        }
        if info.srgb.is_some() {
            return Self::Known(Encoding::Srgb);
        }
        let gamma = info.gama_chunk.map(|exponent| f64::from(exponent.into_value()));
        gamma.filter(|exponent| *exponent > 0.0).map_or(Self::Unstated, |exponent| Self::of_gamma(1.0 / exponent))
    }
}

fn of_icc(profile: &[u8]) -> StatedCurve {
    let Ok(profile) = ColorProfile::new_from_slice(profile) else {
        return StatedCurve::Unknown("a damaged colour profile".into());
    };
    let colours = [&profile.red_trc, &profile.green_trc, &profile.blue_trc];
    let curves: Option<Vec<&ToneReprCurve>> = match &profile.gray_trc {
        Some(grey) => Some(vec![grey]),
        None => colours.into_iter().map(Option::as_ref).collect(),
    };
    let known = curves.and_then(|curves| {
        let mut encodings = curves.into_iter().map(encoding_of);
        let first = encodings.next()??;
        encodings.all(|other| other.is_some_and(|other| other.is_near(first))).then_some(first)
    });
    known.map_or_else(|| StatedCurve::Unknown(name_of(&profile)), StatedCurve::Known)
}

fn encoding_of(curve: &ToneReprCurve) -> Option<Encoding> {
    // One number is a gamma; the crate's own power of 0 is not 0.
    if let ToneReprCurve::Lut(table) = curve
        && let [gamma] = table[..]
    {
        return StatedCurve::of_gamma(f64::from(gamma) / 256.0).known();
    }
    let curve: Box<dyn ToneCurveEvaluator + Send + Sync> = curve.make_linear_evaluator().ok()?;
    let light = |stored: f32| curve.evaluate_value(stored);
    let gamma = f64::from(light(0.5)).ln() / 0.5_f64.ln();
    let gamma = GAMMA_RANGE.contains(&gamma).then_some(Encoding::Gamma(gamma));
    let choices = [Some(Encoding::Linear), Some(Encoding::Srgb), gamma];
    choices.into_iter().flatten().find(|choice| choice.follows(light))
}

fn name_of(profile: &ColorProfile) -> String {
    let name = match &profile.description {
        Some(ProfileText::PlainString(name)) => name.clone(),
        Some(ProfileText::Localizable(names)) => names.first().map(|name| name.value.clone()).unwrap_or_default(),
        Some(ProfileText::Description(name)) => name.ascii_string.clone(),
        None => String::new(),
    };
    let name = one_line(name.replace('\0', ""));
    if name.is_empty() { "a colour profile without a name".into() } else { format!("colour profile \"{name}\"") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_curve(curve: ToneReprCurve) -> StatedCurve {
        let mut profile = ColorProfile::new_srgb();
        (profile.red_trc, profile.green_trc, profile.blue_trc) =
            (Some(curve.clone()), Some(curve.clone()), Some(curve));
        StatedCurve::of_icc(&profile.encode().unwrap())
    }

    fn table(light: impl Fn(f64) -> f64) -> ToneReprCurve {
        ToneReprCurve::Lut((0..1024).map(|index| (65535.0 * light(f64::from(index) / 1023.0)).round() as u16).collect())
    }

    #[test]
    fn the_curves_of_usual_profiles_are_known() {
        let icc = |profile: ColorProfile| StatedCurve::of_icc(&profile.encode().unwrap());
        assert_eq!(icc(ColorProfile::new_srgb()), StatedCurve::Known(Encoding::Srgb));
        let StatedCurve::Known(Encoding::Gamma(gamma)) = icc(ColorProfile::new_adobe_rgb()) else { panic!() };
        assert!((gamma - 2.199).abs() < 1e-2, "{gamma}");
        let StatedCurve::Known(Encoding::Gamma(gamma)) = icc(ColorProfile::new_gray_with_gamma(1.8)) else { panic!() };
        assert!((gamma - 1.8).abs() < 1e-2, "{gamma}");
        assert_eq!(with_curve(table(|x| x)), StatedCurve::Known(Encoding::Linear));
        assert_eq!(with_curve(ToneReprCurve::Lut(Vec::new())), StatedCurve::Known(Encoding::Linear));
        let srgb = table(|x| f64::from(Encoding::Srgb.decode(x as f32)));
        assert_eq!(with_curve(srgb), StatedCurve::Known(Encoding::Srgb));
    }

    #[test]
    fn a_profile_without_a_usual_curve_or_damaged_is_unknown_by_its_name() {
        let StatedCurve::Unknown(name) = with_curve(table(|x| x * x * (3.0 - 2.0 * x))) else { panic!() };
        assert!(name.contains("sRGB"), "{name}");
        let whole = ColorProfile::new_srgb().encode().unwrap();
        for damaged in [&[][..], &whole[..100], &whole[..200], &[0xff; 300]] {
            assert!(matches!(StatedCurve::of_icc(damaged), StatedCurve::Unknown(_)));
        }
    }
}
