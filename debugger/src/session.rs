//! A debug session: runs a program until something stops it, forwards and backwards.

use gsk_core::alarm::Alarm;
use gsk_core::cnc::Event;
use gsk_core::command::{ProgramId, SourcePosition};
use gsk_runner::machining::CollisionFinding;

use crate::breakpoints::{BreakHit, BreakpointSet};
use crate::debugged_run::{DebuggedRun, RunProgress};
use crate::history::StateHistory;

/// The distance that a debugging session runs before it stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DebugStep {
    /// Runs to the next breakpoint.
    Continue,
    /// Runs to the next block, in a called program too.
    Into,
    /// Runs to the next block of this program or of its caller.
    Over,
    /// Runs to the next block of the caller.
    Out,
    /// Runs to the next pass of a cycle, or to the next block of this program or of its caller.
    Pass,
    /// Runs to the next slot of the ladder (8 ms).
    Slot,
    /// Runs for one tick (1 ms).
    Tick,
}

/// Events that stop a session without a breakpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StopFilter {
    /// Whether alarms stop the session.
    pub alarms: bool,
    /// Whether messages of the ladder stop the session.
    pub messages: bool,
    /// Whether collisions of the part stop the session.
    pub collisions: bool,
}

/// The reason for which a debugging session has stopped.
#[derive(Clone, Debug, PartialEq)]
pub enum StopReason {
    /// The session has stopped before the first block.
    Entry,
    /// The requested step has ended.
    Step,
    /// These breakpoints were hit.
    Breakpoint(Vec<BreakHit>),
    /// The control has raised this alarm.
    Alarm(Alarm),
    /// The ladder shows this message.
    Message(Alarm),
    /// A tool has collided as described.
    Collision(CollisionFinding),
    /// The program waits for cycle start: M00.
    ProgramStop,
    /// The block of [`DebugSession::begin_run_to`] begins.
    Reached,
    /// The program has ended.
    Ended,
}

/// The goal of a run that may take several calls of [`DebugSession::advance`].
#[derive(Clone, Copy, Debug)]
enum RunGoal {
    Step { kind: DebugStep, depth: usize },
    Block { program: ProgramId, line: u32 },
}

/// A debugging session of a program.
pub struct DebugSession {
    run: DebuggedRun,
    /// The breakpoints of the session.
    pub breakpoints: BreakpointSet,
    /// The events that stop the session without a breakpoint.
    pub filter: StopFilter,
    history: Box<dyn StateHistory + Send>,
    goal: RunGoal,
    /// The block of the last stop; `None` before the first block.
    stop_block: Option<SourcePosition>,
    is_message_active: bool,
}

impl DebugSession {
    /// Starts a session before the first tick of a run.
    pub fn new(run: DebuggedRun, mut history: Box<dyn StateHistory + Send>) -> Self {
        history.record(&run);
        Self {
            run,
            breakpoints: BreakpointSet::default(),
            filter: StopFilter::default(),
            history,
            goal: RunGoal::Step {
                kind: DebugStep::Continue,
                depth: 0,
            },
            stop_block: None,
            is_message_active: false,
        }
    }

    /// The machine at the present moment.
    pub const fn run(&self) -> &DebuggedRun {
        &self.run
    }

    /// The block at which the session has stopped; `None` before the first block.
    pub const fn stop_block(&self) -> Option<SourcePosition> {
        self.stop_block
    }

    /// Begins a step. If the program waits for cycle start, the operator presses it.
    pub fn begin_step(&mut self, kind: DebugStep) {
        let depth = self.run.calls().depth();
        self.goal = RunGoal::Step { kind, depth };
        self.press_start_if_stopped();
    }

    /// Begins a run to the next begin of the block in a line. No breakpoint stops it.
    pub fn begin_run_to(&mut self, program: ProgramId, line: u32) {
        self.goal = RunGoal::Block { program, line };
        self.press_start_if_stopped();
    }

    /// Takes the present values as those that breakpoints compare with; needed after a
    /// breakpoint was added.
    pub fn resync_breakpoints(&mut self) {
        let block = self.run.calls().block();
        self.breakpoints.resync(self.run.simulation(), block);
    }

    /// Returns to the beginning of the run.
    pub fn rewind(&mut self) {
        self.go_to_tick(0);
    }

    fn press_start_if_stopped(&mut self) {
        if self.run.progress() == RunProgress::Stopped {
            self.run.press_cycle_start();
        }
    }

    /// Runs at most `ticks` ticks towards the goal. Returns why the session has stopped; `None`
    /// if it has not.
    pub fn advance(&mut self, ticks: u64) -> Option<StopReason> {
        for _ in 0..ticks {
            let before = self.run.progress();
            if before == RunProgress::Ended {
                return Some(StopReason::Ended);
            }
            let entry = self.run.entry_block();
            let collisions = self.run.tick();
            self.history.record(&self.run);
            let stop = self.find_stop(&collisions, entry);
            if stop.is_some() {
                return stop;
            }
            match self.run.progress() {
                RunProgress::Ended => return Some(StopReason::Ended),
                RunProgress::Stopped => {
                    self.stop_block = self.run.calls().block();
                    if matches!(self.goal, RunGoal::Step { .. }) {
                        return Some(StopReason::ProgramStop);
                    }
                    // On the way to a block every M00 is answered.
                    self.run.press_cycle_start();
                }
                RunProgress::Starting | RunProgress::Running => {}
            }
        }
        None
    }

