//! Cuts the part while the control runs, tick by tick, in manual and automatic operation.

use std::collections::BTreeMap;

use gsk_core::cnc::{Cnc, Event};
use gsk_core::command::{Frame, ProgramId, SequenceNumber, SourcePosition};
use gsk_core::machine::{LatheFault, LoadLimits};
use gsk_core::operation::RunState;
use gsk_core::simulation::Simulation;
use gsk_core::units::{Point, TICK_S};
use gsk_workpiece::cutting::CuttingMaterial;
use gsk_workpiece::job::Job;
use gsk_workpiece::motion::ToolMotion;
use gsk_workpiece::part::TurnedPart;
use gsk_workpiece::tool::Tool;

use super::load_meter::LoadMeter;
use super::move_load::CutLoad;
use super::pending_cut::{MotionConditions, PendingCut};
use super::slide_shift::SlideShift;
use super::thread_log::ThreadLog;
pub use super::thread_log::ThreadZone;
use super::{CollisionFinding, CutFault, Machining};

/// Speed below which the spindle counts as stopped, r/min.
const STANDSTILL_RPM: f64 = 1.0;
/// Turns of the spindle in a motion below which it has no feed per revolution.
const LEAST_TURNS: f64 = 1e-4;

/// A part that is machined while a control runs, tick by tick.
#[derive(Clone, Debug)]
pub struct LivePart {
    machining: Machining,
    /// Slide and spindle at the last tick; `None` before the first.
    last_tick: Option<TickState>,
    pending: Option<PendingCut>,
    /// Length of the last motion on each axis, mm.
    last_motion: Point,
    /// Number of collisions that [`LivePart::follow_tick`] has already returned.
    reported_findings: usize,
    /// Whether the program has ended; the next program begins with new stock.
    program_ended: bool,
    threads: ThreadLog,
    /// The material of the stock; `None` without constants for it.
    material: Option<CuttingMaterial>,
    overload: OverloadWatch,
    load_meter: LoadMeter,
    /// For each tool that the skipped blocks of a restart cut with, the frame of its first cut;
    /// empty after the run.
    first_cut_frames: BTreeMap<u8, Frame>,
    slide_shift: SlideShift,
    /// Whether motion by hand meets the part where the control's coordinates draw it, if neither
    /// the job nor a cut gives its place.
    meets_drawn_part: bool,
}

/// Whether cuts above the limits break something, and what they have broken.
#[derive(Clone, Debug, Default)]
struct OverloadWatch {
    /// Whether a cut above a limit has an effect even if the machine file does not say so.
    is_on: bool,
    /// The limits of the lathe; `None` while no cut has an effect.
    limits: Option<LoadLimits>,
    /// The tool whose insert is broken.
    broken_tool: Option<u8>,
    /// Whether an insert was replaced and the tool has not stopped since: the cut that broke it is
    /// to be left first.
    awaits_standstill: bool,
    /// The first cut above a limit since the last tick began.
    found: Option<CutFault>,
}

#[derive(Clone, Copy, Debug)]
struct TickState {
    /// Slide position in machine coordinates, mm.
    slide: Point,
    /// Position of the tool tip in part coordinates, mm.
    tip: Point,
    spindle_turns: f64,
}

impl LivePart {
    /// Creates a live part from `machining`, whose part must be uncut.
    pub fn new(machining: Machining) -> Self {
        Self {
            material: machining.job().cutting_material(),
            machining,
            overload: OverloadWatch::default(),
            load_meter: LoadMeter::default(),
            last_tick: None,
            pending: None,
            last_motion: Point::default(),
            reported_findings: 0,
            program_ended: false,
            threads: ThreadLog::default(),
            first_cut_frames: BTreeMap::new(),
            slide_shift: SlideShift::default(),
            meets_drawn_part: true,
        }
    }

    /// Sets whether motion by hand meets a part whose place only the control's coordinates give.
    /// On a real lathe that place is a guess, and a collision there means nothing.
    pub const fn set_meets_drawn_part(&mut self, meets: bool) {
        self.meets_drawn_part = meets;
    }

    /// Returns the threads that were cut since the stock was clamped.
    pub fn threads(&self) -> &[ThreadZone] {
        self.threads.zones()
    }

    /// Returns the length of the last motion on each axis, mm, X as a radius.
    pub const fn last_motion(&self) -> Point {
        self.last_motion
    }

