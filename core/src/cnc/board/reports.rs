//! The board's part of a tick: handles its reports before everything else, and collects the
//! orders for it.

use crate::alarm::{Alarm, groups, number};
use crate::board::{
    BoardInputs, BoardOrders, BoardReport, ReturnOrders, RunOrders, Settled, SpindleOrders,
};
use crate::cnc::{Cnc, Event};
use crate::machine::pins;
use crate::units::{Axis, PerAxis, Pulses};
use gsk_link::{BoardOutputs, SpindleDirection, Uncertainty};
use gsk_messages::say;

const MM_PER_INCH: f64 = 25.4;

impl Cnc {
    /// Handles the board's reports since the last tick. Returns the axis counts after them,
    /// if there is a board.
    pub(crate) fn hear_board(&mut self, board: Option<&BoardInputs>) -> Option<PerAxis<Pulses>> {
        let Some(board) = board else {
            if self.drives.board.is_some() {
                self.detach_board();
            }
            return None;
        };
        self.drives.board = Some(board.drives);
        for report in &board.reports {
            self.react(report);
        }
        self.drop_outputs(&board.dropped);
        if let Some(share) = board.pass_made {
            self.pass_progress(share);
        }
        if let Some(alarm) = &self.drives.board_alarms.standing
            && !self.resetting()
        {
            self.raise(alarm.clone());
        }
        if let Some(settled) = board.settled {
            self.complete_alarms(settled);
        }
        Some(self.pulses())
    }

    /// Connects a board: the slides are real from now on, and their position is unknown.
    pub(crate) fn attach_board(&mut self) {
        self.drop_reference();
    }

    /// Disconnects the board: all motion ends, and the position of the slides is unknown.
    pub(crate) fn detach_board(&mut self) {
        self.halt_for_board();
        self.drop_reference();
        self.drives.board = None;
        self.drives.board_alarms = Default::default();
    }

    fn react(&mut self, report: &BoardReport) {
        match report {
            BoardReport::Halted => self.halt_for_board(),
            BoardReport::Stopped => self.stop_for_board(),
            BoardReport::Paused => self.pause_for_board(),
            BoardReport::StandsAt(pulses) | BoardReport::NotTaken(pulses) => {
                self.stand_at(*pulses);
            }
            BoardReport::Alarm { alarm, in_pass } => self.raise_of_board(alarm.clone(), *in_pass),
            BoardReport::Failed(alarm) => self.raise(alarm.clone()),
            BoardReport::Standing(alarm) => {
                self.drives.board_alarms.standing = Some(alarm.clone());
            }
            BoardReport::CauseGone => self.drives.board_alarms.standing = None,
            BoardReport::Opened => {
                self.halt_for_board();
                for number in groups::OF_OPENING {
                    self.alarms.remove(number);
                }
            }
            BoardReport::ReferenceLost { told } => {
                let referenced = self.coordinates.referenced;
                self.drives.board_alarms.fell |= *told && (referenced.x || referenced.z);
                self.drop_reference();
            }
            BoardReport::Reached(axis) => self.board_reached(*axis),
            BoardReport::Returned { axes, at } => self.board_returned(*axes, *at),
            BoardReport::ReturnsAbandoned => self.abandon_returns(),
            BoardReport::PassRefused(alarm) => self.raise_at_last(alarm.clone()),
            BoardReport::PassBegan => self.begin_pass(),
            BoardReport::PassEnded(end) => self.end_pass(*end),
        }
    }

    /// Raises an alarm whose detail will name the position of the slides.
    fn raise_of_board(&mut self, alarm: Alarm, in_pass: bool) {
        if !self.alarms.contains(alarm.number) {
            self.drives.board_alarms.incomplete.push(alarm.clone());
        }
        if in_pass {
            self.raise_at_last(alarm);
        } else {
            self.raise(alarm);
        }
    }

