//! The part in the lathe with its job: it follows the machine and changes by inputs.

use std::sync::Arc;

use gsk_core::machine::LatheFault;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_runner::machining::live_part::LivePart;
use gsk_runner::machining::{CollisionFinding, CutFault, CutLoad, Machining};
use gsk_workpiece::collision::TouchingPart;
use gsk_workpiece::job::Job;
use gsk_workpiece::stock::Stock;
use serde::{Deserialize, Serialize};

/// A job with the name of its file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct NamedJob {
    /// The job with stock, clamping and tools.
    pub job: Job,
    /// Name of the job file; `None` if the job was guessed.
    pub name: Option<String>,
}

/// A change of the part from outside. The machine does not depend on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum PartInput {
    /// Clamps the stock of another job; `None` removes the part.
    Job(Option<Box<NamedJob>>),
    /// Puts the tools of another job with the same stock and place into the tool post; the part is
    /// kept.
    Tools(Box<NamedJob>),
    /// Clamps new stock of the same job.
    NewStock,
    /// Sets whether a collision stops the lathe.
    CrashStops(bool),
    /// Sets whether a cut above the limits breaks something even if the machine file does not say
    /// so.
    Overload(bool),
}

/// The faults by which a collision stops the lathe (two of them at a time), and those of a cut
/// above the limits.
pub const CRASH_FAULTS: [LatheFault; 5] = [
    LatheFault::DriveX,
    LatheFault::DriveZ,
    LatheFault::SpindleBlocked,
    LatheFault::InsertBroken,
    LatheFault::StockLoose,
];

/// What a tick of cutting does to the simulated lathe.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CutEffect {
    /// The cut above the limits; `None` without one.
    pub cut_fault: Option<CutFault>,
    /// The faults of a collision that stops the lathe; `None` without one.
    pub crash_faults: Option<[LatheFault; 2]>,
}

impl CutEffect {
    /// The faults of the lathe, in the order in which they are set.
    pub fn faults(&self) -> impl Iterator<Item = LatheFault> + use<> {
        let by_cut = self.cut_fault.map(|it| it.fault());
        by_cut
            .into_iter()
            .chain(self.crash_faults.into_iter().flatten())
    }
}

/// The part that the slides cut, its job and the switches that belong to it.
#[derive(Clone, Debug)]
pub struct MachinePart {
    live: Option<LivePart>,
    job: Arc<Job>,
    job_name: Option<Arc<str>>,
    crash_stops: bool,
    overload: bool,
    /// Whether motion by hand meets a part whose place only the control's coordinates give.
    meets_drawn_part: bool,
    /// Whether the power chuck has held the stock at least once.
    has_gripped: bool,
}

impl Default for MachinePart {
    fn default() -> Self {
        Self {
            live: None,
            job: Arc::new(Job::new(Stock::bar(50.0, 0.0, 60.0))),
            job_name: None,
            crash_stops: true,
            overload: false,
            meets_drawn_part: true,
            has_gripped: false,
        }
    }
}

impl MachinePart {
    /// Applies an input to the part.
    pub fn apply(&mut self, input: PartInput) {
        match input {
            PartInput::Job(chosen) => {
                self.live = chosen.map(|chosen| {
                    self.job = Arc::new(chosen.job.clone());
                    self.job_name = chosen.name.map(Arc::from);
                    let mut live = LivePart::new(Machining::new(chosen.job));
                    live.set_overload(self.overload);
                    live.set_meets_drawn_part(self.meets_drawn_part && self.job_name.is_some());
                    live
                });
            }
            PartInput::Tools(chosen) => {
                let Some(live) = &mut self.live else { return };
                self.job = Arc::new(chosen.job.clone());
                self.job_name = chosen.name.map(Arc::from);
                live.change_tools(chosen.job);
            }
            PartInput::NewStock => {
                if let Some(live) = &mut self.live {
                    live.clamp_new_stock();
                }
            }
            PartInput::CrashStops(stops) => self.crash_stops = stops,
            PartInput::Overload(is_on) => {
                self.overload = is_on;
                if let Some(live) = &mut self.live {
                    live.set_overload(is_on);
                }
            }
        }
    }

    /// Sets whether motion by hand meets the part of a job file or of a sample where the control's
    /// coordinates draw it, if nothing else gives its place. Not if the slides are those of a
    /// real lathe; a guessed part is met where a program has cut it.
    pub fn set_meets_drawn_part(&mut self, meets: bool) {
        self.meets_drawn_part = meets;
        let is_given = self.job_name.is_some();
        if let Some(live) = &mut self.live {
            live.set_meets_drawn_part(meets && is_given);
        }
    }

