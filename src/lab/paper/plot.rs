//! Plots as SVG, drawn into a page.

use maud::{Markup, html};

/// Size of a plot and of its margins, in the SVG's own pixels.
const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 380.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = 16.0;
const TOP: f64 = 14.0;
const BOTTOM: f64 = 48.0;

/// How a quantity runs along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By powers of ten.
    Logarithmic,
}

/// One axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it shows, with its unit.
    pub label: &'static str,
    /// How.
    pub scale: Scale,
    /// The values at its ends.
    pub range: [f64; 2],
    /// Where it carries a number.
    pub ticks: Vec<f64>,
}

impl Axis {
    /// A logarithmic axis from the power of ten below the values to that above.
    pub fn decades(label: &'static str, values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = values
            .filter(|value| *value > 0.0 && value.is_finite())
            .fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
        let (low, high) = if low < high { (low.log10().floor(), high.log10().ceil()) } else { (-1.0, 1.0) };
        let ticks = (low as i32..=high as i32).map(|power| 10f64.powi(power)).collect();
        Self { label, scale: Scale::Logarithmic, range: [10f64.powf(low), 10f64.powf(high)], ticks }
    }

    /// Where a value lies along the axis, 0 to 1.
    fn fraction(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        match self.scale {
            Scale::Linear => (value - low) / (high - low),
            Scale::Logarithmic => (value / low).ln() / (high / low).ln(),
        }
    }
}

/// One curve, in pieces between which nothing is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What it shows.
    pub name: String,
    /// Its colour and dash in the page's style: "before", "first", "second", "third", "expected".
    pub class: &'static str,
    /// Points (x, y) of each piece.
    pub pieces: Vec<Vec<(f64, f64)>>,
    /// Whether each point gets a dot.
    pub dots: bool,
}

/// A plot of curves.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// The text alternative.
    pub description: String,
    /// Across.
    pub x: Axis,
    /// Upward.
    pub y: Axis,
    /// The curves, the first on top.
    pub curves: Vec<Curve>,
}

impl Plot {
    fn place(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let (across, up) = (self.x.fraction(x), self.y.fraction(y).clamp(0.0, 1.0));
        (LEFT + across * (WIDTH - LEFT - RIGHT), HEIGHT - BOTTOM - up * (HEIGHT - BOTTOM - TOP))
    }

    /// The plot as SVG, with a legend under it.
    pub fn svg(&self) -> Markup {
        let view = format!("0 0 {WIDTH} {HEIGHT}");
        let (floor, right) = (HEIGHT - BOTTOM, WIDTH - RIGHT);
        html! {
            svg.plot viewBox=(view) role="img" aria-label=(self.description) {
                @for &tick in &self.x.ticks {
                    @let (x, _) = self.place((tick, self.y.range[0]));
                    line.grid x1=(px(x)) x2=(px(x)) y1=(px(TOP)) y2=(px(floor)) {}
                    text x=(px(x)) y=(px(floor + 18.0)) text-anchor="middle" { (tick_words(tick)) }
                }
                @for &tick in &self.y.ticks {
                    @let (_, y) = self.place((self.x.range[0], tick));
                    line.grid x1=(px(LEFT)) x2=(px(right)) y1=(px(y)) y2=(px(y)) {}
                    text x=(px(LEFT - 8.0)) y=(px(y + 4.0)) text-anchor="end" { (tick_words(tick)) }
                }
                line.axis x1=(px(LEFT)) x2=(px(right)) y1=(px(floor)) y2=(px(floor)) {}
                line.axis x1=(px(LEFT)) x2=(px(LEFT)) y1=(px(TOP)) y2=(px(floor)) {}
                text x=(px((LEFT + right) / 2.0)) y=(px(HEIGHT - 8.0)) text-anchor="middle" { (self.x.label) }
                text transform=(format!("translate(16 {}) rotate(-90)", px((TOP + floor) / 2.0))) text-anchor="middle" {
                    (self.y.label)
                }
                @for curve in self.curves.iter().rev() { (self.curve(curve)) }
            }
            p.legend {
                @for curve in &self.curves {
                    span {
                        svg viewBox="0 0 28 10" aria-hidden="true" {
                            line class=(curve.class) x1="1" y1="5" x2="27" y2="5" {}
                            @if curve.dots { circle class=(curve.class) cx="14" cy="5" r="3" {} }
                        }
                        " " (curve.name)
                    }
                }
            }
        }
    }

