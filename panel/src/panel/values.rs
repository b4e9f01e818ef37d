//! Handles values typed on the data pages, and pages whose keys act immediately (manual
//! III-2.3, III-2.5, III-2.6, III-2.7).

use gsk_core::cnc::{Cnc, ControlRequest, OffsetEntry};
use gsk_core::memory::{ElectronicDisk, SettingRow, Variables};
use gsk_core::operation::{OperatingMode, SoftSwitch};
use gsk_core::units::{Axis, parse_finite};

use super::Panel;
use crate::pages::{self, Hint, PageId};

/// Number of binary digits of a state parameter.
const BITS: usize = 8;
/// Greatest number of digits in a row of the password page.
const PASSWORD_LENGTH: usize = 8;
/// Diagnosis number that shows the number of the current tool.
const TOOL: usize = 75;
/// The rows of the setting page, in the order of the cursor.
const SETTINGS: [SettingRow; 4] = [
    SettingRow::Parity,
    SettingRow::Iso,
    SettingRow::Inch,
    SettingRow::Numbering,
];
const DISKS: [ElectronicDisk; 5] = [
    ElectronicDisk::N0,
    ElectronicDisk::N1,
    ElectronicDisk::N2,
    ElectronicDisk::N3,
    ElectronicDisk::N4,
];

impl Panel {
    /// Handles 输入 on a data page: requests the input line as the value of the item at the
    /// cursor. Returns `false` if the line cannot be a value there. It may then be a search.
    pub(super) fn commit_value(&self, cnc: &Cnc, requests: &mut Vec<ControlRequest>) -> bool {
        let input = self.view.input.trim();
        let cursor = self.view.cursors.get(self.page);
        if input.starts_with('P') && self.page != PageId::Mdi {
            return false;
        }
        let request = match self.page {
            PageId::Oft => offset_entry(input).map(|entry| ControlRequest::SetOffset {
                number: cursor.item.min(usize::from(u8::MAX)) as u8,
                entry,
            }),
            PageId::Macro if cnc.are_variables_real() => {
                let numbers = cnc.variable_numbers();
                let variable = numbers.get(cursor.item).copied();
                variable.zip(number(input)).map(|(number, value)| {
                    ControlRequest::SetMacroVariable {
                        number,
                        value: Some(value),
                    }
                })
            }
            PageId::Macro => Variables::numbers()
                .nth(cursor.item)
                .zip(input.parse().ok())
                .map(|(number, value)| ControlRequest::SetVariable { number, value }),
            PageId::SetCode => SETTINGS
                .get(cursor.item)
                .zip(digit(input))
                .map(|(setting, on)| ControlRequest::SetSetting(*setting, on)),
            PageId::ParBit => pages::state_numbers().nth(cursor.item).and_then(|number| {
                if cursor.bit_entry {
                    let bit = cursor.bit;
                    digit(input).map(|on| ControlRequest::SetParameterBit { number, bit, on })
                } else {
                    word(input).map(|value| ControlRequest::SetParameter { number, value })
                }
            }),
            PageId::ParData => pages::data_numbers()
                .nth(cursor.item)
                .zip(whole(input))
                .map(|(number, value)| ControlRequest::SetParameter { number, value }),
            PageId::Pitch => pitch_entry(input, cursor.item),
            PageId::ParModel => {
                let numbers = pages::model_parameter_numbers(cnc);
                let chosen = numbers.get(cursor.item).copied().zip(whole(input));
                chosen.map(|(number, value)| ControlRequest::SetModelParameter { number, value })
            }
            PageId::Coordinates => coordinate_entry(input, cnc),
            PageId::Dgn if cursor.item == TOOL => tool(input).map(ControlRequest::SetTool),
            PageId::PlcValues => {
                let address = pages::value_item(cursor.item);
                whole(input).map(|value| ControlRequest::SetPreset(address, value))
            }
            PageId::Mdi if cnc.mode() == OperatingMode::Mdi => {
                Some(ControlRequest::AddMdiWord(input.to_owned()))
            }
            _ => return false,
        };
        requests.extend(request);
        true
    }

