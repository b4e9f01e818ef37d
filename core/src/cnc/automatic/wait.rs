//! What a program under way waits for, in words: for a run that comes to no end.

use crate::cnc::Cnc;
use crate::command::Action;
use crate::operation::{Return, RunState, Strobe};
use crate::units::{Axis, Feed};

impl Cnc {
    /// What the program under way waits for; none: it goes on, or there is none.
    pub fn waits_for(&self) -> Option<String> {
        match self.run.automatic.state {
            RunState::Reset | RunState::Stop => None,
            RunState::Hold if self.plc.signals.feed_hold => Some(
                "feed hold: *SP (G8.5) is 0: the key [暂停], the pin X1.5 or the ladder".into(),
            ),
            RunState::Hold => Some("cycle start after a feed hold".into()),
            RunState::Run => self
                .waits_in_run()
                .or_else(|| self.waits_for_fin())
                .or_else(|| self.waits_in_motion()),
        }
    }

    /// Signals that lock the motion of a program.
    fn waits_in_run(&self) -> Option<String> {
        let g = &self.plc.signals;
        if !self.run_interlocked() {
            return None;
        }
        let lock = if g.start_lock {
            "the start lock: STLK (G7.1) is 1".into()
        } else if g.interlock {
            "the interlock of all axes: *IT (G8.0) is 0".into()
        } else if self.spindle.control.changing_gear() {
            self.waits_for_gear()
        } else if self.run.automatic.arrival.awaited(g.speed_arrival) {
            "the spindle to reach its speed: SAR (G29.4) is 0 and 175.6 = 1".into()
        } else if self.brake_interlock() {
            "the spindle brake: its output Y0.7 is on and 011.4 = 0".into()
        } else {
            let axis = self.locked_axis()?;
            format!("the interlock of {axis:?}: IT, +MIT or -MIT (G130, G132, G134)")
        };
        Some(lock)
    }

    fn locked_axis(&self) -> Option<Axis> {
        let commanded = self.drives.interpolator.distance_to_go();
        [Axis::X, Axis::Z]
            .into_iter()
            .find(|axis| self.commanded_and_locked(*axis, commanded))
    }

    /// FIN of an M, S or T function, and what the ladder withholds it for.
    fn waits_for_fin(&self) -> Option<String> {
        let (strobe, code) = self.run.handshake.unfinished()?;
        if self.is_moving() || self.run.automatic.dwelling() {
            return None;
        }
        let fin = match strobe {
            Strobe::M => format!("FIN (G4.3) of M{code:02}"),
            Strobe::S => format!("FIN (G4.3) of S{code}"),
            Strobe::T => format!("FIN (G4.3) of T{code:02}"),
        };
        Some(match (strobe, code) {
            (Strobe::M, 12 | 13)
                if self.memory.parameters.has_chuck() && self.memory.parameters.watches_chuck() =>
            {
                format!(
                    "{fin}: the in-position input of the chuck does not come (X1.1, X1.2; 168.2 = 1)"
                )
            }
            (Strobe::M, 41..=44) => self.waits_for_gear(),
            (Strobe::T, _) => format!("{fin}: the tool post has not reached the station"),
            _ => fin,
        })
    }

    fn waits_for_gear(&self) -> String {
        if self.memory.parameters.watches_gear() {
            "the gear change: the in-position input does not come (X1.1, X1.2; 164.6 = 1)".into()
        } else {
            "the gear change".into()
        }
    }

    /// A motion that does not go on.
    fn waits_in_motion(&self) -> Option<String> {
        for axis in [Axis::X, Axis::Z] {
            match self.coordinates.returns.get(axis) {
                Some(Return::Approach | Return::Back) => {
                    return Some(format!("the deceleration switch of {axis:?}"));
                }
                Some(Return::OnSwitch) => {
                    return Some(format!("the end of the deceleration switch of {axis:?}"));
                }
                Some(Return::Search) => return Some(format!("the zero signal of {axis:?}")),
                _ => {}
            }
        }
        if self.drives.interpolator.finished() || self.is_moving() {
            return None;
        }
        let stands = self.spindle.control.actual_rpm().abs() < 1.0;
        let turned = match self.run.automatic.action()? {
            Action::Line { feed, .. } | Action::Arc { feed, .. } => {
                if matches!(feed, Feed::PerRevolution(_)) && stands {
                    true
                } else if self.plc.signals.feed_override == 0 {
                    return Some("a feed override above 0 %".into());
                } else {
                    return None;
                }
            }
            Action::Thread { .. } | Action::Tap { .. } => stands,
            _ => false,
        };
        turned.then(|| "the spindle, which stands".into())
    }
}