    /// Returns the part and its collisions so far.
    pub const fn machining(&self) -> &Machining {
        &self.machining
    }

    /// Sets whether cuts above the limits break something even if the machine file does not say
    /// so.
    pub const fn set_overload(&mut self, is_on: bool) {
        self.overload.is_on = is_on;
    }

    /// Returns the cut that has exceeded a limit in the last tick; `None` without one.
    pub const fn cut_fault(&self) -> Option<CutFault> {
        self.overload.found
    }

    /// Returns the number of the tool whose insert is broken; `None` without one. After a tool
    /// change it is not the tool in the working position.
    pub const fn broken_tool(&self) -> Option<u8> {
        self.overload.broken_tool
    }

    /// Sets whether the load of the current cut is measured.
    pub fn set_measures_load(&mut self, is_on: bool) {
        self.load_meter.switch(is_on);
    }

    /// Returns the load of the current cut while it is measured, 0 while nothing is cut; `None` if
    /// the material of the stock has no constants.
    pub fn load(&self) -> Option<CutLoad> {
        self.material.map(|_| self.load_meter.load())
    }

    /// Takes the tools of another job for the same stock, clamping and place. The part is kept.
    pub fn change_tools(&mut self, job: Job) {
        self.cut_pending();
        self.machining.change_tools(job);
    }

    /// Clamps new stock and discards the findings. Wherever the slides are at the next tick, they
    /// have not moved through it.
    pub fn clamp_new_stock(&mut self) {
        self.last_tick = None;
        self.change_to_new_stock();
    }

    fn change_to_new_stock(&mut self) {
        self.pending = None;
        self.machining.clamp_new_stock();
        self.threads.clear();
        self.reported_findings = 0;
    }

    /// Follows another machine from the next tick on: the slides have made no motion from the
    /// one to the other.
    pub fn change_machine(&mut self) {
        self.cut_pending();
        self.threads.end_pass();
        self.last_tick = None;
        self.program_ended = false;
    }

    /// Cuts the part with the motion of the last tick of the control; call it after every tick.
    /// Returns the collisions found since the last call, empty if there are none.
    pub fn follow_tick(&mut self, simulation: &Simulation) -> &[CollisionFinding] {
        let cnc = &simulation.cnc;
        let tool = simulation.lathe.station().unwrap_or(cnc.tool().0);
        self.follow_restart(cnc);
        self.slide_shift
            .follow_tick(simulation, self.last_tick.is_none());
        let frame = self.part_frame(tool, cnc);
        // The way to the start point of a restart is rapid to its last tick.
        let is_operating = matches!(cnc.run_state(), RunState::Run | RunState::Hold);
        let is_approach = is_operating && cnc.has_restart();
        let conditions = MotionConditions {
            tool,
            rapid: is_approach || cnc.is_rapid_under_way(),
            thread: cnc.is_in_thread(),
            turning: simulation.lathe.spindle_rpm().abs() > STANDSTILL_RPM
                && !simulation.lathe.has_fault(LatheFault::StockLoose),
            source: moving_block(simulation),
        };
        self.overload.found = None;
        self.overload.follow_tick(tool, simulation);
        self.change_stock(simulation);
        let slide = self.slide_position(cnc);
        // Under machine lock the commands move and the slides do not.
        let is_locked = cnc.is_machine_locked();
        let has_moved = !is_locked && self.last_tick.is_some_and(|last| last.slide != slide);
        if !conditions.rapid && conditions.source.is_some() && has_moved {
            self.machining.track.mounting_mut().fix_tool(tool, &frame);
        }
        let tip = |slide| self.machining.mounting().tip_in_part(tool, slide, &frame);
        let now = TickState {
            slide,
            tip: tip(slide),
            spindle_turns: simulation.lathe.spindle_turns(),
        };
        // Position before, in present coordinates: G50 and T move nothing.
        let before = self.last_tick.map(|last| TickState {
            tip: tip(last.slide),
            ..last
        });
        self.last_tick = Some(now);
        let is_located =
            conditions.source.is_some() || self.machining.mounting().is_part_located(tool);
        let touched_before = self.machining.contact_count(tool);
        match before {
            Some(before) if has_moved && (is_located || self.meets_drawn_part) => {
                self.add_tick(conditions, before, now);
            }
            // At standstill the pending motion shows at once.
            _ => {
                self.cut_pending();
                self.load_meter.set_idle();
                self.overload.awaits_standstill = false;
            }
        }
        if !is_located && self.machining.contact_count(tool) != touched_before {
            // What the hand has met stays there when an offset or the work zero changes.
            self.machining.track.mounting_mut().fix_tool(tool, &frame);
        }
        let first = self.reported_findings.min(self.machining.findings.len());
        self.reported_findings = self.machining.findings.len();
        &self.machining.findings[first..]
    }

