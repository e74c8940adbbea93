//! The models' codes side by side, and every rounding that makes them differ.

use std::fmt::Write as _;

use super::layout::{bytes, code, groups, names, over_same, wrap};
use super::{Answer, Answers, Question};
use crate::format::ChannelKind;
use crate::model::account::Cause;
use crate::model::{Number, StepKind, decimal};

/// All tables.
pub(super) fn tables(answers: &Answers, question: &Question) -> String {
    let all: Vec<&Answer> = std::iter::once(&answers.exact).chain(&answers.models).collect();
    let mut text = codes(&all, question);
    let same = |i: usize, j: usize| {
        all.iter().all(|answer| answer.accounts[i] == answer.accounts[j] && answer.stored[i] == answer.stored[j])
    };
    let groups = groups(|i| question.writes(i), same);
    let differs = |group: &Vec<usize>| all.iter().any(|answer| answer.stored[group[0]] != all[0].stored[group[0]]);
    // Where the models agree, their ways matter only if they agree everywhere.
    let agree = !groups.iter().any(differs);
    for group in groups.iter().filter(|group| agree || differs(group)) {
        text.push_str(&account(&all, group, question));
    }
    for reason in &answers.left_out {
        let _ = write!(text, "\n{}", wrap(&format!("left out: {reason}"), 2));
    }
    text
}

/// Codes and bytes by model.
fn codes(all: &[&Answer], question: &Question) -> String {
    let format = question.inputs.format;
    let stored: Vec<usize> = (0..4).filter(|&i| question.stores(i)).collect();
    let mut header = vec!["stored codes".to_owned()];
    header.extend(stored.iter().map(|&i| names(&[i])));
    header.extend(["  in memory".to_owned(), String::new()]);
    let mut rows = vec![header];
    for answer in all {
        let mut row = vec![format!("  {}", answer.model)];
        row.extend(stored.iter().map(|&i| code(answer.stored[i], format)));
        let differs: Vec<usize> = stored.iter().copied().filter(|&i| answer.stored[i] != all[0].stored[i]).collect();
        row.push(format!("  {}", bytes(answer.stored, format)));
        row.push(if differs.is_empty() { String::new() } else { format!("  differs in {}", names(&differs)) });
        rows.push(row);
    }
    let columns = rows[0].len();
    format!("\n{}", table(&rows, |column| column > 0 && column < columns - 2))
}

/// The way of some channels from the exact value to each model's code.
fn account(all: &[&Answer], group: &[usize], question: &Question) -> String {
    let channel = group[0];
    if all[0].accounts[channel].is_none() {
        return format!("\n{}: a value on the way is not finite, so differences have no size\n", names(group));
    }
    let float = matches!(question.inputs.format.channels()[channel], ChannelKind::Float(_));
    let unit = match question.inputs.format.channels()[channel] {
        ChannelKind::Float(_) => "units in the last place at the exact value",
        ChannelKind::Srgb => "codes, interpolated along the sRGB curve",
        _ => "codes",
    };
    let differs = all.iter().any(|answer| answer.stored[channel] != all[0].stored[channel]);
    let title = match (differs, all.len()) {
        (true, _) => "why they differ",
        (false, 1) => "from the exact value to the code",
        (false, _) => "the same code by different ways",
    };
    let mut text = format!("\n{title}: {} (in {unit}; exact + parts = stored)\n", names(group));
    let mut header = vec!["  model".to_owned()];
    header.push("exact".to_owned());
    header.extend(Cause::ALL.map(|cause| cause.name().to_owned()));
    header.push("stored".to_owned());
    let mut rows = vec![header];
    for answer in all {
        let Some(account) = &answer.accounts[channel] else {
            rows.push(vec![format!("  {}", answer.model), "not finite".to_owned()]);
            continue;
        };
        let mut row = vec![format!("  {}", answer.model)];
        // A float value in units of its last place has too many digits to read; the parts are what matters.
        row.push(if float { "0".to_owned() } else { amount(account.exact) });
        row.extend(account.parts.map(part));
        row.push(if float { part(account.stored - account.exact) } else { amount(account.stored) });
        rows.push(row);
    }
    text.push_str(&table(&rows, |column| column > 0));
    text.push_str(&reasons(all, channel, question));
    text
}

/// In words, why models store another code than `exact`; models with the same reasons together.
fn reasons(all: &[&Answer], channel: usize, question: &Question) -> String {
    let mut found: Vec<(Vec<&str>, String)> = Vec::new();
    for answer in all.iter().filter(|answer| answer.stored[channel] != all[0].stored[channel]) {
        let why = because(answer, all[0], channel, question);
        match found.iter_mut().find(|(_, known)| *known == why) {
            Some((models, _)) => models.push(&answer.model),
            None => found.push((vec![&answer.model], why)),
        }
    }
    let line = |(models, why): &(Vec<&str>, String)| {
        let verb = if models.len() == 1 { "stores" } else { "store" };
        let line = wrap(&format!("{} {verb} {why}", models.join(", ")), 2);
        line.lines().map(|line| format!("  {line}\n")).collect::<String>()
    };
    found.iter().map(line).collect()
}

