//! Runs a fuzz target on mutated inputs until its time budget is used up.
//!
//! `cargo run --profile fuzz -p gsk980td-tests --bin fuzz -- TARGET [--seconds N]
//! [--seed S] [--corpus DIR] [--crashes DIR] [--runs N] [--keep] [--trace]`,
//! or `fuzz TARGET FILE…` to run files once.
//!
//! The inputs follow from the seed and the corpus. An input that leads to something
//! new is mutated further; `--keep` adds it to the corpus. A panic, or a block that
//! takes more than 50 ms in every retry, is a finding: the input is minimized, written
//! to the folder of the crashes, and ends the run with exit code 1. An input that runs
//! for a minute is a finding too. `--trace` writes each input to `current` in that
//! folder before it runs, for inputs that kill the process.

use std::collections::BTreeSet;
use std::fs;
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::thread;
use std::time::{Duration, Instant};

use gsk_tests::fuzz::mutate::{Mutator, SplitMix};
use gsk_tests::fuzz::{FuzzTarget, TARGETS, find_target, minimize, watch};

/// Time after which a running input counts as hanging.
const HANG_TIME: Duration = Duration::from_secs(60);
/// Number of times that a slow input is run again.
const RETRIES: u32 = 10;
/// Greatest number of inputs in the pool from which new ones are mutated.
const MAX_POOL: usize = 5000;

/// Position and message of the last panic.
static LAST_PANIC: Mutex<String> = Mutex::new(String::new());
/// The input that is running and its start time; `None` between inputs.
static CURRENT: Mutex<Option<(Instant, Vec<u8>)>> = Mutex::new(None);

struct Options {
    target: &'static FuzzTarget,
    seconds: u64,
    runs: u64,
    seed: u64,
    corpus: PathBuf,
    crashes: PathBuf,
    keep: bool,
    trace: bool,
    files: Vec<PathBuf>,
}

/// A fault of the program that an input shows.
struct FuzzFinding {
    /// The fault in one line with its position in the source, by which findings are compared.
    description: String,
    is_slow: bool,
}

