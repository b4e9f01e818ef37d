//! Homing of Grbl and grblHAL: fast seek to the switch, pull-off, slow approach, pull-off.
//!
//! ```text
//!   $25 ──────────────────────►|switch     at most 1.5 times the travel ($130), or ALARM:9
//!               ◄── $27 ───────|           still operated: ALARM:8
//!        $24    ──────────────►|
//!               ◄── $27 ───────|           here the position is set
//! ```

use std::collections::VecDeque;

use super::{GrblState, GrblTwin, Variant};

/// Distance of the search for a switch as a multiple of the axis travel.
const SEEK_TRAVEL_FACTOR: f64 = 1.5;
/// Distance of the slow approach to a switch as a multiple of the pull-off.
const LOCATE_PULL_OFF_FACTOR: f64 = 5.0;

/// Indices of X and Z among the axes X, Y, Z of the board.
const AXES: [usize; 2] = [0, 2];

/// The stage of homing one axis: search, pull-off, slow approach.
#[derive(Clone, Copy, Debug, PartialEq)]
enum HomingStage {
    Seek,
    FirstPullOff,
    Locate,
    FinalPullOff,
}

/// The state of a homing that is in progress.
#[derive(Clone, Debug)]
pub(super) struct GrblHoming {
    /// Axes that are not homed yet, 0 for X and 1 for Z.
    axes: VecDeque<usize>,
    stage: HomingStage,
    /// Distance moved in this stage, mm.
    distance_mm: f64,
    pulses_made: i64,
}

impl GrblTwin {
    /// Returns whether the board accepts `$HX` and `$HZ`: bit 1 of `$22` of grblHAL.
    pub(super) fn can_home_single_axis(&self) -> bool {
        self.variant == Variant::GrblHal && self.settings.value(22) as u32 & 2 != 0
    }

    /// Starts homing the selected axes, Z first. Returns the error number, or `None` if the
    /// command is answered at the end.
    pub(super) fn begin_homing(&mut self, [x, z]: [bool; 2]) -> Option<Result<(), u8>> {
        if !self.settings.is_on(22) {
            return Some(Err(5));
        }
        if !matches!(self.state, GrblState::Idle | GrblState::Alarm) {
            return Some(Err(8));
        }
        let axes = [(z, 1), (x, 0)]
            .into_iter()
            .filter(|(selected, _)| *selected);
        self.homing = Some(GrblHoming {
            axes: axes.map(|(_, axis)| axis).collect(),
            stage: HomingStage::Seek,
            distance_mm: 0.0,
            pulses_made: 0,
        });
        self.state = GrblState::Home;
        None
    }

    /// Advances homing by a time step of `seconds`.
    pub(super) fn advance_homing(&mut self, seconds: f64) {
        let Some(mut homing) = self.homing.take() else {
            return;
        };
        let Some(&axis) = homing.axes.front() else {
            return self.finish_homing();
        };
        let number = AXES[axis];
        let scale = self.settings.axis_values(100)[number];
        let pull_off = self.settings.value(27);
        let negative = self.settings.value(23) as u32 >> number & 1 == 1;
        let (rate, limit, inwards) = match homing.stage {
            HomingStage::Seek => (
                25,
                SEEK_TRAVEL_FACTOR * self.settings.axis_values(130)[number],
                false,
            ),
            HomingStage::FirstPullOff => (25, pull_off, true),
            HomingStage::Locate => (24, LOCATE_PULL_OFF_FACTOR * pull_off, false),
            HomingStage::FinalPullOff => (24, pull_off, true),
        };
        homing.distance_mm =
            (homing.distance_mm + self.settings.value(rate) / 60.0 * seconds).min(limit);
        let due = (homing.distance_mm * scale) as i64;
        let pulses = due - homing.pulses_made;
        homing.pulses_made = due;
        let pulses = if negative == inwards { pulses } else { -pulses };
        self.pulses[number] += pulses;
        self.position[number] += pulses;
        let operated = self.limits()[axis];
        let finished = homing.distance_mm >= limit;
        let next = match homing.stage {
            HomingStage::Seek if operated => Some(HomingStage::FirstPullOff),
            HomingStage::Locate if operated => Some(HomingStage::FinalPullOff),
            HomingStage::Seek | HomingStage::Locate if finished => return self.fail_homing(9),
            HomingStage::FirstPullOff | HomingStage::FinalPullOff if finished && operated => {
                return self.fail_homing(8);
            }
            HomingStage::FirstPullOff if finished => Some(HomingStage::Locate),
            HomingStage::FinalPullOff if finished => {
                let travel = self.settings.axis_values(130)[number];
                let position_mm = if negative {
                    pull_off - travel
                } else {
                    -pull_off
                };
                self.position[number] = (position_mm * scale).round() as i64;
                self.position_error[number] = 0;
                homing.axes.pop_front();
                Some(HomingStage::Seek)
            }
            _ => None,
        };
        if let Some(stage) = next {
            homing.stage = stage;
            homing.distance_mm = 0.0;
            homing.pulses_made = 0;
        }
        self.homing = Some(homing);
    }

    fn finish_homing(&mut self) {
        self.state = GrblState::Idle;
        self.previous_limits = self.limits();
        self.modal.position = self.position_mm();
        self.send_answer(Ok(()));
    }

    /// Ends homing with the alarm `number` and restarts the firmware.
    fn fail_homing(&mut self, number: u8) {
        self.state = GrblState::Alarm;
        self.send_text(&format!("ALARM:{number}\r\n"));
        self.restart_firmware();
    }
}
