//! The analyses as sections of the report: each a sentence of finding, pictures, tables and the command that makes it.
//!
//! The command line prints the same tables and draws the same charts.

pub mod bound;
pub mod fixpoint;
pub mod page;
pub mod plan;
pub mod stability;
#[cfg(test)]
mod tests;
pub mod texture;
pub mod tradeoff;

use serde::Serialize;

use super::plot::Chart;
use crate::model::NumericModel;
use crate::scene::Picture;

/// A table: the first column names the rows.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Table {
    /// What it shows; may be empty.
    pub caption: String,
    /// Names of the columns.
    pub header: Vec<String>,
    /// The cells, as many a row as the header has.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    #[must_use]
    pub fn new<'a>(caption: &str, header: impl IntoIterator<Item = &'a str>) -> Self {
        Self { caption: caption.to_owned(), header: header.into_iter().map(str::to_owned).collect(), rows: Vec::new() }
    }

    /// Adds a row.
    pub fn add(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }
}

/// What a figure shows.
#[derive(Clone, Debug, PartialEq)]
pub enum Drawing {
    /// A chart.
    Chart(Chart),
    /// A picture.
    Picture(Picture),
}

/// A picture of a section.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// What it shows.
    pub caption: String,
    /// The picture.
    pub drawing: Drawing,
}

impl Figure {
    /// A chart with its caption.
    #[must_use]
    pub fn chart(caption: &str, chart: Chart) -> Self {
        Self { caption: caption.to_owned(), drawing: Drawing::Chart(chart) }
    }

    /// A picture with its caption.
    #[must_use]
    pub fn picture(caption: &str, picture: Picture) -> Self {
        Self { caption: caption.to_owned(), drawing: Drawing::Picture(picture) }
    }
}

/// A section.
#[derive(Clone, Debug, Serialize)]
pub struct Section {
    /// Its anchor on the page.
    pub id: &'static str,
    /// Its title.
    pub title: &'static str,
    /// What was found, in a sentence.
    pub finding: String,
    /// How it was found and how to read it.
    pub method: String,
    /// Its pictures.
    #[serde(skip)]
    pub figures: Vec<Figure>,
    /// Its tables.
    pub tables: Vec<Table>,
    /// The command that prints its figures in full.
    pub command: String,
}

/// Sections [`all`] makes: the number of calls of `done`.
pub const COUNT: usize = 8;

/// An analysis that failed.
pub type Failure = Box<dyn std::error::Error>;

/// Every section. `done` is called after each.
///
/// # Errors
/// The analyses', none of which their fixed questions should meet.
pub fn all(models: &[&dyn NumericModel], done: &dyn Fn()) -> Result<Vec<Section>, Failure> {
    let makers: [&dyn Fn() -> Result<Section, Failure>; COUNT] = [
        &|| tradeoff::section(models),
        &|| fixpoint::section(models),
        &|| bound::section(),
        &|| stability::stack_section(models),
        &|| stability::extreme_section(models),
        &|| stability::order_section(models),
        &|| texture::section(models),
        &|| plan::section(),
    ];
    let mut sections = Vec::new();
    for make in makers {
        sections.push(make()?);
        done();
    }
    Ok(sections)
}

/// Three digits, with sign.
#[must_use]
pub fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if !(0.001..1e5).contains(&size) => format!("{x:.1e}"),
        size if size < 1.0 => format!("{x:.4}"),
        _ => format!("{x:.2}"),
    }
}

/// A share of 1 in percent.
#[must_use]
pub fn percent(share: f64) -> String {
    format!("{:.2} %", 100.0 * share)
}
