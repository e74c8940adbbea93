//! Which test reaches which switch, and how long each takes.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use super::Failure;
use super::compile::Built;

/// Tests that run at once.
pub const WORKERS: usize = 2;

/// Bytes of memory that a test may take; a mutant may make a loop endless.
const MEMORY_KIB: u32 = 8 << 20;

/// One test of one program.
#[derive(Clone, Debug)]
pub struct Test {
    /// Index of the program.
    pub program: usize,
    pub name: String,
    pub seconds: f64,
}

/// The tests, and for each switch those that reach it, quickest first.
#[derive(Debug)]
pub struct Reached {
    pub tests: Vec<Test>,
    pub by_switch: BTreeMap<u32, Vec<usize>>,
}

/// Runs every test once, alone. All must pass.
pub fn measure(tree: &Path, built: &Built) -> Result<Reached, Failure> {
    let mut queue = Vec::new();
    for (program, (_, path)) in built.programs.iter().enumerate() {
        let output = Command::new(path).current_dir(tree).args(["--list", "--format", "terse"]).output()?;
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        queue.extend(text.lines().filter_map(|l| l.strip_suffix(": test")).map(|n| (program, n.trim().to_owned())));
    }
    let (queue, done) = (Mutex::new(queue), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for worker in 0..WORKERS {
            let (queue, done) = (&queue, &done);
            scope.spawn(move || {
                while let Some((program, name)) = queue.lock().ok().and_then(|mut queue| queue.pop()) {
                    let record = std::env::temp_dir().join(format!("reach-{}-{worker}", std::process::id()));
                    let _ = std::fs::remove_file(&record);
                    let started = Instant::now();
                    let names = [name.as_str()];
                    let passed = run(
                        tree,
                        &built.programs[program].1,
                        &names,
                        ("OUTMERGE_REACH", &record.display().to_string()),
                        Duration::from_secs(600),
                    );
                    let seconds = started.elapsed().as_secs_f64();
                    let text = std::fs::read_to_string(&record).unwrap_or_default();
                    let switches: BTreeSet<u32> = text.lines().filter_map(|line| line.parse().ok()).collect();
                    if let Ok(mut done) = done.lock() {
                        done.push((Test { program, name, seconds }, passed == Ended::Passed, switches));
                    }
                    let _ = std::fs::remove_file(&record);
                }
            });
        }
    });
    let mut done = done.into_inner().map_err(|_| "a worker panicked")?;
    done.sort_by(|a, b| a.0.seconds.total_cmp(&b.0.seconds));
    let failed: Vec<&str> = done.iter().filter(|(_, passed, _)| !passed).map(|(test, ..)| test.name.as_str()).collect();
    if !failed.is_empty() {
        return Err(format!("without a mutant these tests fail: {}", failed.join(", ")).into());
    }
    let mut by_switch = BTreeMap::<u32, Vec<usize>>::new();
    for (index, (_, _, switches)) in done.iter().enumerate() {
        switches.iter().for_each(|switch| by_switch.entry(*switch).or_default().push(index));
    }
    Ok(Reached { tests: done.into_iter().map(|(test, ..)| test).collect(), by_switch })
}

/// How a program ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    Passed,
    Failed,
    TimedOut,
}

/// Runs tests of a program, one after the other.
pub fn run(tree: &Path, program: &PathBuf, names: &[&str], variable: (&str, &str), limit: Duration) -> Ended {
    let mut command = Command::new("sh");
    command.arg("-c").arg(format!("ulimit -v {MEMORY_KIB}; exec \"$0\" \"$@\"")).arg(program);
    command.current_dir(tree).args(["--exact", "--test-threads", "1"]).args(names);
    // A failing law must not write its seed down.
    command.env(variable.0, variable.1).env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "true");
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    // A group of its own, so that commands that the tests started end with them.
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    match command.spawn() {
        Ok(child) => wait(child, limit),
        Err(_) => Ended::Failed,
    }
}

fn wait(mut child: Child, limit: Duration) -> Ended {
    let started = Instant::now();
    loop {
        match child.try_wait() {
            Ok(Some(status)) if status.success() => return Ended::Passed,
            Ok(Some(_)) | Err(_) => return Ended::Failed,
            Ok(None) if started.elapsed() > limit => {
                let _ = Command::new("kill").args(["-KILL", "--", &format!("-{}", child.id())]).status();
                let _ = child.wait();
                return Ended::TimedOut;
            }
            Ok(None) => std::thread::sleep(Duration::from_millis(5)),
        }
    }
}
