//! Text in columns.

/// No column is wider; a longer cell reaches beyond its end. Names in a file may be of any length.
const MAX_WIDTH: usize = 1000;

/// Rows of cells, each column as wide as its widest cell, two spaces between; the first row is the heading.
pub fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0).min(MAX_WIDTH)
    };
    let widths: Vec<_> = (0..columns).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    };
    rows.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// A row of cells.
pub fn row<const N: usize>(cells: [&str; N]) -> Vec<String> {
    cells.map(str::to_owned).to_vec()
}

#[cfg(test)]
mod tests {
    use super::{row, table};

    #[test]
    fn a_cell_of_any_length_is_printed() {
        let long = "x".repeat(100_000);
        assert!(table(&[row(["name", "value"]), row([&long, "1"])]).ends_with(&format!("{long}  1")));
    }
}
