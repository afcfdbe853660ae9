//! Fields of numbers that leave a number alone until the user changes it.
//!
//! egui writes back what a field shows when the focus leaves it: Tab alone would round every measured value on its way and
//! make it a typed one, and a value outside a field's range would be moved into it by being shown. Here the text that was
//! shown is taken for the number itself.
//!
//! Every field has ends: what is typed beyond one becomes that end.

use std::ops::RangeInclusive;

use eframe::egui::DragValue;
use eframe::egui::emath::Numeric;

/// From here on a number is shown with its power of ten.
const LONG: f64 = 1e12;

/// A field that always shows as many decimals: for columns of values.
pub fn fixed<N: Numeric>(number: &mut N, decimals: usize, range: RangeInclusive<N>) -> DragValue<'_> {
    field(number, range, move |value| written(value, decimals), |typed| typed)
}

/// A field that shows up to as many decimals.
pub fn up_to<N: Numeric>(number: &mut N, decimals: usize, range: RangeInclusive<N>) -> DragValue<'_> {
    field(number, range, move |value| short(value, decimals), |typed| typed)
}

/// A share of 0 to 1, shown and typed in percent with up to as many decimals.
pub fn percent(share: &mut f64, decimals: usize, range: RangeInclusive<f64>) -> DragValue<'_> {
    field(share, range, move |share| short(100.0 * share, decimals), |typed| typed / 100.0).suffix(" %")
}

fn field<N: Numeric>(
    number: &mut N,
    range: RangeInclusive<N>,
    text_of: impl Fn(f64) -> String + Clone + 'static,
    meant_by: impl Fn(f64) -> f64 + 'static,
) -> DragValue<'_> {
    let exact = number.to_f64();
    let shown = text_of(exact);
    let (low, high) = (range.start().to_f64(), range.end().to_f64());
    let read = move |text: &str| if text == shown { Some(exact) } else { parse(text).map(&meant_by) };
    // Whoever changes the number, a key or a screen reader too, comes by here.
    let get_set = move |new: Option<f64>| {
        if let Some(new) = new.filter(|new| *new != number.to_f64() && !new.is_nan()) {
            *number = N::from_f64(new.clamp(low, high));
        }
        number.to_f64()
    };
    let field = DragValue::from_get_set(get_set)
        .clamp_existing_to_range(false)
        .custom_formatter(move |value, _| text_of(value))
        .custom_parser(read);
    // With its range the field would move a number that lies outside.
    if (low..=high).contains(&exact) { field.range(low..=high) } else { field }
}

fn written(value: f64, decimals: usize) -> String {
    if value.abs() < LONG { format!("{value:.decimals$}") } else { format!("{value:e}") }
}

/// Without the zeros at the end.
fn short(value: f64, decimals: usize) -> String {
    let text = written(value, decimals);
    if text.contains('e') {
        return text;
    }
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
        assert_eq!([short(1e300, 4), written(-1.5e13, 2)], ["1e300", "-1.5e13"]);
    }
}
