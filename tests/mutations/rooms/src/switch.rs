//! A file with its mutants behind switches.
//!
//! Example: `a + b` with the mutants 7 (`-`) and 8 (`*`) becomes `(match crate::mutant::on(3) { 7 => a - b, 8 => a * b,
//! _ => a + b })`. The 3 is the switch: the place, by which it is known which test comes here.

use std::collections::BTreeMap;
use std::ops::Range;

use syn::visit::{self, Visit};

use super::Failure;
use super::list::{Genre, Mutant, State};
use super::source::Source;

/// What stands at a place.
enum Change {
    /// The expression, or one of these texts in place of it.
    Choice(Vec<(u32, String)>),
    /// A return at the start of a body.
    Return(Vec<(u32, String)>),
    /// A guard for an arm that has none.
    NewGuard(u32),
    /// One more condition in a guard.
    MoreGuard(u32),
}

/// A change and where it is.
struct Edit {
    range: Range<usize>,
    switch: u32,
    change: Change,
}

/// A file as it is compiled.
#[derive(Debug)]
pub struct Switched {
    pub text: String,
    /// The texts that belong to one mutant.
    pub mutants: Vec<(Range<usize>, u32)>,
    /// The texts that belong to a switch, with its mutants.
    pub switches: Vec<(Range<usize>, Vec<u32>)>,
}

/// Puts the mutants of one file, those that are not given up, behind switches from number `first` on; says which switch each
/// has.
pub fn switch(
    source: &Source,
    mutants: &mut [&mut Mutant],
    first: u32,
    switch_of: &mut BTreeMap<u32, u32>,
) -> Result<Switched, Failure> {
    let file = syn::parse_file(&source.text)?;
    let mut finder = Finder { source, mutants: Vec::new(), edits: Vec::new(), next: first };
    finder.mutants = mutants
        .iter()
        .filter(|mutant| mutant.state == State::Switched)
        .map(|mutant| {
            let [start, end] = mutant.span.map(|place| source.byte(place));
            (start..end, (**mutant).clone())
        })
        .collect();
    finder.bodies();
    finder.visit_file(&file);
    let mut edits = finder.edits;
    for edit in &edits {
        for id in edit.change.mutants() {
            switch_of.insert(id, edit.switch);
        }
    }
    for mutant in mutants.iter_mut().filter(|mutant| !switch_of.contains_key(&mutant.id)) {
        if mutant.state == State::Switched {
            mutant.state = State::NotSwitched;
        }
    }
    // Outer ones first, and what is put before a place before what stands there.
    edits.sort_by_key(|edit| (edit.range.start, !edit.range.is_empty(), usize::MAX - edit.range.end));
    let mut writer = Writer { source: &source.text, out: String::new(), edits: &edits, at: 0, marks: Vec::new() };
    writer.write(0..source.text.len());
    Ok(writer.finish())
}

impl Change {
    fn mutants(&self) -> Vec<u32> {
        match self {
            Self::Choice(choices) | Self::Return(choices) => choices.iter().map(|(id, _)| *id).collect(),
            Self::NewGuard(id) | Self::MoreGuard(id) => vec![*id],
        }
    }
}

/// Finds the syntax that each mutant is about.
struct Finder<'a> {
    source: &'a Source,
    mutants: Vec<(Range<usize>, Mutant)>,
    edits: Vec<Edit>,
    next: u32,
}

impl Finder<'_> {
    fn edit(&mut self, range: Range<usize>, change: Change) {
        self.edits.push(Edit { range, switch: self.next, change });
        self.next += 1;
    }

    fn text(&self, range: Range<usize>) -> &str {
        &self.source.text[range]
    }

    /// Mutants of a kind that begin at a byte.
    fn at(&self, genre: Genre, start: usize) -> Vec<(Range<usize>, Mutant)> {
        self.mutants.iter().filter(|(range, m)| m.genre == genre && range.start == start).cloned().collect()
    }

    /// Bodies of functions need no syntax: a return goes before their first statement.
    fn bodies(&mut self) {
        let mut by_start = BTreeMap::<usize, Vec<(u32, String)>>::new();
        for (range, mutant) in self.mutants.iter().filter(|(_, mutant)| mutant.genre == Genre::FnValue) {
            by_start.entry(range.start).or_default().push((mutant.id, mutant.replacement.clone()));
        }
        for (start, choices) in by_start {
            self.edit(start..start, Change::Return(choices));
        }
    }
}

/// Whether a condition has a `let` in it, so that it is no expression.
fn has_let(expression: &syn::Expr) -> bool {
    match expression {
        syn::Expr::Let(_) => true,
        syn::Expr::Binary(binary) => has_let(&binary.left) || has_let(&binary.right),
        _ => false,
    }
}

