//! Runs the program in a copy of the machine up to a block.

use std::collections::BTreeMap;

use gsk_core::cnc::{Event, RunStop};
use gsk_core::command::{Frame, MoveKind, ProgramId, SourcePosition};
use gsk_core::program::{Program, Syntax};
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_messages::{Message, say};

use super::copy_run::{CopyProgress, CopyRun};
use super::machine_functions::MachineFunctions;
use super::words::RestartWords;
use crate::block_calls::calls_of_block;
use crate::machining::live_part::LivePart;

/// Machine time after which the search for the block ends, hours.
const MAX_HOURS: u64 = 12;
const TICKS_PER_HOUR: u64 = 3_600_000;
/// Ticks between two stored states of the search, from which the run to the block begins.
const CHECKPOINT_TICKS: u64 = 2000;
/// Ticks without progress of the copied machine after which the search ends.
const MAX_WAIT_TICKS: u64 = 600_000;

/// Recognizes the tick in which the wanted block begins.
pub trait BlockWatcher {
    /// Called after each tick. Returns the wanted block once it has begun in this tick.
    fn follow_tick(&mut self, simulation: &Simulation) -> Option<SourcePosition>;
}

/// Recognizes the first time that the block in a certain line begins. A line that only calls a
/// program never begins: its block is the first one of the program that it calls.
#[derive(Clone, Copy, Debug)]
pub struct LineWatcher {
    program: ProgramId,
    line: u32,
}

impl LineWatcher {
    /// Waits for the first block with words in a line, from 1, of the program or after it: a
    /// comment or an empty line never begins.
    pub fn new(id: ProgramId, program: &Program, line: u32) -> Self {
        let has_words = |index: &u32| {
            let block = program.parse_with_variables(*index, Syntax::default());
            block.is_ok_and(|block| !block.is_empty())
        };
        let first = program.block_from_line(line);
        let found = (first..program.block_count()).find(has_words);
        Self {
            program: id,
            line: found.map_or(line, |index| program.block_line(index)),
        }
    }
}

impl BlockWatcher for LineWatcher {
    fn follow_tick(&mut self, simulation: &Simulation) -> Option<SourcePosition> {
        begun_blocks(simulation).find(|source| {
            let calls = || calls_of_block(&simulation.cnc, *source);
            (source.program, source.line) == (self.program, self.line)
                || (calls().iter())
                    .any(|call| (call.caller, call.caller_line) == (self.program, self.line))
        })
    }
}

fn begun_blocks(simulation: &Simulation) -> impl Iterator<Item = SourcePosition> + '_ {
    let events = simulation.cnc.events().iter();
    events.filter_map(|event| match event {
        Event::BlockStarted(source, _) => Some(*source),
        _ => None,
    })
}

/// The machine before a block, in a copy that has run the program from its head.
#[derive(Clone, Debug)]
pub struct BlockState {
    /// Copy of control and lathe, stopped before the wanted block.
    pub simulation: Simulation,
    /// The part as cut before the wanted block; `None` if the search began without a part.
    pub part: Option<LivePart>,
    /// The M functions that the program has output before the wanted block.
    pub functions: MachineFunctions,
    /// A slide position that is clear of the part, machine coordinates, mm: the one of the last
    /// tool change, else the outermost end of a rapid.
    pub clear_point: Point,
    /// For each tool that the skipped blocks cut with, the frame of its first cut.
    pub(super) first_cut_frames: BTreeMap<u8, Frame>,
    /// Messages about the state before the block that the operator must read.
    pub remarks: Vec<Message>,
    /// Words that the operator has put in place of those of the program.
    pub(super) words: RestartWords,
}

impl BlockState {
    /// The state before the block with the words of the operator in force.
    ///
    /// # Errors
    /// Why a word cannot be changed at this block.
    pub(super) fn with_words(&self, words: &RestartWords) -> Result<Self, Message> {
        let mut target = self.clone();
        target.words = *words;
        let cnc = &mut target.simulation.cnc;
        if let Some(feed) = words.feed {
            cnc.set_restart_feed(feed)?;
        }
        if let Some((tool, offset)) = words.tool {
            let (_, in_force) = cnc.tool();
            if offset.is_some_and(|offset| offset != in_force) {
                return Err(say::restart_offset_stays(in_force));
            }
            cnc.set_restart_tool(tool);
        }
        if let Some(speed) = words.speed {
            cnc.set_restart_speed(speed);
        }
        for code in [words.spindle, words.coolant].into_iter().flatten() {
            target.functions.add(code);
        }
        Ok(target)
    }

