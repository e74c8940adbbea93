//! `outmerge lint`: the classic mistakes in a scene or a state.

use std::fmt::Write as _;
use std::path::Path;

use clap::{Args, ValueEnum};

use super::explain::color;
use super::{Failure, Outcome, output, render};
use crate::format::{ChannelKind, ColorFormat};
use crate::lint::{Example, Finding, RULES, SourceAlpha, StateQuestion, lint_scene, lint_state};
use crate::scene::Scene;
use crate::state::preset;
use crate::state::shaderlab::Properties;
use crate::state::text;
use crate::verdict::Verdict;

/// Arguments of `lint`.
#[derive(Debug, Args)]
pub(super) struct Lint {
    /// A scene file, the name of a bundled scene, or a state: a preset, blend factors, a ShaderLab block, WebGPU JSON.
    #[arg(required_unless_present = "rules")]
    subject: Option<String>,
    /// Of a state: the target's format, by its WebGPU name.
    #[arg(long, short, default_value = "rgba8unorm")]
    format: String,
    /// Of a state: the blend constant, if it is set.
    #[arg(long, value_name = "R,G,B,A", allow_hyphen_values = true)]
    constant: Option<String>,
    /// Of a state: how the shader's color relates to its alpha.
    #[arg(long, value_enum)]
    source: Option<Source>,
    /// List the rules.
    #[arg(long)]
    rules: bool,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// As JSON has it.
#[derive(serde::Serialize)]
struct Report<'a> {
    verdict: Verdict,
    /// Rules that were asked.
    rules: usize,
    findings: &'a [Finding],
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Source {
    Straight,
    Premultiplied,
}

impl Lint {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let Some(subject) = self.subject.as_deref().filter(|_| !self.rules) else {
            let mut table = output::table([]);
            RULES.iter().for_each(|rule| {
                table.add_row([rule.name, rule.about]);
            });
            output::print(&output::lines(&table))?;
            return Ok(Outcome::Done);
        };
        let (findings, is_scene, states) = if names_scene(subject) {
            let scene = render::load(subject)?;
            (lint_scene(&scene)?, true, scene.draws().len())
        } else {
            (lint_state(&self.question(subject)?), false, 1)
        };
        // A scene that draws nothing has no mistakes, and no merits.
        let verdict = Verdict::of_search(!findings.is_empty(), states);
        if self.json {
            output::print_json("lint", &Report { verdict, rules: RULES.len(), findings: &findings })?;
        } else {
            output::print(&text(&findings, is_scene.then_some(subject))?)?;
        }
        Ok(Outcome::Judged(verdict))
    }

    fn question(&self, subject: &str) -> Result<StateQuestion, Failure> {
        let block = text::parse(subject, &Properties::new())
            .map_err(|error| format!("`{subject}` is no bundled scene and no file, and as a state: {error}"))?;
        let source = self.source.map(|source| match source {
            Source::Straight => SourceAlpha::Straight,
            Source::Premultiplied => SourceAlpha::Premultiplied,
        });
        Ok(StateQuestion {
            block,
            format: ColorFormat::from_name(&self.format)?,
            constant: self.constant.as_deref().map(|text| color("--constant", text)).transpose()?,
            source,
            // Bare factors and JSON blend states leave depth open; presets and ShaderLab blocks do not.
            depth_known: preset::by_name(subject.trim()).is_some()
                || subject.contains("Blend")
                || subject.contains("ZWrite"),
        })
    }
}

/// Whether a subject is a scene rather than a state.
fn names_scene(subject: &str) -> bool {
    let path = Path::new(subject);
    let extension = path.extension().and_then(|extension| extension.to_str());
    let scene_file = matches!(extension, Some("toml" | "json")) && !subject.contains('{');
    Scene::bundled_by_name(subject).is_some() || scene_file || path.is_file()
}

fn text(findings: &[Finding], scene: Option<&str>) -> Result<String, Failure> {
    let mut text = String::new();
    for finding in findings {
        writeln!(text, "{}: {}", finding.rule, finding.place)?;
        writeln!(text, "  {}", finding.problem)?;
        let Example { given, format, stored, repaired, pixel, .. } = &finding.example;
        let codes = |codes: &[u32; 4]| {
            let present = (0..4).filter(|&i| format.channels()[i] != ChannelKind::Absent);
            present.map(|i| code(format.channels()[i], codes[i])).collect::<Vec<_>>().join(" ")
        };
        if stored == repaired {
            writeln!(text, "  {given}")?;
        } else {
            writeln!(text, "  {given}: {} stored, {} repaired", codes(stored), codes(repaired))?;
        }
        if let (Some((x, y)), Some(scene)) = (pixel, scene) {
            writeln!(text, "  see: outmerge explain {scene} --pixel {x},{y}")?;
        }
        writeln!(text, "  fix: {}\n", finding.fix)?;
    }
    match findings.len() {
        0 => writeln!(text, "nothing found; {} rules, described in docs/lint.md", RULES.len())?,
        1 => writeln!(text, "1 finding; the rule is described in docs/lint.md")?,
        count => writeln!(text, "{count} findings; the rules are described in docs/lint.md")?,
    }
    Ok(text)
}

/// A code; float codes as the numbers they stand for.
fn code(kind: ChannelKind, code: u32) -> String {
    match kind {
        ChannelKind::Float(layout) => layout.decode(code).to_string(),
        _ => code.to_string(),
    }
}
