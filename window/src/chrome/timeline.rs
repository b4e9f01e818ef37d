//! The time line under the views, or under the panel without one: the session as a band with marks, a handle to see a past
//! moment, and buttons to continue from there.

mod band;

use std::sync::Arc;

use egui::{Align, Frame, Layout, Margin, Panel, RichText, Ui, vec2};
use gsk_host::kernel::timeline::{PastMoment, TimelineCommand, TimelineView};
use gsk_host::kernel::{Command, Console, PanelSnapshot};
use gsk_messages::{Language, Message, say};
use gsk_runner::text_format::format_whole_seconds as clock;

use crate::theme;
use crate::widgets::files::{FileChoice, choose_file};
use crate::widgets::right_aligned;
use band::Band;

/// Height of the time line strip, points.
pub const HEIGHT: f32 = 58.0;
/// Height of the row with text and buttons, points.
const ROW_HEIGHT: f32 = 26.0;
/// Height of the band with the marks, points.
const BAND_HEIGHT: f32 = 24.0;
/// Choices of minutes, for the shown range and for saving; `None` is the whole session.
const MINUTES: [Option<u64>; 4] = [Some(5), Some(15), Some(60), None];
/// Number of ticks in a minute of machine time.
const MINUTE_TICKS: u64 = 60_000;
/// Number of ticks in a second of machine time.
const SECOND_TICKS: u64 = 1000;

/// The state of the time line strip, and the session that it shows.
pub struct TimelineStrip {
    console: Console,
    is_open: bool,
    /// Whether the last snapshot shows the past.
    shows_past: bool,
    /// The session, as it was received last; `None` before the first one.
    view: Option<Arc<TimelineView>>,
    /// Minutes before the present that the band shows; `None` shows the whole session.
    range_minutes: Option<u64>,
    band: Band,
}

impl TimelineStrip {
    /// Creates the time line strip, closed.
    pub fn new(console: Console) -> Self {
        Self {
            console,
            is_open: false,
            shows_past: false,
            view: None,
            range_minutes: None,
            band: Band::default(),
        }
    }

    /// Opens or closes the strip and receives the newest session. A closed strip shows the
    /// present; a step to the past from elsewhere opens it.
    pub fn follow(&mut self, is_wanted: &mut bool, snapshot: Option<&PanelSnapshot>) {
        let shows_past = snapshot.is_some_and(|it| it.past.is_some());
        *is_wanted |= shows_past && !self.shows_past;
        self.shows_past = shows_past;
        let is_open = *is_wanted;
        if self.is_open != is_open {
            self.is_open = is_open;
            self.view = None;
            self.send(TimelineCommand::Publish(is_open));
            if !is_open {
                self.send(TimelineCommand::ReturnToPresent);
            }
        }
        if let Some(view) = self.console.timeline.pop() {
            self.view = Some(view);
        }
    }

    fn send(&self, command: TimelineCommand) {
        self.console.send(Command::Timeline(command));
    }