    /// The M code (M03, M04 or M05) of the direction in which the spindle turns at the block.
    pub(super) fn spindle_code(&self) -> u8 {
        let cnc = &self.simulation.cnc;
        self.words.spindle.unwrap_or_else(|| cnc.spindle_m_code())
    }

    /// Whether coolant is on at the block.
    pub(super) fn is_coolant_on(&self) -> bool {
        let is_on = self.simulation.lathe.is_coolant_on();
        self.words.coolant.map_or(is_on, |code| code == 8)
    }
}

/// A stored state of the search, from which the run to the block is repeated.
#[derive(Clone, Debug)]
struct SearchMoment {
    run: CopyRun,
    /// Number of blocks that have begun up to this state.
    blocks: u64,
    functions: MachineFunctions,
    tool_change: Option<Point>,
    outermost: Point,
    tool: u8,
    first_cut_frames: BTreeMap<u8, Frame>,
}

impl SearchMoment {
    fn new(mut simulation: Simulation, part: Option<LivePart>) -> Self {
        simulation.cnc.begin_restart_search(None);
        Self {
            outermost: simulation.cnc.position_machine(),
            tool: simulation.cnc.tool().0,
            run: CopyRun::new(simulation, part),
            blocks: 0,
            functions: MachineFunctions::default(),
            tool_change: None,
            first_cut_frames: BTreeMap::new(),
        }
    }

    fn tick(&mut self) {
        self.run.tick();
        let cnc = &self.run.simulation.cnc;
        for event in cnc.events() {
            match event {
                Event::BlockStarted(_, modal) => {
                    self.blocks += 1;
                    if let Some(code) = modal.m {
                        self.functions.add(code);
                    }
                    if modal.tool != self.tool {
                        self.tool = modal.tool;
                        self.tool_change = Some(cnc.commanded_machine_position());
                    }
                }
                Event::MoveEnded(executed) if executed.kind == MoveKind::Rapid => {
                    let end = executed.conditions.frame.to_machine(executed.to);
                    if (end.x, end.z) > (self.outermost.x, self.outermost.z) {
                        self.outermost = end;
                    }
                }
                Event::MoveEnded(executed) => {
                    let tool = executed.conditions.tool;
                    let frame = executed.conditions.frame;
                    self.first_cut_frames.entry(tool).or_insert(frame);
                }
                _ => {}
            }
        }
    }

    /// The reason for which the search cannot continue; `None` if it can. A stop of the program
    /// is answered with cycle start.
    fn check(&mut self) -> Option<Message> {
        let cnc = &self.run.simulation.cnc;
        let message = cnc.active_message();
        let alarm = cnc.alarms().first().or(message.as_ref());
        if let Some(alarm) = alarm {
            return Some(say::restart_search_alarm(alarm.number, alarm.reason()));
        }
        match self.run.progress() {
            CopyProgress::Running => None,
            CopyProgress::Stopped => {
                self.run.press_cycle_start();
                None
            }
            CopyProgress::Ended => Some(match cnc.start_refusal() {
                Some(why) if self.blocks == 0 => why,
                _ => say::restart_block_ended(),
            }),
        }
    }
}

/// Runs the selected program in a copy of `now` until `watcher` reports a block, and stops the
/// copy before this block begins; with `pass` before that pass of the block's cycle. A block
/// that continues a thread is replaced by the first block of the thread. With `part` the copy
/// cuts this part.
///
/// # Errors
/// Why the block is not reached.
pub fn find_block(
    now: &Simulation,
    part: Option<LivePart>,
    watcher: &mut impl BlockWatcher,
    pass: Option<u64>,
) -> Result<BlockState, Message> {
    if now.cnc.programs().selected().is_none() {
        return Err(say::restart_no_program());
    }
    let first = SearchMoment::new(place_at_program_zero(now), part);
    let (moments, block) = search_forward(first, watcher)?;
    let mut number = block;
    let mut remarks = Vec::new();
    loop {
        let stopped = stop_before(&moments, number, pass)?;
        let cnc = &stopped.run.simulation.cnc;
        if cnc.continues_thread() && number > 1 {
            if remarks.is_empty() {
                remarks.push(say::restart_thread_begin());
            }
            number -= 1;
            continue;
        }
        let mut part = stopped.run.part;
        if let Some(part) = &mut part {
            part.change_machine();
        }
        return Ok(BlockState {
            clear_point: stopped.tool_change.unwrap_or(stopped.outermost),
            simulation: stopped.run.simulation,
            part,
            functions: stopped.functions,
            first_cut_frames: stopped.first_cut_frames,
            remarks,
            words: RestartWords::default(),
        });
    }
}

