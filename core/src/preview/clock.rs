//! Machine time of a preview: motion, M, S, T and dwell.

use crate::command::SpindleCommand;
use crate::memory::parameter;
use crate::setup::Setup;

/// Time since the start of the program, with what runs beside the motion.
pub(super) struct Clock {
    now: f64,
    /// When the M function beside the motion of the block is finished.
    busy_until: f64,
    m_s: f64,
    s_s: f64,
    /// A gear change to gears 1 and 2, and to gears 3 and 4.
    gear_s: [f64; 2],
    turret: Turret,
}

/// How long tool changes take.
struct Turret {
    stations: u8,
    at: u8,
    station_s: f64,
    clamp_s: f64,
}

impl Clock {
    pub(super) fn new(setup: &Setup) -> Self {
        let seconds = |number| f64::from(setup.memory.parameters.timer_ms(number)) / 1000.0;
        // 065 and 066, and the way of a gear whose switch is looked at (AGIN).
        let shift = |travel_ms: u32| {
            let travel = f64::from(travel_ms) / 1000.0;
            (seconds(parameter::GEAR_TIME_1) + travel + seconds(parameter::GEAR_TIME_2))
                .max(seconds(parameter::M_TIME))
        };
        let checked =
            setup.memory.parameters.watches_gear() && !setup.memory.parameters.watches_chuck();
        let travel_ms = setup.lathe.chuck.travel_ms;
        Self {
            gear_s: [shift(if checked { travel_ms } else { 0 }), shift(0)],
            now: 0.0,
            busy_until: 0.0,
            m_s: seconds(parameter::M_TIME),
            s_s: seconds(parameter::S_TIME),
            turret: Turret {
                stations: setup.memory.parameters.stations(),
                at: setup.memory.parameters.tool_in_position().max(1),
                station_s: f64::from(setup.lathe.turret.station_ms) / 1000.0,
                clamp_s: f64::from(setup.lathe.turret.clamp_ms) / 1000.0
                    + seconds(parameter::CLAMP_DELAY)
                    + seconds(parameter::CLAMP_TIME),
            },
        }
    }

    /// Seconds since the start.
    pub(super) const fn now(&self) -> f64 {
        self.now
    }

    pub(super) const fn advance(&mut self, seconds: f64) {
        self.now += seconds;
    }

    /// An M function begins: its time 080 runs beside what follows it in its block.
    pub(super) const fn output_m(&mut self) {
        self.busy_until = self.now + self.m_s;
    }

    /// A gear change holds the motion.
    pub(super) fn change_gear(&mut self, gear: u8) {
        self.now += self.gear_s[usize::from(gear > 2)];
    }

    /// The time 080 of an M function, s.
    pub(super) const fn m_time(&self) -> f64 {
        self.m_s
    }

    /// The time 081 of a stepped speed; the analog spindle is not waited for.
    pub(super) const fn output_s(&mut self, command: &SpindleCommand) {
        if let SpindleCommand::Step(_) = command {
            self.now += self.s_s;
        }
    }

    /// The turret turns forward station by station, then clamps.
    pub(super) fn change_tool(&mut self, tool: u8) {
        let turret = &mut self.turret;
        if turret.stations == 0 || tool == turret.at || tool > turret.stations {
            return;
        }
        let ahead = (i32::from(tool) - i32::from(turret.at)).rem_euclid(i32::from(turret.stations));
        turret.at = tool;
        self.now += f64::from(ahead) * turret.station_s + turret.clamp_s;
        // One FIN answers M and T.
        self.now = self.now.max(self.busy_until);
    }

    /// What runs beside the motion must be finished too.
    pub(super) const fn block_end(&mut self) {
        self.now = self.now.max(self.busy_until);
    }
}
