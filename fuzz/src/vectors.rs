//! Vector files: an error naming the line, or lines that survive writing and reading, and whose results, filled in by a
//! model, that model confirms.

use outmerge::model::registry;
use outmerge::vectors::{VectorError, VectorLine, apply, check as replay};

pub fn check(data: &[u8]) {
    if let Ok(text) = std::str::from_utf8(data) {
        for line in text.lines() {
            if let Ok(vector) = VectorLine::parse(line) {
                let written = vector.to_json();
                let again = VectorLine::parse(&written).unwrap_or_else(|error| panic!("{error} in {written}"));
                assert_eq!(again.to_json(), written, "written, read and written again");
                assert_eq!(again.dst, vector.dst, "destination bytes");
            }
        }
    }
    for name in ["exact", "exact:toward-zero", "f16", "llvmpipe"] {
        let model = registry::by_name(name).expect("a model");
        let mut filled = Vec::new();
        match apply(model.as_ref(), data, &mut filled) {
            Ok(count) => {
                let report = replay(model.as_ref(), filled.as_slice(), |_| ()).expect("what was just written");
                assert_eq!(
                    (report.total.lines, report.total.failed_texels),
                    (count, 0),
                    "{name} confirms its own results"
                );
            }
            Err(VectorError::Line { line, .. } | VectorError::Unsupported { line, .. }) => {
                let lines = data.split(|byte| *byte == b'\n').count();
                assert!((1..=lines).contains(&line), "line {line} of {lines}");
            }
            Err(VectorError::Io(error)) => panic!("bytes in memory cannot fail to be read: {error}"),
        }
        let _ = replay(model.as_ref(), data, |_| ());
    }
}
