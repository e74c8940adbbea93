//! Results against specifications: the arguments, and `outmerge vectors judge`.

use std::path::PathBuf;

use clap::Args;

use super::vectors::in_file;
use super::{Failure, Outcome, limits, output};
use crate::admissible::{Counts, Judge, Policy, Spec, Verdict};
use crate::vectors::{self, Violation};
use crate::verdict::Verdict as Ended;

/// Whose rules, and what is assumed where they are silent.
#[derive(Clone, Debug, Args)]
pub(super) struct Judging {
    /// Specification that must admit every result, exit 1 if it does not: vulkan, d3d or webgpu. May be repeated.
    #[arg(long)]
    pub(super) spec: Vec<Spec>,
    /// Hold Inf and NaN against Vulkan's rules too; support for them is optional, so that their results are undefined
    /// unless this is given.
    #[arg(long)]
    vulkan_specials: bool,
    /// Bits of a linear value in the coarsest blender of sRGB targets, 8 to 24; no text says.
    #[arg(long, value_name = "BITS", default_value_t = Policy::default().srgb_linear_bits, value_parser = clap::value_parser!(u32).range(8..=24))]
    srgb_linear_bits: u32,
}

impl Judging {
    /// The judges asked for.
    pub(super) fn judges(&self) -> Vec<Judge> {
        let policy = Policy { vulkan_specials: self.vulkan_specials, srgb_linear_bits: self.srgb_linear_bits };
        // In the order of the texts, each once.
        let wanted = Spec::ALL.into_iter().filter(|spec| self.spec.contains(spec));
        wanted.map(|spec| Judge { spec, policy }).collect()
    }
}

/// Arguments of `vectors judge`.
#[derive(Debug, Args)]
pub(super) struct JudgeVectors {
    #[command(flatten)]
    judging: Judging,
    /// Input file with results; `-` is stdin.
    input: PathBuf,
    /// Print counts by format as JSON instead of text.
    #[arg(long)]
    json: bool,
    /// Lines that do not conform to print in full.
    #[arg(long, default_value_t = 10)]
    show: usize,
}

impl JudgeVectors {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let mut judges = self.judging.judges();
        let asked_for = !judges.is_empty();
        if judges.is_empty() {
            judges = Judging { spec: Spec::ALL.to_vec(), ..self.judging.clone() }.judges();
        }
        // Each specification reads the input from the start.
        let mut bytes = Vec::new();
        std::io::Read::read_to_end(&mut output::open(&self.input)?, &mut bytes)?;
        let (mut text, mut reports) = (String::new(), Vec::new());
        for judge in &judges {
            let (mut violations, mut shown) = (String::new(), 0);
            let report = vectors::judge(judge, bytes.as_slice(), limits::get(), |violation| {
                if shown < self.show {
                    violations.push_str(&describe(violation));
                }
                shown += 1;
            })
            .map_err(|error| in_file(&self.input, error))?;
            if shown > self.show {
                violations.push_str(&format!("... and {} more lines outside\n", shown - self.show));
            }
            text.push_str(&table(&report));
            text.push_str(&violations);
            reports.push(report);
        }
        // Each specification that was named must be met; of those that were not, one that says something is enough.
        let each = reports.iter().map(|report| report.verdict);
        let verdict = if asked_for { Ended::of_all(each) } else { Ended::of_parts(each) };
        if self.json {
            output::print_json("vectors-judge", &Report { verdict, specifications: &reports })?;
        } else {
            output::print(&text)?;
        }
        Ok(Outcome::Judged(verdict))
    }
}

/// As JSON has it.
#[derive(serde::Serialize)]
struct Report<'a> {
    verdict: Ended,
    specifications: &'a [vectors::Judgements],
}

fn table(report: &vectors::Judgements) -> String {
    let row = |name: &str, counts: Counts| {
        let cells: String = counts.in_order().iter().map(|count| format!(" {count:>9}")).collect();
        format!("{name:22}{cells}\n")
    };
    let names: String = Verdict::NAMES.iter().map(|name| format!(" {name:>9}")).collect();
    let mut text = format!("{:22}{names}\n", format!("texels by {}", report.spec));
    for (format, judged) in &report.formats {
        if judged.texels.total() > 0 {
            text.push_str(&row(format, judged.texels));
        }
    }
    let total = &report.total;
    text.push_str(&row("all", total.texels));
    text.push_str(&row("lines", total.lines));
    if total.not_judged > 0 {
        let lines = total.not_judged;
        text.push_str(&format!(
            "not judged: {lines} lines of several layers, as what each layer read is not recorded\n"
        ));
    }
    let ended = report.verdict;
    let more = match ended {
        Ended::Holds => format!(", class {}", total.texels.verdict().name()),
        Ended::Fails => ": results are outside what it admits".to_owned(),
        Ended::NotCovered if total.texels.total() > 0 => ": any result conforms".to_owned(),
        _ => format!(": {}", ended.meaning()),
    };
    text.push_str(&format!("{}: {ended}{more}\n", report.spec));
    text
}

/// One line that does not conform.
fn describe(v: &Violation) -> String {
    format!(
        "line {}: {}: {} texels outside\n  first at texel {}: {}\n  {}\n",
        v.line, v.state, v.texels, v.texel, v.inputs, v.why
    )
}
