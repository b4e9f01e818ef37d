//! Converts breakpoints of the client to those of the session.

use std::collections::BTreeMap;
use std::path::Path;

use gsk_core::program::WatchFormula;
use gsk_debugger::location::{BreakEvent, BreakLocation, ProgramFilter, parse_condition};
use gsk_debugger::session::DebugSession;
use gsk_debugger::source_files::{ProgramSource, ProgramSources, find_block_line};
use gsk_debugger::watch::WatchTarget;
use gsk_messages::{Language, Message, say};
use serde_json::{Value, json};

use super::protocol::{BreakpointsArguments, SourceBreakpoint};

/// The breakpoints of the client that the session has, by what they were set for: a file, the
/// functions, the data.
#[derive(Default)]
pub struct ClientBreakpoints {
    ids: BTreeMap<String, Vec<u32>>,
}

/// The kind of breakpoints that a request of the client sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BreakpointKind {
    Line,
    Function,
    Data,
}

impl ClientBreakpoints {
    /// Replaces the breakpoints of a file, of the functions or of the data. Returns the list of
    /// breakpoints for the response. `first_line` is the number of the client's first line.
    pub fn replace(
        &mut self,
        kind: BreakpointKind,
        args: &BreakpointsArguments,
        session: &mut DebugSession,
        sources: &ProgramSources,
        (language, first_line): (Language, i64),
    ) -> Value {
        let key = match kind {
            BreakpointKind::Line => format!("file {}", args.source.path),
            BreakpointKind::Function => "functions".to_owned(),
            BreakpointKind::Data => "data".to_owned(),
        };
        let ids = self.ids.entry(key).or_default();
        for id in ids.drain(..) {
            session.breakpoints.remove(id);
        }
        let mut answers = Vec::with_capacity(args.breakpoints.len());
        for wanted in &args.breakpoints {
            let parsed = match kind {
                BreakpointKind::Line => {
                    let line = u32::try_from(wanted.line - first_line + 1).unwrap_or(0);
                    parse_line(wanted, line, &args.source.path, session, sources)
                }
                BreakpointKind::Function => parse_function(wanted, sources),
                BreakpointKind::Data => parse_data(wanted),
            };
            answers.push(match parsed {
                Ok((location, line)) => {
                    let id = session.breakpoints.add(location);
                    ids.push(id);
                    let mut answer = json!({"id": id, "verified": true});
                    if let Some(line) = line {
                        answer["line"] = (i64::from(line) + first_line - 1).into();
                    }
                    answer
                }
                Err(message) => json!({"verified": false, "message": message.text(language)}),
            });
        }
        session.resync_breakpoints();
        json!({"breakpoints": answers})
    }
}

type ParsedBreakpoint = Result<(BreakLocation, Option<u32>), Message>;

fn parse_line(
    wanted: &SourceBreakpoint,
    line: u32,
    path: &str,
    session: &DebugSession,
    sources: &ProgramSources,
) -> ParsedBreakpoint {
    let known: Vec<&str> = (sources.files().iter())
        .map(|file| file.path.as_str())
        .collect();
    let file =
        find_file(sources, path).ok_or_else(|| say::debug_file_unknown(path, known.join(", ")))?;
    let programs = session.run().simulation().cnc.programs();
    let (program, line) =
        find_block_line(programs, &file.programs, line).ok_or_else(say::dap_no_block)?;
    let location = BreakLocation {
        text: format!("{path}:{line}"),
        event: BreakEvent::Line(ProgramFilter::Listed(vec![program]), line),
        condition: condition(wanted)?,
    };
    Ok((location, Some(line)))
}

fn parse_function(wanted: &SourceBreakpoint, sources: &ProgramSources) -> ParsedBreakpoint {
    let mut location = BreakLocation::parse(&wanted.name, sources)?;
    if let Some(condition) = condition(wanted)? {
        location.condition = Some(condition);
    }
    Ok((location, None))
}

fn parse_data(wanted: &SourceBreakpoint) -> ParsedBreakpoint {
    let target = WatchTarget::parse(&wanted.data_id)?;
    let location = BreakLocation {
        text: wanted.data_id.clone(),
        event: BreakEvent::Change(target),
        condition: condition(wanted)?,
    };
    Ok((location, None))
}

fn condition(wanted: &SourceBreakpoint) -> Result<Option<WatchFormula>, Message> {
    let text = wanted.condition.as_deref().map(str::trim);
    let text = text.filter(|text| !text.is_empty());
    text.map(parse_condition).transpose()
}

/// Finds a file by the path of the client, which may be written in another way.
pub fn find_file<'a>(sources: &'a ProgramSources, path: &str) -> Option<&'a ProgramSource> {
    let resolve = |path: &str| Path::new(path).canonicalize().ok();
    let wanted = resolve(path);
    let files = sources.files();
    let same = files
        .iter()
        .find(|file| wanted.is_some() && resolve(&file.path) == wanted);
    same.or_else(|| sources.find(path))
}
