//! CSV files, and tables in Markdown.

use super::BenchError;
use serde::Serialize;

/// The CSV file with a line for each of `rows`, below one with the names of its fields.
pub fn csv<R: Serialize>(rows: impl IntoIterator<Item = R>) -> Result<Vec<u8>, BenchError> {
    let error = |reason: String| BenchError::Report { what: "a CSV file".into(), reason };
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).map_err(|e| error(e.to_string()))?;
    }
    writer.into_inner().map_err(|e| error(e.to_string()))
}

/// A column of a Markdown table.
pub struct Column {
    title: String,
    cells: Vec<String>,
}

impl Column {
    /// Text as it is.
    pub fn text(title: &str, cells: impl IntoIterator<Item = String>) -> Self {
        Self { title: title.to_owned(), cells: cells.into_iter().collect() }
    }

    /// Ratios to two digits, with the largest in bold where there are several; a dash where there
    /// is none.
    pub fn ratios(title: &str, ratios: &[Option<f64>]) -> Self {
        let best = ratios.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
        let several = ratios.iter().flatten().count() > 1;
        let cell = |ratio: &Option<f64>| match ratio {
            Some(ratio) if several && *ratio == best => format!("**{ratio:.2}**"),
            Some(ratio) => format!("{ratio:.2}"),
            None => "-".into(),
        };
        Self { title: title.to_owned(), cells: ratios.iter().map(cell).collect() }
    }
}

/// A Markdown table of columns of equal length.
pub fn markdown(columns: &[Column]) -> String {
    let width = |column: &Column| {
        column
            .cells
            .iter()
            .chain([&column.title])
            .map(|cell| cell.chars().count())
            .max()
            .unwrap_or_default()
    };
    let widths: Vec<usize> = columns.iter().map(width).collect();
    let line = |cell: &dyn Fn(usize) -> String| {
        let cells: Vec<_> =
            widths.iter().enumerate().map(|(i, &width)| format!("{:<width$}", cell(i))).collect();
        format!("| {} |\n", cells.join(" | "))
    };
    let mut text = line(&|i| columns[i].title.clone());
    text += &line(&|i| "-".repeat(widths[i]));
    let rows = columns.iter().map(|column| column.cells.len()).min().unwrap_or_default();
    for row in 0..rows {
        text += &line(&|i| columns[i].cells[row].clone());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_ratio_is_bold() {
        let columns = [
            Column::text("name", ["a", "long name", "c"].map(String::from)),
            Column::ratios("gain", &[Some(1.239), None, Some(2.0)]),
        ];
        assert_eq!(
            markdown(&columns),
            "| name      | gain     |\n\
             | --------- | -------- |\n\
             | a         | 1.24     |\n\
             | long name | -        |\n\
             | c         | **2.00** |\n"
        );
        assert_eq!(Column::ratios("alone", &[None, Some(1.0)]).cells, ["-", "1.00"]);
    }

    #[test]
    fn csv_has_a_header_and_empty_cells() {
        #[derive(Serialize)]
        struct Row {
            name: &'static str,
            value: Option<f64>,
        }
        let rows = [Row { name: "a, b", value: Some(0.5) }, Row { name: "c", value: None }];
        assert_eq!(
            String::from_utf8(csv(rows).unwrap()).unwrap(),
            "name,value\n\"a, b\",0.5\nc,\n"
        );
    }
}