    /// The frame in which the program places the part for a tool that has not cut. In a restart it
    /// is the frame in which the skipped blocks would have cut, because the frame in force is
    /// that of the state before the restart.
    fn part_frame(&self, tool: u8, cnc: &Cnc) -> Frame {
        let skipped = self.first_cut_frames.get(&tool).copied();
        let frame = skipped.unwrap_or_else(|| cnc.frame_at_restart(tool));
        Frame {
            zero: frame.zero + self.slide_shift.distance,
            ..frame
        }
    }

    /// Position of the slides, machine coordinates of a control with a reference, mm: a machine
    /// zero return changes the numbers of the control and not this position.
    pub fn slide_position(&self, cnc: &Cnc) -> Point {
        cnc.position_machine() + self.slide_shift.distance
    }

    /// Position of the tip of a tool in part coordinates, mm.
    pub fn tip(&self, tool: u8, cnc: &Cnc) -> Point {
        let frame = self.part_frame(tool, cnc);
        let mounting = self.machining.mounting();
        mounting.tip_in_part(tool, self.slide_position(cnc), &frame)
    }

    /// Stores the frames of the blocks that a restart skips, until the run ends.
    fn follow_restart(&mut self, cnc: &Cnc) {
        match cnc.restart_first_cut_frames() {
            Some(frames) if self.first_cut_frames.is_empty() => {
                self.first_cut_frames.clone_from(frames);
            }
            None if cnc.run_state() == RunState::Reset => self.first_cut_frames.clear(),
            _ => {}
        }
    }

    /// Clamps new stock when the first block of a program starts after another program has
    /// ended.
    fn change_stock(&mut self, simulation: &Simulation) {
        for event in simulation.cnc.events() {
            match event {
                Event::ProgramEnded { .. } => self.program_ended = true,
                Event::BlockStarted(source, _)
                    if self.program_ended && source.program != ProgramId::Mdi =>
                {
                    self.program_ended = false;
                    self.change_to_new_stock();
                }
                _ => {}
            }
        }
    }

    fn add_tick(&mut self, conditions: MotionConditions, before: TickState, now: TickState) {
        let continues = self.pending.as_ref().is_some_and(|piece| {
            piece.conditions == conditions && piece.is_continued_by(before.tip, now.tip)
        });
        if !continues {
            self.cut_pending();
        }
        let begin = || PendingCut::new(before.tip, conditions);
        let piece = self.pending.get_or_insert_with(begin);
        let turns = (now.spindle_turns - before.spindle_turns).abs();
        piece.add_tick(now.tip, turns);
        if !conditions.thread {
            self.threads.end_pass();
        } else if let Some((tip, turns)) = plane_crossing(before, now) {
            piece.imprints.push(tip);
            let tool = self.machining.job().tools.get(&conditions.tool);
            let is_internal = tool.is_some_and(Tool::is_internal);
            self.threads.add_imprint(tip, turns, is_internal);
        }
        if piece.is_full() {
            self.cut_pending();
        }
    }

    /// Returns the part at this moment: with the motion that was collected but not cut yet.
    pub fn part_now(&self) -> TurnedPart {
        let pending = self.pending.as_ref().filter(|piece| {
            // A broken insert cuts nothing.
            self.overload.broken_tool != Some(piece.conditions.tool)
        });
        match pending {
            Some(piece) => (self.machining).part_after(piece.conditions.tool, &piece.motion()),
            None => self.machining.scene().part().clone(),
        }
    }

