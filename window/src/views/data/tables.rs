//! Draws tool offsets, pitch errors and macro variables as tables of fields.

use egui::{ScrollArea, Ui, vec2};
use gsk_core::units::Axis;
use gsk_messages::{Language, say};

use super::data_values::DataValues;
use super::edit::{DataField, Drafts, ToolOffsetField};
use super::value_field;
use crate::focus;

/// Width of the column with the numbers, points.
const NUMBER_WIDTH: f32 = 44.0;
/// Minimum and maximum width of a column of values, points.
const COLUMN_WIDTH_RANGE: [f32; 2] = [52.0, 110.0];
/// Width of the column of tool nose numbers, points: one digit.
const NOSE_WIDTH: f32 = 44.0;
/// Width of a pitch error, and width of the coordinate beside it, points.
const PITCH_WIDTHS: [f32; 2] = [52.0, 84.0];
/// Width of the field of a variable, points.
const VARIABLE_WIDTH: f32 = 180.0;
/// Width of the scroll bar of the list, points.
const SCROLL_BAR_WIDTH: f32 = 14.0;

/// Draws the table of tool offsets.
pub fn show_offsets(
    ui: &mut Ui,
    language: Language,
    machine: &DataValues<'_>,
    drafts: &mut Drafts,
) {
    ui.heading(say::data_offsets().text(language));
    ui.weak(say::data_offsets_hint().text(language));
    ui.weak(say::data_add().text(language));
    let gaps = ui.spacing().item_spacing.x * 4.0 + SCROLL_BAR_WIDTH;
    let column = (ui.available_width() - NUMBER_WIDTH - NOSE_WIDTH - gaps) / 3.0;
    let column = column.clamp(COLUMN_WIDTH_RANGE[0], COLUMN_WIDTH_RANGE[1]);
    let width = |part: ToolOffsetField| match part {
        ToolOffsetField::T => NOSE_WIDTH,
        ToolOffsetField::X | ToolOffsetField::Z | ToolOffsetField::R => column,
    };
    let height = ui.spacing().interact_size.y;
    ui.horizontal(|ui| {
        show_cell(
            ui,
            NUMBER_WIDTH,
            height,
            &say::data_column_number().text(language),
        );
        for part in ToolOffsetField::ALL {
            show_cell(ui, width(part), height, part.letter());
        }
    });
    let count = machine.offsets.rows.iter().count();
    ScrollArea::vertical()
        .id_salt("offsets")
        .auto_shrink([false, false])
        .show_rows(ui, height, count, |ui, shown| {
            let rows = machine.offsets.rows.iter();
            for (number, _) in rows.skip(shown.start).take(shown.len()) {
                ui.horizontal(|ui| {
                    show_cell(ui, NUMBER_WIDTH, height, &format!("{number:03}"));
                    let is_fixed = number == 0 && !machine.parameters.has_work_shift();
                    ui.add_enabled_ui(!is_fixed, |ui| {
                        for part in ToolOffsetField::ALL {
                            let field = DataField::Offset(number, part);
                            let response = value_field::show(
                                ui,
                                language,
                                machine,
                                drafts,
                                field,
                                width(part),
                            );
                            if is_fixed {
                                let reason = say::data_offset_fixed().text(language);
                                response.on_disabled_hover_text(reason);
                            }
                        }
                    });
                });
            }
            focus::scroll_to_focus(ui);
        });
}

/// Draws the pitch errors (manual III-10). Beside each is the machine coordinate at which its
/// interval ends, mm of slide travel.
pub fn show_pitch(ui: &mut Ui, language: Language, machine: &DataValues<'_>, drafts: &mut Drafts) {
    ui.heading(say::data_pitch().text(language));
    ui.weak(say::data_pitch_hint().text(language));
    let height = ui.spacing().interact_size.y;
    let axes = [Axis::X, Axis::Z];
    ui.horizontal(|ui| {
        let number = say::data_column_number().text(language);
        show_cell(ui, NUMBER_WIDTH, height, &number);
        for letter in ["X", "Z"] {
            show_cell(ui, PITCH_WIDTHS[0], height, letter);
            show_cell(ui, PITCH_WIDTHS[1], height, "mm");
        }
    });
    let points = usize::from(u8::MAX) + 1;
    ScrollArea::vertical()
        .id_salt("pitch errors")
        .auto_shrink([false, false])
        .show_rows(ui, height, points, |ui, shown| {
            for point in (0..=u8::MAX).skip(shown.start).take(shown.len()) {
                ui.horizontal(|ui| {
                    show_cell(ui, NUMBER_WIDTH, height, &format!("{point:03}"));
                    for axis in axes {
                        let field = DataField::pitch(axis, point);
                        value_field::show(ui, language, machine, drafts, field, PITCH_WIDTHS[0]);
                        show_cell(
                            ui,
                            PITCH_WIDTHS[1],
                            height,
                            &interval_end_text(axis, point, machine),
                        );
                    }
                });
            }
            focus::scroll_to_focus(ui);
        });
}

/// Formats the coordinate at which the interval of a point ends, mm from machine zero. Empty
/// without compensation, and for point 0, which ends no interval (manual III-10).
fn interval_end_text(axis: Axis, point: u8, machine: &DataValues<'_>) -> String {
    let parameters = machine.parameters;
    let interval = gsk_commission::pitch_interval(axis, parameters);
    let Some(interval) = interval.filter(|_| point > 0) else {
        return String::new();
    };
    let origin = i64::from(parameters.pitch_origin(axis));
    let steps = match i64::from(point) - origin {
        plus @ 1.. => plus,
        minus => minus - 1,
    };
    format!("{:.3}", steps as f64 * interval.0)
}

/// Draws the table of macro variables.
pub fn show_variables(
    ui: &mut Ui,
    language: Language,
    machine: &DataValues<'_>,
    drafts: &mut Drafts,
) {
    ui.heading(say::data_variables().text(language));
    ui.weak(say::data_variables_hint().text(language));
    let height = ui.spacing().interact_size.y;
    let rows = &machine.variables.rows;
    ScrollArea::vertical()
        .id_salt("variables")
        .auto_shrink([false, false])
        .show_rows(ui, height, rows.len(), |ui, shown| {
            for (number, _) in rows.get(shown).unwrap_or_default() {
                ui.horizontal(|ui| {
                    show_cell(ui, NUMBER_WIDTH, height, &format!("#{number}"));
                    let field = DataField::Variable(*number);
                    value_field::show(ui, language, machine, drafts, field, VARIABLE_WIDTH);
                });
            }
            focus::scroll_to_focus(ui);
        });
}

/// Draws a text in a table cell of `width` by `height` points.
fn show_cell(ui: &mut Ui, width: f32, height: f32, text: &str) {
    let layout = egui::Layout::left_to_right(egui::Align::Center);
    ui.allocate_ui_with_layout(vec2(width, height), layout, |ui| {
        ui.set_min_width(width);
        ui.monospace(text);
    });
}
