//! The rows of the setting page (manual III-2.5.1).

use serde::{Deserialize, Serialize};

/// A row of the setting page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingRow {
    /// 奇偶校检: stored, without effect on this control.
    Parity,
    /// ISO 代码: character code of program transfer.
    Iso,
    /// 英制编程: programs are in inches.
    Inch,
    /// 自动序号: the editor numbers blocks while they are typed.
    Numbering,
}

/// The settings, kept over power-off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ControlSettings {
    /// 奇偶校检 (parity check): without effect on this control.
    pub parity: bool,
    /// ISO 代码: programs are transferred in ISO code, otherwise in EIA.
    pub iso: bool,
    /// 英制编程: programs are in inches, otherwise in mm.
    pub inch: bool,
    /// 自动序号: the editor numbers blocks while they are typed.
    pub numbering: bool,
    /// Option of macro B: programs may use formulas, jumps, loops and calls with arguments.
    /// No row of the page shows it.
    #[serde(skip_serializing_if = "is_off")]
    pub macro_b: bool,
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    reason = "the form that serde asks for"
)]
const fn is_off(option: &bool) -> bool {
    !*option
}

impl Default for ControlSettings {
    fn default() -> Self {
        Self {
            parity: false,
            iso: true,
            inch: false,
            numbering: false,
            macro_b: false,
        }
    }
}

impl ControlSettings {
    /// Whether a row is on.
    pub const fn get(&self, setting: SettingRow) -> bool {
        match setting {
            SettingRow::Parity => self.parity,
            SettingRow::Iso => self.iso,
            SettingRow::Inch => self.inch,
            SettingRow::Numbering => self.numbering,
        }
    }

    /// Switches a row on or off.
    pub const fn set(&mut self, setting: SettingRow, on: bool) {
        match setting {
            SettingRow::Parity => self.parity = on,
            SettingRow::Iso => self.iso = on,
            SettingRow::Inch => self.inch = on,
            SettingRow::Numbering => self.numbering = on,
        }
    }
}
