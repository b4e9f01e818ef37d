//! The breakpoints, watches and trace of `run`.

use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;

use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_debugger::breakpoints::{BreakHit, BreakpointSet};
use gsk_debugger::call_stack::CallStack;
use gsk_debugger::location::BreakLocation;
use gsk_debugger::source_files::ProgramSources;
use gsk_debugger::trace::{self, TraceError, TraceFormat, TraceWriter};
use gsk_debugger::watch::{WatchTarget, WatchedValue};
use gsk_messages::{Language, Message, say};
use gsk_runner::report::{self, BreakReport};

use super::super::program_sources::{find_sources, program_name};
use crate::cli::{RunArgs, RunDebugArgs};
use crate::commands::{CommandError, output};

/// Executes the options for breakpoints, watches and traces during a run.
pub struct RunDebugger {
    sources: ProgramSources,
    breakpoints: BreakpointSet,
    /// The breakpoint that ends the run; `None` without `--until`.
    until: Option<u32>,
    /// The breakpoint that begins the trace; `None` if the trace begins with the run.
    trace_from: Option<u32>,
    watches: Vec<WatchTarget>,
    calls: CallStack,
    trace: Option<TraceWriter>,
    needs_part: bool,
    needs_passes: bool,
    reports: Vec<BreakReport>,
    language: Option<Language>,
}

/// The breakpoints and the end that a tick has reached.
#[derive(Default)]
pub struct ReachedLocations {
    /// The messages about the breakpoints that this tick has reached.
    pub messages: Vec<Message>,
    /// Whether the run must end after this tick.
    pub ends: bool,
}

impl RunDebugger {
    /// Reads the options and opens the trace. `files` are the program files.
    pub fn open(
        args: &RunDebugArgs,
        files: &[PathBuf],
        setup: &Setup,
        language: Option<Language>,
    ) -> Result<Self, CommandError> {
        let sources = find_sources(&setup.memory.programs, files);
        let mut breakpoints = BreakpointSet::default();
        let mut add = |text: &String| {
            let location = BreakLocation::parse(text, &sources)?;
            Ok::<u32, CommandError>(breakpoints.add(location))
        };
        for text in &args.break_at {
            add(text)?;
        }
        let until = args.until.as_ref().map(&mut add).transpose()?;
        let trace_from = args.trace_from.as_ref().map(&mut add).transpose()?;
        let watches = args.watch.iter().map(|text| WatchTarget::parse(text));
        let watches = watches.collect::<Result<_, _>>()?;
        let needs_passes = breakpoints.needs_passes();
        Ok(Self {
            needs_part: breakpoints.needs_part(),
            needs_passes,
            sources,
            breakpoints,
            until,
            trace_from,
            watches,
            calls: CallStack::default(),
            trace: open_trace(args)?,
            reports: Vec::new(),
            language,
        })
    }

    /// Returns the program files, for locations of breakpoints.
    pub const fn sources(&self) -> &ProgramSources {
        &self.sources
    }

    /// Whether any breakpoint needs the collisions of the part.
    pub const fn needs_part(&self) -> bool {
        self.needs_part
    }

    /// Whether any breakpoint needs the explanations of cycle passes.
    pub const fn needs_passes(&self) -> bool {
        self.needs_passes
    }

    /// Follows a tick of the run, `time_ms` after cycle start.
    ///
    /// # Errors
    /// The trace cannot be written.
    pub fn follow_tick(
        &mut self,
        time_ms: u64,
        simulation: &Simulation,
        has_collided: bool,
    ) -> Result<ReachedLocations, io::Error> {
        let mut reached = ReachedLocations::default();
        if !self.breakpoints.is_empty() {
            self.calls.follow_tick(&simulation.cnc);
            for hit in self.breakpoints.follow_tick(simulation, has_collided) {
                if self.trace_from == Some(hit.id) {
                    self.trace_from = None;
                    self.breakpoints.remove(hit.id);
                    continue;
                }
                reached.ends |= self.until == Some(hit.id);
                reached
                    .messages
                    .extend(self.report(&hit, time_ms, simulation));
            }
        }
        if self.trace_from.is_none()
            && let Some(trace) = &mut self.trace
            && let Err(error) = trace.write_tick(time_ms, simulation)
        {
            self.trace = None;
            return Err(error);
        }
        Ok(reached)
    }

