//! The paper's synthetic experiments, reproduced: records and a page.

use firstbounce_core::trust::gain_of_ratio;
use maud::{Markup, html};
use serde::Serialize;

use super::plot::{Axis, Bar, Curve, Plot, Scale, bars};
use super::{AllBouncesPoint, FIGURE3_BITS, Figure3Point, Paper, PaperErrors, PaperOptions, TableRow};
use firstbounce_capture::report::page::page;

/// What survives of the paper's own figures for one scene. The scan lost most cells of its Table 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PublishedRecord {
    /// Which of our scenes represents the paper's.
    pub scene: &'static str,
    /// Mean error of the normals from the photos before separation.
    pub raw_deg: Option<f64>,
    /// Mean error of the normals from bounce 1.
    pub separated_deg: Option<f64>,
    /// Mean error of bounce 1 in grey levels of 8 bits.
    pub direct_error_levels: f64,
    /// Mean of the true direct light in the same.
    pub mean_direct_level: f64,
    /// The one over the other.
    pub direct_error_percent: f64,
}

/// The paper's surviving figures: its sections 4 and 4.1.
pub const PUBLISHED: [PublishedRecord; 2] = [
    PublishedRecord {
        scene: "corner",
        raw_deg: Some(7.88),
        separated_deg: Some(1.11),
        direct_error_levels: 0.76,
        mean_direct_level: 94.0,
        direct_error_percent: 0.8,
    },
    PublishedRecord {
        scene: "tray",
        raw_deg: None,
        separated_deg: None,
        direct_error_levels: 1.57,
        mean_direct_level: 109.0,
        direct_error_percent: 1.4,
    },
];

/// All results. Errors without a prefix are of pictures of 8 bits, as the paper's were; those under `noiseless` of
/// pictures without noise or rounding.
#[derive(Clone, Debug, Serialize)]
pub struct PaperRecord {
    /// The program and its version.
    pub program: String,
    /// Side of the pictures.
    pub size_px: usize,
    /// The synthetic half of Table 1.
    pub table: Vec<PaperRowRecord>,
    /// Figure 3.
    pub figure3: Vec<Figure3Point>,
    /// The paper's own figures.
    pub published: [PublishedRecord; 2],
    /// Figure 3 for light of all bounces: errors of the normals.
    pub figure3_all_bounces: Vec<AllBouncesPoint>,
}

/// Why some rows have no result of colours and shape together.
pub const MADE_FOR_ALL_BOUNCES: &str = "Colours and shape together take the indirect light for light that bounces without end, \
     so where light is cut after m bounces the method has no result.";

/// One scene under one kind of light, in pictures of 8 bits.
#[derive(Clone, Debug, Serialize)]
pub struct PaperRowRecord {
    /// "corner" or "tray".
    pub scene: &'static str,
    /// "two bounces", "four bounces" or "all bounces": what the pictures hold.
    pub light: &'static str,
    /// The order m that was separated.
    pub bounces: usize,
    /// Bits of the pictures.
    pub bits: u32,
    /// The paint, reference first.
    pub albedos: Vec<f64>,
    /// The mean of the true direct light in grey levels of 8 bits.
    pub mean_direct_level: f64,
    /// Errors in pictures of 8 bits.
    #[serde(flatten)]
    pub errors: PaperErrors,
    /// The same without noise or rounding.
    pub noiseless: PaperErrors,
}

impl PaperRecord {
    /// Of results found with these options.
    pub fn of(paper: &Paper, options: &PaperOptions) -> Self {
        Self {
            program: format!("firstbounce {}", env!("CARGO_PKG_VERSION")),
            size_px: options.size_px,
            table: paper.table.iter().map(PaperRowRecord::of).collect(),
            figure3: paper.figure3.clone(),
            published: PUBLISHED,
            figure3_all_bounces: paper.figure3_all_bounces.clone(),
        }
    }
}

impl PaperRowRecord {
    fn of(row: &TableRow) -> Self {
        Self {
            scene: row.scene,
            light: row.light,
            bounces: row.bounces,
            bits: 8,
            albedos: row.albedos.clone(),
            mean_direct_level: row.mean_direct_level,
            errors: row.eight_bit,
            noiseless: row.noiseless,
        }
    }

    /// The paper's own figures for this row: they are of light that bounced as often as was separated.
    pub fn published(&self) -> Option<&'static PublishedRecord> {
        PUBLISHED.iter().find(|published| published.scene == self.scene && self.light != "all bounces")
    }
}