    /// Adds the position of the slides to the alarms raised since the last standstill.
    fn complete_alarms(&mut self, settled: Settled) {
        let board_alarms = &mut self.drives.board_alarms;
        if board_alarms.fell && !self.emergency_stop && self.reset_left == 0 {
            board_alarms.fell = false;
            if self.alarms.is_empty() {
                let alarm = Alarm::new(number::NO_REFERENCE).because(say::reference_dropped());
                self.raise_of_board(alarm, false);
            }
        }
        let mut incomplete = core::mem::take(&mut self.drives.board_alarms.incomplete);
        if !settled.reported {
            // A board that is not identified yet has moved nothing.
            incomplete.retain(|alarm| !groups::comes_before_motion(alarm.number));
            for Alarm { number, detail, .. } in incomplete {
                let detail = detail.unwrap_or_else(|| say::as_written(""));
                self.alarms
                    .restate(number, say::position_unknown_after(detail));
            }
            return;
        }
        // The control's own emergency stop stops the board too.
        let mut standing = self.alarms.list().iter();
        incomplete.extend(
            standing
                .find(|alarm| alarm.number == number::EMERGENCY_STOP && alarm.detail.is_none())
                .cloned(),
        );
        if incomplete.is_empty() {
            return;
        }
        let sure = settled
            .uncertainty
            .map_or_else(say::position_certain, |reason| {
                say::position_uncertain(reason.text())
            });
        let [x, z] = self.machine_coordinates_in_text();
        let position = if settled.uncertainty.is_none_or(Uncertainty::is_counted) {
            say::position_counted(x, z, sure)
        } else {
            say::position_sent(x, z, sure)
        };
        for alarm in incomplete {
            let detail = match alarm.detail {
                Some(detail) => say::several([detail, position.clone()]),
                None => position.clone(),
            };
            if let Some(standing) = &mut self.drives.board_alarms.standing
                && standing.number == alarm.number
            {
                standing.detail = Some(detail.clone());
            }
            self.alarms.restate(alarm.number, detail);
        }
    }

    /// Machine coordinates as the pages show them.
    fn machine_coordinates_in_text(&self) -> [String; 2] {
        let (at, parameters) = (self.position_machine(), &self.memory.parameters);
        let x = if parameters.radius_programming() {
            at.x
        } else {
            at.diameter().0
        };
        [x, at.z].map(|value| {
            let (unit, decimals) = if parameters.inch_machine() {
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

    /// Prevents motion from starting with parameters that differ from those of the
    /// connection; `stood_at` is the count before the tick.
    pub(crate) fn check_outgrown(&mut self, stood_at: PerAxis<Pulses>) {
        let Some(board) = self.drives.board else {
            return;
        };
        if board.moving || self.pulses() == stood_at {
            return;
        }
        let checked = board.checked;
        let outgrown = checked.and_then(|checked| checked.alarm(&self.memory.parameters));
        if let Some(alarm) = outgrown {
            self.raise(alarm);
            self.halt_for_board();
            self.stand_at(stood_at);
        }
    }

    /// The orders for the board after a tick.
    pub(crate) fn board_orders(&self) -> BoardOrders {
        let parameters = &self.memory.parameters;
        let both = |axis| (self.board_awaits(axis), parameters.backlash(axis) != 0.0);
        let (x, z) = (both(Axis::X), both(Axis::Z));
        let ended = |event: &Event| matches!(event, Event::ProgramEnded { .. });
        BoardOrders {
            outputs: self.switched_by_board(),
            fine: self.drives.chain.fine(),
            moving: self.is_moving(),
            feeding: self.feed_actual() > 0.0,
            spindle: SpindleOrders {
                waits: self.waits_for_spindle(),
                lead: self.lead_followed(),
            },
            pass: self.pass_waiting(),
            returns: ReturnOrders {
                by_board: self.board_returns(),
                awaited: PerAxis::new(x.0, z.0),
                referenced: self.coordinates.referenced,
            },
            emergency_stop: self.emergency_stop,
            resetting: self.resetting(),
            board_alarm: self.has_board_alarm(),
            backlash: x.1 || z.1,
            run: RunOrders {
                state: self.run.automatic.state,
                ended: (self.events.iter().any(ended))
                    .then(|| self.cursor().program)
                    .flatten(),
            },
        }
    }

    /// Outputs that the ladder and the spindle control command.
    fn switched_by_board(&self) -> BoardOutputs {
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
