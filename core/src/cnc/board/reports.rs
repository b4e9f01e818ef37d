//! The part of a tick that concerns the board: handles its reports before everything else, and
//! collects the orders for it.

use crate::alarm::{Alarm, groups, number};
use crate::board::{
    BoardInputs, BoardOrders, BoardReport, ReturnOrders, RunOrders, SpindleOrders, Standstill,
};
use crate::cnc::{Cnc, Event};
use crate::machine::pins;
use crate::units::{Axis, PerAxis, Pulses};
use gsk_link::{BoardOutputs, SpindleDirection, Uncertainty};
use gsk_messages::{Message, say};

const MM_PER_INCH: f64 = 25.4;

impl Cnc {
    /// Handles the board's reports since the last tick. Returns the pulse counts of the
    /// axes after them; `None` without a board.
    pub(crate) fn handle_board_reports(
        &mut self,
        board: Option<&BoardInputs>,
    ) -> Option<PerAxis<Pulses>> {
        let Some(board) = board else {
            if self.drives.board.is_some() {
                self.detach_board();
            }
            return None;
        };
        self.drives.board = Some(board.drives);
        for report in &board.reports {
            self.handle_report(report);
        }
        self.clear_dropped_outputs(&board.dropped);
        if let Some(fraction) = board.pass_fraction {
            self.report_pass_progress(fraction);
        }
        if let Some(depth_mm) = board.tap_depth_mm {
            self.report_tap_depth(depth_mm);
        }
        if let Some(alarm) = &self.drives.board_alarms.persistent
            && !self.is_resetting()
        {
            self.raise(alarm.clone());
        }
        if let Some(standstill) = board.standstill {
            self.add_position_to_alarms(standstill);
        }
        Some(self.pulses())
    }

    /// Prepares the control for a board, which moves real slides: their position is unknown
    /// from now on.
    pub(crate) fn attach_board(&mut self) {
        self.drop_reference();
    }

    /// Disconnects the board: all motion ends, and the position of the slides is unknown.
    pub(crate) fn detach_board(&mut self) {
        self.end_motion_for_board();
        self.hand.retrace = None;
        self.drop_reference();
        self.drives.board = None;
        self.drives.board_alarms = Default::default();
    }

    /// Forgets the board, whose slides stand still; their position and reference remain. For a
    /// copy of the machine.
    pub(crate) fn simulate_slides(&mut self) {
        self.drives.board = None;
        self.drives.board_alarms = Default::default();
    }

    /// Message that explains why the slides of a board must not go to the start point of a
    /// restart; `None` if they may, or without a board.
    pub(crate) fn board_restart_refusal(&self) -> Option<Message> {
        let board = self.drives.board?;
        let referenced = self.coordinates.referenced;
        if !(board.position_known && referenced.x && referenced.z) {
            return Some(say::reference_return_needed());
        }
        (board.has_pending_motion || !board.takes_motion).then(say::restart_while_running)
    }

    fn handle_report(&mut self, report: &BoardReport) {
        match report {
            BoardReport::MotionEnded => self.end_motion_for_board(),
            BoardReport::RunStopped => self.stop_run_for_board(),
            BoardReport::StoppedAtSwitch => self.stop_for_switch(),
            BoardReport::StoppedAt(pulses) | BoardReport::MotionRejected(pulses) => {
                self.set_count(*pulses);
            }
            BoardReport::Alarm { alarm, in_pass } => {
                self.raise_board_alarm(alarm.clone(), *in_pass);
            }
            BoardReport::PositionlessFault(alarm) => self.raise(alarm.clone()),
            BoardReport::PersistentAlarm(alarm) => {
                self.drives.board_alarms.persistent = Some(alarm.clone());
            }
            BoardReport::CauseRecheck => self.drives.board_alarms.persistent = None,
            BoardReport::BoardReady => {
                self.end_motion_for_board();
                for number in groups::CONNECTION_ALARMS {
                    self.alarms.remove(number);
                }
            }
            BoardReport::ReferenceLost { raise_alarm } => {
                let referenced = self.coordinates.referenced;
                self.drives.board_alarms.reference_dropped |=
                    *raise_alarm && (referenced.x || referenced.z);
                self.drop_reference();
            }
            BoardReport::SwitchReached(axis) => self.handle_switch_reached(*axis),
            BoardReport::Homed { axes, at } => self.finish_board_homing(*axes, *at),
            BoardReport::ReturnsAbandoned => self.abandon_returns(),
            BoardReport::PassRefused(alarm) => self.raise_at_last_block(alarm.clone()),
            BoardReport::PassStarted => self.start_pass(),
            BoardReport::PassEnded(end) => self.finish_pass(*end),
            BoardReport::TapStarted => self.drives.interpolator.begin_external_tap(),
            BoardReport::TapEnded(end) => self.finish_tap(*end),
        }
    }

    /// Raises an alarm of the board; the position of the slides is added to its detail later.
    /// `in_pass`: the alarm names the block that began last.
    fn raise_board_alarm(&mut self, alarm: Alarm, in_pass: bool) {
        if !self.alarms.contains(alarm.number) {
            self.drives.board_alarms.incomplete.push(alarm.clone());
        }
        if in_pass {
            self.raise_at_last_block(alarm);
        } else {
            self.raise(alarm);
        }
    }

