//! `firstbounce paper`

use std::path::{Path, PathBuf};

use clap::Args;
use firstbounce_capture::OutputFolder;
use firstbounce_lab::{
    MADE_FOR_ALL_BOUNCES, PaperErrors, PaperOptions, PaperRecord, PaperRowRecord, paper, paper_html,
};

use super::progress::Terminal;
use super::solve::default_place;
use super::table::{row, table};
use super::{PrintArgs, print, print_json};

#[derive(Args, Debug)]
pub struct PaperArgs {
    /// Side of the pictures
    #[arg(long, value_name = "PIXELS", default_value_t = PaperOptions::default().size_px)]
    size: usize,
    /// Where to write the page [default: out/paper.html]
    #[arg(long, value_name = "PAGE.HTML", value_parser = html_path)]
    out: Option<PathBuf>,
    #[command(flatten)]
    print: PrintArgs,
}

fn html_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_page = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("html") || e.eq_ignore_ascii_case("htm"));
    if is_page { Ok(path) } else { Err("the page is HTML: name it .html".into()) }
}

/// Runs the command.
pub fn run(args: &PaperArgs) -> anyhow::Result<()> {
    let terminal = Terminal::attend();
    let page = args.out.clone().map_or_else(|| default_place("paper.html"), Ok)?;
    // Before the work, so that a folder that cannot be written is known at once.
    let folder = page.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let output = OutputFolder::stage(folder)?;
    let staged = output.file(page.file_name().unwrap_or_default())?;
    let options = PaperOptions { size_px: args.size, ..PaperOptions::default() };
    let found = paper(&options, &terminal.job("paper"));
    terminal.finish();
    let words = PaperRecord::of(&found?, &options);
    std::fs::write(staged, paper_html(&words))?;
    output.commit()?;
    if args.print.json { print_json(&words) } else { print(&text(&words, &page)) }
}

fn text(words: &PaperRecord, page: &Path) -> String {
    let mut rows = vec![row([
        "scene",
        "light",
        "m",
        "before, degrees",
        "bounce 1",
        "colours and shape",
        "direct light off by",
        "%",
        "no noise: degrees",
        "%",
        "colours and shape",
        "paper: before",
        "bounce 1",
        "direct light off by",
    ])];
    rows.extend(words.table.iter().map(table_row));
    let curve = |bits: u32| {
        let points = words.figure3.iter().filter(|point| point.bits == bits);
        points.map(|point| format!("{:.3}", point.error_percent)).collect::<Vec<_>>()
    };
    let ratios = words.figure3.iter().filter(|point| point.bits == 8).map(|point| point.ratio.to_string());
    let mut figure3 = vec![row(["ratio", "8 bits, %", "14 bits, %"])];
    figure3.extend(ratios.zip(curve(8)).zip(curve(14)).map(|((ratio, eight), fourteen)| vec![ratio, eight, fourteen]));
    let of_bits = |bits: u32| words.figure3_all_bounces.iter().filter(move |point| point.bits == bits);
    let mut all_bounces = vec![row([
        "ratio",
        "8 bits: before",
        "the paper, m = 2",
        "colours and shape",
        "14 bits: before",
        "the paper, m = 2",
        "colours and shape",
    ])];
    all_bounces.extend(of_bits(8).zip(of_bits(14)).map(|(eight, fourteen)| {
        let degrees = [eight, fourteen].map(|at| [at.raw_deg, at.separated_deg, at.colours_and_shape_deg]);
        let degrees = degrees.as_flattened().iter().map(|degrees| format!("{degrees:.2}"));
        std::iter::once(eight.ratio.to_string()).chain(degrees).collect()
    }));
    format!(
        "Table 1, pictures of 8 bits; \"-\": the paper's scan lost it, or has none\n{}\n{MADE_FOR_ALL_BOUNCES}\n\n\
         Figure 3, error of the direct light against the ratio of albedos\n{}\n\n\
         Figure 3 with all bounces, error of the normals in degrees\n{}\n\nplots in {}",
        table(&rows),
        table(&figure3),
        table(&all_bounces),
        page.display()
    )
}

fn table_row(words: &PaperRowRecord) -> Vec<String> {
    let published = words.published();
    let degrees = |value: Option<f64>| value.map_or_else(|| "-".into(), |value| format!("{value:.2}"));
    let together = |errors: &PaperErrors| degrees(errors.colours_and_shape.map(|errors| errors.normals_deg));
    let levels = |error: f64, mean: f64| format!("{error:.2} levels of {mean:.0}");
    vec![
        words.scene.to_owned(),
        words.light.to_owned(),
        words.bounces.to_string(),
        format!("{:.2}", words.errors.raw_deg),
        format!("{:.2}", words.errors.separated_deg),
        together(&words.errors),
        levels(words.errors.direct_error_levels, words.mean_direct_level),
        format!("{:.2}", words.errors.direct_error_percent),
        format!("{:.2}", words.noiseless.separated_deg),
        format!("{:.2}", words.noiseless.direct_error_percent),
        together(&words.noiseless),
        degrees(published.and_then(|paper| paper.raw_deg)),
        degrees(published.and_then(|paper| paper.separated_deg)),
        published.map_or_else(
            || "-".into(),
            |paper| {
                let error = levels(paper.direct_error_levels, paper.mean_direct_level);
                format!("{error} ({:.1} %)", paper.direct_error_percent)
            },
        ),
    ]
}