/// The roundings that matter, in words.
fn because(answer: &Answer, exact: &Answer, channel: usize, question: &Question) -> String {
    let format = question.inputs.format;
    let mut reasons = Vec::new();
    if let Some(account) = &answer.accounts[channel] {
        for (cause, part) in Cause::ALL.into_iter().zip(account.parts) {
            if part.abs() >= 0.01 {
                reasons.extend(reason(cause, answer, channel));
            }
        }
        if account.parts[5].abs() > 0.5 {
            reasons.push(format!("the store truncates {}", amount(account.exact + account.before_store())));
        }
    }
    if let Some(yardstick) = exact.accounts[channel].filter(|account| account.parts[5].abs() == 0.5) {
        reasons.push(format!("exact has the tie {}, which goes to the even code", amount(yardstick.exact)));
    }
    if reasons.is_empty() {
        reasons.push("roundings below a hundredth of a code tip the store".to_owned());
    }
    let (mine, theirs) = (code(answer.stored[channel], format), code(exact.stored[channel], format));
    format!("{mine}, exact {theirs}: {}.", reasons.join("; "))
}

/// What one cause did, with the numbers.
fn reason(cause: Cause, answer: &Answer, channel: usize) -> Vec<String> {
    let explanation = &answer.explanation;
    let step = |kind, i| explanation.step(kind, i).filter(|step| step.unrounded.is_some());
    let shown = |number: &Number| {
        if number.exact.is_empty() || number.exact.len() > 16 { decimal(number.decimal) } else { number.exact.clone() }
    };
    let rounding = |kind: StepKind, i: usize, name: &str, verb: &str| {
        let step = step(kind, i)?;
        let from = step.unrounded.as_ref()?;
        let before = over_same(from, &step.value).unwrap_or_else(|| decimal(from.decimal));
        let given = match kind {
            StepKind::Source | StepKind::SecondSource | StepKind::Constant => format!("{} = ", decimal(from.decimal)),
            _ => String::new(),
        };
        Some(format!("{name} = {given}{before} is {verb} {}", shown(&step.value)))
    };
    let reads = |symbol: &str| {
        let factors = [StepKind::SourceFactor, StepKind::DestinationFactor];
        factors.iter().filter_map(|kind| explanation.step(*kind, channel)).any(|f| f.formula.contains(symbol))
    };
    let found: Vec<Option<String>> = match cause {
        Cause::TakenIn => vec![
            rounding(StepKind::Source, channel, if channel == 3 { "S.a" } else { "S" }, "taken in as"),
            rounding(StepKind::Source, 3, "S.a", "taken in as").filter(|_| channel != 3 && reads("S.a")),
            rounding(StepKind::SecondSource, channel, "S1", "taken in as"),
            rounding(StepKind::SecondSource, 3, "S1.a", "taken in as").filter(|_| channel != 3 && reads("S1.a")),
            rounding(StepKind::Constant, channel, "K", "taken in as"),
            rounding(StepKind::Destination, channel, "D", "decoded as"),
            rounding(StepKind::Destination, 3, "D.a", "decoded as").filter(|_| channel != 3 && reads("D.a")),
        ],
        Cause::Factors => vec![
            rounding(StepKind::SourceFactor, channel, "Fs", "narrowed to"),
            rounding(StepKind::DestinationFactor, channel, "Fd", "narrowed to"),
        ],
        Cause::Products => vec![
            rounding(StepKind::SourceTerm, channel, "S Fs", "rounded to"),
            rounding(StepKind::DestinationTerm, channel, "D Fd", "rounded to"),
        ],
        Cause::Operation => {
            let whole = explanation.step(StepKind::Result, channel).map(|step| format!("computes {}", step.formula));
            vec![rounding(StepKind::Result, channel, "the sum", "rounded to").or(whole)]
        }
        Cause::Scaling => vec![rounding(StepKind::Scaled, channel, "the scaled result", "rounded to")],
        Cause::Store => Vec::new(),
    };
    found.into_iter().flatten().collect()
}

/// A value in codes.
fn amount(x: f64) -> String {
    let text = format!("{x:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A part with its sign; a dot for nothing.
fn part(x: f64) -> String {
    if x == 0.0 {
        ".".to_owned()
    } else if x.abs() < 0.00005 {
        format!("{x:+.0e}")
    } else {
        let text = format!("{x:+.4}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    }
}

/// Rows in columns; `right` says which are aligned right.
pub(super) fn table(rows: &[Vec<String>], right: impl Fn(usize) -> bool) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let cell = |row: &Vec<String>, column: usize| row.get(column).map_or(0, |cell| cell.chars().count());
    let widths: Vec<usize> =
        (0..columns).map(|column| rows.iter().map(|row| cell(row, column)).max().unwrap_or(0)).collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths).enumerate().map(|(column, (cell, width))| {
            if right(column) { format!("{cell:>width$}") } else { format!("{cell:width$}") }
        });
        let line = cells.collect::<Vec<_>>().join("  ");
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}