/// The page.
pub fn paper_html(words: &PaperRecord) -> String {
    let body = html! {
        p {
            "Liao, Huang, Yang: \"Interreflection Removal for Photometric Stereo by Using Spectrum-dependent Albedo\", \
             CVPR 2011, done again with this program's own radiosity, in pictures of "
            (words.size_px) " x " (words.size_px) " pixels. The paper leaves its lamps, its first scene's albedos and its \
             second scene's shape open: here three equal lamps stand 20 degrees from the camera's axis, the corner's \
             albedos are 0.5 and 0.25, and the second scene is a tray with a ball and a block in it. So figures can be \
             compared in size, not digit by digit."
        }
        h2 { "Table 1" }
        (table(words))
        p {
            "Errors are means over the pixels that all three lamps light, in pictures of 8 bits like the paper's; \
             \"no noise\" is the same without noise or rounding. Where the pictures hold as many bounces as are separated, \
             the model is exact and what is left is rounding; with all bounces, what bounced more often is charged to \
             the bounces that are separated. The paper's figures are those that survive in its scan."
        }
        p { (MADE_FOR_ALL_BOUNCES) }
        (degrees(words))
        h2 { "Figure 3" }
        p {
            "Error of bounce 1 against the ratio of the two albedos, for the corner under light of two bounces. It grows \
             to both sides of 1, where two colours see the same paint, and toward 0, where the second colour sees hardly \
             any. The dashed line is equation 5's gain for even noise, through the curve of 14 bits at 0.5."
        }
        figure { (figure3(words).svg()) }
        details {
            summary { "The numbers" }
            (figure3_table(words))
        }
        h2 { "Figure 3 with all bounces" }
        p {
            "Mean error of the normals against the ratio of the two albedos, for the corner under light that bounces without \
             end: from the photos before separation, from bounce 1 of the paper's method with m = 2, and from the direct \
             light that colours and shape together leave. Above ratio 1 the lamps are dimmer in the second colour, by the \
             square of the ratio, so that nothing clips. What colours and shape together leave hardly depends on the ratio, and \
             falls with the size of the pixels."
        }
        @for bits in FIGURE3_BITS {
            figure {
                (all_bounces(words, bits).svg())
                figcaption { (bits) " bits." }
            }
        }
        details {
            summary { "The numbers" }
            (all_bounces_table(words))
        }
    };
    page("The paper's synthetic experiments", include_str!("plot.css"), &words.program, &body)
}

fn table(words: &PaperRecord) -> Markup {
    let of = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"));
    let together = |errors: &PaperErrors| of(errors.colours_and_shape.map(|errors| errors.normals_deg));
    html! {
        table {
            tr {
                th { "Scene" } th { "light" } th { "m" } th { "before, degrees" } th { "bounce 1, degrees" }
                th { "colours and shape, degrees" }
                th { "direct light off by, levels" } th { "%" } th { "no noise: degrees" } th { "%" }
                th { "colours and shape" }
                th { "paper: before" } th { "bounce 1" } th { "levels" } th { "%" }
            }
            @for row in &words.table {
                @let published = row.published();
                tr {
                    td { (row.scene) } td { (row.light) } td { (row.bounces) }
                    td { (format!("{:.2}", row.errors.raw_deg)) }
                    td { strong { (format!("{:.2}", row.errors.separated_deg)) } }
                    td { strong { (together(&row.errors)) } }
                    td { (format!("{:.2} of {:.0}", row.errors.direct_error_levels, row.mean_direct_level)) }
                    td { (format!("{:.2}", row.errors.direct_error_percent)) }
                    td { (format!("{:.2}", row.noiseless.separated_deg)) }
                    td { (format!("{:.2}", row.noiseless.direct_error_percent)) }
                    td { (together(&row.noiseless)) }
                    td { (of(published.and_then(|paper| paper.raw_deg))) }
                    td { (of(published.and_then(|paper| paper.separated_deg))) }
                    td { (published.map_or("-".into(), |paper| {
                        format!("{:.2} of {:.0}", paper.direct_error_levels, paper.mean_direct_level)
                    })) }
                    td { (published.map_or("-".into(), |paper| format!("{:.1}", paper.direct_error_percent))) }
                }
            }
        }
    }
}

fn degrees(words: &PaperRecord) -> Markup {
    let group = |row: &PaperRowRecord| {
        let mut bars = vec![
            Bar { name: "before", class: "before", value: row.errors.raw_deg },
            Bar { name: "bounce 1, 8 bits", class: "first", value: row.errors.separated_deg },
            Bar { name: "no noise", class: "second", value: row.noiseless.separated_deg },
        ];
        let together = |errors: &PaperErrors| errors.colours_and_shape.map(|errors| errors.normals_deg);
        let of_both = [("colours and shape, 8 bits", &row.errors), ("no noise", &row.noiseless)];
        let of_both = of_both.map(|(name, errors)| Some(Bar { name, class: "third", value: together(errors)? }));
        bars.extend(of_both.into_iter().flatten());
        (format!("{}, {}", row.scene, row.light), bars)
    };
    let groups: Vec<_> = words.table.iter().map(group).collect();
    html! {
        figure {
            (bars("Mean errors of the normals in degrees, before and after separation", "degrees", &groups))
            figcaption { "Mean error of the normals." }
        }
    }
}

