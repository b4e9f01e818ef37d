//! The input of all commissioning steps.

use egui::{Role, TextEdit, Ui, WidgetInfo};
use gsk_commission::{BacklashReading, DriveKind, SlideTravel, ZeroMethod};
use gsk_core::units::parse_finite;
use gsk_messages::{Language, Message, say};

/// Width of a field, points.
const WIDTH: f32 = 90.0;

/// The texts and choices of all steps.
#[derive(Clone, Debug)]
pub struct Fields {
    /// Gear: whether it is computed from a measured move, else from the data plates.
    pub measured_gear: bool,
    /// Gear from the plates: pulses per turn, lead of the screw, teeth of screw and motor.
    pub plates: [String; 4],
    /// Gear from a move: commanded and measured distance.
    pub moved: [String; 2],
    /// The kind of the drives.
    pub kind: DriveKind,
    /// Following error: measured and allowed.
    pub lag: [String; 2],
    /// How the machine zero is found.
    pub method: ZeroMethod,
    /// Spindle: gear, speed, voltage.
    pub spindle: [String; 3],
    /// Backlash: a pair of readings per line.
    pub readings: String,
    /// Pitch: the interval of the points.
    pub interval: String,
    /// Pitch: whether the table was empty during the measurement.
    pub clear: bool,
    /// Pitch: whether the X targets are diameters.
    pub diameters: bool,
}

impl Default for Fields {
    fn default() -> Self {
        let own = |words: &str| words.to_owned();
        Self {
            measured_gear: true,
            plates: [own("10000"), own("5"), own("1"), own("1")],
            moved: [own("-100"), String::new()],
            kind: DriveKind::Servo,
            lag: [String::new(), String::new()],
            method: ZeroMethod::SwitchAndSignal,
            spindle: [own("1"), String::new(), String::new()],
            readings: String::new(),
            interval: String::new(),
            clear: false,
            diameters: false,
        }
    }
}

/// Parses a number with a decimal point or comma.
pub fn number(text: &str) -> Result<f64, Message> {
    parse_finite(&text.trim().replace(',', ".")).ok_or_else(say::commission_numbers)
}

/// Parses a number that may be missing.
pub fn optional(text: &str) -> Result<Option<f64>, Message> {
    match text.trim().is_empty() {
        true => Ok(None),
        false => number(text).map(Some),
    }
}

/// Parses pairs of readings, one per line.
pub fn readings(text: &str) -> Result<Vec<BacklashReading>, Message> {
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    lines
        .map(|line| {
            let mut words = line.split_whitespace();
            let (Some(a), Some(b), None) = (words.next(), words.next(), words.next()) else {
                return Err(say::commission_numbers());
            };
            Ok(BacklashReading {
                a: SlideTravel(number(a)?),
                b: SlideTravel(number(b)?),
            })
        })
        .collect()
}

/// Draws rows of a field and its name.
pub fn rows(ui: &mut Ui, language: Language, rows: &mut [(Message, &mut String)]) {
    for (name, text) in rows {
        ui.horizontal(|ui| {
            let name = name.text(language);
            let field = ui.add(TextEdit::singleline(*text).desired_width(WIDTH));
            field.widget_info(|| WidgetInfo {
                current_text_value: Some(text.clone()),
                ..WidgetInfo::labeled(Role::TextInput, true, &name)
            });
            ui.label(name.as_str());
        });
    }
}
