//! The simulated tool post: TL+ turns it, TL- seats and clamps it (manual II-2.8.2).
//!
//! ```text
//!  TL+   ▁▁▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔▁▁▁▁▁▁▁▁▁▁▁▁▁
//!  T02   ▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▔▔▔▔▔▔▔▔▔▔▔▔▔▔▔   0.92…1.08 of a pitch
//!  TL-   ▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▔▔▔▔▔▔▔▔▔▔▁▁▁
//!  *TCP  ▔▔▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▁▔▔▔▔▔▔▔▔▔   clamped
//! ```

use serde::{Deserialize, Serialize};

use super::config::TurretConfig;

/// A simulated tool post that turns in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct TurretDrive {
    stations: u8,
    /// Position, ms of turning; station n (from 1) is at (n - 1) · `pitch`.
    #[serde(rename = "place")]
    position_ms: u32,
    pitch: u32,
    /// Half the width in which a station switch is active, ms of turning.
    window: u32,
    clamp_ms: u32,
    /// Time for which TL- has been on, ms; at most the clamping time.
    pressed: u32,
    clamped: bool,
    /// Whether the post is jammed by a fault.
    pub blocked: bool,
}

impl TurretDrive {
    pub fn new(config: &TurretConfig, stations: u8) -> Self {
        let pitch = config.station_ms.clamp(1, 100_000);
        let first = u32::from(config.first.clamp(1, stations.max(1)) - 1);
        let window = (f64::from(pitch) * config.window.clamp(0.0, 0.49)).round();
        Self {
            stations,
            position_ms: first * pitch,
            pitch,
            window: window as u32,
            clamp_ms: config.clamp_ms,
            pressed: config.clamp_ms,
            clamped: true,
            blocked: false,
        }
    }

    /// The station whose switch is active, from 1; `None` between stations.
    pub fn station(&self) -> Option<u8> {
        if self.stations == 0 {
            return None;
        }
        let nearest = (self.position_ms + self.pitch / 2) / self.pitch;
        let distance = self.position_ms.abs_diff(nearest * self.pitch);
        let stations = u32::from(self.stations);
        // The first station follows the last one; a division is necessary only there.
        let station = if nearest < stations {
            nearest
        } else {
            nearest % stations
        };
        (distance <= self.window).then_some(station as u8 + 1)
    }

    /// Whether the tool post is clamped.
    pub const fn is_clamped(&self) -> bool {
        self.clamped
    }

    /// Advances by one tick (1 ms) with the outputs TL+ and TL-.
    pub fn tick(&mut self, forward: bool, reverse: bool) {
        if self.stations == 0 || forward == reverse {
            return;
        }
        if forward {
            self.clamped = false;
            self.pressed = 0;
            if !self.blocked {
                self.position_ms = (self.position_ms + 1) % (self.pitch * u32::from(self.stations));
            }
            return;
        }
        // TL- drives the post against the pawl of the station that it has reached.
        let seat = (self.position_ms + self.window) / self.pitch * self.pitch;
        if self.position_ms != seat && !self.blocked {
            self.position_ms = if self.position_ms < seat {
                self.position_ms + 1
            } else {
                self.position_ms - 1
            };
        }
        self.pressed = (self.pressed + 1).min(self.clamp_ms);
        self.clamped = self.position_ms == seat && self.pressed >= self.clamp_ms;
    }
}