    /// Handles a character that acts immediately on the page. Returns `false` if the page has
    /// no such characters.
    pub(super) fn command_character(
        &mut self,
        character: char,
        cnc: &Cnc,
        requests: &mut Vec<ControlRequest>,
    ) -> bool {
        match self.page {
            PageId::SetSwitch => {
                let on = match character {
                    'D' | 'U' => true,
                    'W' => false,
                    _ => return true,
                };
                requests.push(if self.view.cursors.get(PageId::SetSwitch).item == 0 {
                    ControlRequest::SetParameterSwitch(on)
                } else {
                    ControlRequest::SetProgramSwitch(on)
                });
            }
            PageId::Edisk => self.disk_command(character, cnc, requests),
            PageId::Softpanel => {
                let key = character.to_digit(10).and_then(|key| key.checked_sub(1));
                let switch = key.and_then(|key| SoftSwitch::ALL.get(key as usize));
                requests.extend(switch.copied().map(ControlRequest::ToggleSoftSwitch));
            }
            PageId::Password => self.password_digit(character),
            PageId::Reset => self.reset_command(character, cnc, requests),
            _ => return false,
        }
        true
    }

    /// Handles a digit of the disk page: 0 to 4 read that disk, 5 to 8 save to disk 1 to 4.
    fn disk_command(&mut self, character: char, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        let Some(key) = character.to_digit(10) else {
            return;
        };
        let disk = |number: u32| DISKS.get(number as usize).copied();
        let request = if key <= 4 {
            disk(key).map(ControlRequest::LoadDisk)
        } else {
            disk(key - 4).map(ControlRequest::SaveDisk)
        };
        let Some(request) = request else {
            return;
        };
        let done = cnc.rights().check_disks().is_ok();
        self.view.disk_done = Some(done);
        if done {
            requests.push(request);
        }
    }

    /// Handles a digit of the reset page: 1 deletes the programs, 2 restores delivered
    /// parameters, 3 makes the current point the work zero.
    fn reset_command(&mut self, character: char, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        let rights = cnc.rights();
        let done = match character {
            '1' => {
                requests.push(ControlRequest::DeleteAllPrograms);
                rights.check_program_edit(0).is_ok()
            }
            '2' => {
                requests.push(ControlRequest::LoadDisk(ElectronicDisk::N0));
                rights.check_disks().is_ok()
            }
            '3' => {
                requests
                    .extend([Axis::X, Axis::Z].map(|it| ControlRequest::SetCoordinate(it, 0.0)));
                rights.check_offsets().is_ok() && !cnc.is_moving()
            }
            _ => return,
        };
        self.view.disk_done = Some(done);
    }

    fn password_row(&mut self) -> Option<&mut String> {
        let row = self
            .view
            .cursors
            .get(PageId::Password)
            .item
            .checked_sub(1)?;
        self.view.password.rows.get_mut(row)
    }

    fn password_digit(&mut self, character: char) {
        self.view.password.hint = Hint::None;
        if !character.is_ascii_digit() {
            return;
        }
        if let Some(row) = self.password_row()
            && row.len() < PASSWORD_LENGTH
        {
            row.push(character);
        }
    }

    /// Deletes the last digit of the password row at the cursor (取消).
    pub(super) fn password_cancel(&mut self) {
        if let Some(row) = self.password_row() {
            row.pop();
        }
    }

    /// Handles 输入 on the password page: enters, changes or leaves the level (manual
    /// III-2.5.1.4).
    pub(super) fn password_input(&mut self, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        if cnc.rights().check_password().is_err() {
            return;
        }
        let entry = &mut self.view.password;
        if self.view.cursors.get(PageId::Password).item == 0 {
            requests.push(ControlRequest::LowerLevel);
            entry.clear();
            entry.hint = Hint::LevelLeft;
            return;
        }
        let [old, new, again] = &mut entry.rows;
        let known = cnc.authority().level_for(old).is_some();
        if new.is_empty() && again.is_empty() {
            entry.hint = if known {
                requests.push(ControlRequest::EnterPassword(old.clone()));
                Hint::LevelEntered
            } else {
                Hint::Wrong
            };
            old.clear();
            return;
        }
        if new != again || new.len() != old.len() {
            new.clear();
            again.clear();
            entry.hint = Hint::Different;
            return;
        }
        let hint = if known {
            requests.push(ControlRequest::ChangePassword {
                old: core::mem::take(old),
                new: core::mem::take(new),
            });
            Hint::Changed
        } else {
            Hint::Wrong
        };
        entry.clear();
        entry.hint = hint;
    }
}

/// Parses an entry of the offset page: a letter with a number, or U or W alone. `None` if
/// invalid.
fn offset_entry(input: &str) -> Option<OffsetEntry> {
    let letter = input.chars().next()?;
    let value = input.get(1..)?.trim();
    let number = || number(value);
    Some(match letter {
        'X' => OffsetEntry::Length(Axis::X, number()?),
        'Z' => OffsetEntry::Length(Axis::Z, number()?),
        'U' if value.is_empty() => OffsetEntry::RelativeCoordinate(Axis::X),
        'W' if value.is_empty() => OffsetEntry::RelativeCoordinate(Axis::Z),
        'U' => OffsetEntry::Change(Axis::X, number()?),
        'W' => OffsetEntry::Change(Axis::Z, number()?),
        'R' => OffsetEntry::NoseRadius(number()?),
        'T' => OffsetEntry::NoseNumber(value.parse().ok()?),
        _ => return None,
    })
}

