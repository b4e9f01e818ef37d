//! The breakpoints of a debugger: which of them a tick of the control hits.

use gsk_core::alarm::Alarm;
use gsk_core::cnc::{Cnc, Event};
use gsk_core::command::{ProgramId, SourcePosition};
use gsk_core::interpreter::RunningCall;
use gsk_core::simulation::Simulation;
use gsk_runner::block_calls::calls_of_block;

use crate::location::{BreakEvent, BreakLocation, ProgramFilter};
use crate::watch::{WatchTarget, WatchedValue};

/// A breakpoint that a tick has hit.
#[derive(Clone, Debug, PartialEq)]
pub struct BreakHit {
    /// The number of the breakpoint, which [`BreakpointSet::add`] returned.
    pub id: u32,
    /// The block of the hit: the one that begins, else the one in execution.
    pub block: Option<SourcePosition>,
    /// The alarm of a condition that could not be evaluated; the run stops for it.
    pub fault: Option<Alarm>,
}

#[derive(Clone, Debug, PartialEq)]
struct Breakpoint {
    id: u32,
    location: BreakLocation,
    /// The value at the last tick, of a breakpoint on a value; `None` before the first.
    last: Option<WatchedValue>,
}

/// All breakpoints, and what they need to know of the last tick. This state is separate from
/// the machine's: it survives going back.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BreakpointSet {
    breakpoints: Vec<Breakpoint>,
    next_id: u32,
    /// The block that began last; `None` if no block has begun.
    last_block: Option<SourcePosition>,
    /// The first block of the program that contains the block that began last.
    entry_line: u32,
    messages: Vec<u16>,
    /// The calls of the block that began last, the innermost last.
    calls: Vec<RunningCall>,
}

impl BreakpointSet {
    /// Adds a breakpoint and returns its number, from 1.
    pub fn add(&mut self, location: BreakLocation) -> u32 {
        self.next_id += 1;
        self.breakpoints.push(Breakpoint {
            id: self.next_id,
            location,
            last: None,
        });
        self.next_id
    }

    /// Removes the breakpoint with this number.
    pub fn remove(&mut self, id: u32) {
        self.breakpoints.retain(|it| it.id != id);
    }

    /// The location of a breakpoint; `None` after its removal.
    pub fn location(&self, id: u32) -> Option<&BreakLocation> {
        let found = self.breakpoints.iter().find(|it| it.id == id);
        found.map(|it| &it.location)
    }

    /// Whether the set has no breakpoints.
    pub const fn is_empty(&self) -> bool {
        self.breakpoints.is_empty()
    }

    /// Whether a breakpoint needs the collisions of the part.
    pub fn needs_part(&self) -> bool {
        self.breakpoints.iter().any(|it| it.location.needs_part())
    }

    /// Whether a breakpoint needs the explanations of cycle passes.
    pub fn needs_passes(&self) -> bool {
        self.breakpoints.iter().any(|it| it.location.needs_passes())
    }

    /// Takes the state of a machine as that of the last tick, after the machine has gone to
    /// another moment. `block` is its block in execution.
    pub fn resync(&mut self, simulation: &Simulation, block: Option<SourcePosition>) {
        self.last_block = block;
        self.entry_line = 0;
        self.messages = active_messages(&simulation.cnc);
        // The calls of the block, and not one that was read ahead and begins later.
        self.calls = block.map_or_else(Vec::new, |it| calls_of_block(&simulation.cnc, it));
        for breakpoint in &mut self.breakpoints {
            breakpoint.last = read_value(&breakpoint.location.event, simulation);
        }
    }

    /// Returns the breakpoints that the last tick has hit. Call it after every tick;
    /// `has_collided` is whether that tick has found a collision.
    pub fn follow_tick(&mut self, simulation: &Simulation, has_collided: bool) -> Vec<BreakHit> {
        let cnc = &simulation.cnc;
        let mut hits = Vec::new();
        for event in cnc.events() {
            self.follow_event(event, simulation, &mut hits);
        }
        let messages = active_messages(cnc);
        let tick = cnc.ticks();
        for breakpoint in &mut self.breakpoints {
            let is_hit = match &breakpoint.location.event {
                BreakEvent::Collision => has_collided,
                BreakEvent::Tick(wanted) => tick == *wanted,
                BreakEvent::Message(wanted) => messages.iter().any(|number| {
                    !self.messages.contains(number) && wanted.is_none_or(|it| it == *number)
                }),
                event @ (BreakEvent::Change(_) | BreakEvent::Comparison(..)) => {
                    let value = read_value(event, simulation);
                    let is_hit = is_value_hit(event, breakpoint.last.as_ref(), value.as_ref());
                    breakpoint.last = value;
                    is_hit
                }
                _ => false,
            };
            if is_hit {
                hits.extend(check_condition(breakpoint, simulation, self.last_block));
            }
        }
        self.messages = messages;
        hits
    }

