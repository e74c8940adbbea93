//! A report in words.

use super::pipeline::Pipeline;
use super::{ImageReport, PipelineReport};

/// What to store this image as, and why.
pub(super) fn verdict(report: &ImageReport) -> String {
    let find = |pipeline| report.pipelines.iter().find(|row| row.pipeline == pipeline);
    let (Some(eight), Some(sixteen), Some(half)) =
        (find(Pipeline::Premultiplied8), find(Pipeline::Premultiplied16), find(Pipeline::Half))
    else {
        return String::new();
    };
    if report.translucent == 0 {
        return "no texel is translucent: 8-bit premultiplied storage loses no color that shows".to_owned()
            + &bleeding(report);
    }
    let drawn = eight.composites.iter().filter(|c| c.model == "exact").map(|c| c.worst).max();
    let once = match drawn {
        None => String::new(),
        Some(0 | 1) => "8-bit premultiplied storage is safe for this image when drawn once; ".to_owned(),
        Some(codes) => format!("8-bit premultiplied storage changes what is drawn once by up to {codes} codes; "),
    };
    let lost = if eight.worst == 0.0 {
        "unpremultiplying loses nothing".to_owned()
    } else {
        format!(
            "unpremultiplying loses up to {} in {:.1} % of texels",
            codes(eight.worst),
            100.0 * eight.texels_changed
        )
    };
    let better = |row: &PipelineReport, name: &str| {
        if row.worst == 0.0 { format!("{name} removes it") } else { format!("{name} leaves {}", codes(row.worst)) }
    };
    let remedy = if eight.worst == 0.0 {
        String::new()
    } else {
        format!("; {}, {}", better(sixteen, "16 bits"), better(half, "half"))
    };
    format!("{once}{lost}{remedy}{}", bleeding(report))
}

/// The other side of the trade.
fn bleeding(report: &ImageReport) -> String {
    let fringe = report.filtering.straight.worst;
    if fringe < 1.0 {
        return String::new();
    }
    format!("; straight storage would bleed up to {} into filtered edges", codes(fringe))
}

/// `1 code`, `42 codes`, `0.5 codes`.
fn codes(n: f64) -> String {
    if n == 1.0 {
        "1 code".to_owned()
    } else if n.fract() == 0.0 || n >= 10.0 {
        format!("{n:.0} codes")
    } else {
        format!("{n:.2} codes")
    }
}
