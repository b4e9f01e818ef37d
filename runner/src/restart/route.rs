//! The way to the start point of a restart: away from the part, tool change, spindle, approach.
//! Each order of the axes is tried in a copy of the machine with its part.

use gsk_core::cnc::{ControlRequest, RestartRoute};
use gsk_core::operation::PreparedRestart;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_messages::{Message, say};

use super::block_search::BlockState;
use super::copy_run::{CopyProgress, CopyRun};
use super::machine_functions::{Equipment, MachineFunctions};
use crate::machining::live_part::LivePart;
use crate::report;

/// Greatest machine time of a trial approach, ticks.
const MAX_TRIAL_TICKS: u32 = 300_000;
/// Length of a displacement below which an axis does not move, mm.
const SAME_MM: f64 = 1e-9;

/// Which axis moves first on a section of the approach: X or Z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum AxisOrder {
    XFirst,
    ZFirst,
}

/// The orders of retract and approach that are tried; the usual one of outside turning is first.
const ORDERS: [(AxisOrder, AxisOrder); 4] = [
    (AxisOrder::XFirst, AxisOrder::ZFirst),
    (AxisOrder::ZFirst, AxisOrder::XFirst),
    (AxisOrder::ZFirst, AxisOrder::ZFirst),
    (AxisOrder::XFirst, AxisOrder::XFirst),
];

/// Finds the first way without a collision.
///
/// # Errors
/// Why no way leads to the start point.
pub(super) fn find_route(
    now: &Simulation,
    part: Option<&LivePart>,
    target: &BlockState,
) -> Result<RestartRoute, Message> {
    let mut reason = None;
    for (retract, approach) in ORDERS {
        let route = build_route(now, target, retract, approach);
        match try_route(now, part, target, &route) {
            Ok(()) => return Ok(route),
            Err(why) => reason = Some(why),
        }
    }
    Err(reason.unwrap_or_else(say::restart_approach_collision))
}

/// Prepares the restart on a way.
///
/// # Errors
/// The copy of `target` has not read a block.
pub(super) fn prepare(
    now: &Simulation,
    target: &BlockState,
    route: &RestartRoute,
) -> Result<PreparedRestart, Message> {
    let restart = now.cnc.prepare_restart(&target.simulation.cnc, route);
    restart.ok_or_else(say::restart_block_ended)
}

fn build_route(
    now: &Simulation,
    target: &BlockState,
    retract: AxisOrder,
    approach: AxisOrder,
) -> RestartRoute {
    let from = now.cnc.position_machine();
    let to = target.simulation.cnc.commanded_machine_position();
    let clear = target.clear_point;
    let functions = &target.functions;
    let (m_before_tool, m_after_tool) = function_codes(now, target, functions);
    RestartRoute {
        retract: leg(from, clear, retract),
        m_before_tool,
        m_after_tool,
        approach: leg(clear, to, approach),
        first_cut_frames: target.first_cut_frames.clone(),
    }
}

/// Returns the points of a section of the approach, one axis after the other; none for an axis that
/// does not move.
fn leg(from: Point, to: Point, order: AxisOrder) -> Vec<Point> {
    let corner = match order {
        AxisOrder::XFirst => Point::new(to.x, from.z),
        AxisOrder::ZFirst => Point::new(from.x, to.z),
    };
    let mut points = Vec::new();
    let mut last = from;
    for point in [corner, to] {
        if (point - last).length() > SAME_MM {
            points.push(point);
            last = point;
        }
    }
    points
}

/// The M codes before the tool change and after the S function. The spindle stops first when
/// its direction changes or the chuck is switched.
fn function_codes(
    now: &Simulation,
    target: &BlockState,
    functions: &MachineFunctions,
) -> (Vec<u8>, Vec<u8>) {
    let spindle = functions.last(Equipment::Spindle);
    let spindle = spindle.map(|_| target.spindle_code());
    let turning = now.cnc.spindle_m_code();
    let holders = [Equipment::Chuck, Equipment::Tailstock].map(|it| functions.last(it));
    let is_stopped_first = turning != 5
        && (holders.iter().any(Option::is_some) || spindle.is_some_and(|code| code != turning));
    let mut before: Vec<u8> = is_stopped_first.then_some(5).into_iter().collect();
    before.extend(holders.into_iter().flatten());
    let gear = functions.last(Equipment::Gear);
    let others = [Equipment::Coolant, Equipment::Lubrication].map(|it| functions.last(it));
    let kept = is_stopped_first.then_some(turning);
    let after = [gear, spindle.or(kept)].into_iter().chain(others);
    (before, after.flatten().collect())
}

/// Executes the approach in a copy of the machine, to find out whether it collides.
fn try_route(
    now: &Simulation,
    part: Option<&LivePart>,
    target: &BlockState,
    route: &RestartRoute,
) -> Result<(), Message> {
    let restart = prepare(now, target, route)?;
    let mut simulation = now.clone();
    let request = ControlRequest::Restart(Box::new(restart));
    if let Some(why) = simulation.cnc.request_refusal(&request) {
        return Err(why);
    }
    // The restart raises no alarm.
    let _ = simulation.cnc.request(request);
    let mut copy = CopyRun::new(simulation, part.cloned());
    for _ in 0..MAX_TRIAL_TICKS {
        if !copy.tick().is_empty() {
            return Err(say::restart_approach_collision());
        }
        let cnc = &copy.simulation.cnc;
        let message = cnc.active_message();
        if let Some(alarm) = cnc.alarms().first().or(message.as_ref()) {
            return Err(say::restart_approach_alarm(alarm.number, alarm.reason()));
        }
        match copy.progress() {
            CopyProgress::Running => {}
            CopyProgress::Stopped if !cnc.has_restart() => return Ok(()),
            CopyProgress::Stopped | CopyProgress::Ended => break,
        }
    }
    let cnc = &copy.simulation.cnc;
    let wait = cnc.wait_reason().or_else(|| cnc.start_refusal());
    Err(say::restart_approach_stuck(
        wait.unwrap_or_else(say::wait_for_cycle_start),
    ))
}

/// Returns the actions of the approach as messages, in their order.
pub(super) fn step_messages(route: &RestartRoute, target: &Simulation) -> Vec<Message> {
    let rapid = |point: &Point| say::restart_path(2.0 * point.x, point.z);
    let output = |code: &u8| say::restart_step_m(*code);
    let mut steps: Vec<Message> = route.retract.iter().map(rapid).collect();
    steps.extend(route.m_before_tool.iter().map(output));
    steps.push(say::restart_step_tool(report::tool_word(target.cnc.tool())));
    let spindle = target.cnc.spindle();
    let code = if spindle.is_surface_mode() {
        "G96"
    } else {
        "G97"
    };
    steps.push(say::restart_step_s(format!("{code} S{}", spindle.s_word())));
    steps.extend(route.m_after_tool.iter().map(output));
    steps.extend(route.approach.iter().map(rapid));
    steps
}
