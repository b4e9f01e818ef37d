//! Answers the requests of a debug client and runs the session between them.

use std::io::{self, Write};

use crossbeam::channel::{Receiver, TryRecvError};
use gsk_core::alarm::Alarm;
use gsk_debugger::session::{DebugStep, StopReason};
use gsk_debugger::watch::WatchTarget;
use gsk_host::setup_args::SetupArgs;
use gsk_messages::{Language, say};
use serde_json::{Value, json};

use super::launch::launch;
use super::launched_program::{LaunchedProgram, SessionState};
use super::protocol::{
    BreakpointsArguments, ClientOutput, InitializeArguments, InquiryArguments, LaunchArguments,
    Request,
};
use super::stop_points::{BreakpointKind, ClientBreakpoints};
use super::variables;
use crate::cli::is_chinese;

/// Number of ticks between two checks for requests while the program runs.
const RUN_TICKS: u64 = 20_000;
/// Id of the only thread: the control.
const THREAD_ID: i64 = 1;
const ALARM_FILTER: &str = "alarms";
const MESSAGE_FILTER: &str = "messages";
const COLLISION_FILTER: &str = "collisions";

struct DapServer<'a, W> {
    client: ClientOutput<W>,
    setup: &'a SetupArgs,
    language: Language,
    /// Whether the command line has chosen the language.
    is_language_fixed: bool,
    /// Number that the client gives to the first line: 1 or 0.
    first_line: i64,
    program: Option<LaunchedProgram>,
    is_finished: bool,
}

/// Serves a client until it disconnects.
///
/// # Errors
/// The client does not read.
pub fn serve(
    requests: &Receiver<Request>,
    output: impl Write,
    setup: &SetupArgs,
    language: Option<Language>,
) -> io::Result<()> {
    let mut server = DapServer {
        client: ClientOutput::new(output),
        setup,
        language: language.unwrap_or(Language::En),
        is_language_fixed: language.is_some(),
        first_line: 1,
        program: None,
        is_finished: false,
    };
    while !server.is_finished {
        if server.is_running() {
            match requests.try_recv() {
                Ok(request) => server.handle(&request)?,
                Err(TryRecvError::Empty) => server.advance()?,
                Err(TryRecvError::Disconnected) => break,
            }
        } else {
            let Ok(request) = requests.recv() else { break };
            server.handle(&request)?;
        }
    }
    Ok(())
}