    fn curve(&self, curve: &Curve) -> Markup {
        let points = |piece: &Vec<(f64, f64)>| {
            let places = piece.iter().map(|&point| self.place(point));
            places.map(|(x, y)| format!("{},{}", px(x), px(y))).collect::<Vec<_>>().join(" ")
        };
        html! {
            @for piece in &curve.pieces {
                polyline class=(curve.class) points=(points(piece)) {}
                @if curve.dots {
                    @for &(x, y) in piece {
                        @let (cx, cy) = self.place((x, y));
                        circle class=(curve.class) cx=(px(cx)) cy=(px(cy)) r="3" {
                            title { (curve.name) ": " (format!("{y:.3} at {x}")) }
                        }
                    }
                }
            }
        }
    }
}

/// One bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// What it shows.
    pub name: &'static str,
    /// Its colour in the page's style: "before", "first", "second" or "third".
    pub class: &'static str,
    /// How long it is.
    pub value: f64,
}

/// Horizontal bars in named groups, with their numbers.
pub fn bars(description: &str, unit: &str, groups: &[(String, Vec<Bar>)]) -> Markup {
    const BAR: f64 = 18.0;
    const GAP: f64 = 14.0;
    const NAMES: f64 = 250.0;
    let most = groups.iter().flat_map(|(_, bars)| bars).map(|bar| bar.value).fold(f64::MIN_POSITIVE, f64::max);
    let count: usize = groups.iter().map(|(_, bars)| bars.len()).sum();
    let height = count as f64 * BAR + groups.len() as f64 * GAP;
    let length = |value: f64| (WIDTH - NAMES - 100.0) * value / most;
    let mut y = 0.0;
    let mut rows = Vec::new();
    for (group, bars) in groups {
        y += GAP;
        for (k, &Bar { name, class, value }) in bars.iter().enumerate() {
            rows.push((if k == 0 { group.as_str() } else { "" }, name, class, value, y));
            y += BAR;
        }
    }
    html! {
        svg.plot viewBox=(format!("0 0 {WIDTH} {height}")) role="img" aria-label=(description) {
            @for (group, name, class, value, y) in rows {
                @let base = px(y + 13.0);
                text x="0" y=(base) { (group) }
                text x=(px(NAMES - 8.0)) y=(base) text-anchor="end" { (name) }
                rect class=(class) x=(px(NAMES)) y=(px(y + 2.0)) width=(px(length(value).max(1.0))) height=(px(BAR - 4.0)) {}
                text x=(px(NAMES + length(value).max(1.0) + 6.0)) y=(base) { (format!("{value:.2} {unit}")) }
            }
        }
    }
}

fn px(value: f64) -> String {
    format!("{value:.1}")
}

fn tick_words(value: f64) -> String {
    let digits = if value.abs() >= 1.0 { 6 } else { (1.0 - value.abs().log10().floor()).clamp(1.0, 6.0) as usize };
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_read_as_a_person_writes_them() {
        let words: Vec<_> = [0.001, 0.05, 0.2, 1.0, 1.4, 10.0, 100.0, 0.0].map(tick_words).to_vec();
        assert_eq!(words, ["0.001", "0.05", "0.2", "1", "1.4", "10", "100", "0"]);
    }

    #[test]
    fn a_point_lies_between_its_ticks() {
        let y = Axis::decades("error, %", [0.02, 3.0].into_iter());
        assert_eq!((y.range, y.ticks.len()), ([0.01, 10.0], 4));
        let x = Axis { label: "ratio", scale: Scale::Linear, range: [0.0, 2.0], ticks: vec![0.0, 1.0, 2.0] };
        let plot = Plot { description: "a test".into(), x, y, curves: Vec::new() };
        let (a, b, c) = (plot.place((0.5, 0.1)), plot.place((1.0, 0.3)), plot.place((2.0, 1.0)));
        assert!(a.0 < b.0 && b.0 < c.0 && a.1 > b.1 && b.1 > c.1);
        assert!((c.0 - (WIDTH - RIGHT)).abs() < 1e-9);
    }
}