    /// Cuts the part with the motion that was collected but not cut yet.
    fn cut_pending(&mut self) {
        let Some(piece) = self.pending.take() else {
            return;
        };
        self.last_motion = piece.to - piece.from;
        let motion = piece.motion();
        let MotionConditions { source, tool, .. } = piece.conditions;
        if self.overload.broken_tool == Some(tool) {
            self.load_meter.set_idle();
            self.machining.move_broken_tool(source, tool, &motion);
            return;
        }
        if piece.conditions.turning && piece.turns > LEAST_TURNS {
            let feed_mm = (piece.to - piece.from).length() / piece.turns;
            let rpm = piece.turns * 60_000.0 / f64::from(piece.ticks);
            self.check_limits(source, tool, &motion, (feed_mm, rpm));
            if self.load_meter.is_due(&motion, piece.ticks) {
                let material = self.material.as_ref();
                let load = material.and_then(|material| {
                    (self.machining).heaviest_load(tool, &motion, (feed_mm, rpm), material)
                });
                self.load_meter.set(load);
            }
        }
        if piece.conditions.rapid || !piece.conditions.turning {
            self.load_meter.set_idle();
        }
        let seconds = f64::from(piece.ticks) * TICK_S;
        self.machining.move_tool(source, tool, &motion, seconds);
    }

    /// Stores the first limit that a motion exceeds with a feed per revolution, mm, at a spindle
    /// speed, r/min.
    fn check_limits(
        &mut self,
        source: Option<SourcePosition>,
        tool: u8,
        motion: &ToolMotion,
        feed: (f64, f64),
    ) {
        let overload = &mut self.overload;
        let (Some(limits), Some(material)) = (&overload.limits, &self.material) else {
            return;
        };
        if overload.found.is_none() && !overload.awaits_standstill {
            let exceeded = (self.machining).exceeded_limit(tool, motion, feed, limits, material);
            overload.found = exceeded.map(|kind| CutFault {
                kind,
                tool,
                source,
                tip: motion.to,
            });
        }
    }
}

impl OverloadWatch {
    /// Follows the switch of the machine file and the faults of the lathe. The insert that breaks
    /// is that of the tool in the working position.
    fn follow_tick(&mut self, tool: u8, simulation: &Simulation) {
        let lathe = &simulation.lathe;
        let limits = &lathe.config().load;
        // A spindle that stalls, or runs down after RESET, slows down before the slides stop: its
        // feed per revolution says nothing then.
        let is_stopped = simulation.cnc.spindle_m_code() == 5
            || [LatheFault::SpindleBlocked, LatheFault::StockLoose]
                .iter()
                .any(|fault| lathe.has_fault(*fault));
        if !(self.is_on || limits.events) || is_stopped {
            self.limits = None;
        } else if self.limits.is_none() {
            self.limits = Some(limits.clone());
        }
        let is_broken = lathe.has_fault(LatheFault::InsertBroken);
        self.awaits_standstill |= self.broken_tool.is_some() && !is_broken;
        self.broken_tool = match is_broken {
            true => self.broken_tool.or(Some(tool)),
            false => None,
        };
    }
}

/// Returns the block that the program executes, or between two blocks the last one. `None` after
/// the end of an MDI block and when nothing runs.
pub fn running_block(simulation: &Simulation) -> Option<SourcePosition> {
    let cnc = &simulation.cnc;
    let cursor = cnc.cursor();
    let program = cursor.program.filter(|program| match cnc.run_state() {
        RunState::Reset => false,
        RunState::Stop => *program != ProgramId::Mdi,
        RunState::Run | RunState::Hold => true,
    });
    program.map(|program| SourcePosition {
        program,
        line: cursor.line,
        sequence: cursor.sequence.map(SequenceNumber::from),
    })
}

/// Returns the block of the program that moves the tool; `None` in manual operation.
fn moving_block(simulation: &Simulation) -> Option<SourcePosition> {
    let by_program = matches!(simulation.cnc.run_state(), RunState::Run | RunState::Hold);
    running_block(simulation).filter(|_| by_program)
}

/// Tip position and whole turns at which the spindle passed the drawn plane between two ticks;
/// `None` if it did not.
fn plane_crossing(before: TickState, now: TickState) -> Option<(Point, f64)> {
    let (low, high) = (
        before.spindle_turns.min(now.spindle_turns),
        before.spindle_turns.max(now.spindle_turns),
    );
    let whole = high.floor();
    if whole <= low || high <= low {
        return None;
    }
    let part = (whole - before.spindle_turns) / (now.spindle_turns - before.spindle_turns);
    Some((before.tip + (now.tip - before.tip) * part, whole))
}
