//! The part in the simulated lathe: the slides cut it as they move, whether a view shows it
//! or not. A collision may stop the lathe.

use std::path::Path;
use std::sync::Arc;

use crossbeam::queue::ArrayQueue;
use gsk_core::command::{Frame, SourcePosition};
use gsk_core::machine::LatheFault;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_runner::machining::CollisionFinding;
use gsk_runner::machining::live_part::{LivePart, running_block};
use gsk_workpiece::collision::TouchingPart;
use gsk_workpiece::job::Job;
use gsk_workpiece::region::Region;

use crate::job::SelectedJob;

/// The part and the lathe around it at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct PartView {
    pub job: Arc<Job>,
    /// Name of the job file; `None` if the job was guessed.
    pub job_name: Option<Arc<str>>,
    /// Half section of what remains of the stock.
    pub section: Arc<Region>,
    /// Number of the tool in the working position, 0 = none.
    pub tool: u8,
    /// Position of the tool tip, part coordinates, mm.
    pub tip: Point,
    /// Slide position at which the tip is at the zero of the part, machine coordinates,
    /// mm: `part = program + zero of the frame + offset − this`.
    pub zero: Point,
    pub frame: Frame,
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
    /// Collisions since the stock was clamped.
    pub findings: Vec<CollisionFinding>,
    /// The block under execution; `None` if no program runs.
    pub block: Option<SourcePosition>,
}

/// The faults that a collision sets.
const CRASH_FAULTS: [LatheFault; 3] = [
    LatheFault::DriveX,
    LatheFault::DriveZ,
    LatheFault::SpindleBlocked,
];

/// Clears the faults that a collision has set. Faults of another kind remain.
pub(super) fn end_crash_faults(simulation: &mut Simulation) {
    for fault in CRASH_FAULTS {
        simulation.lathe.set_fault(fault, false);
    }
}

/// The part in the simulated lathe with its job, and what the window has been shown of it.
#[derive(Debug)]
pub(super) struct KernelPart {
    live: Option<LivePart>,
    job: Arc<Job>,
    job_name: Option<Arc<str>>,
    crash_stops: bool,
    /// Whether a view shows the part.
    visible: bool,
    /// Whether the power chuck has held the stock at least once.
    has_gripped: bool,
    section: Arc<Region>,
    /// Version of the part from which `section` was made; `None` before the first one.
    shown_version: Option<u64>,
    last: Option<Arc<PartView>>,
    views: Arc<ArrayQueue<Arc<PartView>>>,
}

impl KernelPart {
    /// Creates a lathe without a part; `views` takes the states for the window.
    pub(super) fn new(views: Arc<ArrayQueue<Arc<PartView>>>) -> Self {
        Self {
            live: None,
            job: Arc::new(Job::new(gsk_workpiece::stock::Stock::bar(50.0, 0.0, 60.0))),
            job_name: None,
            crash_stops: true,
            visible: false,
            has_gripped: false,
            section: Arc::default(),
            shown_version: None,
            last: None,
            views,
        }
    }

    /// Creates a state without a part for the same window, with the same switches.
    pub(super) fn empty_for_same_window(&self) -> Self {
        Self::new(Arc::clone(&self.views)).with_switches_of(self)
    }

    /// Copies the switches of the window, stop at a collision and visible, from `other`.
    pub(super) fn with_switches_of(mut self, other: &Self) -> Self {
        self.crash_stops = other.crash_stops;
        self.visible = other.visible;
        self.force_publish();
        self
    }

    /// Makes the next call of [`Self::publish`] publish even an unchanged part.
    pub(super) fn force_publish(&mut self) {
        self.last = None;
    }

