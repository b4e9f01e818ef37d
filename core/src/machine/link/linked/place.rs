//! Where the slides stand after a stop that the control has not made, and the words
//! of the alarms for it.

use super::Linked;
use crate::alarm::Alarm;
use crate::cnc::Cnc;
use crate::machine::link::{LinkState, RunTime};
use crate::operation::EMERGENCY_STOP;
use crate::simulation::Simulation;

const MM_PER_INCH: f64 = 25.4;

/// The moment of the motion that a picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp {
    at: RunTime,
    /// Stops since the opening behind which the control went on from another place.
    stops: u64,
}

impl Linked {
    /// The moment of the motion that a picture taken now shows.
    pub const fn stamp(&self) -> Stamp {
        Stamp {
            at: self.last_motion,
            stops: self.stops,
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
        stamp.stops != self.stops
    }

    /// Ticks of the kernel whose motion may not have been made yet.
    pub(super) fn ticks_ahead(&self) -> u64 {
        // Behind a fault nobody knows before the board has said where it stands.
        if self.link.takes_motion() && !self.is_behind() {
            return 0;
        }
        let ahead = self.run.saturating_sub(self.link.executed());
        ahead.as_micros().div_ceil(1000) as u64
    }

    /// The control goes on from where the slides are.
    pub(super) fn stands_at(&mut self, simulation: &mut Simulation) {
        self.pulses = simulation.cnc.pulses();
        self.moved = false;
        self.stops += 1;
    }

    /// The slides are on their way, or being stopped.
    fn is_under_way(&self) -> bool {
        self.is_behind() || self.flushing || self.halting.is_some() || self.pass.is_some()
    }

    /// Behind a fault or a loss the pages show what the board has made by its last
    /// count, not what was commanded.
    pub(super) fn stand_where_counted(&mut self, simulation: &mut Simulation) {
        if self.link.takes_motion() || self.is_under_way() {
            return;
        }
        if let Some(at) = self.link.place().filter(|at| *at != self.pulses) {
            simulation.cnc.stand_at(at);
            self.stands_at(simulation);
        }
    }

    /// Raises an alarm that is going to say where the slides stand.
    pub(super) fn raise(&mut self, simulation: &mut Simulation, alarm: Alarm) {
        let cnc = &mut simulation.cnc;
        let passing = self.pass.take().is_some();
        if !cnc.alarms.contains(alarm.number) {
            self.untold.push(alarm.clone());
        }
        if passing {
            cnc.raise_at_last(alarm);
        } else {
            cnc.raise(alarm);
        }
    }

    /// Alarms raised since say where the slides stand, as soon as that is known.
    pub(super) fn tell_place(&mut self, simulation: &mut Simulation) {
        if self.is_under_way() || self.link.is_stopping() {
            return;
        }
        let cnc = &mut simulation.cnc;
        if self.fell && !cnc.emergency_stop && !cnc.resetting() {
            self.fell = false;
            if cnc.alarms.is_empty() {
                let text = "the reference was dropped: make the reference return of both axes";
                let alarm = Alarm::new(610).because(text);
                self.untold.push(alarm.clone());
                cnc.raise(alarm);
            }
        }
        let mut untold = core::mem::take(&mut self.untold);
        if self.link.place().is_none() {
            // A board that is not known yet has moved nothing.
            untold.retain(|alarm| !(601..=604).contains(&alarm.number));
            for Alarm { number, detail, .. } in untold {
                let detail = detail.unwrap_or_default();
                let detail = format!("{detail}; nobody knows where the slides stand");
                cnc.alarms.restate(number, detail);
            }
            return;
        }
        // The control's own emergency stop stops the board as much as its faults do.
        let mut standing = cnc.alarms.list().iter();
        untold.extend(
            standing
                .find(|alarm| alarm.number == EMERGENCY_STOP && alarm.detail.is_none())
                .cloned(),
        );
        if untold.is_empty() {
            return;
        }
        let sure = if self.link.knows_position() {
            "certain".to_owned()
        } else {
            format!("uncertain: {}", self.link.doubt().text())
        };
        let [x, z] = shown(cnc);
        for alarm in untold {
            let detail = match alarm.detail {
                Some(detail) => format!(
                    "{detail}; machine coordinates X {x} Z {z} by the board's count, {sure}"
                ),
                None => format!("machine coordinates X {x} Z {z} by the board's count, {sure}"),
            };
            if let Some(standing) = &mut self.standing
                && standing.number == alarm.number
            {
                standing.detail = Some(detail.clone());
            }
            cnc.alarms.restate(alarm.number, detail);
        }
    }

    /// Motion came too late to a board that answers; one that is lost is another matter.
    pub(super) fn tell_late(&mut self, simulation: &mut Simulation) {
        let lost = matches!(self.link.state(), LinkState::Lost | LinkState::Fault);
        if let Some(text) = self
            .late
            .take_if(|_| lost || self.link.is_heard())
            .filter(|_| !lost)
        {
            self.raise(simulation, Alarm::new(612).because(text));
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
