//! Result files: the head, then a line a unit, then a checksum of the whole.

use serde_json::{Map, Value};

use super::Results;
use super::checksum::{self, SealError, digest};
use super::result::VERSION;

/// A file that holds no results, or changed ones.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// No JSON.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// Another version.
    #[error("results of version {0}; this program reads version {VERSION}")]
    Version(String),
    /// A damaged unit.
    #[error("line {line}: unit `{unit}`: {source}")]
    Unit {
        /// From 1.
        line: usize,
        /// Its name.
        unit: String,
        /// What is wrong.
        source: SealError,
    },
    /// A damaged head, or units left out.
    #[error(
        "line {line}: the checksum of the whole does not fit: a member of the head was changed, or a unit left out"
    )]
    Head {
        /// Of the checksum, from 1.
        line: usize,
    },
}

/// The head alone, in a form whose every change shows.
fn head(results: &Results) -> Result<Map<String, Value>, serde_json::Error> {
    let mut members = match serde_json::to_value(Results { units: Vec::new(), ..results.clone() })? {
        Value::Object(members) => members,
        _ => Map::new(),
    };
    members.remove("units");
    Ok(members)
}

/// The checksum of the whole: the head's and those of all units.
fn whole(results: &Results) -> Result<String, serde_json::Error> {
    let mut text = serde_json::to_string(&head(results)?)?;
    for unit in &results.units {
        text.push_str(&checksum::checksum(unit)?);
    }
    Ok(digest(&text))
}

/// The file's text.
///
/// # Errors
/// When the results cannot be written as JSON.
pub fn write(results: &Results) -> Result<String, serde_json::Error> {
    let mut text = String::from("{\n  \"schema\": \"conform\",\n");
    for (name, value) in head(results)? {
        text.push_str(&format!("  {}: {value},\n", Value::String(name)));
    }
    let units = results.units.iter().map(checksum::seal).collect::<Result<Vec<_>, _>>()?;
    let list = if units.is_empty() { "[]".to_owned() } else { format!("[\n    {}\n  ]", units.join(",\n    ")) };
    text.push_str(&format!("  \"units\": {list},\n  \"checksum\": \"{}\"\n}}\n", whole(results)?));
    Ok(text)
}

/// The results in a file's text.
///
/// # Errors
/// [`FileError`], naming the line.
pub fn read(text: &str) -> Result<Results, FileError> {
    let mut value: Value = serde_json::from_str(text)?;
    let version = value.get("version").cloned().unwrap_or(Value::Null);
    if version != VERSION {
        return Err(FileError::Version(version.to_string()));
    }
    let line_of = |what: &str| text.lines().position(|line| line.contains(what)).map_or(1, |line| line + 1);
    let take = |value: &mut Value, member: &str| {
        value.as_object_mut().and_then(|members| members.remove(member)).unwrap_or(Value::Null)
    };
    take(&mut value, "schema");
    let (units, given) = (take(&mut value, "units"), take(&mut value, "checksum"));
    value["units"] = Value::Array(Vec::new());
    let mut results: Results = serde_json::from_value(value)?;
    for sealed in units.as_array().cloned().unwrap_or_default() {
        let unit = sealed.get("unit").and_then(Value::as_str).unwrap_or("?").to_owned();
        let line = line_of(&Value::from(unit.as_str()).to_string());
        results.units.push(checksum::open(sealed).map_err(|source| FileError::Unit { line, unit, source })?);
    }
    if given.as_str() != Some(whole(&results)?.as_str()) {
        let line =
            text.lines().count() - text.lines().rev().position(|line| line.contains("\"checksum\"")).unwrap_or(0);
        return Err(FileError::Head { line });
    }
    Ok(results)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::conform::result::samples;

    #[test]
    fn results_survive_writing_and_reading() {
        let results = samples::results(&["blend/r8unorm/a", "blend/r8unorm/b"]);
        let text = write(&results).expect("JSON");
        assert_eq!(read(&text).expect("what was written"), results);
        let reformatted =
            serde_json::to_string_pretty(&serde_json::from_str::<Value>(&text).expect("JSON")).expect("JSON");
        assert_eq!(read(&reformatted).expect("white space does not count"), results);
    }

    /// Every digit of a file, one at a time, becomes another: each is noticed, and the line is named.
    #[test]
    fn a_changed_digit_is_an_error_that_names_the_line() {
        let text = write(&samples::results(&["blend/r8unorm/a", "blend/r8unorm/b"])).expect("JSON");
        let mut tried = 0;
        for (at, digit) in text.char_indices().filter(|(_, c)| c.is_ascii_digit()) {
            let other = if digit == '9' { '8' } else { char::from(digit as u8 + 1) };
            let changed = format!("{}{other}{}", &text[..at], &text[at + 1..]);
            let error = read(&changed).expect_err(&changed).to_string();
            let line = text[..at].lines().count();
            let in_units = text.lines().nth(line - 1).is_some_and(|line| line.contains("\"unit\""));
            if in_units {
                assert!(error.starts_with(&format!("line {line}: ")), "digit {at}, line {line}: {error}");
            }
            tried += 1;
        }
        assert!(tried > 50, "{tried} digits");
    }

    #[test]
    fn a_unit_left_out_or_an_old_version_is_refused() {
        let text = write(&samples::results(&["a", "b"])).expect("JSON");
        let mut value: Value = serde_json::from_str(&text).expect("JSON");
        value["units"].as_array_mut().expect("units").pop();
        assert!(matches!(read(&value.to_string()), Err(FileError::Head { .. })), "one unit fewer");
        let old = text.replace("\"version\": 2", "\"version\": 1");
        assert!(matches!(read(&old), Err(FileError::Version(_))), "version 1");
        assert!(matches!(read("{}"), Err(FileError::Version(_))), "no version");
        assert!(matches!(read("nothing"), Err(FileError::Json(_))), "no JSON");
    }
}
