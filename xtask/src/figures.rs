//! Prints the figures of speed: every bench, the samples, and the cost of a block in
//! `check` compared with LinuxCNC's interpreter.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::time::Instant;

use super::{root, run};
use crate::dist::target;
use crate::error::TaskError;
use crate::shapes;

/// Names of the sample programs whose `check` and `run` are timed.
const SAMPLES: [&str; 3] = ["01-stepped-shaft", "02-bushing", "03-grooved-pin"];

/// Number of runs per figure; the median is printed.
const RUNS: usize = 5;

/// Speed of `rs274 -g` of LinuxCNC 2.9 on an x86-64 computer with two cores, in blocks per
/// second, or in moves per second for calls and roughing. Programs and computers are
/// similar, not equal: the ratio shows a loss, but not a few per cent.
const LINUXCNC: [(&str, f64); 6] = [
    ("short lines", 329_000.0),
    ("mixed arcs", 238_000.0),
    ("subprogram calls", 217_500.0),
    ("G71 roughing", 458_000.0),
    ("compensated contour", 204_000.0),
    ("macro loop", 505_000.0),
];

/// Measures all figures of speed and prints them.
pub fn print() -> Result<(), TaskError> {
    run("cargo", &["bench", "--workspace", "--locked"], &[])?;
    run("cargo", &["build", "--release", "--locked"], &[])?;
    let target = target(&root());
    let program = target.join("release/gsk980td");
    for sample in SAMPLES {
        let file = format!("assets/programs/{sample}.CNC");
        for command in ["check", "run"] {
            let begun = Instant::now();
            run(&program.to_string_lossy(), &[command, &file], &[])?;
            println!(
                "{sample}: {command} in {:.3} s",
                begun.elapsed().as_secs_f64()
            );
        }
    }
    let folder = target.join("figures");
    let write_failed = |error| TaskError::Write {
        path: folder.clone(),
        error,
    };
    fs::create_dir_all(&folder).map_err(write_failed)?;
    for (name, text) in shapes::all_shapes() {
        let file = folder.join(name.replace(' ', "-")).with_extension("CNC");
        fs::write(&file, text).map_err(write_failed)?;
        println!("{}", measure_check(&program, name, &file)?);
    }
    measure_long_programs(&program, &folder.join("long.CNC"))
}

/// Measures and prints time and memory for long programs: `check` of ten thousand to ten
/// million blocks, `plot` of a million moves.
fn measure_long_programs(program: &Path, file: &Path) -> Result<(), TaskError> {
    let write = |text: String| {
        fs::write(file, text).map_err(|error| TaskError::Write {
            path: file.to_owned(),
            error,
        })
    };
    let (program, name) = (program.to_string_lossy(), file.to_string_lossy());
    for blocks in [10_000, 100_000, 1_000_000, 10_000_000] {
        write(shapes::short_lines(blocks))?;
        let cost = time_and_memory(&[&program, "check", "--give-up=1h", &name])?;
        println!("check of {blocks} blocks: {cost}");
    }
    let picture = file.with_extension("png");
    let picture = picture.to_string_lossy();
    for (shape, text) in shapes::long_shapes(1_000_000) {
        write(text)?;
        let cost = time_and_memory(&[
            &program,
            "plot",
            "--param=2.1=1",
            "--offset=01=0,0,0.4,3",
            &name,
            "-o",
            &picture,
        ])?;
        println!("plot of a million moves, {shape}: {cost}");
    }
    Ok(())
}

/// Runs a command and formats its time and peak memory.
fn time_and_memory(command: &[&str]) -> Result<String, TaskError> {
    /// Path of GNU time; a shell's own `time` does not report memory.
    const GNU_TIME: &str = "/usr/bin/time";
    let begun = Instant::now();
    if !Path::new(GNU_TIME).exists() {
        output(command)?;
        let seconds = begun.elapsed().as_secs_f64();
        return Ok(format!(
            "{seconds:.2} s, memory not measured without GNU time"
        ));
    }
    let timed = [&[GNU_TIME, "-f", "peak %M"], command].concat();
    let result = output(&timed)?;
    let seconds = begun.elapsed().as_secs_f64();
    let peak = number_after(&text(&result.stderr), "peak ").unwrap_or_default();
    Ok(format!("{seconds:.2} s, {:.0} MiB", peak / 1024.0))
}

/// Measures `check` of a file and formats its figures.
fn measure_check(program: &Path, name: &str, file: &Path) -> Result<String, TaskError> {
    let check = [
        program.to_string_lossy(),
        "check".into(),
        "--json".into(),
        "--param=2.1=1".into(),
        "--offset=01=0,0,0.4,3".into(),
        // Under callgrind a program takes fifty times as long.
        "--give-up=1h".into(),
        file.to_string_lossy(),
    ];
    let mut report = String::new();
    let mut seconds = Vec::with_capacity(RUNS);
    for _ in 0..RUNS {
        let begun = Instant::now();
        report = text(&output(&check)?.stdout);
        seconds.push(begun.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    let reported = |key| number_after(&report, key).unwrap_or_default();
    let elements = reported("\"blocks\":").max(reported("\"moves\":")).max(1.0);
    let rate = elements / seconds[RUNS / 2];
    let peer = LINUXCNC.iter().find(|(shape, _)| *shape == name);
    let ratio = peer.map_or(0.0, |(_, peer)| rate / peer);
    let instructions = count_instructions(&check).map_or_else(
        || "not counted without valgrind".to_owned(),
        |count| format!("{:.0} each", count / elements),
    );
    Ok(format!(
        "check of {name}: {rate:.0} a second, {ratio:.1} times LinuxCNC; instructions: {instructions}"
    ))
}

/// Counts the processor instructions of a command; `None` if valgrind is not installed.
fn count_instructions(command: &[impl AsRef<str>]) -> Option<f64> {
    let counted = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .args(command.iter().map(AsRef::as_ref))
        .output()
        .ok()?;
    number_after(&text(&counted.stderr), "Collected :")
}

fn output(command: &[impl AsRef<str>]) -> Result<Output, TaskError> {
    let line: Vec<&str> = command.iter().map(AsRef::as_ref).collect();
    let failed = |error| TaskError::Start {
        line: line.join(" "),
        error,
    };
    let result = Command::new(line[0]).args(&line[1..]).output();
    let result = result.map_err(failed)?;
    if result.status.success() {
        return Ok(result);
    }
    Err(TaskError::Failed {
        line: line.join(" "),
        status: result.status,
    })
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Returns the whole number that follows `before` in the text; `None` if there is none.
fn number_after(text: &str, before: &str) -> Option<f64> {
    let (_, rest) = text.split_once(before)?;
    let rest = rest.trim_start();
    let end = rest.find(|letter: char| !letter.is_ascii_digit());
    rest[..end.unwrap_or(rest.len())].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_read_from_reports() {
        assert_eq!(
            number_after("==7== Collected : 512\n", "Collected :"),
            Some(512.0)
        );
        assert_eq!(number_after("{\"moves\":40}", "\"moves\":"), Some(40.0));
        assert_eq!(number_after("", "\"moves\":"), None);
    }

    #[test]
    fn every_shape_has_a_figure_of_linuxcnc() {
        for (name, _) in shapes::all_shapes() {
            assert!(LINUXCNC.iter().any(|(shape, _)| *shape == name), "{name}");
        }
    }
}
