//! Follows how a learner works: starts, cuts, trials, alarms, repairs.

use std::collections::{BTreeMap, BTreeSet};

use gsk_core::alarm::Alarm;
use gsk_core::cnc::Event;
use gsk_core::command::ProgramId;
use gsk_core::machine::LatheFault;
use gsk_core::memory::{OFFSET_ROWS, ToolOffset};
use gsk_core::model::ProgramNaming;
use gsk_core::operation::{OperatingMode, RunState};
use gsk_history::moment::{HistoryInput, MachineMoment};
use gsk_messages::{Message, say};
use gsk_panel::emulator::EmulatorInput;
use gsk_panel::keys::Key;
use gsk_panel::panel::KeyEvent;
use gsk_runner::machining::CollisionFinding;
use gsk_runner::machining::live_part::running_block;

use crate::report::{MarkEvidence, RefusedPresses};

/// A fault of the lathe that was repaired, with the moment of the repair.
#[derive(Clone, Debug)]
pub struct FaultRepair {
    /// The repaired fault.
    pub fault: LatheFault,
    /// The moment of the repair.
    pub evidence: MarkEvidence,
}

/// The events of a solution on which criteria depend, such as the first collision.
#[derive(Clone, Debug, Default)]
pub struct ProcedureLog {
    start_tick: u64,
    /// X and Z of each tool offset at the start, by offset number, mm.
    start_offsets: BTreeMap<u8, (f64, f64)>,
    part_version: Option<u64>,
    was_running: bool,
    /// Numbers of the alarms that were active after the last tick.
    active_alarms: BTreeSet<u16>,
    /// Moment of the first start of a program; `None` before it.
    pub first_start: Option<MarkEvidence>,
    /// Moment of the first program start with an axis that was not referenced; `None` without one.
    pub unreferenced_start: Option<MarkEvidence>,
    /// Moment of the first end of a program under machine lock; `None` without one.
    pub trial: Option<MarkEvidence>,
    /// Moment of the first cut in automatic operation; `None` without one.
    pub first_cut: Option<MarkEvidence>,
    /// For each tool offset in force during a cut: moment of the first cut, and whether X and Z
    /// were measured before it.
    pub tool_cuts: BTreeMap<u8, (MarkEvidence, bool)>,
    /// Moment of the first collision; `None` without one.
    pub crash: Option<MarkEvidence>,
    /// Moment of the first alarm; `None` without one.
    pub alarm: Option<MarkEvidence>,
    /// Moment of the first cycle start while an alarm was active; `None` without one.
    pub ignored_alarm: Option<MarkEvidence>,
    /// The repairs of faults, the first one first.
    pub repairs: Vec<FaultRepair>,
    /// Key presses that the task has refused; `None` without any.
    pub refused: Option<RefusedPresses>,
}

impl ProcedureLog {
    /// Creates the log of a solution that begins with the machine state `start`.
    pub fn new(start: &MachineMoment) -> Self {
        let cnc = start.emulator.cnc();
        let offsets = (1..OFFSET_ROWS as u8).map(|number| (number, xz(cnc.offsets().get(number))));
        Self {
            start_tick: start.ticks(),
            start_offsets: offsets.collect(),
            part_version: part_version(start),
            active_alarms: active_alarms(start),
            ..Self::default()
        }
    }

    /// Returns the current time and block as evidence for a verdict.
    pub fn evidence(&self, moment: &MachineMoment) -> MarkEvidence {
        let simulation = moment.emulator.simulation();
        let naming = simulation.cnc.model().record().program_naming();
        let block = running_block(simulation);
        MarkEvidence {
            tick: Some(moment.ticks().saturating_sub(self.start_tick)),
            block: block.map(|block| {
                let name = program_name(block.program, naming);
                let sequence = block.sequence.map(u32::from);
                let sequence = sequence.map_or_else(String::new, |n| format!(" N{n}"));
                format!("{}:{}{sequence}", name, block.line)
            }),
            measured: None,
            found: None,
        }
    }

    /// Returns the current time and block as evidence, with a message about the cause.
    pub fn evidence_of(&self, moment: &MachineMoment, found: Message) -> MarkEvidence {
        MarkEvidence {
            found: Some(found),
            ..self.evidence(moment)
        }
    }

