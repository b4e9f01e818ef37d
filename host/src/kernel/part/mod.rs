//! The part in the simulated lathe: the slides cut it as they move, whether a view shows it
//! or not. A collision may stop the lathe.

mod empty_chuck;
mod fittings;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use crossbeam::queue::ArrayQueue;
use gsk_core::alarm::Alarm;
use gsk_core::command::SourcePosition;
use gsk_core::machine::{LatheConfig, LatheFault, SimulatedLathe};
use gsk_core::units::Point;
use gsk_history::machine_part::{CRASH_FAULTS, CutEffect, MachinePart, NamedJob, PartInput};
use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;
use gsk_runner::machining::live_part::{ThreadZone, running_block};
use gsk_runner::machining::{CollisionFinding, CutFault};
use gsk_workpiece::collision::Collision;
use gsk_workpiece::job::Job;
use gsk_workpiece::part::TurnedPart;
use gsk_workpiece::region::Region;
use gsk_workpiece::tool::Tool;

use crate::files::tool_library::ToolMinutes;
use crate::job::SelectedJob;
use empty_chuck::EmptyChuck;
pub use fittings::LatheFittings;

/// The part and the lathe around it at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct PartView {
    pub job: Arc<Job>,
    /// Name of the job file; `None` if the job was guessed.
    pub job_name: Option<Arc<str>>,
    /// The farthest position of the tip if the chuck holds nothing, in an exercise without a part:
    /// part coordinates, mm. `job` describes the lathe alone then, and its stock is not there.
    pub empty_chuck: Option<Point>,
    /// Half section of the part in its current state.
    pub section: Arc<Region>,
    /// The threads that were cut on the part.
    pub threads: Arc<Vec<ThreadZone>>,
    /// Number of the tool in the working position, 0 = none.
    pub tool: u8,
    /// Position of the tool tip, part coordinates, mm.
    pub tip: Point,
    /// Absolute coordinates of the control, mm; X as a radius.
    pub absolute: Point,
    /// Speed of the spindle, r/min; negative in reverse.
    pub spindle_rpm: f64,
    pub coolant: bool,
    /// Whether the power chuck holds the stock.
    pub clamped: bool,
    /// Whether the power chuck has held the stock and has released it. A chuck that never held
    /// stock counts as clamped by hand.
    pub chuck_open: bool,
    /// Whether the quill of the tailstock is extended.
    pub tailstock_forward: bool,
    pub door_open: bool,
    /// Whether the tool post is on the far side of the spindle.
    pub rear_tool_post: bool,
    /// Construction, steady rest, signal lamps, handwheel and broken insert, for the 3D view.
    pub fittings: LatheFittings,
    /// Collisions since the stock was clamped.
    pub findings: Vec<CollisionFinding>,
    /// The collision that has stopped the lathe; `None` once its faults are cleared.
    pub crash: Option<CollisionFinding>,
    /// The block that is being executed; `None` if no program runs.
    pub block: Option<SourcePosition>,
    /// The active alarms, the newest first.
    pub alarms: Vec<Alarm>,
}

impl PartView {
    /// The state of the lathe around an empty chuck, with the tip of the tool at `tip`.
    fn of_lathe(emulator: &Emulator, job: &Arc<Job>, tip: Point) -> Self {
        let simulation = emulator.simulation();
        let lathe = &simulation.lathe;
        Self {
            job: Arc::clone(job),
            job_name: None,
            alarms: simulation.cnc.alarms().to_vec(),
            empty_chuck: None,
            section: Arc::default(),
            threads: Arc::default(),
            tool: active_tool(emulator),
            tip,
            absolute: simulation.cnc.position_absolute(),
            spindle_rpm: lathe.spindle_rpm(),
            coolant: lathe.is_coolant_on(),
            clamped: lathe.is_chuck_clamped(),
            chuck_open: false,
            tailstock_forward: lathe.is_tailstock_forward(),
            door_open: lathe.has_fault(LatheFault::DoorOpen),
            rear_tool_post: lathe.config().rear_tool_post,
            fittings: LatheFittings::from_emulator(emulator),
            findings: Vec::new(),
            crash: None,
            block: running_block(simulation),
        }
    }
}

