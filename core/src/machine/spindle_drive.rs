//! The simulated inverter, spindle and encoder. The speed follows its command as a
//! first-order lag; the brake stops the spindle five times as fast.

use serde::{Deserialize, Serialize};

use super::config::SpindleConfig;
use super::wiring::MachineWiring;
use crate::memory::ControlParameters;
use crate::units::{TICK_S, floor_to_i64};

/// Speed differences below this count as zero, r/min.
const MIN_RPM: f64 = 0.01;

/// The simulated spindle with its drive and encoder.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SpindleDrive {
    analog: bool,
    top: [f64; 4],
    steps: [f64; 4],
    /// Fraction of the speed difference that disappears in a tick, when running and when
    /// braking.
    lag: f64,
    braking_lag: f64,
    /// Encoder counts per revolution of the encoder, and encoder revolutions per spindle
    /// revolution.
    #[serde(rename = "counts")]
    counts_per_turn: i64,
    encoder_ratio: f64,
    rpm: f64,
    /// Number of spindle revolutions since the start.
    turns: f64,
    /// Speed of a spindle that turns without M03 or M04, r/min; negative in reverse. `None` if it
    /// is at standstill without them.
    coasting: Option<f64>,
    /// Whether the spindle is jammed by a fault.
    pub blocked: bool,
    /// Whether the encoder sends no counts, because of a fault.
    pub encoder_lost: bool,
    encoder: i64,
    /// Whole encoder revolutions since the start, and encoder count at the last index
    /// pulse.
    #[serde(rename = "whole")]
    whole_turns: i64,
    index: i64,
    index_now: bool,
}

/// Outputs of the control and the ladder that drive the spindle in a tick.
pub(super) struct SpindleOutputs {
    pub forward: bool,
    pub reverse: bool,
    pub brake: bool,
    pub volts: f64,
    /// Speed step or gear whose output is on, from 1; `None` if none is on.
    pub step: Option<u8>,
    /// Gear that is engaged or being engaged, 1–4.
    pub gear: u8,
}

impl SpindleDrive {
    pub fn new(
        config: &SpindleConfig,
        wiring: &MachineWiring,
        parameters: &ControlParameters,
    ) -> Self {
        // Within 1 % after the settling time: time constant = settle / ln 100.
        let lag = |ms: f64| 1.0 - libm::exp(-libm::log(100.0) * 1000.0 * TICK_S / ms.max(1.0));
        let settle = f64::from(config.settle_ms);
        let lines = config
            .encoder_lines
            .map_or(f64::from(parameters.encoder_lines()), f64::from);
        Self {
            analog: wiring.analog,
            top: config
                .top
                .unwrap_or([1, 2, 3, 4].map(|gear| parameters.gear_top_speed(gear))),
            steps: config.steps,
            lag: lag(settle),
            braking_lag: lag(settle / 5.0),
            counts_per_turn: (4.0 * lines.max(0.0)) as i64,
            encoder_ratio: 1.0 / parameters.encoder_ratio(),
            rpm: 0.0,
            turns: 0.0,
            coasting: None,
            blocked: false,
            encoder_lost: false,
            encoder: 0,
            whole_turns: 0,
            index: 0,
            index_now: false,
        }
    }

    /// Selects the analog inverter or switched speeds, as wired.
    pub const fn set_wiring(&mut self, wiring: &MachineWiring) {
        self.analog = wiring.analog;
    }

    /// Lets the spindle turn at a speed (r/min, negative in reverse) until M03 or M04 takes
    /// over.
    pub const fn start_coasting(&mut self, rpm: f64) {
        self.coasting = Some(rpm);
        self.rpm = rpm;
    }

    /// Returns the spindle speed, r/min; negative in reverse.
    pub const fn rpm(&self) -> f64 {
        self.rpm
    }

    /// Spindle revolutions since the start; in reverse they decrease.
    pub const fn turns(&self) -> f64 {
        self.turns
    }

    /// Encoder count, encoder count at the last index pulse, and whether the pulse came in
    /// this tick.
    pub const fn encoder(&self) -> (i64, i64, bool) {
        (self.encoder, self.index, self.index_now)
    }

    fn target_rpm(&self, demand: &SpindleOutputs) -> f64 {
        let speed = if self.analog {
            let gear = usize::from(demand.gear.clamp(1, 4) - 1);
            demand.volts / 10.0 * self.top[gear]
        } else {
            demand
                .step
                .map_or(0.0, |step| self.steps[usize::from(step.clamp(1, 4) - 1)])
        };
        match (demand.forward, demand.reverse) {
            (true, false) => speed,
            (false, true) => -speed,
            _ => self.coasting.unwrap_or(0.0),
        }
    }

    /// Advances by one tick (1 ms) with the outputs that drive the spindle.
    pub fn tick(&mut self, demand: &SpindleOutputs) {
        if demand.forward || demand.reverse {
            self.coasting = None;
        }
        let target = if self.blocked || demand.brake {
            0.0
        } else {
            self.target_rpm(demand)
        };
        let lag = if demand.brake || self.blocked {
            self.braking_lag
        } else {
            self.lag
        };
        let missing = target - self.rpm;
        if missing != 0.0 {
            self.rpm += missing * lag;
        }
        if (self.rpm - target).abs() < MIN_RPM {
            self.rpm = target;
        }
        self.turns += self.rpm / 60.0 * TICK_S;
        self.index_now = false;
        if self.encoder_lost {
            return;
        }
        let turns = self.turns * self.encoder_ratio;
        let whole = floor_to_i64(turns);
        let crossed = self.whole_turns.max(whole);
        self.index_now = self.whole_turns != whole;
        if self.index_now {
            self.index = crossed * self.counts_per_turn;
        }
        self.whole_turns = whole;
        let fraction = turns - whole as f64;
        self.encoder =
            whole * self.counts_per_turn + (fraction * self.counts_per_turn as f64) as i64;
    }
}