    /// Records an input before the machine executes it.
    pub fn before_input(&mut self, moment: &MachineMoment, input: &HistoryInput) {
        if let HistoryInput::Machine(EmulatorInput::Key(event)) = input {
            self.note_refusal(moment, *event);
        }
        match input {
            HistoryInput::Machine(EmulatorInput::Fault(fault, false)) => {
                let evidence = self.evidence_of(moment, fault.row().label());
                self.repairs.push(FaultRepair {
                    fault: *fault,
                    evidence,
                });
            }
            HistoryInput::Machine(EmulatorInput::Key(KeyEvent::Down(Key::CycleStart))) => {
                let alarm = moment.emulator.cnc().alarms().first();
                if let Some(alarm) = alarm.filter(|_| self.ignored_alarm.is_none()) {
                    self.ignored_alarm = Some(self.evidence_of(moment, alarm_message(alarm)));
                }
            }
            _ => {}
        }
    }

    fn note_refusal(&mut self, moment: &MachineMoment, event: KeyEvent) {
        let emulator = &moment.emulator;
        let Some(why) = emulator.panel().limit_refusal(event, emulator.cnc()) else {
            return;
        };
        let first_tick = moment.ticks().saturating_sub(self.start_tick);
        let refused = self.refused.get_or_insert(RefusedPresses {
            count: 0,
            first_tick,
            first: why,
        });
        refused.count += 1;
    }

    /// Records what has changed in a tick; `collision` is the first collision in it.
    pub fn after_tick(&mut self, moment: &MachineMoment, collision: Option<&CollisionFinding>) {
        let cnc = moment.emulator.cnc();
        if let Some(collision) = collision.filter(|_| self.crash.is_none()) {
            self.crash = Some(self.evidence_of(moment, collision.collision.message()));
        }
        let is_running = cnc.run_state() == RunState::Run;
        let is_automatic = matches!(cnc.mode(), OperatingMode::Auto);
        if is_running && !self.was_running && is_automatic {
            let evidence = self.evidence(moment);
            let referenced = cnc.referenced_axes();
            if !(referenced.x && referenced.z) && self.unreferenced_start.is_none() {
                self.unreferenced_start = Some(evidence.clone());
            }
            self.first_start.get_or_insert(evidence);
        }
        self.was_running = is_running;
        let has_ended = cnc
            .events()
            .iter()
            .any(|event| matches!(event, Event::ProgramEnded { .. }));
        if has_ended && cnc.is_machine_locked() && self.trial.is_none() {
            self.trial = Some(self.evidence(moment));
        }
        self.follow_cuts(moment, is_automatic && is_running);
        self.follow_alarms(moment);
    }

    fn follow_cuts(&mut self, moment: &MachineMoment, is_automatic: bool) {
        let version = part_version(moment);
        if version == self.part_version {
            return;
        }
        self.part_version = version;
        // Version 0 is new stock.
        if !is_automatic || version.is_none_or(|version| version == 0) {
            return;
        }
        let cnc = moment.emulator.cnc();
        let (_, offset) = cnc.tool();
        if self.first_cut.is_none() {
            self.first_cut = Some(self.evidence(moment));
        }
        if !self.tool_cuts.contains_key(&offset) {
            let before = self.start_offsets.get(&offset).copied().unwrap_or_default();
            let now = xz(cnc.offsets().get(offset));
            let is_measured = before.0 != now.0 && before.1 != now.1;
            let cut = (self.evidence(moment), is_measured);
            self.tool_cuts.insert(offset, cut);
        }
    }

    fn follow_alarms(&mut self, moment: &MachineMoment) {
        let alarms = moment.emulator.cnc().alarms();
        if alarms.len() == self.active_alarms.len() {
            return;
        }
        let is_new = |number: &u16| !self.active_alarms.contains(number);
        let raised = alarms.iter().find(|alarm| is_new(&alarm.number));
        if let Some(alarm) = raised.filter(|_| self.alarm.is_none()) {
            self.alarm = Some(self.evidence_of(moment, alarm_message(alarm)));
        }
        self.active_alarms = active_alarms(moment);
    }
}

/// Returns number and text of an alarm.
pub fn alarm_message(alarm: &Alarm) -> Message {
    say::subject_reason(alarm.number_text(), alarm.reason())
}

fn program_name(program: ProgramId, naming: ProgramNaming) -> String {
    match program {
        ProgramId::Stored(number) => naming.name(number),
        ProgramId::External => "CNC".to_owned(),
        ProgramId::Mdi => "MDI".to_owned(),
        ProgramId::Dnc => "DNC".to_owned(),
    }
}

fn active_alarms(moment: &MachineMoment) -> BTreeSet<u16> {
    let alarms = moment.emulator.cnc().alarms().iter();
    alarms.map(|alarm| alarm.number).collect()
}

fn part_version(moment: &MachineMoment) -> Option<u64> {
    let machining = moment.part.machining()?;
    Some(machining.scene().part().version())
}

const fn xz(row: ToolOffset) -> (f64, f64) {
    (row.x, row.z)
}