/// Parses a coordinate that the tool gets: X or Z with a number in the unit of the display.
/// `None` if invalid.
fn coordinate_entry(input: &str, cnc: &Cnc) -> Option<ControlRequest> {
    let axis = match input.chars().next()? {
        'X' => Axis::X,
        'Z' => Axis::Z,
        _ => return None,
    };
    let display = pages::CoordinateFormat::of(cnc);
    let value = display.to_mm(axis, number(input.get(1..)?.trim())?);
    Some(ControlRequest::SetCoordinate(axis, value))
}

/// Parses an entry for a point of the pitch error table: X or Z with a number. `None` if
/// invalid.
fn pitch_entry(input: &str, point: usize) -> Option<ControlRequest> {
    let axis = match input.chars().next()? {
        'X' => Axis::X,
        'Z' => Axis::Z,
        _ => return None,
    };
    let value = whole(input.get(1..)?.trim())?;
    Some(ControlRequest::SetPitch {
        axis,
        point: u8::try_from(point).ok()?,
        // A value beyond i16 is as much out of range as the greatest.
        value: i16::try_from(value).unwrap_or(i16::MAX),
    })
}

/// Parses a decimal number: digits, one point, a minus sign in front. `None` if invalid.
fn number(text: &str) -> Option<f64> {
    let digits = text.strip_prefix('-').unwrap_or(text);
    let plain = digits
        .bytes()
        .all(|byte| byte.is_ascii_digit() || byte == b'.');
    let some = digits.bytes().any(|byte| byte.is_ascii_digit());
    if plain && some {
        parse_finite(text)
    } else {
        None
    }
}

/// Parses an integer; `None` if invalid. A value that no parameter can hold becomes the
/// greatest or least.
fn whole(text: &str) -> Option<i32> {
    let digits = text.strip_prefix('-').unwrap_or(text);
    if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let limit = if digits.len() < text.len() {
        i32::MIN
    } else {
        i32::MAX
    };
    Some(text.parse().unwrap_or(limit))
}

/// Parses the value of a state parameter, binary digits without the leading zeros; `None` if
/// it is no integer. More or other digits give a number beyond a byte.
fn word(text: &str) -> Option<i32> {
    let number = whole(text)?;
    let binary = text.bytes().all(|byte| matches!(byte, b'0' | b'1'));
    if binary && text.len() <= BITS {
        return i32::from_str_radix(text, 2).ok();
    }
    Some(number.saturating_abs().max(1 << BITS))
}

fn digit(text: &str) -> Option<bool> {
    match text {
        "0" => Some(false),
        "1" => Some(true),
        _ => None,
    }
}

/// Parses a tool number, or the eight binary digits that the page shows. `None` if invalid.
fn tool(text: &str) -> Option<u8> {
    if text.len() == BITS {
        return u8::from_str_radix(text, 2).ok();
    }
    whole(text).map(|value| u8::try_from(value).unwrap_or(u8::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_of_the_offset_page() {
        assert_eq!(
            offset_entry("U"),
            Some(OffsetEntry::RelativeCoordinate(Axis::X))
        );
        assert_eq!(
            offset_entry("X-134.2"),
            Some(OffsetEntry::Length(Axis::X, -134.2))
        );
        assert_eq!(offset_entry("W.5"), Some(OffsetEntry::Change(Axis::Z, 0.5)));
        assert_eq!(offset_entry("T3"), Some(OffsetEntry::NoseNumber(3)));
        for wrong in ["X", "R", "T", "T-1", "U1.2.3", "X1E5", "XINF", "5", ""] {
            assert_eq!(offset_entry(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn numbers_of_parameters() {
        assert_eq!(whole("-9999999"), Some(-9_999_999));
        assert_eq!(whole("99999999999"), Some(i32::MAX));
        assert_eq!(whole("-99999999999"), Some(i32::MIN));
        assert_eq!((whole("1.5"), whole("-"), whole("")), (None, None, None));
        assert_eq!(word("101"), Some(5));
        assert_eq!(word("11111111"), Some(255));
        assert_eq!(word("111111111"), Some(111_111_111));
        assert_eq!(word("2"), Some(256), "no byte holds it");
        assert_eq!((tool("12"), tool("00000010")), (Some(12), Some(2)));
        assert_eq!((digit("1"), digit("2")), (Some(true), None));
    }
}
