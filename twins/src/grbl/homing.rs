//! Seeking the limit switches: fast to the switch, off it, slowly back, off it again.
//!
//! ```text
//!   $25 ──────────────────────►|switch     at most 1.5 times the travel ($130), or ALARM:9
//!               ◄── $27 ───────|           still operated: ALARM:8
//!        $24    ──────────────►|
//!               ◄── $27 ───────|           here the position is set
//! ```

use std::collections::VecDeque;

use super::{GrblTwin, State, Variant};

/// The search goes this far beyond the travel.
const SEARCH: f64 = 1.5;
/// The slow approach goes so many times the way back off the switch.
const LOCATE: f64 = 5.0;

/// Indices of X and Z among the axes of the board.
const AXES: [usize; 2] = [0, 2];

/// What one axis does now.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    Seek,
    OffAgain,
    Locate,
    Off,
}

/// A search under way.
#[derive(Clone, Debug)]
pub(super) struct Homing {
    /// Axes still to come, 0 X, 1 Z.
    axes: VecDeque<usize>,
    stage: Stage,
    /// Way made in this stage, mm, and its pulses.
    way: f64,
    made: i64,
}

impl GrblTwin {
    /// Whether `$HX` is known: bit 1 of `$22` on the larger board.
    pub(super) fn homes_single_axes(&self) -> bool {
        self.variant == Variant::GrblHal && self.settings.value(22) as u32 & 2 != 0
    }

    /// Z first, as the firmware does; answered when it is over.
    pub(super) fn begin_homing(&mut self, [x, z]: [bool; 2]) -> Option<Result<(), u8>> {
        if !self.settings.is_on(22) {
            return Some(Err(5));
        }
        if !matches!(self.state, State::Idle | State::Alarm) {
            return Some(Err(8));
        }
        let axes = [(z, 1), (x, 0)].into_iter().filter(|(taken, _)| *taken);
        self.homing = Some(Homing {
            axes: axes.map(|(_, axis)| axis).collect(),
            stage: Stage::Seek,
            way: 0.0,
            made: 0,
        });
        self.state = State::Home;
        None
    }

    /// A step of the search.
    pub(super) fn home(&mut self, seconds: f64) {
        let Some(mut homing) = self.homing.take() else {
            return;
        };
        let Some(&axis) = homing.axes.front() else {
            return self.homed();
        };
        let number = AXES[axis];
        let scale = self.settings.axes(100)[number];
        let pull_off = self.settings.value(27);
        let negative = self.settings.value(23) as u32 >> number & 1 == 1;
        let (rate, limit, inwards) = match homing.stage {
            Stage::Seek => (25, SEARCH * self.settings.axes(130)[number], false),
            Stage::OffAgain => (25, pull_off, true),
            Stage::Locate => (24, LOCATE * pull_off, false),
            Stage::Off => (24, pull_off, true),
        };
        homing.way = (homing.way + self.settings.value(rate) / 60.0 * seconds).min(limit);
        let due = (homing.way * scale) as i64;
        let pulses = due - homing.made;
        homing.made = due;
        let pulses = if negative == inwards { pulses } else { -pulses };
        self.pulses[number] += pulses;
        self.position[number] += pulses;
        let operated = self.limits()[axis];
        let over = homing.way >= limit;
        let next = match homing.stage {
            Stage::Seek if operated => Some(Stage::OffAgain),
            Stage::Locate if operated => Some(Stage::Off),
            Stage::Seek | Stage::Locate if over => return self.homing_failed(9),
            Stage::OffAgain | Stage::Off if over && operated => return self.homing_failed(8),
            Stage::OffAgain if over => Some(Stage::Locate),
            Stage::Off if over => {
                let travel = self.settings.axes(130)[number];
                let place = if negative {
                    pull_off - travel
                } else {
                    -pull_off
                };
                self.position[number] = (place * scale).round() as i64;
                self.miscounted[number] = 0;
                homing.axes.pop_front();
                Some(Stage::Seek)
            }
            _ => None,
        };
        if let Some(stage) = next {
            homing.stage = stage;
            homing.way = 0.0;
            homing.made = 0;
        }
        self.homing = Some(homing);
    }

    fn homed(&mut self) {
        self.state = State::Idle;
        self.limits_were = self.limits();
        self.modal.position = self.millimetres();
        self.answer(Ok(()));
    }

    /// The firmware restarts itself.
    fn homing_failed(&mut self, number: u8) {
        self.state = State::Alarm;
        self.say(&format!("ALARM:{number}\r\n"));
        self.start_firmware();
    }
}
