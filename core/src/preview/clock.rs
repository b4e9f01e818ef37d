//! Machine time of a preview: motion, M, S, T and dwell.

use crate::command::SpindleCommand;
use crate::memory::parameter;
use crate::setup::Setup;

/// The machine time of a preview, including functions that run in parallel with motion.
pub(super) struct PreviewClock {
    now_s: f64,
    /// Time at which the M function that runs in parallel with motion is finished, s.
    busy_until: f64,
    m_function_s: f64,
    s_function_s: f64,
    /// Duration of a change to gear 1 or 2, and to gear 3 or 4, s.
    gear_change_s: [f64; 2],
    turret: TurretTimes,
}

/// The turret: its station and the durations of a tool change, s.
struct TurretTimes {
    stations: u8,
    station: u8,
    station_s: f64,
    clamp_s: f64,
}

impl PreviewClock {
    pub(super) fn new(setup: &Setup) -> Self {
        let seconds = |number| f64::from(setup.memory.parameters.timer_ms(number)) / 1000.0;
        // 065 and 066, and the travel of a gear whose switch is monitored (AGIN).
        let shift = |travel_ms: u32| {
            let travel = f64::from(travel_ms) / 1000.0;
            (seconds(parameter::GEAR_TIME_1) + travel + seconds(parameter::GEAR_TIME_2))
                .max(seconds(parameter::M_TIME))
        };
        let checked =
            setup.memory.parameters.watches_gear() && !setup.memory.parameters.watches_chuck();
        let travel_ms = setup.lathe.chuck.travel_ms;
        Self {
            gear_change_s: [shift(if checked { travel_ms } else { 0 }), shift(0)],
            now_s: 0.0,
            busy_until: 0.0,
            m_function_s: seconds(parameter::M_TIME),
            s_function_s: seconds(parameter::S_TIME),
            turret: TurretTimes {
                stations: setup.memory.parameters.station_count(),
                station: setup.memory.parameters.tool_in_position().max(1),
                station_s: f64::from(setup.lathe.turret.station_ms) / 1000.0,
                clamp_s: f64::from(setup.lathe.turret.clamp_ms) / 1000.0
                    + seconds(parameter::CLAMP_DELAY)
                    + seconds(parameter::CLAMP_TIME),
            },
        }
    }

    /// Time since the start of the program, s.
    pub(super) const fn now(&self) -> f64 {
        self.now_s
    }

    pub(super) const fn advance(&mut self, seconds: f64) {
        self.now_s += seconds;
    }

    /// Starts an M function. It takes the time of parameter 080, in parallel with the rest of
    /// its block.
    pub(super) const fn start_m_function(&mut self) {
        self.busy_until = self.now_s + self.m_function_s;
    }

    /// Advances the clock by a change to `gear` (1 to 4); motion waits meanwhile.
    pub(super) fn change_gear(&mut self, gear: u8) {
        self.now_s += self.gear_change_s[usize::from(gear > 2)];
    }

    /// The duration of an M function, parameter 080, s.
    pub(super) const fn m_function_s(&self) -> f64 {
        self.m_function_s
    }

    /// Advances the clock by the time of a stepped speed, parameter 081. Motion does not wait
    /// for an analog spindle.
    pub(super) const fn add_speed_time(&mut self, command: &SpindleCommand) {
        if let SpindleCommand::Step(_) = command {
            self.now_s += self.s_function_s;
        }
    }

    /// Advances the clock by a change to the tool `tool`: the turret turns forward station by
    /// station, then clamps.
    pub(super) fn change_tool(&mut self, tool: u8) {
        let turret = &mut self.turret;
        if turret.stations == 0 || tool == turret.station || tool > turret.stations {
            return;
        }
        let ahead =
            (i32::from(tool) - i32::from(turret.station)).rem_euclid(i32::from(turret.stations));
        turret.station = tool;
        self.now_s += f64::from(ahead) * turret.station_s + turret.clamp_s;
        // M and T are completed by the same FIN.
        self.now_s = self.now_s.max(self.busy_until);
    }

    /// Ends a block: advances the clock until the M function in parallel with motion is
    /// finished.
    pub(super) const fn end_block(&mut self) {
        self.now_s = self.now_s.max(self.busy_until);
    }
}
