//! The parameter wizard (参数设置向导): the keep relays, data, timers and counters of a ladder with
//! their meanings, values and presets.

use std::sync::Arc;

use egui::{Button, Panel, RichText, TextEdit, Ui};
use gsk_core::cnc::ControlRequest;
use gsk_core::plc::address::ByteAddress;
use gsk_core::plc::{Area, Ladder, PlcAddress};
use gsk_host::kernel::monitor::MachineView;
use gsk_messages::{Language, say};
use gsk_runner::ladder::{LadderParameter, list_parameters};

use super::directive::LadderTable;
use super::draft::LadderDraft;
use super::tables::show_table;
use super::{LadderView, operand_value};
use crate::theme;

/// The selected parameter and the typed value.
#[derive(Debug, Default)]
pub struct ParameterWizard {
    selected: Option<PlcAddress>,
    value_entry: String,
    /// The parameters of a ladder in a language, kept until either changes.
    listed: Option<(Arc<Ladder>, Language, Arc<[LadderParameter]>)>,
}

impl ParameterWizard {
    fn parameters(&mut self, ladder: &Arc<Ladder>, language: Language) -> Arc<[LadderParameter]> {
        match &self.listed {
            Some((of, shown, list)) if Arc::ptr_eq(of, ladder) && *shown == language => {
                Arc::clone(list)
            }
            _ => {
                let list: Arc<[LadderParameter]> = list_parameters(ladder, language).into();
                self.listed = Some((Arc::clone(ladder), language, Arc::clone(&list)));
                list
            }
        }
    }
}

/// The address with which the control takes a preset; `None` if it takes none for this address.
const fn preset_address(address: PlcAddress) -> Option<ByteAddress> {
    let PlcAddress::Byte(byte) = address else {
        return None;
    };
    let area = match byte.area {
        Area::D => Area::D,
        Area::Dt => Area::T,
        Area::Dc => Area::C,
        _ => return None,
    };
    Some(ByteAddress::new(area, byte.byte))
}

/// Whether a blank memory can get a value for this address (`.INIT`).
const fn has_start_value(address: PlcAddress) -> bool {
    matches!(address, PlcAddress::Byte(byte) if !matches!(byte.area, Area::T))
}

/// Formats the current value of a parameter.
fn value_text(address: PlcAddress, machine: &MachineView) -> String {
    let memory = machine.plc.memory();
    match address {
        PlcAddress::Bit(bit) => u8::from(memory.bit(bit)).to_string(),
        PlcAddress::Byte(byte) => operand_value::format_value(byte, 1, memory),
    }
}

impl LadderView {
    pub(super) fn show_parameter_wizard(
        &mut self,
        ui: &mut Ui,
        language: Language,
        machine: &MachineView,
    ) {
        let ladder = self.drawn_ladder(machine);
        let parameters = self.wizard.parameters(&ladder, language);
        let selected = self.wizard.selected;
        let selected = parameters.iter().find(|it| Some(it.address) == selected);
        let panel = Panel::bottom("parameter wizard").frame(crate::views::side_frame());
        panel.show(ui, |ui| match selected {
            Some(parameter) => self.show_parameter(ui, language, &ladder, parameter),
            None => {
                let words = say::ladder_parameter_click().text(language);
                ui.label(RichText::new(words).weak());
            }
        });
        let columns = [
            (say::ladder_column_address(), 90.0),
            (say::ladder_column_value_now(), 100.0),
            (say::ladder_column_initial_value(), 80.0),
            (say::ladder_column_preset(), 80.0),
            (say::ladder_column_rows(), 150.0),
            (say::ladder_column_comment(), 0.0),
        ];
        let clicked = show_table(ui, language, &columns, parameters.len(), |index| {
            let Some(parameter) = parameters.get(index) else {
                return Vec::new();
            };
            let is_selected = selected.is_some_and(|it| it.address == parameter.address);
            let address = RichText::new(parameter.address.to_string()).monospace();
            let start = parameter
                .start
                .map_or_else(String::new, |it| it.to_string());
            vec![
                if is_selected {
                    address.strong()
                } else {
                    address
                },
                RichText::new(value_text(parameter.address, machine))
                    .monospace()
                    .color(theme::LADDER_LIVE),
                RichText::new(start).monospace(),
                RichText::new(parameter.preset_text()).monospace(),
                RichText::new(parameter.rows_text()).weak(),
                RichText::new(&parameter.meaning),
            ]
        });
        if let Some(parameter) = clicked.and_then(|index| parameters.get(index)) {
            self.wizard.selected = Some(parameter.address);
            self.wizard.value_entry.clear();
            self.row_error = None;
        }
    }