    /// Draws the open strip at the lower end of `ui`.
    pub fn show(&mut self, ui: &mut Ui, snapshot: Option<&PanelSnapshot>, language: Language) {
        let (Some(snapshot), true) = (snapshot, self.is_open) else {
            return;
        };
        let frame = Frame::new()
            .fill(theme::BAR_GROUND)
            .inner_margin(Margin::symmetric(8, 2));
        let panel = Panel::bottom("timeline")
            .exact_size(HEIGHT)
            .frame(frame)
            .show_separator_line(true);
        panel.show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 2.0;
            self.show_state_row(ui, snapshot, language);
            if let Some(view) = self.view.clone() {
                self.show_band_row(ui, &view, snapshot.past, language);
            }
        });
    }

    /// Draws the row with the shown moment (present or past) and the buttons.
    fn show_state_row(&self, ui: &mut Ui, snapshot: &PanelSnapshot, language: Language) {
        let size = vec2(ui.available_width(), ROW_HEIGHT);
        let past = snapshot.past;
        ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
            ui.set_min_size(size);
            let color = match past {
                Some(_) => {
                    let ground = ui.max_rect().expand2(vec2(8.0, 0.0));
                    ui.painter().rect_filled(ground, 0.0, theme::WARNING);
                    theme::TEXT_ON_BRIGHT
                }
                None => theme::HINT_TEXT,
            };
            let group = "timeline buttons";
            let space = ui.available_width() - right_aligned::last_width(ui, group, 360.0);
            let follows_wheel = self.view.as_deref().is_some_and(|it| it.is_handwheel_run);
            let words = state_text(past, snapshot.board.is_some(), follows_wheel).text(language);
            let text_size = vec2((space - 16.0).max(40.0), ROW_HEIGHT);
            ui.allocate_ui_with_layout(text_size, Layout::left_to_right(Align::Center), |ui| {
                let mut text = RichText::new(&words).color(color);
                if past.is_some() {
                    text = text.strong();
                }
                ui.add(egui::Label::new(text).truncate())
                    .on_hover_text(words);
            });
            right_aligned::show(ui, group, 360.0, |ui| {
                self.show_buttons(ui, past, snapshot.board.is_some(), language);
            });
        });
    }

    fn show_buttons(
        &self,
        ui: &mut Ui,
        past: Option<PastMoment>,
        has_board: bool,
        language: Language,
    ) {
        let view = self.view.as_deref();
        let can_continue = view.is_some_and(|view| view.can_continue);
        let refusal = say::timeline_not_with_board().text(language);
        let mut button = |name: Message, hint: Message, is_enabled, command| {
            let button = egui::Button::new(name.text(language));
            let response = ui.add_enabled(is_enabled, button);
            let response = response.on_hover_text(hint.text(language));
            if response.on_disabled_hover_text(&refusal).clicked() {
                self.send(command);
            }
        };
        if past.is_some() {
            button(
                say::timeline_continue(),
                say::timeline_continue_hint(),
                can_continue,
                TimelineCommand::ContinueFromHere,
            );
            button(
                say::timeline_present(),
                say::timeline_present_hint(),
                true,
                TimelineCommand::ReturnToPresent,
            );
        }
        if view.is_some_and(|view| view.branch.is_some()) {
            button(
                say::timeline_branch(),
                say::timeline_branch_hint(),
                can_continue,
                TimelineCommand::ReturnToBranch,
            );
        }
        let is_on = view.is_some_and(|view| view.is_handwheel_run);
        let name = say::handwheel_run_name().text(language);
        let toggle = ui.add(egui::Button::selectable(is_on, name));
        let hint = match has_board {
            true => say::retrace_hint(),
            false => say::handwheel_run_hint(),
        };
        let hint = hint.text(language);
        if toggle.on_hover_text(hint).clicked() {
            self.send(TimelineCommand::RunByHandwheel(!is_on));
        }
        let menu = ui.menu_button(say::timeline_save().text(language), |ui| {
            for minutes in MINUTES {
                if ui.button(minutes_text(minutes).text(language)).clicked() {
                    self.save(minutes, language, ui.ctx());
                    ui.close();
                }
            }
        });
        let hint = say::timeline_save_hint().text(language);
        menu.response.on_hover_text(hint);
    }

    /// Lets the operator choose a file for the last minutes of the session.
    fn save(&self, minutes: Option<u64>, language: Language, context: &egui::Context) {
        let console = self.console.clone();
        let choice = FileChoice::Save("session.gskrec".to_owned(), "gskrec");
        let notices = &self.console.notice_sender;
        choose_file(context, language, notices, choice, move |path| {
            console.send(Command::Timeline(TimelineCommand::Save { minutes, path }));
            None
        });
    }

    /// Draws the buttons that step by slots of the ladder. They keep their place in the present,
    /// so that the band stays under the pointer.
    fn show_slot_buttons(
        &self,
        ui: &mut Ui,
        view: &TimelineView,
        past: Option<PastMoment>,
        language: Language,
    ) {
        let slot_back = (
            say::breakpoint_slot_back(),
            say::breakpoint_slot_back_hint(),
        );
        let next_slot = (say::breakpoint_next_slot(), say::timeline_next_slot_hint());
        for ((name, hint), back) in [(slot_back, true), (next_slot, false)] {
            let is_enabled = view.can_continue && (back || past.is_some());
            let button = ui.add_enabled(is_enabled, egui::Button::new(name.text(language)));
            if button.on_hover_text(hint.text(language)).clicked() {
                self.send(TimelineCommand::StepSlot { back });
            }
        }
    }

    /// Draws the menu of time ranges, the steps by slots and the band with the marks.
    fn show_band_row(
        &mut self,
        ui: &mut Ui,
        view: &TimelineView,
        past: Option<PastMoment>,
        language: Language,
    ) {
        let size = vec2(ui.available_width(), BAND_HEIGHT);
        ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
            let chosen = self.range_minutes;
            let menu = ui.menu_button(say::timeline_range().text(language), |ui| {
                for minutes in MINUTES {
                    let name = minutes_text(minutes).text(language);
                    if ui
                        .add(egui::Button::selectable(minutes == chosen, name))
                        .clicked()
                    {
                        self.range_minutes = minutes;
                        ui.close();
                    }
                }
            });
            let hint = say::timeline_range_hint().text(language);
            menu.response.on_hover_text(hint);
            self.show_slot_buttons(ui, view, past, language);
            let shown = past.map_or(view.end, |past| past.tick);
            let first = match self.range_minutes {
                Some(minutes) => view.end.saturating_sub(minutes * MINUTE_TICKS).min(shown),
                None => view.start,
            };
            let first = first.max(view.start);
            let length = clock(to_seconds(view.end - first));
            ui.label(RichText::new(format!("-{length}")).color(theme::NOTE_TEXT));
            let now = say::timeline_now().text(language);
            let font = egui::TextStyle::Body.resolve(ui.style());
            let now_width = ui.painter().layout_no_wrap(now.clone(), font, theme::TEXT);
            let margin = now_width.size().x + 2.0 * ui.spacing().item_spacing.x;
            let width = (ui.available_width() - margin).max(60.0);
            let moved = self.band.show(ui, width, (view, first), shown, language);
            ui.label(RichText::new(now).color(theme::NOTE_TEXT));
            match moved {
                Some(tick) if tick >= view.end => self.send(TimelineCommand::ReturnToPresent),
                Some(tick) => self.send(TimelineCommand::LookAt(tick)),
                None => {}
            }
        });
    }
}

/// Returns a sentence about the moment that the strip shows.
fn state_text(past: Option<PastMoment>, has_board: bool, follows_wheel: bool) -> Message {
    let Some(past) = past else {
        return match (follows_wheel, has_board) {
            (true, true) => say::retrace_state(),
            (true, false) => say::handwheel_run_state(),
            (false, _) => say::timeline_hint(),
        };
    };
    let time = clock(to_seconds(past.age_ms));
    match (has_board, past.is_part_pending) {
        (true, _) => say::timeline_banner_board(time),
        (false, _) if follows_wheel => {
            say::handwheel_run_back(format!("{:.2}", to_seconds(past.age_ms)))
        }
        (false, true) => say::timeline_banner_part(time),
        (false, false) => say::timeline_banner(time),
    }
}

fn minutes_text(minutes: Option<u64>) -> Message {
    minutes.map_or_else(say::timeline_all, say::timeline_minutes)
}

fn to_seconds(ticks: u64) -> f64 {
    ticks as f64 / SECOND_TICKS as f64
}