    /// Returns the inputs that give a new part the same job, on uncut stock, and the same
    /// switches.
    pub fn inputs_for_uncut(&self) -> Vec<PartInput> {
        let named = self.live.as_ref().map(|_| {
            Box::new(NamedJob {
                job: Job::clone(&self.job),
                name: self.job_name.as_deref().map(str::to_owned),
            })
        });
        let mut inputs = vec![
            PartInput::Job(named),
            PartInput::CrashStops(self.crash_stops),
        ];
        // Versions before this input read the recordings of sessions without it.
        inputs.extend(self.overload.then_some(PartInput::Overload(true)));
        inputs
    }

    /// Cuts the part after a tick. Returns the first collision of the tick, if any.
    pub fn follow_tick(&mut self, simulation: &Simulation) -> Option<CollisionFinding> {
        self.has_gripped |= simulation.lathe.is_chuck_clamped();
        self.live.as_mut()?.follow_tick(simulation).first().copied()
    }

    /// Returns what the last tick does to the simulated lathe, which is faulty from now on. A
    /// replay has these faults among its inputs. `collision` is that of the tick.
    pub fn cut_effect(
        &self,
        collision: Option<&CollisionFinding>,
        simulation: &Simulation,
    ) -> CutEffect {
        CutEffect {
            cut_fault: self.live.as_ref().and_then(LivePart::cut_fault),
            crash_faults: collision.and_then(|it| self.crash_faults(it, simulation)),
        }
    }

    /// Sets whether the load of the current cut is measured. The machine does not depend on it.
    pub fn set_measures_load(&mut self, is_on: bool) {
        if let Some(live) = &mut self.live {
            live.set_measures_load(is_on);
        }
    }

    /// Returns the load of the current cut while it is measured, 0 without a part; `None` if the
    /// material of the stock has no constants.
    pub fn load(&self) -> Option<CutLoad> {
        match &self.live {
            Some(live) => live.load(),
            None => Some(CutLoad::default()),
        }
    }

    /// Returns the faults by which a collision stops the simulated lathe: the drive of the axis
    /// with more distance to go, by hand that of the axis that has moved, trips, and the spindle
    /// is blocked. `None` if the collision stops
    /// nothing.
    ///
    /// With a guessed job the position of the part is an assumption by hand, and the shape of a
    /// tool beyond its edge is one always: such a collision is reported and stops nothing
    /// (WINDOW-29).
    fn crash_faults(
        &self,
        finding: &CollisionFinding,
        simulation: &Simulation,
    ) -> Option<[LatheFault; 2]> {
        let by_body = matches!(finding.collision.touching_part, TouchingPart::Body(_));
        let is_given = self.job_name.is_some() || self.job.zero.is_some();
        let is_certain = is_given || (finding.source.is_some() && !by_body);
        let mut left = simulation.cnc.distance_to_go();
        if left == Point::default()
            && let Some(live) = &self.live
        {
            left = live.last_motion();
        }
        let drive = match left.x.abs() > left.z.abs() {
            true => LatheFault::DriveX,
            false => LatheFault::DriveZ,
        };
        (self.crash_stops && is_certain).then_some([drive, LatheFault::SpindleBlocked])
    }

    /// Returns the part with its threads; `None` without a job.
    pub const fn live(&self) -> Option<&LivePart> {
        self.live.as_ref()
    }

    /// Returns the part that is cut; `None` without a job.
    pub fn machining(&self) -> Option<&Machining> {
        self.live.as_ref().map(LivePart::machining)
    }

    /// Returns the job of the part, the last one if there is none now.
    pub const fn job(&self) -> &Arc<Job> {
        &self.job
    }

    /// Returns the name of the job file; `None` if the job was guessed.
    pub const fn job_name(&self) -> Option<&Arc<str>> {
        self.job_name.as_ref()
    }

    /// Returns whether a collision stops the lathe.
    pub const fn crash_stops(&self) -> bool {
        self.crash_stops
    }

    /// Returns whether a cut above the limits breaks something even if the machine file does not
    /// say so.
    pub const fn overload(&self) -> bool {
        self.overload
    }

    /// Returns whether the power chuck has held the stock at least once.
    pub const fn has_gripped(&self) -> bool {
        self.has_gripped
    }
}
