//! Begins a run in the middle of its program.

use gsk_core::cnc::ControlRequest;
use gsk_core::command::SourcePosition;
use gsk_core::simulation::Simulation;
use gsk_debugger::breakpoints::BreakpointSet;
use gsk_debugger::location::BreakLocation;
use gsk_messages::say;
use gsk_runner::machining::live_part::LivePart;
use gsk_runner::restart::{self, BlockWatcher};

use super::debugging::{RunDebugger, uses_standard_output};
use crate::cli::RunArgs;
use crate::commands::{CommandError, output};

/// Recognizes the location of the restart with the breakpoints of the debugger.
struct LocationWatcher(BreakpointSet);

impl BlockWatcher for LocationWatcher {
    fn follow_tick(&mut self, simulation: &Simulation) -> Option<SourcePosition> {
        let hits = self.0.follow_tick(simulation, false);
        hits.first().and_then(|hit| hit.block)
    }
}

/// Prepares the restart that the options request: prints what differs and hands it to the
/// control. `live_part` becomes the part that the skipped blocks leave. Does nothing without
/// the option.
///
/// # Errors
/// The location is wrong, the block is not reached, or no way leads to its start point.
pub fn prepare_restart(
    args: &RunArgs,
    simulation: &mut Simulation,
    live_part: &mut Option<LivePart>,
    debugger: &RunDebugger,
) -> Result<(), CommandError> {
    let Some(text) = &args.restart.restart else {
        return Ok(());
    };
    let location = BreakLocation::parse(text, debugger.sources())?;
    if location.needs_part() {
        return Err(say::restart_at_collision(text).into());
    }
    let mut breakpoints = BreakpointSet::default();
    breakpoints.add(location);
    let mut watcher = LocationWatcher(breakpoints);
    let pass = args.restart.restart_pass;
    let target = restart::find_block(simulation, live_part.take(), &mut watcher, pass)?;
    let plan = restart::plan_restart(simulation, target.part.as_ref(), &target)?;
    let is_result_elsewhere = args.json || uses_standard_output(args);
    for line in plan.lines(|program| debugger.name_of(program)) {
        if is_result_elsewhere {
            output::report_error(&line);
        } else {
            output::print_message(&line);
        }
    }
    *live_part = target.part;
    let request = ControlRequest::Restart(plan.restart);
    if let Some(why) = simulation.cnc.request_refusal(&request) {
        return Err(why.into());
    }
    // The restart raises no alarm.
    let _ = simulation.cnc.request(request);
    Ok(())
}
