//! A launched program: its session, and its answers about blocks and calls.

use gsk_core::alarm::Alarm;
use gsk_core::command::ProgramId;
use gsk_debugger::session::{DebugSession, DebugStep};
use gsk_debugger::source_files::{ProgramSources, find_block_line};
use gsk_messages::Language;
use serde_json::{Value, json};

use super::protocol::{BreakpointsArguments, InquiryArguments};
use super::stop_points::{BreakpointKind, ClientBreakpoints, find_file};
use crate::commands::program_sources::program_name;

/// The state of the debug session between requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SessionState {
    /// Breakpoints are being set; the request `configurationDone` starts the program.
    Configuring,
    Running,
    Stopped,
    Ended,
}

/// A launched program, with the breakpoints that the client has set for it.
pub struct LaunchedProgram {
    pub session: DebugSession,
    pub sources: ProgramSources,
    pub breakpoints: ClientBreakpoints,
    pub state: SessionState,
    /// Whether the session stops before the first block.
    pub stops_on_entry: bool,
    pub is_undisturbed: bool,
    /// The alarm or message of the last stop by one; `None` after another stop.
    pub exception: Option<Alarm>,
    /// The targets of `goto` requests; their numbers count from 1.
    pub goto_targets: Vec<(ProgramId, u32)>,
    /// Line of the `goto` under way, and whether it already runs from the beginning.
    pub goto: Option<(ProgramId, u32, bool)>,
    /// The step of the granularity `instruction`.
    pub instruction: DebugStep,
}

impl LaunchedProgram {
    /// Replaces the client's breakpoints of one kind; returns the body of the response.
    pub fn set_breakpoints(
        &mut self,
        kind: BreakpointKind,
        args: &BreakpointsArguments,
        language: Language,
        first_line: i64,
    ) -> Value {
        self.breakpoints.replace(
            kind,
            args,
            &mut self.session,
            &self.sources,
            (language, first_line),
        )
    }

    /// Returns the body of the response to `stackTrace`.
    pub fn stack_trace(&self, args: &InquiryArguments, first_line: i64) -> Value {
        let run = self.session.run();
        let model = run.simulation().cnc.model();
        let naming = model.record().program_naming();
        let mut frames = run.frames();
        if let (Some(block), Some(frame)) = (self.session.stop_block(), frames.first_mut())
            && frame.program == block.program
        {
            frame.line = block.line;
        }
        let all = frames.iter().enumerate().map(|(index, frame)| {
            let file = self.sources.file_of(frame.program);
            let mut answer = json!({
                "id": index + 1,
                "name": program_name(frame.program, naming, &self.sources),
                "line": i64::from(frame.line) + first_line - 1,
                "column": 1,
            });
            if let Some(file) = file {
                let path = std::path::absolute(&file.path);
                let path = path.map_or_else(|_| file.path.clone(), |it| it.display().to_string());
                let name = path.rsplit(['/', '\\']).next().unwrap_or_default();
                if frame.program == ProgramId::External {
                    answer["name"] = json!(name);
                }
                answer["source"] = json!({"name": name, "path": path});
            }
            answer
        });
        let levels = match args.levels {
            0 => usize::MAX,
            levels => levels,
        };
        let shown: Vec<Value> = all.skip(args.start_frame).take(levels).collect();
        json!({"stackFrames": shown, "totalFrames": frames.len()})
    }

    /// The body of a `gotoTargets` response; `None` if no block is at or after the line.
    pub fn add_goto_targets(&mut self, args: &InquiryArguments, first_line: i64) -> Option<Value> {
        let line = u32::try_from(args.line - first_line + 1).ok()?;
        let file = find_file(&self.sources, &args.source.path)?;
        let programs = self.session.run().simulation().cnc.programs();
        let (program, line) = find_block_line(programs, &file.programs, line)?;
        let label = programs.get(program)?.line(line).trim().to_owned();
        self.goto_targets.push((program, line));
        Some(json!({"targets": [{
            "id": self.goto_targets.len(),
            "label": label,
            "line": i64::from(line) + first_line - 1,
        }]}))
    }
}