/// The machine with its slides at the point where the program last set its coordinates (G50),
/// from which a full run begins; without such a point the slides stay.
fn place_at_program_zero(now: &Simulation) -> Simulation {
    let mut copy = now.trial_copy();
    if let Some(zero) = now.cnc.program_zero() {
        copy.place_slides(zero);
    }
    copy
}

/// Runs until the watcher reports a block. Returns the stored states, the oldest first, and the
/// number of the block in the run.
fn search_forward(
    mut moment: SearchMoment,
    watcher: &mut impl BlockWatcher,
) -> Result<(Vec<SearchMoment>, u64), Message> {
    let mut moments = vec![moment.clone()];
    let mut last_stored = 0;
    let mut last_progress = 0;
    for tick in 0..MAX_HOURS * TICKS_PER_HOUR {
        let before = moment.blocks;
        moment.tick();
        if let Some(wanted) = watcher.follow_tick(&moment.run.simulation) {
            let is_wanted = |source: SourcePosition| {
                source.program == wanted.program && source.line == wanted.line
            };
            let index = begun_blocks(&moment.run.simulation).position(is_wanted);
            let begun = index.map_or(moment.blocks, |index| before + index as u64 + 1);
            return Ok((moments, begun.max(1)));
        }
        if let Some(why) = moment.check() {
            return Err(why);
        }
        if moment.blocks > before || moment.run.simulation.cnc.is_moving() {
            last_progress = tick;
        } else if tick - last_progress > MAX_WAIT_TICKS
            && let Some(wait) = moment.run.simulation.cnc.wait_reason()
        {
            return Err(say::restart_search_waits(wait));
        }
        if moment.blocks > before && tick >= last_stored + CHECKPOINT_TICKS {
            last_stored = tick;
            // The first one stays: a thread may have begun long ago.
            if moments.len() > 2 {
                moments.remove(1);
            }
            moments.push(moment.clone());
        }
    }
    Err(say::restart_not_reached(MAX_HOURS))
}

/// Runs from the last moment before block number `number` to the begin of this block.
fn stop_before(
    moments: &[SearchMoment],
    number: u64,
    pass: Option<u64>,
) -> Result<SearchMoment, Message> {
    let before = moments.iter().rev().find(|moment| moment.blocks < number);
    let mut moment = before.cloned().ok_or_else(say::restart_block_ended)?;
    moment.run.simulation.cnc.set_run_stop(Some(RunStop {
        blocks_before: number - moment.blocks - 1,
        pass,
        is_in_block: false,
    }));
    loop {
        moment.tick();
        let is_block_over = moment.blocks > number;
        if moment.run.simulation.cnc.is_at_run_stop() {
            let is_next = pass.is_some() && moment.run.simulation.cnc.is_before_block();
            let is_first = moment.blocks < number;
            if let Some(pass) = pass.filter(|_| is_next && !is_first) {
                return Err(say::restart_pass_missing(pass));
            }
            moment.run.simulation.cnc.set_run_stop(None);
            return Ok(moment);
        }
        if is_block_over {
            return Err(say::restart_block_ended());
        }
        if let Some(why) = moment.check() {
            return Err(why);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comment_line_stands_for_the_block_below_it() {
        let program = Program::new("O0001\n(rough)\n\nG00 X#100\nM30\n");
        let line = |line| LineWatcher::new(ProgramId::External, &program, line).line;
        assert_eq!([2, 3, 4, 5, 6].map(line), [4, 4, 4, 5, 6]);
    }
}
