//! The frame of every page: it needs no other file.

use maud::{DOCTYPE, Markup, PreEscaped, html};

/// A page under a title, with `style` beside the style of all, signed by the program.
pub fn page(title: &str, style: &str, program: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) " - Firstbounce" }
                style { (PreEscaped(include_str!("../report.css"))) (PreEscaped(style)) }
            }
            body {
                h1 { (title) }
                (body)
                footer { (program) }
            }
        }
    };
    page.into_string()
}
