//! The fault bench: switches that simulate faults of a real machine, and inputs held at a
//! value regardless of their sensors.

use std::sync::Arc;

use egui::{
    Align, Align2, FontId, Label, Layout, Panel, RichText, ScrollArea, Sense, Ui, UiBuilder, vec2,
};
use gsk_core::machine::LatheFault;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_host::kernel::monitor::MachineView;
use gsk_host::kernel::{Command, Console};
use gsk_panel::pages::{signal_meaning, signal_name};

use super::interface::{View, ViewFrame, ViewStart};
use crate::theme;
use crate::widgets::{alarm_text, right_aligned};
use crate::{focus, screen_reader};
use gsk_messages::{Language, Message, say};

/// Height of a row of the fault bench, points.
const ROW_HEIGHT: f32 = 24.0;
/// Width reserved for the scroll bar of a list, points.
const SCROLL_BAR_WIDTH: f32 = 12.0;
/// Width of the column of contact lamps, points. The constant after it is that of the PLC
/// lamps.
const CONTACT_WIDTH: f32 = 48.0;
const PLC_WIDTH: f32 = 34.0;
/// Width of the column of inputs, points.
const INPUTS_WIDTH: f32 = 470.0;
/// Minimum width of the column of faults, points. The constant after it is the maximum.
const MIN_FAULTS_WIDTH: f32 = 240.0;
const MAX_FAULTS_WIDTH: f32 = 420.0;
/// Width of the column of faults from which the script names are shown, too, points.
const SCRIPT_NAMES_WIDTH: f32 = 380.0;
/// Name of the group of buttons that hold an input, for their widget ids.
const HOLD_BUTTONS: &str = "held";
/// Bytes of the X addresses whose inputs are plugs for machine contacts.
const PLUGGED_BYTES: std::ops::Range<u16> = 0..4;

pub struct Bench {
    console: Console,
    entry: String,
    entry_error: Option<String>,
    /// Inputs that the user has added to those of the plugs.
    added_inputs: Vec<BitAddress>,
}

impl View for Bench {
    fn create(start: ViewStart<'_>) -> Self {
        Self::new(start.console.clone())
    }

    fn show(&mut self, ui: &mut Ui, frame: ViewFrame<'_>) {
        self.draw(ui, frame.language, frame.machine);
    }
}

impl Bench {
    /// Creates the fault bench; no fault is set.
    pub fn new(console: Console) -> Self {
        Self {
            console,
            entry: String::new(),
            entry_error: None,
            added_inputs: Vec::new(),
        }
    }

    /// Draws the bench and handles its input. `machine` is the newest state, `None` before the
    /// first one.
    fn draw(&mut self, ui: &mut Ui, language: Language, machine: Option<&Arc<MachineView>>) {
        let Some(machine) = machine else {
            ui.centered_and_justified(|ui| ui.label(say::window_one_moment().text(language)));
            return;
        };
        let state = Panel::bottom("machine state").frame(super::bar_frame());
        state.show(ui, |ui| show_state(ui, language, machine));
        let faults = Panel::left("faults")
            .exact_size(
                (ui.available_width() - INPUTS_WIDTH).clamp(MIN_FAULTS_WIDTH, MAX_FAULTS_WIDTH),
            )
            .resizable(false)
            .frame(super::side_frame());
        faults.show(ui, |ui| self.show_faults(ui, language, machine));
        egui::CentralPanel::default()
            .frame(super::side_frame())
            .show(ui, |ui| self.show_inputs(ui, language, machine));
    }

