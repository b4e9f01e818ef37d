//! Begins a run in the middle of its program.

use std::thread;

use crossbeam::channel::{Receiver, TryRecvError, bounded};
use gsk_core::cnc::ControlRequest;
use gsk_core::command::SourcePosition;
use gsk_core::simulation::Simulation;
use gsk_debugger::breakpoints::BreakpointSet;
use gsk_debugger::location::BreakLocation;
use gsk_debugger::source_files::ProgramSources;
use gsk_messages::{Message, say};
use gsk_runner::board::{BoardRestart, RestartPlanner};
use gsk_runner::machining::live_part::LivePart;
use gsk_runner::restart::{self, BlockWatcher, RestartPlan, RestartWords};

use crate::cli::RunArgs;
use crate::commands::program_sources::program_name;
use crate::commands::{CommandError, output};

/// Recognizes the location of the restart with the breakpoints of the debugger.
#[derive(Clone)]
struct LocationWatcher(BreakpointSet);

impl BlockWatcher for LocationWatcher {
    fn follow_tick(&mut self, simulation: &Simulation) -> Option<SourcePosition> {
        let hits = self.0.follow_tick(simulation, false);
        hits.first().and_then(|hit| hit.block)
    }
}

/// The restart that the options of a run request.
#[derive(Clone)]
pub struct RequestedRestart {
    watcher: LocationWatcher,
    pass: Option<u64>,
    words: RestartWords,
    /// The code of the differences that the operator has confirmed; `None` without the option.
    confirmed_code: Option<String>,
    sources: ProgramSources,
}

impl RequestedRestart {
    /// Reads the options; `None` without a restart.
    ///
    /// # Errors
    /// The location or a word is wrong.
    pub fn from_args(args: &RunArgs, sources: &ProgramSources) -> Result<Option<Self>, Message> {
        let Some(text) = &args.restart.restart else {
            return Ok(None);
        };
        let location = BreakLocation::parse(text, sources)?;
        if location.needs_part() {
            return Err(say::restart_at_collision(text));
        }
        let mut breakpoints = BreakpointSet::default();
        breakpoints.add(location);
        let mut words = RestartWords::default();
        for word in &args.restart.restart_words {
            words.set(word)?;
        }
        Ok(Some(Self {
            watcher: LocationWatcher(breakpoints),
            pass: args.restart.restart_pass,
            words,
            confirmed_code: args.restart.confirm.clone(),
            sources: sources.clone(),
        }))
    }

    /// Plans the restart of a machine. `part` is the uncut part. Also returns the part that the
    /// skipped blocks leave.
    fn plan(
        mut self,
        simulation: &Simulation,
        part: Option<LivePart>,
    ) -> Result<(RestartPlan, Option<LivePart>), Message> {
        let found = restart::find_block(simulation, part, &mut self.watcher, self.pass)?;
        let plan = restart::plan_restart(simulation, found.part.as_ref(), &found, &self.words)?;
        Ok((plan, found.part))
    }

    /// Prepares the restart on the simulated lathe: prints what differs and hands it to the
    /// control. `live_part` becomes the part that the skipped blocks leave.
    ///
    /// # Errors
    /// The block is not reached, or no way leads to its start point.
    pub fn prepare(
        self,
        simulation: &mut Simulation,
        live_part: &mut Option<LivePart>,
        is_result_elsewhere: bool,
    ) -> Result<(), CommandError> {
        let sources = self.sources.clone();
        let naming = simulation.cnc.model().record().program_naming();
        let (plan, part) = self.plan(simulation, live_part.take())?;
        for line in plan.lines(|program| program_name(program, naming, &sources)) {
            if is_result_elsewhere {
                output::report_error(&line);
            } else {
                output::print_message(&line);
            }
        }
        *live_part = part;
        let request = ControlRequest::Restart(plan.restart);
        if let Some(why) = simulation.cnc.request_refusal(&request) {
            return Err(why.into());
        }
        // The restart raises no alarm.
        let _ = simulation.cnc.request(request);
        Ok(())
    }

    /// A planner for a run on a board, with the uncut part. `keeps_part`: the run needs the part
    /// that the skipped blocks leave.
    pub fn into_planner(self, part: Option<LivePart>, keeps_part: bool) -> ThreadPlanner {
        ThreadPlanner {
            begins: Some((self, part, keeps_part)),
            plans: None,
        }
    }

    fn plan_for_board(
        self,
        simulation: &Simulation,
        part: Option<LivePart>,
    ) -> Result<BoardRestart, Message> {
        let sources = self.sources.clone();
        let naming = simulation.cnc.model().record().program_naming();
        let confirmed_code = self.confirmed_code.clone();
        let (plan, part) = self.plan(simulation, part)?;
        let code = plan.confirmation_code();
        let is_confirmed = match confirmed_code {
            Some(confirmed) if confirmed != code => return Err(say::restart_code_wrong(code)),
            confirmed => confirmed.is_some(),
        };
        Ok(BoardRestart {
            block_lines: plan.block_lines(|program| program_name(program, naming, &sources)),
            plan,
            part,
            is_confirmed,
        })
    }
}

/// Plans a restart in a thread: the board is served meanwhile.
pub struct ThreadPlanner {
    /// The restart, the uncut part and whether the run keeps the part, until the planner begins.
    begins: Option<(RequestedRestart, Option<LivePart>, bool)>,
    /// Where the plan arrives; `None` before the planner begins.
    plans: Option<Receiver<Result<BoardRestart, Message>>>,
}

impl RestartPlanner for ThreadPlanner {
    fn begin(&mut self, simulation: &Simulation) {
        let Some((requested, part, keeps_part)) = self.begins.take() else {
            return;
        };
        let (send, plans) = bounded(1);
        let simulation = simulation.clone();
        // Without a thread `poll` reports that no plan arrives.
        let _ = (thread::Builder::new().name("restart".to_owned())).spawn(move || {
            // The send fails when the run has ended. No run needs the plan then.
            let planned = requested.plan_for_board(&simulation, part);
            let _ = send.send(planned.map(|it| BoardRestart {
                part: it.part.filter(|_| keeps_part),
                ..it
            }));
        });
        self.plans = Some(plans);
    }

    fn poll(&mut self) -> Option<Result<BoardRestart, Message>> {
        match self.plans.as_ref()?.try_recv() {
            Ok(planned) => Some(planned),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err(say::window_kernel_stopped())),
        }
    }
}
