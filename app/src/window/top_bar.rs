//! The slim bar above the panel and the line of messages below it.

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

/// The group at the right end of the bar.
const RIGHT: &str = "bar right";
/// Where less room is left for the menus, points, those of programs are one.
const NARROW: f32 = 620.0;

/// Ground of the sign that something is imposed.
const IMPOSED: Color32 = Color32::from_rgb(255, 196, 90);

/// Ink of an alarm.
const ALARM: Color32 = Color32::from_rgb(255, 120, 96);

/// What was asked for in the bar.
#[derive(Clone, Debug)]
pub enum Asked {
    /// Choose a program and open it.
    Choose,
    /// Open this program.
    Open(PathBuf),
    /// Open a sample.
    Sample(&'static Sample),
    /// Do something with a project.
    Project(ProjectCommand),
    /// Use a layout.
    Layout(Layout),
    /// Light surroundings, or dark ones again.
    Light,
    /// The sound of the machine so loud, per cent; none: off.
    Sound(Option<u8>),
    /// Keys as large as fingers, or any size again.
    Fingers,
    /// Everything so large, per cent; none: as the monitor asks for.
    Zoom(Option<u16>),
    /// Open a view, or close it.
    View(View),
    /// Open the lessons, or close them.
    Lessons,
    /// Give the learner his own machine back.
    LeaveLesson,
    /// Run programs at this speed.
    Speed(Speed),
    /// Let every forced bit go.
    FreeBits,
    /// Mend every fault and let every held input go.
    Mend,
    /// Turn another control model on.
    Model(ModelId),
    /// Ask the questions of the first start again.
    FirstStart,
    /// Show the key map.
    Keys,
    /// Open the help.
    Help,
    /// The other language.
    Language,
}

impl Asked {
    /// Whether something comes onto the screen that the questions of the first start would
    /// hide.
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
    /// The one that is turned on.
    pub shown: ModelId,
    /// Whether there is a choice at all.
    pub offered: bool,
    /// Why another one cannot be turned on now.
    pub why_not: Option<Message>,
}

/// Draws the bar.
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
        // What does not fit beside the right side is scrolled: nothing lies over anything.
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

/// The speed at which programs run; a board has one speed only.
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

/// A sign that a practice machine stands in the place of the learner's own.
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

/// A sign that something is forced or broken, also when its view is closed; it opens
/// the view or takes everything back.
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

/// Draws the line of messages.
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

/// Draws a crash that has stopped the lathe, with the way out of it before the words, where
/// no length of theirs hides it. Returns whether it is chosen.
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

/// Draws the alarm that stands on the line of messages. Cause and way out are shown
/// upon the LCD: no key of the panel lies under them.
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