    /// Adds the position of the slides to the details of the alarms raised since the last
    /// standstill.
    fn add_position_to_alarms(&mut self, standstill: Standstill) {
        let board_alarms = &mut self.drives.board_alarms;
        if board_alarms.reference_dropped && !self.emergency_stop && self.reset_left_ms == 0 {
            board_alarms.reference_dropped = false;
            if self.alarms.is_empty() {
                let alarm = Alarm::new(number::NO_REFERENCE).with_detail(say::reference_dropped());
                self.raise_board_alarm(alarm, false);
            }
        }
        let mut incomplete = core::mem::take(&mut self.drives.board_alarms.incomplete);
        if !standstill.position_reported {
            // A board that is not identified yet has moved nothing.
            incomplete.retain(|alarm| !groups::can_precede_motion(alarm.number));
            for Alarm { number, detail, .. } in incomplete {
                let detail = detail.unwrap_or_else(|| say::as_written(""));
                self.alarms
                    .set_detail(number, say::position_unknown_after(detail));
            }
            return;
        }
        // The control's own emergency stop stops the board too.
        let mut active = self.alarms.list().iter();
        incomplete.extend(
            active
                .find(|alarm| alarm.number == number::EMERGENCY_STOP && alarm.detail.is_none())
                .cloned(),
        );
        if incomplete.is_empty() {
            return;
        }
        let certainty = standstill
            .uncertainty
            .map_or_else(say::position_certain, |reason| {
                say::position_uncertain(reason.text())
            });
        let [x, z] = self.machine_coordinate_texts();
        let position = if standstill.uncertainty.is_none_or(Uncertainty::is_counted) {
            say::position_counted(x, z, certainty)
        } else {
            say::position_sent(x, z, certainty)
        };
        for alarm in incomplete {
            let detail = match alarm.detail {
                Some(detail) => say::several([detail, position.clone()]),
                None => position.clone(),
            };
            if let Some(persistent) = &mut self.drives.board_alarms.persistent
                && persistent.number == alarm.number
            {
                persistent.detail = Some(detail.clone());
            }
            self.alarms.set_detail(alarm.number, detail);
        }
    }

    /// Machine coordinates of X and Z as texts, in the unit of the display (mm or inch).
    fn machine_coordinate_texts(&self) -> [String; 2] {
        let (at, parameters) = (self.position_machine(), &self.memory.parameters);
        let x = if parameters.is_radius_programming() {
            at.x
        } else {
            at.diameter().0
        };
        [x, at.z].map(|value| {
            let (unit, decimals) = if parameters.is_inch_machine() {
                (MM_PER_INCH, 4)
            } else {
                (1.0, 3)
            };
            let text = format!("{:.decimals$}", value / unit);
            // Avoids "-0.000".
            let zero = !text.contains(|digit| matches!(digit, '1'..='9'));
            text.trim_start_matches(|sign| zero && sign == '-')
                .to_owned()
        })
    }

    /// Raises an alarm and undoes the motion of the tick if parameters have changed since the board
    /// was connected. `pulses_before` is the pulse count before the tick.
    pub(crate) fn check_changed_parameters(&mut self, pulses_before: PerAxis<Pulses>) {
        let Some(board) = self.drives.board else {
            return;
        };
        if board.is_moving || self.pulses() == pulses_before {
            return;
        }
        let checked = board.checked_parameters;
        let changed_parameter =
            checked.and_then(|checked| checked.to_alarm(&self.memory.parameters));
        if let Some(alarm) = changed_parameter {
            self.raise(alarm);
            self.end_motion_for_board();
            self.set_count(pulses_before);
        }
    }

    /// Collects the orders for the board after this tick.
    pub(crate) fn board_orders(&self) -> BoardOrders {
        let parameters = &self.memory.parameters;
        let awaited_and_backlash =
            |axis| (self.awaited_input(axis), parameters.backlash(axis) != 0.0);
        let (x, z) = (awaited_and_backlash(Axis::X), awaited_and_backlash(Axis::Z));
        let is_end = |event: &Event| matches!(event, Event::ProgramEnded { .. });
        BoardOrders {
            outputs: self.commanded_outputs(),
            fraction: self.drives.axis_chain.fine_pulses(),
            is_moving: self.is_moving(),
            is_feeding: self.feed_actual() > 0.0,
            spindle: SpindleOrders {
                waits_for_angle: self.is_waiting_for_spindle(),
                lead_mm: self.followed_lead(),
                continues: self.drives.interpolator.is_between_threads(),
                is_braking: self.drives.interpolator.is_braking(),
                planned_rpm: self.thread_rpm(),
            },
            pass: self.pending_pass(),
            tap: self.pending_tap(),
            follows_tap: self.follows_board_tap(),
            returns: ReturnOrders {
                by_board: self.board_homing_axes(),
                awaited: PerAxis::new(x.0, z.0),
                referenced: self.coordinates.referenced,
            },
            is_emergency_stop: self.emergency_stop,
            is_resetting: self.is_resetting(),
            has_board_alarm: self.has_board_alarm(),
            compensates_backlash: x.1 || z.1,
            run: RunOrders {
                run_state: self.run.automatic.state,
                ended: (self.events.iter().any(is_end))
                    .then(|| self.cursor().program)
                    .flatten(),
            },
        }
    }

    /// Outputs of the board as the ladder and the spindle control command them.
    fn commanded_outputs(&self) -> BoardOutputs {
        let memory = self.plc.engine.memory();
        let (coolant, bit) = pins::COOLANT;
        let spindle = pins::spindle_direction(memory);
        let millivolts = match spindle {
            SpindleDirection::Stop => 0,
            _ => (self.spindle.control.volts() * 1000.0).round() as u16,
        };
        BoardOutputs {
            spindle,
            millivolts,
            coolant: memory.y(u16::from(coolant)) >> bit & 1 == 1,
        }
    }
}
