//! The part of a tick that moves the axes, and the resulting position of the slides.

use super::Cnc;
use crate::motion::{DryRun, MotionInputs, RapidOverride};
use crate::operation::{JOG_RATE_MAX, OperatingMode, RunState, jog_rate};
use crate::units::{Axis, PerAxis, Point, percent_to_factor};

/// Greatest number of motions shorter than a tick that are executed in one tick.
const MOTIONS_PER_TICK: usize = 16;

/// Whether two coordinates of an axis, mm, are equal except for rounding.
fn is_equal(one: f64, other: f64) -> bool {
    (one - other).abs() < 1e-6
}

impl Cnc {
    /// Returns the inputs of the interpolator in this tick: overrides, hold and spindle.
    pub(super) fn motion_inputs(&self) -> MotionInputs {
        MotionInputs {
            feed_override: self.feed_override_factor(),
            rapid_override: RapidOverride::from_percent(self.plc.signals.rapid_override),
            spindle_rpm: self.spindle.control.actual_rpm(),
            spindle: self.spindle.angle.turn(),
            thread_continues: self.run.automatic.continues_thread(),
            cut_continues: self.continues_cut(),
            hold: self.is_motion_held() || self.is_run_interlocked(),
            dry_run: self.dry_run(),
        }
    }

    /// Whether feed hold stops the motion of a program.
    fn is_motion_held(&self) -> bool {
        self.run.automatic.state == RunState::Hold
            && self.run.held_motion.is_none()
            && !self.run.automatic.is_hold_protected()
    }

    pub(super) fn advance_motion(&mut self) {
        if !self.advance_retrace() {
            self.advance_interpolator();
            self.record_made_path();
        }
        self.drives
            .axis_chain
            .advance(self.position(), self.plc.signals.machine_lock);
        self.check_gear_speed_of_tick();
    }

    fn advance_interpolator(&mut self) {
        let held = self.is_motion_held();
        let mut inputs = self.motion_inputs();
        self.drives.interpolator.tick(&self.drives.limits, &inputs);
        for _ in 0..MOTIONS_PER_TICK {
            if !self.start_within_tick() {
                break;
            }
            inputs.thread_continues = self.run.automatic.continues_thread();
            inputs.cut_continues = self.continues_cut();
            inputs.hold = held || self.is_run_interlocked();
            self.drives
                .interpolator
                .continue_tick(&self.drives.limits, &inputs);
        }
    }

    /// The feed override in force, as a factor; 1 when OVC (G6.4) or a macro B program
    /// cancels it.
    pub fn feed_override_factor(&self) -> f64 {
        if self.plc.signals.override_cancel || self.run.registers.off.is_feed_override_off() {
            return 1.0;
        }
        percent_to_factor(self.plc.signals.feed_override)
    }

    /// Rates of the dry run (manual III-5.3.3): cuts at the jog rate, or at its highest step with
    /// manual rapid on; rapids at the jog rate, unless manual rapid is on or 004.6 RDRN = 1. `None`
    /// if dry run is off.
    pub(crate) fn dry_run(&self) -> Option<DryRun> {
        if !self.plc.signals.dry_run
            || !matches!(self.run.mode, OperatingMode::Auto | OperatingMode::Dnc)
        {
            return None;
        }
        let jog = jog_rate(self.plc.signals.jog_code);
        let rapid = self.plc.signals.rapid;
        Some(DryRun {
            cutting_mm_per_min: if rapid { JOG_RATE_MAX } else { jog },
            rapid_mm_per_min: (!rapid && !self.memory.parameters.dry_run_keeps_rapid())
                .then_some(jog),
        })
    }

    /// Whether machine lock is on for both axes: the commanded position changes, but the slides do
    /// not move.
    pub const fn is_machine_locked(&self) -> bool {
        self.plc.signals.machine_lock.x && self.plc.signals.machine_lock.z
    }

    /// Adds the distance that machine lock held back to the coordinate frame, before a run
    /// begins. The displayed coordinates and the slides stay, and machine coordinates are
    /// valid again.
    pub(crate) fn settle_coordinates(&mut self) {
        let slide = self.drives.axis_chain.slide_position();
        let held_back = self.position() - slide;
        if held_back != Point::default() {
            self.forget_made_path();
        }
        self.drives.interpolator.translate(-held_back);
        self.drives.axis_chain.preset(Axis::X, slide.x);
        self.drives.axis_chain.preset(Axis::Z, slide.z);
        self.coordinates.frame.zero = self.coordinates.frame.zero - held_back;
        let frame = self.coordinates.frame;
        let (interpreter, world) = self.interpreter_and_world(true);
        interpreter.set_frame(frame, &world);
    }

    /// Position of the slides, machine coordinates, mm: without the distance that machine lock held
    /// back.
    pub(crate) fn slide_position(&self) -> Point {
        self.drives.axis_chain.slide_position()
    }

    /// Machine coordinates (mm) at which the axes stop if they brake now.
    pub(crate) fn stopping_point(&self) -> Point {
        self.drives.interpolator.stopping_point(&self.drives.limits)
    }

    /// Switches the zero lamps off when an axis leaves its reference point or the program
    /// zero.
    pub(super) fn update_reference_lamps(&mut self) {
        let slide = self.slide_position();
        let at_zero = self.is_on_program_zero();
        for axis in [Axis::X, Axis::Z] {
            let at = self.coordinates.at_reference.get_mut(axis);
            if at.is_some_and(|at| !is_equal(at, slide.get(axis))) {
                *at = None;
            }
            *self.coordinates.program_zero_ended.get_mut(axis) &= *at_zero.get(axis);
        }
    }

    /// Ends ZP and PRO at an emergency stop and at a drive alarm, until the axes reach
    /// these points again (manual PLC-II 5.1, 5.2).
    pub(super) fn leave_zero_points(&mut self) {
        self.coordinates.at_reference = PerAxis::default();
        self.coordinates.program_zero_ended = PerAxis::new(true, true);
    }

    /// Axes whose slide is at the position of the last G50.
    fn is_on_program_zero(&self) -> PerAxis<bool> {
        let Some(zero) = self.coordinates.program_zero else {
            return PerAxis::default();
        };
        let slide = self.slide_position();
        PerAxis::new(is_equal(slide.x, zero.x), is_equal(slide.z, zero.z))
    }

    /// PRO: whether each axis is at the program zero.
    pub(super) fn at_program_zero(&self) -> PerAxis<bool> {
        let is_at_zero = self.is_on_program_zero();
        let ended = self.coordinates.program_zero_ended;
        PerAxis::new(is_at_zero.x && !ended.x, is_at_zero.z && !ended.z)
    }
}
