//! Fields of numbers that leave a number alone until the user changes it.
//!
//! egui writes back what a field shows when the focus leaves it: Tab alone would round every measured value on its way and
//! make it a typed one, and a value outside a field's range would be moved into it by being shown. Here the text that was
//! shown is taken for the number itself.

use eframe::egui::DragValue;
use eframe::egui::emath::Numeric;

/// A field that always shows as many decimals: for columns of values.
pub fn fixed<N: Numeric>(number: &mut N, decimals: usize) -> DragValue<'_> {
    field(number, move |value| format!("{value:.decimals$}"), |typed| typed)
}

/// A field that shows up to as many decimals.
pub fn up_to<N: Numeric>(number: &mut N, decimals: usize) -> DragValue<'_> {
    field(number, move |value| short(value, decimals), |typed| typed)
}

/// A share of 0 to 1, shown and typed in percent with up to as many decimals.
pub fn percent(share: &mut f64, decimals: usize) -> DragValue<'_> {
    field(share, move |share| short(100.0 * share, decimals), |typed| typed / 100.0).suffix(" %")
}

fn field<N: Numeric>(
    number: &mut N,
    text_of: impl Fn(f64) -> String + Clone + 'static,
    meant_by: impl Fn(f64) -> f64 + 'static,
) -> DragValue<'_> {
    let exact = number.to_f64();
    let shown = text_of(exact);
    let read = move |text: &str| if text == shown { Some(exact) } else { parse(text).map(&meant_by) };
    DragValue::new(number)
        .clamp_existing_to_range(false)
        .custom_formatter(move |value, _| text_of(value))
        .custom_parser(read)
}

/// Without the zeros at the end.
fn short(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// As people write numbers: with spaces between thousands, or a decimal comma.
fn parse(text: &str) -> Option<f64> {
    let plain: String = text.chars().filter(|letter| !letter.is_whitespace()).collect();
    plain.replace(',', ".").replace('\u{2212}', "-").parse().ok().filter(|number: &f64| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_as_people_write_them() {
        assert_eq!(parse("0,97"), Some(0.97));
        assert_eq!(parse("1 000.5"), Some(1000.5));
        assert_eq!(parse("\u{2212}0.5"), Some(-0.5));
        assert_eq!([parse(""), parse("inf"), parse("nan"), parse("1,000.5")], [None; 4]);
    }

    #[test]
    fn zeros_at_the_end_are_not_shown() {
        assert_eq!([short(1.0, 4), short(0.25, 1), short(100.0, 0), short(-0.5, 3)], ["1", "0.2", "100", "-0.5"]);
    }
}