fn figure3(words: &PaperRecord) -> Plot {
    let of_bits = |bits: u32| words.figure3.iter().filter(move |point| point.bits == bits);
    let curve = |bits: u32, class: &'static str| {
        let side = |keep: fn(f64) -> bool| -> Vec<(f64, f64)> {
            of_bits(bits).filter(|point| keep(point.ratio)).map(|point| (point.ratio, point.error_percent)).collect()
        };
        let pieces = vec![side(|ratio| ratio < 1.0), side(|ratio| ratio > 1.0)];
        Curve { name: format!("{bits} bits"), class, pieces, dots: true }
    };
    let ratios = || of_bits(14).map(|point| point.ratio);
    let anchor = of_bits(14).find(|point| point.ratio == 0.5).map_or(0.0, |point| point.error_percent);
    let expected = |keep: fn(f64) -> bool| {
        let scale = anchor / gain_of_ratio(0.5);
        ratios().filter(|&ratio| keep(ratio)).map(|ratio| (ratio, scale * gain_of_ratio(ratio))).collect()
    };
    let expected = Curve {
        name: "gain of equation 5".into(),
        class: "expected",
        pieces: vec![expected(|ratio| ratio < 1.0), expected(|ratio| ratio > 1.0)],
        dots: false,
    };
    Plot {
        description:
            "Error of the direct light in percent, on a log scale, against the ratio of albedos: it rises to both \
                      sides of ratio 1"
                .into(),
        x: ratio_axis(ratios()),
        y: Axis::decades("error of the direct light, % (log scale)", words.figure3.iter().map(|p| p.error_percent)),
        curves: vec![curve(8, "first"), curve(14, "second"), expected],
    }
}

fn ratio_axis(ratios: impl Iterator<Item = f64>) -> Axis {
    let most = ratios.fold(1.0, f64::max);
    Axis {
        label: "ratio of albedos, second over first",
        scale: Scale::Linear,
        range: [0.0, most],
        ticks: (0..=(most / 0.1).round() as usize).step_by(2).map(|k| k as f64 / 10.0).collect(),
    }
}

/// One curve a method.
fn all_bounces(words: &PaperRecord, bits: u32) -> Plot {
    let of_bits = || words.figure3_all_bounces.iter().filter(|point| point.bits == bits);
    let curve = |name: &str, class: &'static str, degrees: fn(&AllBouncesPoint) -> f64| {
        let side = |keep: fn(f64) -> bool| -> Vec<(f64, f64)> {
            of_bits().filter(|point| keep(point.ratio)).map(|point| (point.ratio, degrees(point))).collect()
        };
        let pieces = vec![side(|ratio| ratio < 1.0), side(|ratio| ratio > 1.0)];
        Curve { name: name.into(), class, pieces, dots: true }
    };
    let degrees = words.figure3_all_bounces.iter();
    let degrees = degrees.flat_map(|point| [point.raw_deg, point.separated_deg, point.colours_and_shape_deg]);
    Plot {
        description: format!(
            "Errors of the normals in degrees, on a log scale, against the ratio of albedos in pictures of {bits} bits: before \
             separation, by the paper's method and by colours and shape together"
        ),
        x: ratio_axis(of_bits().map(|point| point.ratio)),
        y: Axis::decades("error of the normals, degrees (log scale)", degrees),
        curves: vec![
            curve("colours and shape", "third", |point| point.colours_and_shape_deg),
            curve("the paper, m = 2", "first", |point| point.separated_deg),
            curve("before", "before", |point| point.raw_deg),
        ],
    }
}

fn all_bounces_table(words: &PaperRecord) -> Markup {
    html! {
        table {
            tr {
                th { "ratio" } th { "bits" } th { "before, degrees" } th { "the paper, m = 2" } th { "colours and shape" }
            }
            @for point in &words.figure3_all_bounces {
                tr {
                    td { (point.ratio) } td { (point.bits) }
                    td { (format!("{:.2}", point.raw_deg)) }
                    td { (format!("{:.2}", point.separated_deg)) }
                    td { (format!("{:.2}", point.colours_and_shape_deg)) }
                }
            }
        }
    }
}

fn figure3_table(words: &PaperRecord) -> Markup {
    let error = |ratio: f64, bits: u32| {
        let point = words.figure3.iter().find(|point| point.ratio == ratio && point.bits == bits);
        point.map_or_else(String::new, |point| format!("{:.4}", point.error_percent))
    };
    html! {
        table {
            tr { th { "ratio" } th { "8 bits, %" } th { "14 bits, %" } }
            @for point in words.figure3.iter().filter(|point| point.bits == 8) {
                tr { td { (point.ratio) } td { (error(point.ratio, 8)) } td { (error(point.ratio, 14)) } }
            }
        }
    }
}
