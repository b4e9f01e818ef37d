//! Draws the top bar with its menus, and the message line at the bottom.

mod menus;

use std::path::PathBuf;

use egui::scroll_area::ScrollBarVisibility;
use egui::{Align2, Area, Color32, Frame, Order, Rect, RichText, ScrollArea, Tooltip, Ui};

use gsk_core::alarm::Alarm;
use gsk_core::model::ModelId;

use super::Settings;
use super::alarm_line;
use super::at_end;
use super::focus;
use super::fonts;
use super::layout::Layout;
use super::samples::Sample;
use super::view::{VIEWS, View};
use super::views::project::ProjectCommand;
use crate::kernel::{Imposed, Snapshot, Times};
use crate::pace::Speed;
use gsk_messages::{Language, Message, say};

/// Widget name of the group at the right end of the bar.
const RIGHT: &str = "bar right";
/// Below this width the program menus become one menu, points.
const NARROW: f32 = 620.0;

/// Background of the sign that inputs are forced or faults are set.
const IMPOSED: Color32 = Color32::from_rgb(255, 196, 90);

const ALARM: Color32 = Color32::from_rgb(255, 120, 96);

/// A request from the top bar.
#[derive(Clone, Debug)]
pub enum Asked {
    /// Choose a program file and open it.
    Choose,
    /// Open this program file or project.
    Open(PathBuf),
    /// Open a sample program.
    Sample(&'static Sample),
    /// Carry out a command of the project view.
    Project(ProjectCommand),
    /// Use a layout.
    Layout(Layout),
    /// Switch between the light and the dark theme.
    Light,
    /// Set the volume of the machine's sound, per cent; `None`: off.
    Sound(Option<u8>),
    /// Switch between keys as large as a finger and keys of any size.
    Fingers,
    /// Set the zoom, per cent; `None`: chosen by the monitor.
    Zoom(Option<u16>),
    /// Open or close a view.
    View(View),
    /// Open or close the lessons.
    Lessons,
    /// End the lesson and return to the learner's machine.
    LeaveLesson,
    /// Set the speed at which programs run.
    Speed(Speed),
    /// Release all forced bits.
    FreeBits,
    /// Clear all faults and release all held inputs.
    Mend,
    /// Turn another control model on.
    Model(ModelId),
    /// Show the questions of the first start again.
    FirstStart,
    /// Show or hide the key map.
    Keys,
    /// Open the help.
    Help,
    /// Switch to the other language.
    Language,
}

impl Asked {
    /// Whether the request shows something that the questions of the first start would cover.
    pub const fn shows_something(&self) -> bool {
        matches!(
            self,
            Self::Choose
                | Self::Open(_)
                | Self::Sample(_)
                | Self::Layout(_)
                | Self::View(_)
                | Self::Lessons
                | Self::Model(_)
        )
    }
}

/// The control models to choose from.
#[derive(Clone, Debug)]
pub struct ModelChoice {
    /// The model that is on.
    pub shown: ModelId,
    /// Whether another model can be chosen at all.
    pub offered: bool,
    /// Why another model cannot be turned on now; `None`: it can.
    pub why_not: Option<Message>,
}

/// Draws the bar and returns the operator's request.
pub fn show(
    ui: &mut Ui,
    settings: &Settings,
    opened: Option<&PathBuf>,
    picture: Option<&Snapshot>,
    models: &ModelChoice,
) -> Option<Asked> {
    let (language, layouts) = (settings.language, &settings.layouts);
    let imposed = picture.map(|picture| picture.imposed).unwrap_or_default();
    let is_open = |view| layouts.is_open(view);
    let mut asked = None;
    ui.horizontal_centered(|ui| {
        // Menus that do not fit beside the right group scroll: nothing overlaps.
        let right = at_end::width(ui, RIGHT, 320.0);
        let room = (ui.available_width() - right - ui.spacing().item_spacing.x).max(40.0);
        ScrollArea::horizontal()
            .id_salt("bar")
            .max_width(room)
            .scroll_bar_visibility(ScrollBarVisibility::AlwaysHidden)
            .show(ui, |ui| {
                ui.horizontal_centered(|ui| {
                    if room < NARROW {
                        ui.menu_button(say::program_file().text(language), |ui| {
                            asked = menus::programs(ui, settings, opened);
                        });
                    } else {
                        asked = menus::programs(ui, settings, opened);
                    }
                    ui.menu_button(say::window_layouts().text(language), |ui| {
                        asked = menus::looks(ui, settings, models).or(asked.take());
                    });
                    ui.menu_button(say::window_views().text(language), |ui| {
                        asked = menus::views(ui, settings).or(asked.take());
                    });
                    if !models.shown.is_main() {
                        let name = RichText::new(models.shown.name()).color(IMPOSED);
                        ui.label(name)
                            .on_hover_text(say::model_is_on(models.shown.name()).text(language));
                    }
                    if let Some(opened) = opened {
                        let name = opened.file_name().unwrap_or_default().to_string_lossy();
                        ui.label(RichText::new(name.as_ref()).color(Color32::from_gray(170)))
                            .on_hover_text(opened.display().to_string());
                    }
                });
                focus::follow(ui);
            });
        at_end::show(ui, RIGHT, 320.0, |ui| {
            if imposed != Imposed::default() {
                asked = standing(ui, language, imposed, &is_open).or(asked.take());
            }
            if picture.is_some_and(|picture| picture.lesson.is_some()) {
                asked = practises(ui, language, is_open(View::Lesson)).or(asked.take());
            }
            if let Some(picture) = picture {
                asked = speeds(ui, language, picture).or(asked.take());
            }
            for (words, answer) in [
                (say::window_help(), Asked::Help),
                (say::window_keys(), Asked::Keys),
                (say::window_other_language(), Asked::Language),
            ] {
                if ui.button(words.text(language)).clicked() {
                    asked = Some(answer);
                }
            }
        });
    });
    asked
}

/// Draws the menu of program speeds. With a board the speed is fixed.
fn speeds(ui: &mut Ui, language: Language, picture: &Snapshot) -> Option<Asked> {
    let name = |speed: Speed| match speed {
        Speed::Percent(percent) => format!("{}x", f64::from(percent) / 100.0),
        Speed::Fastest => say::window_speed_fastest().text(language),
    };
    let linked = picture.board.is_some();
    let chosen = if linked { Speed::REAL } else { picture.speed };
    let words = match picture.times {
        Some(Times(times)) => {
            let now = (times * 100.0).round() / 100.0;
            say::window_speed_now(name(chosen), now).text(language)
        }
        None => say::window_speed(name(chosen)).text(language),
    };
    let hint = match linked {
        true => say::window_speed_of_board(),
        false => say::window_speed_hint(),
    };
    let mut asked = None;
    let bar = ui.add_enabled_ui(!linked, |ui| {
        ui.menu_button(words, |ui| {
            for speed in Speed::CHOICES {
                let entry = egui::Button::selectable(speed == chosen, name(speed));
                if ui.add(entry).clicked() {
                    asked = Some(Asked::Speed(speed));
                    ui.close();
                }
            }
        })
        .response
    });
    let hint = hint.text(language);
    bar.inner.on_hover_text(&hint).on_disabled_hover_text(&hint);
    asked
}

/// Draws the sign that the practice machine replaces the learner's machine, with its menu.
fn practises(ui: &mut Ui, language: Language, is_open: bool) -> Option<Asked> {
    let mut asked = None;
    let text = RichText::new(say::window_lesson_menu().text(language)).color(Color32::BLACK);
    let button = egui::Button::new(text).fill(IMPOSED);
    egui::containers::menu::MenuButton::from_button(button).ui(ui, |ui| {
        ui.label(say::lesson_practice_hint().text(language));
        let entries = [
            (!is_open, say::window_lesson_open(), Asked::Lessons),
            (true, say::lesson_leave(), Asked::LeaveLesson),
        ];
        for (shown, name, answer) in entries {
            if shown && ui.button(name.text(language)).clicked() {
                asked = Some(answer);
                ui.close();
            }
        }
    });
    asked
}

/// Draws the sign that bits or inputs are forced or faults are set, even while their view is
/// closed. Its menu opens the view or clears them.
fn standing(
    ui: &mut Ui,
    language: Language,
    imposed: Imposed,
    is_open: &impl Fn(View) -> bool,
) -> Option<Asked> {
    let held = imposed.bits + imposed.inputs;
    let mut words = Vec::new();
    if held > 0 {
        words.push(say::window_forced(held).text(language));
    }
    if imposed.faults > 0 {
        words.push(say::window_faults(imposed.faults).text(language));
    }
    let mut asked = None;
    let text = RichText::new(words.join("   ")).color(Color32::BLACK);
    let button = egui::Button::new(text).fill(IMPOSED);
    egui::containers::menu::MenuButton::from_button(button).ui(ui, |ui| {
        let mut entry = |ui: &mut Ui, words: String, answer: Asked| {
            if ui.button(words).clicked() {
                asked = Some(answer);
                ui.close();
            }
        };
        if imposed.bits > 0 {
            let words = say::window_release_bits(imposed.bits).text(language);
            entry(ui, words, Asked::FreeBits);
        }
        let broken = imposed.inputs + imposed.faults;
        if broken > 0 {
            let words = say::window_mend(broken).text(language);
            entry(ui, words, Asked::Mend);
        }
        for (view, stands) in [(View::Ladder, imposed.bits), (View::Bench, broken)] {
            let row = VIEWS.iter().find(|row| row.view == view);
            if let Some(row) = row.filter(|_| stands > 0 && !is_open(view)) {
                let words = say::window_open_view((row.name)()).text(language);
                entry(ui, words, Asked::View(view));
            }
        }
    });
    asked
}

/// Draws the text of the message line: a message, else a hint.
pub fn status(ui: &mut Ui, message: Option<&str>, warning: bool, hint: &str) {
    ui.horizontal_centered(|ui| {
        let (text, colour) = match message {
            Some(message) if warning => (message, Color32::from_rgb(255, 196, 90)),
            Some(message) => (message, Color32::from_gray(220)),
            None => (hint, Color32::from_gray(140)),
        };
        let font = egui::TextStyle::Body.resolve(ui.style());
        let label = egui::Label::new(fonts::words(text, font, colour)).truncate();
        ui.add(label).on_hover_text(text);
    });
}

/// Draws a crash that has stopped the lathe. The button is left of the text, where a long text
/// does not hide it. Returns true when the button is clicked.
pub fn crash(ui: &mut Ui, text: &str, language: Language) -> bool {
    ui.horizontal_centered(|ui| {
        let words = RichText::new(say::window_free_lathe().text(language)).color(Color32::BLACK);
        let button = ui.add(egui::Button::new(words).fill(IMPOSED));
        let hint = say::window_free_lathe_hint().text(language);
        let label = egui::Label::new(RichText::new(text).color(ALARM)).truncate();
        ui.add(label).on_hover_text(text);
        button.on_hover_text(hint).clicked()
    })
    .inner
}

/// Draws the current alarm on the message line. Its tool tip with cause and remedy is drawn
/// over the LCD: it covers no key of the panel.
pub fn alarm(ui: &mut Ui, alarm: &Alarm, language: Language, lcd: Option<Rect>) {
    ui.horizontal_centered(|ui| {
        let text = RichText::new(alarm_line::short(alarm, language)).color(ALARM);
        let label = egui::Label::new(text)
            .truncate()
            .show_tooltip_when_elided(false);
        let line = ui.add(label);
        if !Tooltip::should_show_tooltip(&line, false) {
            return;
        }
        let lcd = lcd.unwrap_or_else(|| ui.ctx().content_rect());
        let tip = Area::new(egui::Id::unique("alarm tip"))
            .order(Order::Tooltip)
            .pivot(Align2::LEFT_BOTTOM)
            .fixed_pos(lcd.left_bottom())
            .interactable(false);
        tip.show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(lcd.width() - 2.0 * ui.spacing().window_margin.leftf() - 4.0);
                ui.label(alarm_line::long(alarm, language));
            });
        });
    });
}
