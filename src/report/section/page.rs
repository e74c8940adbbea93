//! Sections as HTML.

use maud::{Markup, PreEscaped, html};

use super::{Drawing, Figure, Section, Table};
use crate::report::{html, plot};

/// Rows of a table shown at once; longer ones fold.
const OPEN_ROWS: usize = 16;

/// One section.
///
/// # Errors
/// When a chart or picture cannot be drawn.
pub fn section(section: &Section) -> Result<Markup, super::Failure> {
    let figures = section.figures.iter().map(figure).collect::<Result<Vec<_>, _>>()?;
    Ok(html! {
        section #(section.id) {
            h2 { (section.title) }
            p.finding { (section.finding) }
            p { (prose(&section.method)) }
            div.charts { @for figure in &figures { (figure) } }
            @for table in &section.tables { (folded(table)) }
            p.command { "In full: " code { (section.command) } }
        }
    })
}

/// Text whose parts in backticks are code.
fn prose(text: &str) -> Markup {
    html! {
        @for (i, part) in text.split('`').enumerate() {
            @if i % 2 == 1 { code { (part) } } @else { (part) }
        }
    }
}

fn figure(figure: &Figure) -> Result<Markup, super::Failure> {
    let drawing = match &figure.drawing {
        // Generated here: nothing in it comes from outside but names, which the chart escapes.
        Drawing::Chart(chart) => PreEscaped(plot::svg(chart)?),
        Drawing::Picture(picture) => html::image(picture, &figure.caption)?,
    };
    Ok(html! { figure.chart { (drawing) figcaption { (figure.caption) } } })
}

fn folded(table: &Table) -> Markup {
    if table.rows.len() <= OPEN_ROWS {
        return html! { @if !table.caption.is_empty() { p.caption { (table.caption) } } div.wide { (markup(table)) } };
    }
    html! { details { summary { (table.caption) " (" (table.rows.len()) " rows)" } div.wide { (markup(table)) } } }
}

fn markup(table: &Table) -> Markup {
    html! {
        table {
            thead { tr { @for name in &table.header { th { (name) } } } }
            tbody { @for row in &table.rows { tr {
                @for (i, cell) in row.iter().enumerate() {
                    @if i == 0 { th scope="row" { (cell) } } @else { td { (cell) } }
                }
            } } }
        }
    }
}