/// Number of the tool in the working position, 0 = none.
fn active_tool(emulator: &Emulator) -> u8 {
    let simulation = emulator.simulation();
    let station = simulation.lathe.station();
    station.unwrap_or(simulation.cnc.tool().0)
}

/// Clears the faults that a collision has set. Faults of another kind remain.
pub(super) fn end_crash_faults(emulator: &mut Emulator) {
    for fault in CRASH_FAULTS {
        // A fault that is not there is not repaired either: an exercise would count it.
        if emulator.lathe().has_fault(fault) {
            emulator.set_fault(fault, false);
        }
    }
}

/// A job with the name of its file.
fn named_job(chosen: SelectedJob) -> Box<NamedJob> {
    let name = chosen.file.as_deref().and_then(Path::file_name);
    Box::new(NamedJob {
        name: name.map(|name| name.to_string_lossy().into_owned()),
        job: chosen.job,
    })
}

/// The sentence about a collision; `stops`: it has stopped the lathe.
pub(super) fn collision_message(collision: &Collision, stops: bool) -> Message {
    let (x, z) = (collision.tip.diameter().0, collision.tip.z);
    let what = collision.message();
    match stops {
        true => say::window_crash(what, x, z),
        false => say::window_collision(what, x, z),
    }
}

/// The part in the simulated lathe with its job, and the view of it that was last published.
#[derive(Debug)]
pub(super) struct KernelPart {
    state: MachinePart,
    /// Inputs applied since they were last taken, for the recorder.
    inputs: Vec<PartInput>,
    /// Whether any view shows the part.
    visible: bool,
    /// What a lathe without a part shows; `None`: nothing.
    empty_chuck: Option<EmptyChuck>,
    section: Arc<Region>,
    threads: Arc<Vec<ThreadZone>>,
    /// The last collision that has stopped the lathe; `None` without one.
    crash: Option<CollisionFinding>,
    /// The last cut above the limits that has broken something; `None` without one.
    cut_fault: Option<CutFault>,
    /// The part from which `section` was made; `None` before the first one.
    shown_part: Option<TurnedPart>,
    last: Option<Arc<PartView>>,
    /// Seconds in the material by tool that were taken for the lives of the tools.
    counted_s: BTreeMap<u8, f64>,
    views: Arc<ArrayQueue<Arc<PartView>>>,
}

impl KernelPart {
    /// Creates a lathe without a part; `views` takes the states for the window.
    pub(super) fn new(views: Arc<ArrayQueue<Arc<PartView>>>) -> Self {
        Self {
            state: MachinePart::default(),
            inputs: Vec::new(),
            visible: false,
            empty_chuck: None,
            section: Arc::default(),
            threads: Arc::default(),
            crash: None,
            cut_fault: None,
            shown_part: None,
            last: None,
            counted_s: BTreeMap::new(),
            views,
        }
    }

    /// Creates the state without a part for the same window, with the same settings of that window.
    pub(super) fn empty_for_same_window(&self) -> Self {
        Self::new(Arc::clone(&self.views)).with_switches_of(self)
    }

    /// Copies the settings of the window, stop at a collision and visible, from `other`.
    pub(super) fn with_switches_of(mut self, other: &Self) -> Self {
        self.set_crash_stops(other.state.crash_stops());
        if other.state.overload() {
            self.set_overload(true);
        }
        self.visible = other.visible;
        self.force_publish();
        self
    }

    /// Shows the lathe with an empty chuck as long as there is no part.
    pub(super) fn with_empty_chuck(mut self, lathe: &LatheConfig) -> Self {
        self.empty_chuck = Some(EmptyChuck::of_lathe(lathe));
        self
    }

    /// Returns the part with its job.
    pub(super) const fn state(&self) -> &MachinePart {
        &self.state
    }

    /// Takes the inputs that were applied since the last call.
    pub(super) fn take_inputs(&mut self) -> Vec<PartInput> {
        core::mem::take(&mut self.inputs)
    }