    /// Sets another job, on fresh stock; `None` removes the part, and programs cut nothing.
    pub(super) fn set_job(&mut self, chosen: Option<SelectedJob>) {
        self.shown_version = None;
        self.last = None;
        self.live = chosen.map(|chosen| {
            self.job = Arc::new(chosen.job.clone());
            let name = chosen.file.as_deref().and_then(Path::file_name);
            self.job_name = name.map(|name| name.to_string_lossy().into());
            LivePart::new(chosen.create_machining())
        });
    }

    pub(super) fn fresh_stock(&mut self) {
        if let Some(live) = &mut self.live {
            live.clamp_new_stock();
        }
        self.shown_version = None;
    }

    /// Sets whether the lathe stops at a collision.
    pub(super) const fn set_crash_stops(&mut self, stops: bool) {
        self.crash_stops = stops;
    }

    /// Sets whether a view shows the part. Its section is published only then.
    pub(super) fn set_visible(&mut self, visible: bool) {
        self.visible = visible;
        self.force_publish();
    }

    /// Cuts the part after a tick. Returns the first collision of the tick, if any, and
    /// whether it stops the lathe: then it has blocked the spindle and tripped the drive of
    /// the axis with more distance to go. A real lathe is not stopped, because its part may
    /// differ from this one.
    pub(super) fn after_tick(
        &mut self,
        simulation: &mut Simulation,
        simulated: bool,
    ) -> Option<(CollisionFinding, bool)> {
        let finding = *self.live.as_mut()?.follow_tick(simulation).first()?;
        // With a guessed job the position of the part is an assumption by hand, and the shape of
        // a tool beyond its edge is one always: such a collision is reported and stops nothing
        // (WINDOW-29).
        let by_body = matches!(finding.collision.touching_part, TouchingPart::Body(_));
        let is_given = self.job_name.is_some() || self.job.zero.is_some();
        let is_certain = is_given || (finding.source.is_some() && !by_body);
        let stops = self.crash_stops && simulated && is_certain;
        if stops {
            let left = simulation.cnc.distance_to_go();
            let drive = match left.x.abs() > left.z.abs() {
                true => LatheFault::DriveX,
                false => LatheFault::DriveZ,
            };
            simulation.lathe.set_fault(drive, true);
            simulation.lathe.set_fault(LatheFault::SpindleBlocked, true);
        }
        Some((finding, stops))
    }

    /// Publishes the part if a view shows it and it has changed since the last time; returns
    /// true if so.
    pub(super) fn publish(&mut self, simulation: &Simulation) -> bool {
        let Some(live) = self.live.as_ref().filter(|_| self.visible) else {
            return false;
        };
        let part = live.machining().scene().part();
        if self.shown_version != Some(part.version()) {
            self.shown_version = Some(part.version());
            self.section = Arc::new(part.section());
        }
        let (cnc, lathe) = (&simulation.cnc, &simulation.lathe);
        self.has_gripped |= lathe.is_chuck_clamped();
        let tool = lathe.station().unwrap_or(cnc.tool().0);
        let frame = cnc.frame();
        let mounting = live.machining().mounting();
        let view = PartView {
            job: Arc::clone(&self.job),
            job_name: self.job_name.clone(),
            section: Arc::clone(&self.section),
            tool,
            tip: mounting.tip_in_part(tool, cnc.position_machine(), &frame),
            zero: mounting.slide_at_part_zero(tool, &frame),
            frame,
            spindle_rpm: lathe.spindle_rpm(),
            coolant: lathe.is_coolant_on(),
            clamped: lathe.is_chuck_clamped(),
            chuck_open: self.has_gripped && !lathe.is_chuck_clamped(),
            tailstock_forward: lathe.is_tailstock_forward(),
            door_open: lathe.has_fault(LatheFault::DoorOpen),
            rear_tool_post: lathe.config().rear_tool_post,
            findings: live.machining().findings().to_vec(),
            block: running_block(simulation),
        };
        if self.last.as_deref() == Some(&view) {
            return false;
        }
        let view = Arc::new(view);
        self.views.force_push(Arc::clone(&view));
        self.last = Some(view);
        true
    }
}