    /// Returns the reason for which the tick that has just passed stops the session; `None` if it
    /// does not. `entry` is [`DebuggedRun::entry_block`] before the tick.
    fn find_stop(
        &mut self,
        collisions: &[CollisionFinding],
        entry: Option<(ProgramId, u32)>,
    ) -> Option<StopReason> {
        let simulation = self.run.simulation();
        let hits = self
            .breakpoints
            .follow_tick(simulation, !collisions.is_empty());
        let message = simulation.cnc.active_message();
        let is_new_message = message.is_some() && !self.is_message_active;
        self.is_message_active = message.is_some();
        if let RunGoal::Block { program, line } = self.goal {
            let reached = begun_blocks(&self.run)
                .find(|block| block.program == program && block.line == line);
            self.stop_block = reached.or(self.run.calls().block());
            return reached.map(|_| StopReason::Reached);
        }
        self.stop_block = self.run.calls().block();
        if let Some(hit) = hits.first() {
            self.stop_block = hit.block.or(self.stop_block);
            return Some(StopReason::Breakpoint(hits));
        }
        if let Some(alarm) = raised_alarm(&self.run).filter(|_| self.filter.alarms) {
            // The faulty block has not begun: it was read ahead.
            self.stop_block = alarm.source.or(self.stop_block);
            return Some(StopReason::Alarm(alarm));
        }
        if let Some(message) = message.filter(|_| is_new_message && self.filter.messages) {
            return Some(StopReason::Message(message));
        }
        if let Some(collision) = collisions.first().filter(|_| self.filter.collisions) {
            return Some(StopReason::Collision(*collision));
        }
        let RunGoal::Step { kind, depth } = self.goal else {
            return None;
        };
        is_step_end(&self.run, entry, kind, depth).then_some(StopReason::Step)
    }

    /// Goes back: to the last breakpoint before the present moment ([`DebugStep::Continue`]), or
    /// to the last begin of a block, as [`DebugStep::Into`] and [`DebugStep::Over`] mean it
    /// forwards. Stops at the beginning of the run if there is none.
    pub fn go_back(&mut self, kind: DebugStep) -> StopReason {
        let present = self.run.ticks();
        if kind == DebugStep::Tick {
            self.go_to_tick(present.saturating_sub(1));
            return StopReason::Step;
        }
        let depth = self.run.calls().depth();
        let (mut moment, mut end) = (present, present);
        let state_before = |session: &Self, moment: u64| {
            let tick = moment.checked_sub(1)?;
            session.history.state_before(tick)
        };
        while let Some(start) = state_before(self, moment) {
            moment = start.ticks();
            if let Some(tick) = self.find_last_stop(start, end, kind, depth) {
                return self.stop_at_tick(tick, kind, depth);
            }
            // A stop at the stored moment itself is found from the moment before it.
            end = moment + 1;
        }
        self.rewind();
        StopReason::Entry
    }

    /// The last tick after the moment `start` and before the tick `end` at which a stop of this
    /// kind occurs.
    fn find_last_stop(
        &mut self,
        start: DebuggedRun,
        end: u64,
        kind: DebugStep,
        depth: usize,
    ) -> Option<u64> {
        let mut run = start;
        let mut found = None;
        self.breakpoints
            .resync(run.simulation(), run.calls().block());
        while run.ticks() + 1 < end {
            let entry = run.entry_block();
            let collisions = run.tick_again();
            let hits = self
                .breakpoints
                .follow_tick(run.simulation(), !collisions.is_empty());
            if !hits.is_empty() || is_step_end(&run, entry, kind, depth) {
                found = Some(run.ticks());
            }
        }
        found
    }

    /// Goes to a tick at which a stop occurs, and returns its reason.
    fn stop_at_tick(&mut self, tick: u64, kind: DebugStep, depth: usize) -> StopReason {
        self.go_to_tick(tick - 1);
        self.goal = RunGoal::Step { kind, depth };
        self.press_start_if_stopped();
        self.advance(1).unwrap_or(StopReason::Step)
    }

    /// Goes to a tick of the past.
    fn go_to_tick(&mut self, tick: u64) {
        let Some(mut run) = self.history.state_before(tick) else {
            return;
        };
        while run.ticks() < tick {
            run.tick_again();
        }
        self.run = run;
        let block = self.run.calls().block();
        self.stop_block = block;
        self.resync_breakpoints();
        self.is_message_active = self.run.simulation().cnc.active_message().is_some();
    }
}

fn begun_blocks(run: &DebuggedRun) -> impl Iterator<Item = SourcePosition> + '_ {
    let events = run.simulation().cnc.events().iter();
    events.filter_map(|event| match event {
        Event::BlockStarted(source, _) => Some(*source),
        _ => None,
    })
}

fn raised_alarm(run: &DebuggedRun) -> Option<Alarm> {
    let mut events = run.simulation().cnc.events().iter();
    events.find_map(|event| match event {
        Event::AlarmRaised(alarm) => Some(alarm.clone()),
        _ => None,
    })
}

/// Whether the tick that has just passed ends a step that began at `depth` running calls. The
/// first block, `entry` before it begins, ends no step: the session stands at it from the start.
fn is_step_end(
    run: &DebuggedRun,
    entry: Option<(ProgramId, u32)>,
    kind: DebugStep,
    depth: usize,
) -> bool {
    let has_begun = begun_blocks(run).any(|block| entry != Some((block.program, block.line)));
    let now = run.calls().depth();
    let events = run.simulation().cnc.events();
    match kind {
        DebugStep::Continue => false,
        DebugStep::Into => has_begun,
        DebugStep::Over => has_begun && now <= depth,
        DebugStep::Out => has_begun && now < depth,
        DebugStep::Pass => {
            let is_pass = |event: &Event| matches!(event, Event::Explained(_));
            has_begun && now <= depth || events.iter().any(is_pass)
        }
        DebugStep::Slot => run.simulation().cnc.has_run_ladder_slot(),
        DebugStep::Tick => true,
    }
}
