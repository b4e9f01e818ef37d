//! The input of all commissioning steps.

use egui::{Role, TextEdit, Ui, WidgetInfo};
use gsk_commission::{BacklashReading, DriveKind, SlideTravel, ZeroMethod};
use gsk_core::units::parse_finite;
use gsk_messages::{Language, Message, say};

/// Width of an input field, points.
const FIELD_WIDTH: f32 = 90.0;

/// The texts and choices that the operator has entered in all steps.
#[derive(Clone, Debug)]
pub struct CommissionInputs {
    /// Gear step: true to compute the gear from a measured move, false from the data plates.
    pub is_gear_measured: bool,
    /// Gear step, from the data plates: pulses per turn, lead of the screw in mm, teeth of
    /// screw, teeth of motor.
    pub plate_texts: [String; 4],
    /// Gear step, from a move: commanded distance and measured distance, mm.
    pub move_texts: [String; 2],
    /// Following error step: the type of the drives.
    pub drive_kind: DriveKind,
    /// Following error step: measured and permitted following error, mm, as typed.
    pub following_error_texts: [String; 2],
    /// Machine zero step: the method by which the machine zero is found.
    pub zero_method: ZeroMethod,
    /// Spindle step: number of the gear, measured speed in r/min, voltage in V.
    pub spindle_texts: [String; 3],
    /// Backlash step: the readings as typed, one pair per line.
    pub backlash_text: String,
    /// Pitch error step: the interval between points, mm, as typed.
    pub pitch_interval_text: String,
    /// Pitch error step: whether the table was empty during the measurement.
    pub is_table_empty: bool,
    /// Pitch error step: whether the X target positions are diameters.
    pub are_targets_diameters: bool,
}

impl Default for CommissionInputs {
    fn default() -> Self {
        let text = |words: &str| words.to_owned();
        Self {
            is_gear_measured: true,
            plate_texts: [text("10000"), text("5"), text("1"), text("1")],
            move_texts: [text("-100"), String::new()],
            drive_kind: DriveKind::Servo,
            following_error_texts: [String::new(), String::new()],
            zero_method: ZeroMethod::SwitchAndSignal,
            spindle_texts: [text("1"), String::new(), String::new()],
            backlash_text: String::new(),
            pitch_interval_text: String::new(),
            is_table_empty: false,
            are_targets_diameters: false,
        }
    }
}

/// Parses a number with a decimal point or comma. Returns a message as error for another text.
pub fn parse_number(text: &str) -> Result<f64, Message> {
    parse_finite(&text.trim().replace(',', ".")).ok_or_else(say::commission_numbers)
}

/// Parses a number with a decimal point or comma; `None` if the text is empty. Returns a message as
/// error for another text.
pub fn parse_optional(text: &str) -> Result<Option<f64>, Message> {
    match text.trim().is_empty() {
        true => Ok(None),
        false => parse_number(text).map(Some),
    }
}

/// Parses pairs of readings, one pair per line. Returns a message as error for a wrong line.
pub fn parse_readings(text: &str) -> Result<Vec<BacklashReading>, Message> {
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    lines
        .map(|line| {
            let mut words = line.split_whitespace();
            let (Some(a), Some(b), None) = (words.next(), words.next(), words.next()) else {
                return Err(say::commission_numbers());
            };
            Ok(BacklashReading {
                a: SlideTravel(parse_number(a)?),
                b: SlideTravel(parse_number(b)?),
            })
        })
        .collect()
}

/// Draws rows that each consist of a name and its text field.
pub fn show_rows(ui: &mut Ui, language: Language, rows: &mut [(Message, &mut String)]) {
    for (name, text) in rows {
        ui.horizontal(|ui| {
            let name = name.text(language);
            let field = ui.add(TextEdit::singleline(*text).desired_width(FIELD_WIDTH));
            field.widget_info(|| WidgetInfo {
                current_text_value: Some(text.clone()),
                ..WidgetInfo::labeled(Role::TextInput, true, &name)
            });
            ui.label(name.as_str());
        });
    }
}
