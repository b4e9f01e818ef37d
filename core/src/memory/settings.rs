//! The rows of the setting page (manual III-2.5.1).

use serde::{Deserialize, Serialize};

/// A row of the setting page of the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum SettingRow {
    /// 奇偶校检 (parity check): stored, without effect on this control.
    Parity,
    /// ISO 代码: whether programs are transferred in ISO code.
    Iso,
    /// 英制编程: whether programs are in inches.
    Inch,
    /// 自动序号: whether the editor numbers blocks while they are typed.
    Numbering,
}

/// The values of the setting page and the option of macro B, kept over power-off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ControlSettings {
    /// 奇偶校检 (parity check): stored, without effect on this control.
    pub parity: bool,
    /// ISO 代码: whether programs are transferred in ISO code; otherwise in EIA code.
    pub iso: bool,
    /// 英制编程: whether programs are in inches; otherwise in mm.
    pub inch: bool,
    /// 自动序号: whether the editor numbers blocks while they are typed.
    pub numbering: bool,
    /// Option of macro B: whether programs may use formulas, jumps, loops and calls with
    /// arguments. No row of the page shows this option.
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
    /// Whether the setting of a row of the page is on.
    pub const fn get(&self, setting: SettingRow) -> bool {
        match setting {
            SettingRow::Parity => self.parity,
            SettingRow::Iso => self.iso,
            SettingRow::Inch => self.inch,
            SettingRow::Numbering => self.numbering,
        }
    }

    /// Switches the setting of a row of the page on or off.
    pub const fn set(&mut self, setting: SettingRow, on: bool) {
        match setting {
            SettingRow::Parity => self.parity = on,
            SettingRow::Iso => self.iso = on,
            SettingRow::Inch => self.inch = on,
            SettingRow::Numbering => self.numbering = on,
        }
    }
}
