//! The mutants of a room, as cargo-mutants lists them.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

use super::Failure;

/// What kind of change a mutant is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Genre {
    /// A function's body becomes a value.
    FnValue,
    /// Another binary operator.
    Binary,
    /// A unary operator less.
    Unary,
    /// An arm of a match less.
    Arm,
    /// A guard of an arm becomes true or false.
    Guard,
    /// A field of a struct expression with a base less.
    Field,
}

/// How a mutant stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// It is compiled, behind its number.
    Switched,
    /// The compiler refuses it.
    Unviable,
    /// It stands where no switch can: in a constant, a `const fn`, a condition with `let`.
    NotSwitched,
}

/// One mutant.
#[derive(Clone, Debug)]
pub struct Mutant {
    /// The number to switch it on, from 1.
    pub id: u32,
    /// Its name, with file, line and column.
    pub name: String,
    /// The file, from the root of the tree.
    pub file: String,
    /// What kind it is.
    pub genre: Genre,
    /// The text that is replaced: lines and columns from 1, the end excluded.
    pub span: [(usize, usize); 2],
    /// What replaces it.
    pub replacement: String,
    /// Whether it is compiled.
    pub state: State,
}

impl Mutant {
    /// The room: the folder below `src`.
    pub fn room(&self) -> &str {
        self.file.split('/').nth(1).unwrap_or_default()
    }
}

/// The mutants of some rooms, numbered.
pub fn of_rooms(tree: &Path, rooms: &[String]) -> Result<Vec<Mutant>, Failure> {
    let mut command = Command::new("cargo");
    command.current_dir(tree).args(["mutants", "--list", "--json"]);
    for room in rooms {
        command.args(["-f", &format!("src/{room}/**")]);
    }
    let output = command.output()?;
    if !output.status.success() {
        return Err(format!("cargo mutants --list: {}", String::from_utf8_lossy(&output.stderr)).into());
    }
    let list: Vec<Value> = serde_json::from_slice(&output.stdout)?;
    (1..).zip(&list).map(|(id, value)| mutant(id, value)).collect()
}

fn mutant(id: u32, value: &Value) -> Result<Mutant, Failure> {
    let text = |member: &str| value[member].as_str().map(str::to_owned).ok_or(format!("no `{member}` in {value}"));
    let number = |value: &Value| value.as_u64().and_then(|n| usize::try_from(n).ok()).unwrap_or(0);
    let place = |end: &str| (number(&value["span"][end]["line"]), number(&value["span"][end]["column"]));
    let genre = match text("genre")?.as_str() {
        "FnValue" => Genre::FnValue,
        "BinaryOperator" => Genre::Binary,
        "UnaryOperator" => Genre::Unary,
        "MatchArm" => Genre::Arm,
        "MatchArmGuard" => Genre::Guard,
        "StructField" => Genre::Field,
        other => return Err(format!("genre `{other}` is not known here").into()),
    };
    Ok(Mutant {
        id,
        name: text("name")?,
        file: text("file")?,
        genre,
        span: [place("start"), place("end")],
        replacement: text("replacement")?,
        state: State::NotSwitched,
    })
}