    fn apply(&mut self, input: PartInput) {
        self.inputs.push(input.clone());
        self.state.apply(input);
    }

    /// Replaces the part and its job by those of another moment.
    pub(super) fn replace_state(&mut self, state: MachinePart) {
        self.inputs.clear();
        self.crash = (state.machining()).and_then(|it| it.findings().last().copied());
        self.cut_fault = None;
        self.state = state;
        self.counted_s = self.cutting_s();
        self.shown_part = None;
        self.force_publish();
    }

    /// Seconds in the material by tool since the job was set.
    fn cutting_s(&self) -> BTreeMap<u8, f64> {
        let machining = self.state.machining();
        let cutting = machining.iter().flat_map(|it| it.cutting());
        cutting
            .map(|(tool, cutting)| (*tool, cutting.seconds))
            .collect()
    }

    /// Takes the minutes in the material of the tools from the tool library since the last call.
    pub(super) fn take_tool_minutes(&mut self) -> Vec<ToolMinutes> {
        let library = &self.state.job().library;
        if library.is_empty() {
            return Vec::new();
        }
        let now = self.cutting_s();
        let before = &self.counted_s;
        let spent = library.iter().filter_map(|(number, id)| {
            let counted = before.get(number).copied().unwrap_or_default();
            let seconds = now.get(number)? - counted;
            (seconds > 0.0).then(|| ToolMinutes {
                number: *number,
                id: id.clone(),
                minutes: seconds / 60.0,
            })
        });
        let spent = spent.collect();
        self.counted_s = now;
        spent
    }

    /// Makes the next call of [`Self::publish`] publish even an unchanged part.
    pub(super) fn force_publish(&mut self) {
        self.last = None;
    }

    /// Sets another job, on fresh stock; `None` empties the chuck of the lathe, and programs cut
    /// nothing.
    pub(super) fn set_job(&mut self, chosen: Option<SelectedJob>, lathe: &LatheConfig) {
        if chosen.is_none() {
            self.empty_chuck = Some(EmptyChuck::of_lathe(lathe));
        }
        self.shown_part = None;
        self.last = None;
        self.counted_s.clear();
        self.apply(PartInput::Job(chosen.map(named_job)));
    }

    /// Puts the tools of another job with the same stock into the tool post; the part is kept.
    pub(super) fn change_tools(&mut self, chosen: SelectedJob) {
        self.last = None;
        self.apply(PartInput::Tools(named_job(chosen)));
    }

    pub(super) fn fresh_stock(&mut self) {
        self.apply(PartInput::NewStock);
        self.shown_part = None;
    }

    /// Sets whether the lathe stops at a collision.
    pub(super) fn set_crash_stops(&mut self, stops: bool) {
        self.apply(PartInput::CrashStops(stops));
    }

    /// Sets whether a cut above the limits breaks something even if the machine file does not say
    /// so.
    pub(super) fn set_overload(&mut self, is_on: bool) {
        self.apply(PartInput::Overload(is_on));
    }

    /// Sets whether the load of the current cut is measured.
    pub(super) fn set_measures_load(&mut self, is_on: bool) {
        self.state.set_measures_load(is_on);
    }

    /// Sets whether a view shows the part. Its section is published only then.
    pub(super) fn set_visible(&mut self, visible: bool) {
        self.visible = visible;
        self.force_publish();
    }

    /// Cuts the part after a tick. Returns the sentence about a collision, or about a cut above the
    /// limits; `None` without one. A real lathe (`simulated` is false) is not stopped, because its
    /// part may differ from this one.
    pub(super) fn after_tick(
        &mut self,
        emulator: &mut Emulator,
        simulated: bool,
    ) -> Option<Message> {
        self.state.set_meets_drawn_part(simulated);
        let finding = self.state.follow_tick(emulator.simulation());
        let effect = match simulated {
            true => (self.state).cut_effect(finding.as_ref(), emulator.simulation()),
            false => CutEffect::default(),
        };
        let cut_fault = effect.cut_fault;
        if finding.is_none() && cut_fault.is_none() {
            return None;
        }
        // A fault that was mended says nothing about the next one.
        self.cut_fault = self.lasting_cut_fault(emulator.lathe());
        if let Some(cut_fault) = cut_fault {
            self.crash = None;
            self.cut_fault = Some(cut_fault);
        }
        for fault in effect.faults() {
            emulator.set_fault(fault, true);
        }
        let Some(finding) = finding else {
            return cut_fault.map(|it| it.message());
        };
        let stops = effect.crash_faults.is_some();
        if stops {
            self.crash = Some(finding);
        }
        Some(collision_message(&finding.collision, stops))
    }

