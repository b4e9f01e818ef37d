//! Where the slides stand after a stop that the control has not made, and the words
//! of the alarms for it.

use super::Linked;
use crate::alarm::{Alarm, groups, number};
use crate::cnc::Cnc;
use crate::simulation::Simulation;
use gsk_link::{LinkState, RunTime, Uncertainty};
use gsk_messages::say;

const MM_PER_INCH: f64 = 25.4;

/// The moment of the motion that a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    at: RunTime,
    /// Stops since the opening behind which the control went on from another place.
    stops: u64,
}

/// Alarms of the link, and what they are still to say.
#[derive(Clone, Debug, Default)]
pub(super) struct LinkAlarms {
    /// It stands as long as its cause, whatever RESET does.
    pub(super) standing: Option<Alarm>,
    /// Alarms that do not say yet where the slides stand.
    pub(super) incomplete: Vec<Alarm>,
    /// The reference was dropped where the axes can be moved on.
    pub(super) fell: bool,
    /// Why motion came late, when it is not sure yet that the board is there.
    pub(super) late: Option<String>,
}

impl Linked {
    /// The moment of the motion that a picture taken now shows.
    pub const fn stamp(&self) -> Stamp {
        Stamp {
            at: self.motion.last,
            stops: self.motion.stops,
        }
    }

    /// Whether the board has made all motion up to a moment: pictures of it may be
    /// shown.
    pub fn has_made(&self, stamp: Stamp) -> bool {
        !self.is_behind() || self.link.executed() >= stamp.at
    }

    /// Whether the motion up to a moment may never have been made: pictures of it are
    /// not to be shown any more.
    pub const fn is_void(&self, stamp: Stamp) -> bool {
        stamp.stops != self.motion.stops
    }

    /// Ticks of the kernel whose motion may not have been made yet.
    pub(super) fn ticks_ahead(&self) -> u64 {
        // Behind a fault nobody knows before the board has said where it stands.
        if self.link.takes_motion() && !self.is_behind() {
            return 0;
        }
        let ahead = self.clock.run.saturating_sub(self.link.executed());
        ahead.as_micros().div_ceil(1000) as u64
    }

    /// The control goes on from where the slides are.
    pub(super) fn stopped_at(&mut self, simulation: &mut Simulation) {
        self.motion.stand_at(simulation.cnc.pulses());
        self.motion.stops += 1;
    }

    /// The slides are on their way, or being stopped.
    fn is_under_way(&self) -> bool {
        self.is_behind() || !self.stopping.is_none() || self.thread.pass.is_some()
    }

    /// Behind a fault or a loss the pages show what the board has made by its last
    /// count, not what was commanded.
    pub(super) fn adopt_count(&mut self, simulation: &mut Simulation) {
        if self.link.takes_motion() || self.is_under_way() {
            return;
        }
        if let Some(at) = self
            .link
            .last_position()
            .filter(|at| *at != self.motion.pulses)
        {
            simulation.cnc.stand_at(at);
            self.stopped_at(simulation);
        }
    }

    /// Raises an alarm that is going to say where the slides stand.
    pub(super) fn raise(&mut self, simulation: &mut Simulation, alarm: Alarm) {
        let cnc = &mut simulation.cnc;
        let passing = self.thread.pass.take().is_some();
        if !cnc.alarms.contains(alarm.number) {
            self.alarms.incomplete.push(alarm.clone());
        }
        if passing {
            cnc.raise_at_last(alarm);
        } else {
            cnc.raise(alarm);
        }
    }

    /// Alarms raised since say where the slides stand, as soon as that is known.
    pub(super) fn complete_alarms(&mut self, simulation: &mut Simulation) {
        if self.is_under_way() || self.link.is_stopping() {
            return;
        }
        let cnc = &mut simulation.cnc;
        if self.alarms.fell && !cnc.emergency_stop && !cnc.resetting() {
            self.alarms.fell = false;
            if cnc.alarms.is_empty() {
                let text = "the reference was dropped: make the reference return of both axes";
                let alarm = Alarm::new(number::NO_REFERENCE).because(text);
                self.alarms.incomplete.push(alarm.clone());
                cnc.raise(alarm);
            }
        }
        let mut incomplete = core::mem::take(&mut self.alarms.incomplete);
        if self.link.last_position().is_none() {
            // A board that is not known yet has moved nothing.
            incomplete.retain(|alarm| !groups::comes_before_motion(alarm.number));
            for Alarm { number, detail, .. } in incomplete {
                let detail = detail.unwrap_or_else(|| "".into());
                cnc.alarms
                    .restate(number, say::position_unknown_after(detail));
            }
            return;
        }
        // The control's own emergency stop stops the board as much as its faults do.
        let mut standing = cnc.alarms.list().iter();
        incomplete.extend(
            standing
                .find(|alarm| alarm.number == number::EMERGENCY_STOP && alarm.detail.is_none())
                .cloned(),
        );
        if incomplete.is_empty() {
            return;
        }
        let uncertainty = self.link.uncertainty();
        let sure = uncertainty.map_or_else(say::position_certain, |reason| {
            say::position_uncertain(reason.text())
        });
        let [x, z] = shown(cnc);
        let place = if uncertainty.is_none_or(Uncertainty::is_counted) {
            say::position_counted(x, z, sure)
        } else {
            say::position_sent(x, z, sure)
        };
        for alarm in incomplete {
            let detail = match alarm.detail {
                Some(detail) => say::several([detail, place.clone()]),
                None => place.clone(),
            };
            if let Some(standing) = &mut self.alarms.standing
                && standing.number == alarm.number
            {
                standing.detail = Some(detail.clone());
            }
            cnc.alarms.restate(alarm.number, detail);
        }
    }

    /// Motion came too late to a board that answers; one that is lost is another matter.
    pub(super) fn report_late(&mut self, simulation: &mut Simulation) {
        let lost = matches!(self.link.state(), LinkState::Lost | LinkState::Fault);
        if let Some(text) = self
            .alarms
            .late
            .take_if(|_| lost || self.link.is_responding())
            .filter(|_| !lost)
        {
            self.raise(simulation, Alarm::new(number::STEPS_TOO_LATE).because(text));
        }
    }
}

/// The machine coordinates as the pages show them.
fn shown(cnc: &Cnc) -> [String; 2] {
    let (at, parameters) = (cnc.position_machine(), cnc.parameters());
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
        // Never "-0.000".
        let zero = !text.contains(|digit| matches!(digit, '1'..='9'));
        text.trim_start_matches(|sign| zero && sign == '-')
            .to_owned()
    })
}