    /// Draws what the selected parameter does, its uses, and the fields that change it.
    fn show_parameter(
        &mut self,
        ui: &mut Ui,
        language: Language,
        ladder: &Arc<Ladder>,
        parameter: &LadderParameter,
    ) {
        ui.horizontal_wrapped(|ui| {
            let address = parameter.address.to_string();
            ui.label(RichText::new(address).monospace().strong());
            if !parameter.meaning.is_empty() {
                ui.label(&parameter.meaning);
            }
            for row in &parameter.rows {
                let button = Button::new(RichText::new(format!("{row:04}")).monospace()).small();
                if ui.add(button).clicked() {
                    self.search_address(ladder, parameter.address);
                    let uses = ladder.references(parameter.address);
                    if let Some(first) = uses.iter().find(|it| it.rung == *row) {
                        self.select_statement(ladder, first.statement);
                    }
                }
            }
        });
        if !parameter.explanation.is_empty() {
            ui.label(RichText::new(parameter.explanation).weak());
        }
        if let Some(number) = parameter.data_parameter {
            ui.label(say::ladder_parameter_of_control(number).text(language));
        }
        let preset =
            preset_address(parameter.address).filter(|_| parameter.data_parameter.is_none());
        let can_start = self.is_editing && has_start_value(parameter.address);
        if preset.is_none() && !can_start {
            return;
        }
        ui.horizontal_wrapped(|ui| {
            let name = say::ladder_parameter_value().text(language);
            ui.label(&name);
            let entry = &mut self.wizard.value_entry;
            let response = ui.add(TextEdit::singleline(entry).desired_width(100.0));
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &name));
            let value: Option<i32> = entry.trim().parse().ok().filter(|value| *value >= 0);
            if let Some(address) = preset {
                let write = Button::new(say::ladder_parameter_write().text(language));
                let hint = say::ladder_parameter_write_hint().text(language);
                let clicked = ui.add_enabled(value.is_some(), write).on_hover_text(hint);
                if let Some(value) = value.filter(|_| clicked.clicked()) {
                    self.send_request(ControlRequest::SetPreset(address, value));
                }
            }
            if can_start {
                let write = Button::new(say::ladder_parameter_start().text(language));
                let hint = say::ladder_parameter_start_hint().text(language);
                let clicked = ui.add_enabled(value.is_some(), write).on_hover_text(hint);
                if let Some(value) = value.filter(|_| clicked.clicked()) {
                    self.write_start_value(parameter.address, value, language);
                }
            }
        });
        if let Some(error) = &self.row_error {
            ui.label(RichText::new(error).color(theme::LADDER_ERROR_TEXT));
        }
    }

    /// Writes the value of a blank memory (`.INIT`) into the draft.
    fn write_start_value(&mut self, address: PlcAddress, value: i32, language: Language) {
        let source = self.draft.as_ref().map_or("", LadderDraft::text);
        let row = [address.to_string(), value.to_string()];
        self.row_error = match LadderTable::StartValues.with_row(source, &row) {
            Ok(list) => self.take_list(list, language),
            Err(wrong) => Some(wrong.text(language)),
        };
    }
}