impl<'ast> Visit<'ast> for Finder<'_> {
    fn visit_expr_binary(&mut self, binary: &'ast syn::ExprBinary) {
        let (range, operator) = (self.source.range(binary), self.source.range(&binary.op));
        if !has_let(&binary.left) && !has_let(&binary.right) {
            let choices: Vec<_> = self
                .at(Genre::Binary, operator.start)
                .into_iter()
                .map(|(_, mutant)| {
                    let left = self.text(range.start..operator.start);
                    (mutant.id, format!("{left}{} {}", mutant.replacement, self.text(operator.end..range.end)))
                })
                .collect();
            if !choices.is_empty() {
                self.edit(range, Change::Choice(choices));
            }
        }
        visit::visit_expr_binary(self, binary);
    }

    fn visit_expr_unary(&mut self, unary: &'ast syn::ExprUnary) {
        let range = self.source.range(unary);
        let operand = self.text(self.source.range(&*unary.expr)).to_owned();
        let choices: Vec<_> =
            self.at(Genre::Unary, range.start).into_iter().map(|(_, mutant)| (mutant.id, operand.clone())).collect();
        if !choices.is_empty() {
            self.edit(range, Change::Choice(choices));
        }
        visit::visit_expr_unary(self, unary);
    }

    fn visit_arm(&mut self, arm: &'ast syn::Arm) {
        let pattern = self.source.range(&arm.pat);
        let guard = arm.guard.as_ref().map(|(_, guard)| self.source.range(&**guard));
        for (_, mutant) in self.at(Genre::Arm, self.source.range(arm).start) {
            match &guard {
                Some(range) if arm.guard.as_ref().is_some_and(|(_, guard)| !has_let(guard)) => {
                    self.edit(range.clone(), Change::MoreGuard(mutant.id));
                }
                Some(_) => {}
                None => self.edit(pattern.end..pattern.end, Change::NewGuard(mutant.id)),
            }
        }
        if let Some(range) = guard {
            let mutants = self.at(Genre::Guard, range.start).into_iter();
            let choices: Vec<_> = mutants.map(|(_, mutant)| (mutant.id, mutant.replacement)).collect();
            if !choices.is_empty() && arm.guard.as_ref().is_some_and(|(_, guard)| !has_let(guard)) {
                self.edit(range, Change::Choice(choices));
            }
        }
        visit::visit_arm(self, arm);
    }

    fn visit_expr_struct(&mut self, expression: &'ast syn::ExprStruct) {
        let range = self.source.range(expression);
        let fields: Vec<usize> = expression.fields.iter().map(|field| self.source.range(field).start).collect();
        let choices: Vec<_> = fields
            .into_iter()
            .flat_map(|start| self.at(Genre::Field, start))
            .map(|(field, mutant)| {
                let (before, after) = (self.text(range.start..field.start), self.text(field.end..range.end));
                (mutant.id, format!("{before}{after}"))
            })
            .collect();
        if !choices.is_empty() {
            self.edit(range, Change::Choice(choices));
        }
        visit::visit_expr_struct(self, expression);
    }
}

/// What a marked text belongs to.
enum Mark {
    Mutant(u32),
    Switch(Vec<u32>),
}

/// Writes the text with its changes, the inner within the outer ones.
struct Writer<'a> {
    source: &'a str,
    out: String,
    edits: &'a [Edit],
    at: usize,
    marks: Vec<(Range<usize>, Mark)>,
}

impl Writer<'_> {
    fn write(&mut self, range: Range<usize>) {
        let mut done = range.start;
        let edits = self.edits;
        while let Some(edit) = edits.get(self.at).filter(|edit| edit.range.start < range.end) {
            self.at += 1;
            self.out.push_str(&self.source[done..edit.range.start]);
            self.change(edit);
            done = edit.range.end;
        }
        self.out.push_str(&self.source[done..range.end]);
    }

    fn change(&mut self, edit: &Edit) {
        let start = self.out.len();
        let on = format!("crate::mutant::on({})", edit.switch);
        match &edit.change {
            Change::Choice(choices) => {
                self.out.push_str(&format!("(match {on} {{ "));
                for (id, text) in choices {
                    self.alternative(*id, &format!("{id} => "), text, ",\n");
                }
                self.out.push_str("_ => ");
                self.write(edit.range.clone());
                self.out.push_str(" })");
            }
            Change::Return(choices) => {
                self.out.push_str(&format!("match {on} {{ "));
                for (id, text) in choices {
                    self.alternative(*id, &format!("{id} => return "), text, ",\n");
                }
                self.out.push_str("_ => {} }\n");
            }
            Change::NewGuard(id) => self.out.push_str(&format!(" if {on} != {id} ")),
            Change::MoreGuard(id) => {
                self.out.push_str(&format!("{on} != {id} && ("));
                self.write(edit.range.clone());
                self.out.push(')');
            }
        }
        self.marks.push((start..self.out.len(), Mark::Switch(edit.change.mutants())));
    }

    fn alternative(&mut self, id: u32, before: &str, text: &str, after: &str) {
        let start = self.out.len();
        self.out.push_str(before);
        self.out.push_str(text);
        self.out.push_str(after);
        self.marks.push((start..self.out.len(), Mark::Mutant(id)));
    }

    fn finish(self) -> Switched {
        let mut switched = Switched { text: self.out, mutants: Vec::new(), switches: Vec::new() };
        for (range, mark) in self.marks {
            match mark {
                Mark::Mutant(id) => switched.mutants.push((range, id)),
                Mark::Switch(ids) => switched.switches.push((range, ids)),
            }
        }
        switched
    }
}