    fn show_faults(&self, ui: &mut Ui, language: Language, machine: &MachineView) {
        ui.horizontal(|ui| {
            ui.heading(say::bench_faults().text(language));
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let words = say::bench_mend_all().text(language);
                let hint = say::bench_mend_all_hint().text(language);
                let button = egui::Button::new(words);
                let button = ui.add_enabled(!machine.hides_faults, button);
                if button.on_hover_text(hint).clicked() {
                    self.console.send(Command::ClearFaults);
                }
            });
        });
        if machine.hides_faults {
            let hint = RichText::new(say::bench_repair_hint().text(language));
            ui.add(Label::new(hint.color(theme::LESSON_HINT_TEXT)).wrap());
        }
        let shows_script_names = ui.available_width() >= SCRIPT_NAMES_WIDTH;
        if shows_script_names {
            let hint = say::bench_faults_hint().text(language);
            ui.label(RichText::new(hint).weak());
        }
        ui.add_space(4.0);
        ScrollArea::vertical()
            .auto_shrink([false, false])
            .show(ui, |ui| {
                ui.set_max_width(ui.available_width() - SCROLL_BAR_WIDTH);
                for (name, fault) in LatheFault::ALL {
                    let row = fault.row();
                    let text = row.label().text(language);
                    let effect = row.effect().text(language);
                    let is_shown = !machine.hides_faults && machine.lathe.has_fault(fault);
                    let mut on = is_shown;
                    let colour = if on {
                        theme::ALARM_TEXT
                    } else {
                        theme::ROW_TEXT
                    };
                    // Who searches a fault needs no script.
                    let hover_text = match shows_script_names || machine.hides_faults {
                        true => effect.clone(),
                        false => format!("{effect}\n{name}"),
                    };
                    let mut add_check = |ui: &mut Ui| {
                        let check = ui.checkbox(&mut on, RichText::new(&text).color(colour));
                        check.widget_info(|| {
                            egui::WidgetInfo::selected(egui::Role::CheckBox, true, on, &text)
                        });
                        if check.on_hover_text(&hover_text).changed() {
                            self.console.send(Command::Fault(fault, on));
                        }
                    };
                    match shows_script_names {
                        true => draw_row(ui, |ui| {
                            ui.label(RichText::new(name).monospace().weak());
                            ui.with_layout(Layout::left_to_right(Align::Center), add_check);
                        }),
                        // In a narrow column a long name takes two rows.
                        false => add_check(ui),
                    }
                    // The effect, while the fault is active.
                    if is_shown {
                        ui.indent(name, |ui| {
                            ui.add(Label::new(RichText::new(effect).weak()).wrap());
                        });
                    }
                }
                focus::scroll_to_focus(ui);
            });
    }

    fn show_inputs(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        ui.horizontal(|ui| {
            ui.heading(say::bench_inputs().text(language));
            right_aligned::show(ui, "bench add", 120.0, |ui| {
                let entry = egui::TextEdit::singleline(&mut self.entry)
                    .desired_width(70.0)
                    .hint_text("X20.5");
                let response = ui.add(entry);
                let name = say::bench_input_address().text(language);
                response
                    .widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, &name));
                let words = say::window_add().text(language);
                let added = ui.button(words).clicked();
                let entered =
                    response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
                if (added || entered) && !self.entry.trim().is_empty() {
                    self.add_input(language);
                }
            });
        });
        if let Some(complaint) = &self.entry_error {
            ui.label(RichText::new(complaint).color(theme::ALARM_TEXT));
        }
        draw_row(ui, |ui| {
            ui.add_space(SCROLL_BAR_WIDTH);
            ui.label(RichText::new(say::bench_held_at().text(language)).weak());
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                draw_column_heading(ui, &say::bench_contact().text(language), CONTACT_WIDTH);
                draw_column_heading(ui, "PLC", PLC_WIDTH);
                let words = say::bench_address().text(language);
                ui.label(RichText::new(words).weak());
            });
        });
        ScrollArea::vertical()
            .auto_shrink([false, false])
            .show(ui, |ui| {
                ui.set_max_width(ui.available_width() - SCROLL_BAR_WIDTH);
                let plugged = PLUGGED_BYTES
                    .flat_map(|byte| (0..8).map(move |bit| BitAddress::new(Area::X, byte, bit)));
                for address in self.added_inputs.iter().copied().chain(plugged) {
                    self.show_input(ui, language, machine, address);
                }
                focus::scroll_to_focus(ui);
            });
    }

    fn show_input(
        &self,
        ui: &mut Ui,
        language: Language,
        machine: &MachineView,
        address: BitAddress,
    ) {
        let held = machine.lathe.forced_input(address);
        let contact = machine
            .inputs
            .is_closed(usize::from(address.byte), address.bit);
        let accepted = machine.plc.memory().bit(address);
        let size = vec2(ui.available_width(), ROW_HEIGHT);
        let (rect, _) = ui.allocate_exact_size(size, Sense::HOVER);
        let builder = UiBuilder::new()
            .max_rect(rect)
            .layout(Layout::left_to_right(Align::Center));
        ui.scope_builder(builder, |ui| {
            draw_lamp(
                ui,
                contact,
                &say::bench_contact().text(language),
                CONTACT_WIDTH,
            );
            draw_lamp(ui, accepted, "PLC", PLC_WIDTH);
            ui.label(RichText::new(format!("X{}.{}", address.byte, address.bit)).monospace());
            let symbol = signal_name(address);
            let meaning = signal_meaning(address, language);
            let words = if symbol == "-" {
                meaning.to_owned()
            } else {
                format!("{symbol}  {meaning}")
            };
            let meaning_width =
                ui.available_width() - right_aligned::last_width(ui, HOLD_BUTTONS, 150.0) - 24.0;
            let size = vec2(meaning_width.max(0.0), ROW_HEIGHT);
            ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
                ui.add(Label::new(RichText::new(&words).weak()).truncate())
                    .on_hover_text(&words);
            });
            right_aligned::show(ui, HOLD_BUTTONS, 150.0, |ui| {
                self.show_hold_buttons(ui, language, address, held);
            });
        });
    }

    /// Draws the buttons that hold an input at 0 or 1, or release it to its sensor. `held` is
    /// the value at which it is held, `None` if it is not.
    fn show_hold_buttons(
        &self,
        ui: &mut Ui,
        language: Language,
        address: BitAddress,
        held: Option<bool>,
    ) {
        for (value, word) in [
            (None, say::bench_sensor().text(language)),
            (Some(false), "0".to_owned()),
            (Some(true), "1".to_owned()),
        ] {
            let chosen = held == value;
            let (fill, ink) = match (chosen, value) {
                (true, Some(_)) => (theme::FORCED, theme::TEXT_ON_BRIGHT),
                (true, None) => (theme::CHOICE_SELECTED_GROUND, theme::CHOICE_SELECTED_TEXT),
                (false, _) => (theme::NO_FILL, theme::WEAK_TEXT),
            };
            let button = egui::Button::new(RichText::new(&word).color(ink))
                .fill(fill)
                .min_size(vec2(28.0, 0.0));
            let response = ui.add(button);
            response.widget_info(|| {
                let name = format!("{address} {word}");
                egui::WidgetInfo::selected(egui::Role::RadioButton, true, chosen, name)
            });
            if response.clicked() {
                self.console.send(Command::ForceInput(address, value));
            }
        }
    }

    fn add_input(&mut self, language: Language) {
        let entry = self.entry.trim().to_ascii_uppercase();
        let address: Result<BitAddress, _> = entry.parse();
        self.entry_error = match address {
            Ok(address) if address.area == Area::X => {
                let is_listed =
                    PLUGGED_BYTES.contains(&address.byte) || self.added_inputs.contains(&address);
                if !is_listed {
                    self.added_inputs.push(address);
                }
                self.entry.clear();
                None
            }
            Ok(_) => Some(say::bench_inputs_here(entry).text(language)),
            Err(error) => Some(error.to_string()),
        };
    }
}