fn main() -> ExitCode {
    let options = match parse_options() {
        Ok(options) => options,
        Err(message) => {
            eprintln!("{message}");
            return ExitCode::from(2);
        }
    };
    panic::set_hook(Box::new(|panic| {
        if let Ok(mut last) = LAST_PANIC.lock() {
            *last = panic.to_string().replace('\n', " ");
        }
    }));
    watch_for_hangs(options.crashes.clone(), options.target.name);
    let outcome = if options.files.is_empty() {
        fuzz(&options)
    } else {
        replay(&options)
    };
    match outcome {
        Ok(clean) if clean => ExitCode::SUCCESS,
        Ok(_) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn parse_options() -> Result<Options, String> {
    let names = TARGETS.map(|target| target.name).join(" ");
    let mut words = std::env::args().skip(1);
    let name = words
        .next()
        .ok_or(format!("a target is missing: {names}"))?;
    let target = find_target(&name).ok_or(format!("{name} is none of the targets {names}"))?;
    let mut options = Options {
        target,
        seconds: 10,
        runs: u64::MAX,
        seed: 1,
        corpus: Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("fuzz-corpus")
            .join(target.name),
        crashes: std::env::temp_dir().join("gsk980td-fuzz"),
        keep: false,
        trace: false,
        files: Vec::new(),
    };
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        let number = |text: String| text.parse().map_err(|_| format!("{text} is no number"));
        match word.as_str() {
            "--seconds" => options.seconds = number(value()?)?,
            "--runs" => options.runs = number(value()?)?,
            "--seed" => options.seed = number(value()?)?,
            "--corpus" => options.corpus = value()?.into(),
            "--crashes" => options.crashes = value()?.into(),
            "--keep" => options.keep = true,
            "--trace" => options.trace = true,
            _ if word.starts_with("--") => return Err(format!("{word} is no option")),
            _ => options.files.push(word.into()),
        }
    }
    Ok(options)
}

/// Runs files once and prints the fault of each. Returns whether no file shows a fault.
fn replay(options: &Options) -> Result<bool, String> {
    let mut clean = true;
    for file in &options.files {
        let input = fs::read(file).map_err(|error| format!("{}: {error}", file.display()))?;
        let start = Instant::now();
        let (_, found) = run_input(options, &input);
        let what = found.map_or("fine".to_owned(), |finding| finding.description);
        clean &= what == "fine";
        println!("{}: {:.1?}: {what}", file.display(), start.elapsed());
    }
    Ok(clean)
}

fn fuzz(options: &Options) -> Result<bool, String> {
    let corpus = read_corpus(&options.corpus)?;
    let mut pool = Vec::new();
    let mut seen = BTreeSet::new();
    let mut longest = Duration::ZERO;
    for input in corpus {
        let (mut report, found) = run_input(options, &input);
        if let Some(finding) = found {
            return write_finding(options, &input, &finding).map(|()| false);
        }
        seen.append(&mut report.events);
        pool.push(input);
    }
    let kept = pool.len();
    let mutator = Mutator::new(options.target.words);
    let mut random = SplitMix::new(options.seed);
    let start = Instant::now();
    let mut runs = 0_u64;
    while runs < options.runs && start.elapsed().as_secs() < options.seconds {
        let input = mutator.next(&pool, &mut random);
        runs += 1;
        let (mut report, found) = run_input(options, &input);
        longest = longest.max(report.longest_unit);
        if let Some(finding) = found {
            println!(
                "{}: run {runs} of seed {}",
                options.target.name, options.seed
            );
            return write_finding(options, &input, &finding).map(|()| false);
        }
        if report.events.is_subset(&seen) {
            continue;
        }
        seen.append(&mut report.events);
        if options.keep {
            let path = options.corpus.join(format!("{:016x}", input_hash(&input)));
            fs::write(&path, &input).map_err(|error| format!("{}: {error}", path.display()))?;
        }
        if pool.len() < MAX_POOL {
            pool.push(input);
        }
    }
    println!(
        "{}: {runs} runs in {:.0?}, corpus {kept} and {} new, {} marks, longest block {longest:.1?}",
        options.target.name,
        start.elapsed(),
        pool.len() - kept,
        seen.len(),
    );
    Ok(true)
}

/// Runs one input through the target, again if it is slow. Returns its record and its fault.
fn run_input(options: &Options, input: &[u8]) -> (watch::UnitRecord, Option<FuzzFinding>) {
    if options.trace {
        // Without the file the trace is incomplete, but the run is not.
        let _ = fs::create_dir_all(&options.crashes);
        let _ = fs::write(options.crashes.join("current"), input);
    }
    let (report, panicked) = run_once(options.target, input);
    if panicked.is_some() || report.longest_unit <= watch::UNIT_TIME_LIMIT {
        return (report, panicked);
    }
    // Another process may have used the processor: the shortest time counts.
    let mut shortest = report.longest_unit;
    for _ in 0..RETRIES {
        if shortest <= watch::UNIT_TIME_LIMIT {
            break;
        }
        shortest = shortest.min(run_once(options.target, input).0.longest_unit);
    }
    let slow = (shortest > watch::UNIT_TIME_LIMIT).then(|| FuzzFinding {
        description: format!("a block takes {shortest:.0?}"),
        is_slow: true,
    });
    let report = watch::UnitRecord {
        longest_unit: shortest,
        ..report
    };
    (report, slow)
}

fn run_once(target: &FuzzTarget, input: &[u8]) -> (watch::UnitRecord, Option<FuzzFinding>) {
    set_current(Some((Instant::now(), input.to_vec())));
    let result = panic::catch_unwind(AssertUnwindSafe(|| (target.run)(input)));
    set_current(None);
    let finding = result.is_err().then(|| FuzzFinding {
        description: LAST_PANIC
            .lock()
            .map(|last| last.clone())
            .unwrap_or_default(),
        is_slow: false,
    });
    (watch::take_record(), finding)
}

fn set_current(input: Option<(Instant, Vec<u8>)>) {
    if let Ok(mut current) = CURRENT.lock() {
        *current = input;
    }
}

/// Minimizes an input that shows a fault, writes it to a file and prints the fault.
fn write_finding(options: &Options, input: &[u8], finding: &FuzzFinding) -> Result<(), String> {
    let place = |what: &str| {
        what.split(" at ")
            .nth(1)
            .map(|at| at.split(' ').next().unwrap_or("").to_owned())
    };
    let small = minimize(input, &mut |shorter| {
        let found = run_input(options, shorter).1;
        found.is_some_and(|found| {
            found.is_slow == finding.is_slow
                && (found.is_slow || place(&found.description) == place(&finding.description))
        })
    });
    let path = write_input(&options.crashes, options.target.name, &small)?;
    println!(
        "{}: {}\n{}: {} bytes, {} before it was made small",
        options.target.name,
        finding.description,
        path.display(),
        small.len(),
        input.len()
    );
    Ok(())
}

fn write_input(folder: &Path, target: &str, input: &[u8]) -> Result<PathBuf, String> {
    let path = folder.join(format!("{target}-{:016x}", input_hash(input)));
    fs::create_dir_all(folder)
        .and_then(|()| fs::write(&path, input))
        .map_err(|error| format!("{}: {error}", path.display()))?;
    Ok(path)
}

fn watch_for_hangs(crashes: PathBuf, target: &'static str) {
    thread::spawn(move || {
        loop {
            thread::sleep(Duration::from_secs(1));
            let hanging = CURRENT.lock().ok().and_then(|current| {
                let (since, input) = current.as_ref()?;
                (since.elapsed() > HANG_TIME).then(|| input.clone())
            });
            let Some(input) = hanging else {
                continue;
            };
            match write_input(&crashes, target, &input) {
                Ok(path) => println!("{target}: hangs\n{}", path.display()),
                Err(error) => eprintln!("{target}: hangs; {error}"),
            }
            std::process::exit(1);
        }
    });
}

/// Returns the inputs in a folder, sorted by the names of their files.
fn read_corpus(folder: &Path) -> Result<Vec<Vec<u8>>, String> {
    let error = |error| format!("{}: {error}", folder.display());
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(error)? {
        paths.push(entry.map_err(error)?.path());
    }
    paths.sort();
    paths
        .iter()
        .map(|path| fs::read(path).map_err(error))
        .collect()
}

/// Returns the hash of an input (FNV-1a), which is the name of its file.
fn input_hash(input: &[u8]) -> u64 {
    input.iter().fold(0xCBF2_9CE4_8422_2325, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)
    })
}