    /// Handles the calls that lead to a block that begins. A block that only calls is no block
    /// of the machine: its line counts as reached when the first block after it begins.
    fn follow_calls(
        &mut self,
        block: SourcePosition,
        simulation: &Simulation,
        hits: &mut Vec<BreakHit>,
    ) {
        let calls = calls_of_block(&simulation.cnc, block);
        let is_same = |(one, other): &(&RunningCall, &RunningCall)| {
            (one.program, one.caller, one.caller_line)
                == (other.program, other.caller, other.caller_line)
        };
        let common = calls.iter().zip(&self.calls).take_while(is_same).count();
        for call in calls.iter().skip(common) {
            // M98 with other words has begun as a block.
            if self
                .last_block
                .is_some_and(|last| (last.program, last.line) == (call.caller, call.caller_line))
            {
                continue;
            }
            for breakpoint in &self.breakpoints {
                if let BreakEvent::Line(filter, line) = &breakpoint.location.event
                    && call.caller_line == *line
                    && is_in(&simulation.cnc, filter, call.caller)
                {
                    let caller = SourcePosition {
                        program: call.caller,
                        line: *line,
                        sequence: None,
                    };
                    hits.extend(check_condition(breakpoint, simulation, Some(caller)));
                }
            }
        }
        self.calls = calls;
    }

    fn follow_event(&mut self, event: &Event, simulation: &Simulation, hits: &mut Vec<BreakHit>) {
        if let Event::BlockStarted(source, _) = event {
            self.follow_calls(*source, simulation, hits);
            let previous = self.last_block;
            if previous.is_none_or(|previous| previous.program != source.program) {
                self.entry_line = source.line;
            }
            self.last_block = Some(*source);
        }
        for breakpoint in &self.breakpoints {
            let is_hit = match (&breakpoint.location.event, event) {
                (BreakEvent::Line(filter, line), Event::BlockStarted(source, _)) => {
                    source.line == *line && is_in(&simulation.cnc, filter, source.program)
                }
                (BreakEvent::Sequence(filter, number), Event::BlockStarted(source, _)) => {
                    has_sequence(&simulation.cnc, *source, *number)
                        && is_in(&simulation.cnc, filter, source.program)
                }
                (BreakEvent::Program(number), Event::BlockStarted(source, _)) => {
                    source.line == self.entry_line
                        && has_number(&simulation.cnc, source.program, *number)
                }
                (BreakEvent::Alarm(wanted), Event::AlarmRaised(alarm)) => {
                    wanted.is_none_or(|it| it == alarm.number)
                }
                (BreakEvent::Pass, Event::Explained(_)) => true,
                _ => false,
            };
            if is_hit {
                hits.extend(check_condition(breakpoint, simulation, self.last_block));
            }
        }
    }
}

/// The hit of a breakpoint whose event has occurred; `None` if its condition does not hold.
fn check_condition(
    breakpoint: &Breakpoint,
    simulation: &Simulation,
    block: Option<SourcePosition>,
) -> Option<BreakHit> {
    let fault = match &breakpoint.location.condition {
        None => None,
        Some(condition) => match simulation.cnc.evaluate(condition) {
            Ok(value) if value.unwrap_or(0.0) == 0.0 => return None,
            Ok(_) => None,
            Err(alarm) => Some(alarm),
        },
    };
    Some(BreakHit {
        id: breakpoint.id,
        block,
        fault,
    })
}

/// The value of a breakpoint on a value; `None` for other events, and for a value that cannot
/// be read.
fn read_value(event: &BreakEvent, simulation: &Simulation) -> Option<WatchedValue> {
    match event {
        BreakEvent::Change(target) | BreakEvent::Comparison(target, ..) => {
            WatchTarget::read(target, simulation).ok()
        }
        _ => None,
    }
}

/// Whether a value has changed, or its comparison has become true.
fn is_value_hit(
    event: &BreakEvent,
    last: Option<&WatchedValue>,
    value: Option<&WatchedValue>,
) -> bool {
    match event {
        BreakEvent::Comparison(_, relation, wanted) => {
            let holds = |value: &WatchedValue| {
                let number = value.number();
                number.is_some_and(|number| relation.holds(number, *wanted))
            };
            value.is_some_and(holds) && last.is_some_and(|last| !holds(last))
        }
        _ => last.is_some() && value.is_some() && last != value,
    }
}

fn active_messages(cnc: &Cnc) -> Vec<u16> {
    cnc.plc_messages().map(|(number, _)| number).collect()
}

fn is_in(cnc: &Cnc, filter: &ProgramFilter, program: ProgramId) -> bool {
    match filter {
        ProgramFilter::Any => true,
        ProgramFilter::Listed(programs) => programs.contains(&program),
        ProgramFilter::Number(number) => has_number(cnc, program, *number),
    }
}

/// Whether the block at a source position has this N word itself. The sequence number of a
/// source position may be that of an earlier block.
fn has_sequence(cnc: &Cnc, source: SourcePosition, number: u32) -> bool {
    let text = cnc.programs().get(source.program);
    source.sequence.map(u32::from) == Some(number)
        && text.is_some_and(|text| text.sequence(text.block_from_line(source.line)) == Some(number))
}

/// Whether a program has this O number. That of a program outside the memory is in its text.
fn has_number(cnc: &Cnc, program: ProgramId, number: u16) -> bool {
    match program {
        ProgramId::Stored(stored) => stored == number,
        other => {
            let text = cnc.programs().get(other);
            text.and_then(gsk_core::program::Program::number) == Some(number)
        }
    }
}