impl<W: Write> DapServer<'_, W> {
    fn is_running(&self) -> bool {
        let program = self.program.as_ref();
        program.is_some_and(|program| program.state == SessionState::Running)
    }

    fn handle(&mut self, request: &Request) -> io::Result<()> {
        let result = match request.command.as_str() {
            "initialize" => self.initialize(request),
            "launch" => return self.launch(request),
            "disconnect" | "terminate" => return self.finish(request),
            _ => match self.answer(request) {
                Some(result) => result,
                None => return self.control(request),
            },
        };
        self.client.send_response(request, result)
    }

    fn initialize(&mut self, request: &Request) -> Result<Value, String> {
        let args: InitializeArguments = request.parse()?;
        self.first_line = i64::from(args.lines_start_at_1);
        if !self.is_language_fixed && is_chinese(&args.locale) {
            self.language = Language::Zh;
        }
        let filter = |id: &str, label: gsk_messages::Message, is_default: bool| json!({"filter": id, "label": label.text(self.language), "default": is_default});
        Ok(json!({
            "supportsConfigurationDoneRequest": true,
            "supportsConditionalBreakpoints": true,
            "supportsFunctionBreakpoints": true,
            "supportsDataBreakpoints": true,
            "supportsStepBack": true,
            "supportsGotoTargetsRequest": true,
            "supportsEvaluateForHovers": true,
            "supportsExceptionInfoRequest": true,
            "supportsSteppingGranularity": true,
            "supportsTerminateRequest": true,
            "exceptionBreakpointFilters": [
                filter(ALARM_FILTER, say::dap_filter_alarms(), true),
                filter(MESSAGE_FILTER, say::dap_filter_messages(), true),
                filter(COLLISION_FILTER, say::dap_filter_collisions(), true),
            ],
        }))
    }

    fn launch(&mut self, request: &Request) -> io::Result<()> {
        let launched = request.parse().and_then(|args: LaunchArguments| {
            let (session, sources) = launch(&args, self.setup, self.language)
                .map_err(|error| error.message().text(self.language))?;
            Ok(LaunchedProgram {
                session,
                sources,
                breakpoints: ClientBreakpoints::default(),
                state: SessionState::Configuring,
                stops_on_entry: args.stop_on_entry && !args.no_debug,
                is_undisturbed: args.no_debug,
                exception: None,
                goto_targets: Vec::new(),
                goto: None,
                instruction: match args.instruction.as_str() {
                    "slot" => DebugStep::Slot,
                    _ => DebugStep::Tick,
                },
            })
        });
        match launched {
            Ok(program) => {
                self.program = Some(program);
                self.client.send_response(request, Ok(Value::Null))?;
                self.client.send_event("initialized", json!({}))
            }
            Err(text) => self.client.send_response(request, Err(text)),
        }
    }

    fn finish(&mut self, request: &Request) -> io::Result<()> {
        self.client.send_response(request, Ok(Value::Null))?;
        if request.command == "terminate" {
            return self.end_program();
        }
        self.is_finished = true;
        Ok(())
    }

    /// Reports the end of the program to the client, once.
    fn end_program(&mut self) -> io::Result<()> {
        if let Some(program) = &mut self.program {
            if program.state == SessionState::Ended {
                return Ok(());
            }
            program.state = SessionState::Ended;
        }
        self.client.send_event("exited", json!({"exitCode": 0}))?;
        self.client.send_event("terminated", json!({}))
    }

    /// Answers a request that does not move the program; `None` for another one.
    fn answer(&mut self, request: &Request) -> Option<Result<Value, String>> {
        let unknown = say::dap_request_unknown(&request.command).text(self.language);
        if request.command == "threads" {
            let name = say::dap_thread().text(self.language);
            return Some(Ok(json!({"threads": [{"id": THREAD_ID, "name": name}]})));
        }
        let Some(program) = &mut self.program else {
            return Some(Err(unknown));
        };
        let (language, first_line) = (self.language, self.first_line);
        let kind = match request.command.as_str() {
            "setBreakpoints" => Some(BreakpointKind::Line),
            "setFunctionBreakpoints" => Some(BreakpointKind::Function),
            "setDataBreakpoints" => Some(BreakpointKind::Data),
            _ => None,
        };
        if let Some(kind) = kind {
            let parsed = request.parse::<BreakpointsArguments>();
            return Some(
                parsed.map(|args| program.set_breakpoints(kind, &args, language, first_line)),
            );
        }
        let args: InquiryArguments = match request.parse() {
            Ok(args) => args,
            Err(text) => return Some(Err(text)),
        };
        let simulation = program.session.run().simulation();
        Some(match request.command.as_str() {
            "setExceptionBreakpoints" => {
                let has = |id: &str| args.filters.iter().any(|filter| filter == id);
                program.session.filter.alarms = has(ALARM_FILTER);
                program.session.filter.messages = has(MESSAGE_FILTER);
                program.session.filter.collisions = has(COLLISION_FILTER);
                Ok(Value::Null)
            }
            "stackTrace" => Ok(program.stack_trace(&args, first_line)),
            "scopes" => Ok(variables::scopes(language)),
            "variables" => Ok(variables::variables(args.variables_reference, simulation)),
            "evaluate" => {
                let target = WatchTarget::parse(&args.expression);
                let value = target.and_then(|target| {
                    (target.read(simulation)).map_err(|alarm| {
                        say::debug_condition_failed(&args.expression, alarm.reason())
                    })
                });
                value
                    .map(|value| json!({"result": value.to_string(), "variablesReference": 0}))
                    .map_err(|message| message.text(language))
            }
            "dataBreakpointInfo" => Ok(match WatchTarget::parse(&args.name) {
                Ok(target) => json!({
                    "dataId": target.name(),
                    "description": target.name(),
                    "accessTypes": ["write"],
                }),
                Err(message) => json!({"dataId": null, "description": message.text(language)}),
            }),
            "exceptionInfo" => match &program.exception {
                Some(alarm) => Ok(json!({
                    "exceptionId": alarm.number_text(),
                    "description": alarm_text(alarm, language),
                    "breakMode": "always",
                })),
                None => Err(unknown),
            },
            "gotoTargets" => program
                .add_goto_targets(&args, first_line)
                .ok_or_else(|| say::dap_goto_unknown().text(language)),
            "configurationDone" | "continue" | "next" | "stepIn" | "stepOut" | "stepBack"
            | "reverseContinue" | "pause" | "goto" => return None,
            _ => Err(unknown),
        })
    }

    /// Carries out a request that continues, steps or stops the program.
    fn control(&mut self, request: &Request) -> io::Result<()> {
        let args: InquiryArguments = match request.parse() {
            Ok(args) => args,
            Err(text) => return self.client.send_response(request, Err(text)),
        };
        let Some(program) = &mut self.program else {
            return Ok(());
        };
        if request.command == "configurationDone" && program.stops_on_entry {
            program.state = SessionState::Stopped;
            self.client.send_response(request, Ok(Value::Null))?;
            return self.send_stopped("entry", None);
        }
        let is_instruction = args.granularity == "instruction";
        let instruction = program.instruction;
        let step = |kind: DebugStep| if is_instruction { instruction } else { kind };
        let forwards = match request.command.as_str() {
            "configurationDone" | "continue" => Some(DebugStep::Continue),
            "next" => Some(step(DebugStep::Over)),
            "stepIn" => Some(step(DebugStep::Into)),
            "stepOut" => Some(step(DebugStep::Out)),
            _ => None,
        };
        if let Some(kind) = forwards {
            if program.state != SessionState::Ended {
                program.exception = None;
                program.goto = None;
                program.session.begin_step(kind);
                program.state = SessionState::Running;
            }
            let body = json!({"allThreadsContinued": true});
            let body = if request.command == "continue" {
                body
            } else {
                Value::Null
            };
            return self.client.send_response(request, Ok(body));
        }
        match request.command.as_str() {
            "stepBack" | "reverseContinue" => {
                let kind = match request.command.as_str() {
                    "stepBack" => step(DebugStep::Over),
                    _ => DebugStep::Continue,
                };
                self.client.send_response(request, Ok(Value::Null))?;
                let reason = program.session.go_back(kind);
                self.report_stop(reason)
            }
            "goto" => {
                let index = usize::try_from(args.target_id - 1).unwrap_or(usize::MAX);
                let Some((target, line)) = program.goto_targets.get(index).copied() else {
                    let text = say::dap_goto_unknown().text(self.language);
                    return self.client.send_response(request, Err(text));
                };
                program.goto = Some((target, line, false));
                program.exception = None;
                program.session.begin_run_to(target, line);
                program.state = SessionState::Running;
                self.client.send_response(request, Ok(Value::Null))
            }
            _ => {
                let was_running = program.state == SessionState::Running;
                program.state = SessionState::Stopped;
                self.client.send_response(request, Ok(Value::Null))?;
                if was_running {
                    self.send_stopped("pause", None)?;
                }
                Ok(())
            }
        }
    }

    /// Runs the program for a limited number of ticks.
    fn advance(&mut self) -> io::Result<()> {
        let Some(program) = &mut self.program else {
            return Ok(());
        };
        match program.session.advance(RUN_TICKS) {
            Some(reason) => self.report_stop(reason),
            None => Ok(()),
        }
    }

    fn report_stop(&mut self, reason: StopReason) -> io::Result<()> {
        let language = self.language;
        let Some(program) = &mut self.program else {
            return Ok(());
        };
        if program.is_undisturbed && reason != StopReason::Ended {
            if reason == StopReason::ProgramStop {
                program.session.begin_step(DebugStep::Continue);
            }
            return Ok(());
        }
        program.state = SessionState::Stopped;
        program.exception = None;
        match reason {
            StopReason::Entry => self.send_stopped("entry", None),
            StopReason::Step => self.send_stopped("step", None),
            StopReason::ProgramStop => self.send_stopped("pause", Some("M00".to_owned())),
            StopReason::Reached => self.send_stopped("goto", None),
            StopReason::Breakpoint(hits) => {
                let faults = hits.iter().filter_map(|hit| hit.fault.as_ref());
                let text = faults.map(|alarm| alarm_text(alarm, language)).next();
                let ids: Vec<u32> = hits.iter().map(|hit| hit.id).collect();
                self.client.send_event(
                    "stopped",
                    json!({
                        "reason": "breakpoint",
                        "threadId": THREAD_ID,
                        "allThreadsStopped": true,
                        "hitBreakpointIds": ids,
                        "text": text,
                    }),
                )
            }
            StopReason::Alarm(alarm) | StopReason::Message(alarm) => self.report_exception(alarm),
            StopReason::Collision(found) => {
                let text = found.collision.message().text(language);
                self.send_stopped("exception", Some(text))
            }
            StopReason::Ended => match program.goto {
                Some((target, line, false)) => {
                    // The block may be before the present one.
                    program.session.rewind();
                    program.session.begin_run_to(target, line);
                    program.goto = Some((target, line, true));
                    program.state = SessionState::Running;
                    Ok(())
                }
                Some((_, line, true)) => {
                    program.goto = None;
                    program.session.rewind();
                    let text = say::dap_goto_unreached(line).text(language);
                    self.send_stopped("entry", Some(text))
                }
                None => self.end_program(),
            },
        }
    }

    fn report_exception(&mut self, alarm: Alarm) -> io::Result<()> {
        let text = alarm_text(&alarm, self.language);
        if let Some(program) = &mut self.program {
            program.exception = Some(alarm);
        }
        self.send_stopped("exception", Some(text))
    }

    fn send_stopped(&mut self, reason: &str, text: Option<String>) -> io::Result<()> {
        let mut body = json!({
            "reason": reason,
            "threadId": THREAD_ID,
            "allThreadsStopped": true,
        });
        if let Some(text) = text {
            body["description"] = text.as_str().into();
            body["text"] = text.into();
        }
        self.client.send_event("stopped", body)
    }
}

fn alarm_text(alarm: &Alarm, language: Language) -> String {
    let (number, text) = (alarm.number_text(), alarm.text(language));
    format!("{number} {text}: {}", alarm.reason().text(language))
}
