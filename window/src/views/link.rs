//! The link page: the pulse board, its traffic, and the comparison of its pulse count.

mod figures;
mod words;

use egui::{Color32, Label, Panel, RichText, ScrollArea, Ui, vec2};
use gsk_host::kernel::link_view::LinkView;
use gsk_host::kernel::{Command, Console, LinkAction};
use gsk_host::message_format::describe_setting_difference;
use gsk_link::LinkState;

use super::interface::{View, ViewFrame, ViewStart};
use super::text_files;
use crate::focus;
use crate::widgets::real_machine_bar::state_name;
use crate::widgets::right_aligned;
use crate::{fonts, theme};
use gsk_messages::{Language, say};

/// The view that shows the pulse board and its link.
pub struct LinkPage {
    console: Console,
    view: Option<LinkView>,
    rates: figures::TrafficRates,
}

impl View for LinkPage {
    fn create(start: ViewStart<'_>) -> Self {
        Self::new(start.console.clone())
    }

    fn open(&mut self) {
        self.console.send(Command::WatchLink(true));
    }

    fn close(&mut self) {
        self.console.send(Command::WatchLink(false));
        self.view = None;
    }

    fn show(&mut self, ui: &mut Ui, frame: ViewFrame<'_>) {
        self.draw(ui, frame.language);
    }
}

impl LinkPage {
    /// Creates the page; it is empty until the kernel reports about the board.
    pub fn new(console: Console) -> Self {
        Self {
            console,
            view: None,
            rates: figures::TrafficRates::default(),
        }
    }

    fn draw(&mut self, ui: &mut Ui, language: Language) {
        if let Some(view) = self.console.link.pop() {
            self.rates
                .update(&view.traffic, ui.input(|input| input.time));
            self.view = Some(view);
        }
        let Some(view) = self.view.take() else {
            egui::CentralPanel::default()
                .frame(super::side_frame())
                .show(ui, |ui| show_no_board(ui, language));
            return;
        };
        let bar = Panel::top("link bar").frame(super::bar_frame());
        bar.show(ui, |ui| self.show_bar(ui, language, &view));
        let side = Panel::left("link figures")
            .exact_size((ui.available_width() * 0.55).clamp(340.0, 400.0))
            .resizable(false)
            .frame(super::side_frame());
        side.show(ui, |ui| {
            ScrollArea::vertical()
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    // The figures are right-aligned beside the scroll bar.
                    ui.set_max_width(ui.available_width() - ui.spacing().scroll.bar_width);
                    figures::show(ui, language, &view, &self.rates);
                    focus::scroll_to_focus(ui);
                });
        });
        egui::CentralPanel::default()
            .frame(super::side_frame())
            .show(ui, |ui| self.show_traffic(ui, language, &view));
        self.view = Some(view);
    }

    fn show_bar(&self, ui: &mut Ui, language: Language, view: &LinkView) {
        ui.horizontal_wrapped(|ui| {
            let state = RichText::new(state_name(view.state).text(language));
            ui.label(state.color(state_colour(view.state)).strong());
            let board = match view.board.firmware.as_str() {
                "" => say::link_page_board_not_known().text(language),
                firmware => firmware.to_owned(),
            };
            ui.label(board);
            ui.label(RichText::new(&view.port).monospace().weak());
            right_aligned::show(ui, "link orders", 320.0, |ui| {
                let words = say::link_page_reconnect().text(language);
                let is_stopped = view.state != LinkState::Moving;
                let button = ui.add_enabled(is_stopped, egui::Button::new(words));
                self.send_order_if_clicked(&button, LinkAction::Reconnect);
                let words = say::link_page_check_position().text(language);
                let hint = say::link_page_check_position_hint().text(language);
                let ready = view.state == LinkState::Ready;
                let button = ui.add_enabled(ready, egui::Button::new(words));
                self.send_order_if_clicked(&button.on_hover_text(hint), LinkAction::Check);
                let words = say::link_page_save_report().text(language);
                if ui.button(words).clicked() {
                    let view = view.clone();
                    let name_and_extension = ("link.txt", "txt");
                    let context = ui.ctx().clone();
                    text_files::save(
                        &self.console,
                        &context,
                        language,
                        name_and_extension,
                        move || format_report(&view),
                    );
                }
            });
        });
        if let Some(advice) = words::advice(view.state) {
            ui.label(RichText::new(advice.text(language)).weak());
        }
    }

    fn send_order_if_clicked(&self, button: &egui::Response, order: LinkAction) {
        if button.clicked() {
            self.console.send(Command::Link(order));
        }
    }

    /// Draws the lines of traffic with the board, below the differing settings and position
    /// checks.
    fn show_traffic(&self, ui: &mut Ui, language: Language, view: &LinkView) {
        if !view.differences.is_empty() {
            self.show_differences(ui, language, view);
            ui.separator();
        }
        if !view.position_checks.is_empty() {
            ui.heading(say::link_page_position_checks().text(language));
            for line in view.position_checks.iter().rev().take(4).rev() {
                let ink = match line.agrees {
                    true => theme::QUIET_TEXT,
                    false => theme::ALARM_TEXT,
                };
                let text = RichText::new(line.message.text(language));
                ui.add(Label::new(text.monospace().color(ink)).wrap());
            }
            ui.separator();
        }
        ui.heading(say::link_page_traffic().text(language));
        let height = ui.text_style_height(&egui::TextStyle::Monospace);
        ScrollArea::vertical()
            .auto_shrink([false, false])
            .stick_to_bottom(true)
            .show_rows(ui, height, view.traffic_lines.len(), |ui, rows| {
                for line in view.traffic_lines.get(rows).unwrap_or_default() {
                    let (arrow, ink) = match line.is_outward {
                        true => ('>', theme::BUSY),
                        false => ('<', theme::SECONDARY_TEXT),
                    };
                    let at = line.at.as_secs_f64();
                    let text = format!("{at:9.3} {arrow} {}", line.text);
                    let text = RichText::new(text).monospace().color(ink);
                    ui.add(Label::new(text).truncate());
                }
                focus::scroll_to_focus(ui);
            });
    }

    /// Draws the settings of the board that differ from the required ones.
    fn show_differences(&self, ui: &mut Ui, language: Language, view: &LinkView) {
        ui.heading(say::link_page_settings_differ().text(language));
        ui.add_space(2.0);
        // Every setting may differ: the button must stay visible below a long table.
        let max_height = ui.available_height() * 0.6;
        ScrollArea::both()
            .id_salt("differences")
            .max_height(max_height)
            .show(ui, |ui| {
                draw_difference_table(ui, language, view);
                focus::scroll_to_focus(ui);
            });
        ui.add_space(4.0);
        let words = say::link_page_write_settings().text(language);
        self.send_order_if_clicked(&ui.button(words), LinkAction::WriteSettings);
        if view.board.forgets {
            ui.label(say::link_page_board_forgets().text(language));
        }
    }
}

