//! Status reports (`?`) and build information (`$I`).

use core::fmt::Write;

use super::{GrblState, GrblTwin, REPORTS_PER_OFFSET, Variant};

/// Formats the values of X, Y, Z as in a report, separated by commas.
pub(super) fn format_axes([x, y, z]: [f64; 3]) -> String {
    format!("{x:.3},{y:.3},{z:.3}")
}

impl GrblTwin {
    /// Returns the text of a status report, the answer to `?`.
    pub(super) fn status_report(&self) -> String {
        let state = match self.state {
            GrblState::Idle => "Idle",
            GrblState::Run if self.hold_pending => "Run:1",
            GrblState::Run => "Run",
            GrblState::Hold { complete: true } => "Hold:0",
            GrblState::Hold { complete: false } => "Hold:1",
            GrblState::Home => "Home",
            GrblState::Alarm | GrblState::Critical => "Alarm",
            GrblState::Check => "Check",
            GrblState::Starting => "Starting",
        };
        let fluid = self.variant == Variant::FluidNc;
        let [x, y, z] = self.position_mm();
        // FluidNC reports the work position if the machine position is not selected.
        let coordinate_letter = if fluid && !self.is_field_reported(0) {
            'W'
        } else {
            'M'
        };
        let mut text = format!("<{state}|{coordinate_letter}Pos:{x:.3},{y:.3},{z:.3}");
        // Writing to a `String` cannot fail.
        if self.is_field_reported(1) {
            let free = if fluid {
                self.reported_buffer_free()
            } else {
                self.variant.receive_buffer_bytes() - self.received.len()
            };
            let _ = write!(text, "|Bf:{},{free}", self.planner.free_blocks());
        }
        let moves = !matches!(self.state, GrblState::Alarm | GrblState::Critical);
        let feed = if moves || !fluid {
            self.planner.speed() * 60.0
        } else {
            0.0
        };
        let speed = if self.spindle_code == 5 {
            0.0
        } else {
            self.modal.speed
        };
        if self.is_field_reported(3) {
            let _ = write!(text, "|FS:{feed:.0},{speed:.0}");
            if self.has_spindle_sync() {
                let _ = write!(text, ",{:.0}", self.spindle().rpm().abs());
            }
        }
        let mut pins = if fluid {
            self.pin_letters()
        } else {
            String::new()
        };
        let [limit_x, limit_z] = self.limits();
        let emergency = self.variant.emergency_letter();
        for (operated, letter) in [
            (limit_x, 'X'),
            (limit_z, 'Z'),
            (self.pins.probe, 'P'),
            (self.pins.door, 'D'),
            (self.pins.emergency, emergency),
        ] {
            if operated && !fluid {
                pins.push(letter);
            }
        }
        if !pins.is_empty() && self.is_field_reported(4) {
            let _ = write!(text, "|Pn:{pins}");
        }
        match self.reports % REPORTS_PER_OFFSET {
            0 if self.is_field_reported(5) => {
                let _ = write!(text, "|WCO:{}", format_axes(self.work_offset));
            }
            1 if self.is_field_reported(6) => {
                text.push_str("|Ov:100,100,100");
                if fluid {
                    text.push_str(self.accessory_field());
                }
            }
            _ => {}
        }
        text.push_str(">\r\n");
        text
    }

    /// Returns the field `A` of the status report with the letters of the active outputs;
    /// empty if no output is on.
    const fn accessory_field(&self) -> &'static str {
        match (self.spindle_code, self.coolant) {
            (3, true) => "|A:SF",
            (3, false) => "|A:S",
            (4, true) => "|A:CF",
            (4, false) => "|A:C",
            (_, true) => "|A:F",
            (_, false) => "",
        }
    }

    /// Returns whether status reports contain the field with this bit number in `$10`. Boards
    /// other than grblHAL have bits for the first two fields and report all others.
    fn is_field_reported(&self, field: u32) -> bool {
        let all = self.variant != Variant::GrblHal && field > 1;
        all || self.settings.value(10) as u32 >> field & 1 == 1
    }

    /// Returns the build information, the answer to `$I` without its `ok`.
    pub(super) fn build_info(&self) -> String {
        match self.variant {
            Variant::Grbl => "[VER:1.1h.20190825:]\r\n[OPT:V,15,128]\r\n".into(),
            Variant::GrblHal => format!(
                "[VER:1.1f.20260815:]\r\n\
                 [OPT:VNMSL,100,1024,3,0]\r\n\
                 [AXS:3:XYZ]\r\n\
                 [NEWOPT:ENUMS,RT+,{}SED]\r\n\
                 [FIRMWARE:grblHAL]\r\n\
                 [DRIVER:Twin]\r\n",
                if self.has_spindle_sync() { "SS," } else { "" }
            ),
            Variant::FluidNc => format!(
                "[VER:4.0 FluidNC v4.0.4 (esp32-wifi) :]\r\n\
                 [OPT:PHS]\r\n\
                 [MSG:Machine: {}]\r\n\
                 [MSG:No radio]\r\n",
                self.config_item("name").unwrap_or_default()
            ),
        }
    }
}