    /// Stores the report about a reached breakpoint and returns its lines.
    fn report(&mut self, hit: &BreakHit, time_ms: u64, simulation: &Simulation) -> Vec<Message> {
        let location = self.breakpoints.location(hit.id);
        let location = location.map_or_else(String::new, |it| it.text.clone());
        let programs = simulation.cnc.programs();
        let t = time_ms as f64 / 1000.0;
        let naming = simulation.cnc.model().record().program_naming();
        let name = |program| program_name(program, naming, &self.sources);
        let text = hit.block.and_then(|block| {
            let program = programs.get(block.program)?;
            Some(program.line(block.line).trim().to_owned())
        });
        let read = |target: &WatchTarget| target.read(simulation).unwrap_or(WatchedValue::Null);
        let values: Vec<(&str, WatchedValue)> = (self.watches.iter())
            .map(|target| (target.name(), read(target)))
            .collect();
        let frames = self.calls.frames().into_iter();
        let frames = frames.map(|frame| format!("{}:{}", name(frame.program), frame.line));
        let report = BreakReport {
            location,
            t,
            program: hit.block.map(|block| name(block.program)),
            line: hit.block.map(|block| block.line),
            block: text.unwrap_or_default(),
            calls: frames.collect(),
            values: (values.iter())
                .map(|(name, value)| ((*name).to_owned(), value.to_json()))
                .collect::<BTreeMap<_, _>>(),
            fault: (hit.fault.as_ref())
                .map(|alarm| report::message_text(&alarm.reason(), self.language)),
        };
        let mut lines = vec![match (&report.program, report.line) {
            (Some(program), Some(line)) => {
                say::debug_hit(&report.location, program, line, t, &report.block)
            }
            _ => say::debug_hit_before(&report.location, t),
        }];
        if let Some(alarm) = &hit.fault {
            lines.push(say::debug_condition_failed(
                &report.location,
                alarm.reason(),
            ));
        }
        for (name, value) in values {
            lines.push(say::as_written(format!("  {name} = {value}")));
        }
        // The innermost call is the block itself.
        for call in report.calls.iter().skip(1) {
            lines.push(say::as_written(format!("  < {call}")));
        }
        self.reports.push(report);
        lines
    }

    /// Ends the trace and returns the reports of the breakpoints.
    ///
    /// # Errors
    /// The trace cannot be written.
    pub fn finish(&mut self) -> io::Result<Vec<BreakReport>> {
        if let Some(trace) = &mut self.trace {
            trace.finish()?;
        }
        Ok(core::mem::take(&mut self.reports))
    }
}

fn open_trace(args: &RunDebugArgs) -> Result<Option<TraceWriter>, CommandError> {
    let Some(path) = &args.trace else {
        return Ok(None);
    };
    let format = TraceFormat::from_file_name(&path.display().to_string());
    let format = format?;
    let signals = args.signals.as_deref().unwrap_or(trace::DEFAULT_SIGNALS);
    let targets = trace::parse_signals(signals)?;
    let writer = TraceWriter::new(format, targets, output::open(path)?);
    writer.map(Some).map_err(|error| match error {
        TraceError::Output(error) => CommandError::output(error),
        error @ TraceError::TextInBits(_) => error.message().into(),
    })
}

/// Whether any stream of results is written to standard output.
pub fn uses_standard_output(args: &RunArgs) -> bool {
    [&args.moves, &args.positions, &args.debug.trace]
        .into_iter()
        .any(|path| output::is_standard_output(path.as_deref()))
}