/// Draws one row per differing setting: name, value on the board, required value, meaning.
fn draw_difference_table(ui: &mut Ui, language: Language, view: &LinkView) {
    egui::Grid::new("differences")
        .num_columns(4)
        .spacing(vec2(24.0, 4.0))
        .striped(true)
        .show(ui, |ui| {
            for heading in [
                say::link_page_column_setting(),
                say::link_page_column_board(),
                say::link_page_column_wanted(),
                say::link_page_column_meaning(),
            ] {
                ui.label(RichText::new(heading.text(language)).weak());
            }
            ui.end_row();
            for difference in &view.differences {
                ui.monospace(&difference.name);
                ui.monospace(difference.board.as_deref().unwrap_or("-"));
                ui.monospace(&difference.wanted);
                let meaning = words::setting_name(difference.number);
                ui.label(meaning.map_or_else(String::new, |it| it.text(language)));
                ui.end_row();
            }
        });
}

/// Draws a sentence in which command line options may occur.
fn draw_sentence(ui: &mut Ui, text: &str) {
    let font = egui::TextStyle::Body.resolve(ui.style());
    ui.label(fonts::layout_text(text, font, ui.visuals().text_color()));
}

fn show_no_board(ui: &mut Ui, language: Language) {
    // A page wider than its pane does not scroll here: the text wraps at the pane.
    ui.set_max_width(ui.max_rect().intersect(ui.clip_rect()).width() - 8.0);
    ui.add_space(12.0);
    ui.heading(say::link_page_no_board().text(language));
    draw_sentence(ui, &say::link_page_no_board_how_to_link().text(language));
    ui.add_space(6.0);
    draw_sentence(ui, &say::link_page_no_board_twin().text(language));
}

const fn state_colour(state: LinkState) -> Color32 {
    match state {
        LinkState::Ready => theme::SUCCESS,
        LinkState::Moving | LinkState::Homing | LinkState::Verify => theme::BUSY,
        LinkState::Opening | LinkState::Identify | LinkState::Configure | LinkState::Locked => {
            theme::WARNING
        }
        LinkState::Off | LinkState::Tripped | LinkState::Fault | LinkState::Lost => {
            theme::ALARM_TEXT
        }
    }
}

/// Formats the contents of the link page as English text.
fn format_report(view: &LinkView) -> String {
    let mut out = format!(
        "{}  {}  {}\n\n",
        state_name(view.state).text(Language::En),
        view.board.firmware,
        view.port
    );
    for section in figures::build_sections(Language::En, view, &figures::TrafficRates::default()) {
        out.push_str(&format!("{}\n", section.title));
        for (name, value) in section.rows {
            out.push_str(&format!("  {name:<24}{value}\n"));
        }
        out.push('\n');
    }
    for difference in &view.differences {
        out.push_str(&format!("{}\n", describe_setting_difference(difference)));
    }
    for line in &view.position_checks {
        out.push_str(&format!("{}\n", line.message));
    }
    out.push('\n');
    for line in &view.traffic_lines {
        let arrow = if line.is_outward { '>' } else { '<' };
        out.push_str(&format!(
            "{:9.3} {arrow} {}\n",
            line.at.as_secs_f64(),
            line.text
        ));
    }
    out
}