    /// The cut above the limits whose fault lasts.
    fn lasting_cut_fault(&self, lathe: &SimulatedLathe) -> Option<CutFault> {
        self.cut_fault.filter(|it| lathe.has_fault(it.fault()))
    }

    /// The collision that has stopped the lathe; `None` once its faults are cleared.
    fn stopping_crash(&self, lathe: &SimulatedLathe) -> Option<CollisionFinding> {
        let is_crashed = CRASH_FAULTS.iter().any(|fault| lathe.has_fault(*fault));
        self.crash.filter(|_| is_crashed)
    }

    /// Returns the sentences about the cut that has broken something and the collision that has
    /// stopped the lathe; `None` once their faults are cleared.
    pub(super) fn crash_message(&self, emulator: &Emulator) -> Option<Message> {
        let cut_fault = self.lasting_cut_fault(emulator.lathe());
        let crash = self.stopping_crash(emulator.lathe());
        let crash = crash.map(|crash| collision_message(&crash.collision, true));
        let messages: Vec<Message> = cut_fault
            .map(|it| it.message())
            .into_iter()
            .chain(crash)
            .collect();
        (!messages.is_empty()).then(|| say::several(messages))
    }

    /// Whether the tool in the working position works in a bore.
    pub(super) fn is_tool_internal(&self, emulator: &Emulator) -> bool {
        let tool = active_tool(emulator);
        let machining = self.state.machining();
        let tool = machining.and_then(|machining| machining.job().tools.get(&tool));
        tool.is_some_and(Tool::is_internal)
    }

    /// Publishes the part if a view shows it and it has changed since the last time; returns
    /// true if so.
    pub(super) fn publish(&mut self, emulator: &Emulator) -> bool {
        if !self.visible {
            return false;
        }
        let view = match (self.state.live().is_some(), &self.empty_chuck) {
            (true, _) => self.part_view(emulator),
            (false, Some(empty)) => Some(empty.view(emulator)),
            (false, None) => None,
        };
        let Some(view) = view else {
            return false;
        };
        if self.last.as_deref() == Some(&view) {
            return false;
        }
        let view = Arc::new(view);
        self.views.force_push(Arc::clone(&view));
        self.last = Some(view);
        true
    }

    /// The part, with its outline made anew if it has changed; `None` without a part.
    fn part_view(&mut self, emulator: &Emulator) -> Option<PartView> {
        let live = self.state.live()?;
        let machining = live.machining();
        let part = live.part_now();
        if self.shown_part.as_ref() != Some(&part) {
            self.section = Arc::new(part.section());
            self.shown_part = Some(part);
        }
        if *self.threads != live.threads() {
            self.threads = Arc::new(live.threads().to_vec());
        }
        let (cnc, tool) = (emulator.cnc(), active_tool(emulator));
        let tip = live.tip(tool, cnc);
        let fittings = LatheFittings {
            broken_tool: live.broken_tool(),
            ..LatheFittings::from_emulator(emulator)
        };
        Some(PartView {
            fittings,
            job_name: self.state.job_name().cloned(),
            section: Arc::clone(&self.section),
            threads: Arc::clone(&self.threads),
            chuck_open: self.state.has_gripped() && !emulator.lathe().is_chuck_clamped(),
            findings: machining.findings().to_vec(),
            crash: self.stopping_crash(emulator.lathe()),
            ..PartView::of_lathe(emulator, self.state.job(), tip)
        })
    }
}
