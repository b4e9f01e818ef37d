//! The list beside the rungs: the selected element, the uses of its addresses, forced bits.

use egui::{RichText, ScrollArea, Ui, vec2};
use gsk_core::cnc::ControlRequest;
use gsk_core::plc::address::BitAddress;
use gsk_core::plc::{Access, Ladder, PlcAddress};
use gsk_host::kernel::Command;
use gsk_host::kernel::monitor::MachineView;
use gsk_panel::pages::signal_name;
use gsk_runner::ladder::address_comment;

use super::{LadderView, operand_value, statement_addresses};
use crate::focus;
use crate::theme;
use gsk_messages::{Language, say};

/// Width of the list beside the rungs for a view that is `view` points wide, points.
pub fn side_width(view: f32) -> f32 {
    (view * 0.3).clamp(190.0, 304.0)
}

impl LadderView {
    pub(super) fn show_side(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        let ladder = self.drawn_ladder(machine);
        ScrollArea::vertical()
            .auto_shrink([false, false])
            .show(ui, |ui| {
                let chosen = self.selected.and_then(|at| ladder.statements().get(at));
                match chosen {
                    Some(statement) => {
                        let rung = say::ladder_rung(statement.rung).text(language);
                        ui.label(RichText::new(rung).weak());
                        ui.label(RichText::new(statement.to_string()).monospace().strong());
                        for subject in statement_addresses(statement) {
                            self.show_address(ui, language, machine, &ladder, subject);
                        }
                    }
                    None => {
                        let words = say::ladder_click_element().text(language);
                        ui.label(RichText::new(words).weak());
                    }
                }
                self.show_forces(ui, language, machine);
                focus::scroll_to_focus(ui);
            });
    }

    /// Draws the line of an address: name, state, force, number of uses.
    fn show_address(
        &mut self,
        ui: &mut Ui,
        language: Language,
        machine: &MachineView,
        ladder: &Ladder,
        subject: PlcAddress,
    ) {
        ui.add_space(4.0);
        ui.separator();
        let memory = machine.plc.memory();
        let held = match subject {
            PlcAddress::Bit(bit) => u8::from(memory.bit(bit)).to_string(),
            PlcAddress::Byte(byte) => operand_value::format_value(byte, 1, memory),
        };
        ui.horizontal(|ui| {
            ui.label(RichText::new(subject.to_string()).monospace().strong());
            ui.label(
                RichText::new(format!("= {held}"))
                    .monospace()
                    .color(theme::LADDER_LIVE),
            );
            if let PlcAddress::Bit(bit) = subject {
                let symbol = signal_name(bit);
                if symbol != "-" {
                    ui.label(RichText::new(symbol).weak());
                }
                let why = ui.small_button(say::window_why().text(language));
                if why
                    .on_hover_text(say::window_why_hint().text(language))
                    .clicked()
                {
                    self.bit_to_explain = Some(bit);
                }
            }
        });
        let words = address_comment(ladder, subject, language);
        if !words.is_empty() {
            ui.label(words);
        }
        if let PlcAddress::Bit(bit) = subject {
            self.show_force_buttons(ui, language, machine, bit);
        }
        let references = ladder.references(subject);
        for (access, words) in [
            (Access::Write, say::ladder_written().text(language)),
            (Access::Read, say::ladder_read().text(language)),
        ] {
            let mut listed = references
                .iter()
                .filter(|reference| match access {
                    Access::Read => reference.access.is_read(),
                    _ => reference.access.is_write(),
                })
                .peekable();
            if listed.peek().is_none() {
                continue;
            }
            ui.horizontal_wrapped(|ui| {
                ui.spacing_mut().item_spacing = vec2(4.0, 3.0);
                ui.label(RichText::new(words).weak());
                for reference in listed {
                    let name = reference.mnemonic.row().name;
                    let text = format!("{:04} {name}", reference.rung);
                    let is_selected = self.selected == Some(reference.statement);
                    let text = RichText::new(text).monospace();
                    let text = if is_selected { text.strong() } else { text };
                    if ui.add(egui::Button::new(text).small()).clicked() {
                        self.search_address(ladder, subject);
                        self.select_statement(ladder, reference.statement);
                    }
                }
            });
        }
    }

    /// Draws three buttons that force a bit to 1 or 0, or release it.
    fn show_force_buttons(
        &self,
        ui: &mut Ui,
        language: Language,
        machine: &MachineView,
        bit: BitAddress,
    ) {
        let forces = machine.plc.forces().iter();
        let held = forces
            .clone()
            .find(|force| force.bit == bit)
            .map(|force| force.value);
        ui.horizontal(|ui| {
            ui.label(RichText::new(say::ladder_force().text(language)).weak());
            for (value, word) in [
                (Some(true), "1".to_owned()),
                (Some(false), "0".to_owned()),
                (None, say::ladder_force_free().text(language)),
            ] {
                let chosen = held == value;
                let (fill, ink) = match (chosen, value) {
                    (true, Some(_)) => (theme::FORCED, theme::TEXT_ON_BRIGHT),
                    (true, None) => (theme::CHOICE_SELECTED_GROUND, theme::CHOICE_SELECTED_TEXT),
                    (false, _) => (theme::CHOICE_GROUND, theme::QUIET_TEXT),
                };
                let button = egui::Button::new(RichText::new(&word).color(ink))
                    .fill(fill)
                    .min_size(vec2(30.0, 0.0));
                let response = ui.add(button);
                response.widget_info(|| {
                    let name = say::ladder_force_to(bit, &word).text(language);
                    egui::WidgetInfo::selected(egui::Role::RadioButton, true, chosen, name)
                });
                if response.clicked() {
                    self.send_request(ControlRequest::ForceBit(bit, value));
                }
            }
        });
    }

    fn show_forces(&self, ui: &mut Ui, language: Language, machine: &MachineView) {
        let forces = machine.plc.forces();
        if forces.is_empty() {
            return;
        }
        ui.add_space(10.0);
        ui.separator();
        let words = say::ladder_forced_bits().text(language);
        ui.label(RichText::new(words).color(theme::FORCED));
        for force in forces {
            ui.horizontal(|ui| {
                let text = format!("{} = {}", force.bit, u8::from(force.value));
                ui.label(RichText::new(text).monospace());
                let name = say::ladder_release(force.bit).text(language);
                let button = ui.small_button("×");
                button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
                if button.on_hover_text(&name).clicked() {
                    self.send_request(ControlRequest::ForceBit(force.bit, None));
                }
            });
        }
        if ui
            .button(say::ladder_release_all().text(language))
            .clicked()
        {
            self.console.send(Command::ReleaseForcedBits);
        }
    }
}