/// Allocates a row and draws its content from the right.
fn draw_row(ui: &mut Ui, content: impl FnOnce(&mut Ui)) {
    let size = vec2(ui.available_width(), ROW_HEIGHT);
    let (rect, _) = ui.allocate_exact_size(size, Sense::HOVER);
    let builder = UiBuilder::new()
        .max_rect(rect)
        .layout(Layout::right_to_left(Align::Center));
    ui.scope_builder(builder, content);
}

/// Draws the heading of a column of lamps, centred.
fn draw_column_heading(ui: &mut Ui, words: &str, width: f32) {
    let (rect, _) = ui.allocate_exact_size(vec2(width, ROW_HEIGHT), Sense::HOVER);
    let font = egui::TextStyle::Body.resolve(ui.style());
    let ink = ui.visuals().weak_text_color();
    let middle = Align2::CENTER_CENTER;
    ui.painter().text(rect.center(), middle, words, font, ink);
}

/// Draws a lamp with 1 or 0, named for screen readers, in a column of `width` points.
fn draw_lamp(ui: &mut Ui, lit: bool, name: &str, width: f32) {
    let (rect, response) = ui.allocate_exact_size(vec2(width, ROW_HEIGHT), Sense::HOVER);
    let colour = if lit { theme::LAMP_ON } else { theme::LAMP_OFF };
    ui.painter().circle_filled(rect.center(), 5.5, colour);
    let text = if lit { "1" } else { "0" };
    let ink = if lit {
        theme::TEXT_ON_BRIGHT
    } else {
        theme::LAMP_OFF_TEXT
    };
    let font = FontId::proportional(theme::LAMP_SIZE);
    ui.painter()
        .text(rect.center(), Align2::CENTER_CENTER, text, font, ink);
    response.widget_info(|| egui::WidgetInfo {
        current_text_value: Some(text.to_owned()),
        ..egui::WidgetInfo::labeled(egui::Role::Status, true, name)
    });
    screen_reader::add_state(ui, &response, text);
}

/// Draws the state of the machine and the alarms of the control.
fn show_state(ui: &mut Ui, language: Language, machine: &MachineView) {
    let lathe = &machine.lathe;
    let station = lathe
        .station()
        .map_or_else(say::bench_between_stations, say::bench_station);
    let slides = lathe.slide_position();
    let facts = [
        Some(say::bench_slides(slides.x, slides.z)),
        Some(say::as_written(format_args!(
            "S {:.0} r/min",
            lathe.spindle_rpm()
        ))),
        Some(station),
        (!lathe.is_tool_post_clamped()).then(say::bench_tool_post_not_clamped),
        lathe.is_chuck_clamped().then(say::bench_chuck_clamped),
        lathe
            .is_tailstock_forward()
            .then(say::bench_tailstock_forward),
        lathe.is_coolant_on().then(say::bench_coolant),
        lathe.is_lubrication_on().then(say::bench_lubrication),
        lathe.is_over_limit().then(say::bench_limit_switch_tripped),
        (!lathe.is_emergency_loop_closed()).then(say::bench_emergency_loop_open),
    ];
    ui.horizontal_wrapped(|ui| {
        let words = say::bench_machine().text(language);
        ui.label(RichText::new(words).weak());
        let facts = facts.into_iter().flatten();
        let facts: Vec<String> = facts.map(|fact: Message| fact.text(language)).collect();
        ui.label(facts.join("   "));
    });
    ui.horizontal_wrapped(|ui| {
        let words = say::bench_alarms().text(language);
        ui.label(RichText::new(words).weak());
        let alarms = alarm_text::joined_row(&machine.alarms, language);
        if alarms.is_empty() {
            ui.label(say::bench_no_alarms().text(language));
        } else {
            ui.label(RichText::new(alarms).color(theme::ALARM_TEXT));
        }
    });
}
