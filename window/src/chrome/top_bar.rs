//! Draws the top bar with its menus, and the message line at the bottom.

mod menus;

use std::path::PathBuf;

use egui::scroll_area::ScrollBarVisibility;
use egui::{Align2, Area, Frame, Label, Order, Popup, Rect, RichText, ScrollArea, Tooltip, Ui};

use gsk_core::alarm::Alarm;
use gsk_core::model::ModelId;
use gsk_host::kernel::pace::RunSpeed;
use gsk_host::kernel::{ExerciseState, ForcedState, PanelSnapshot, SpeedRatio};

use crate::WindowSettings;
use crate::focus;
use crate::fonts;
use crate::layout::WindowLayout;
use crate::samples::ProgramSample;
use crate::theme;
use crate::view::{VIEWS, ViewId};
use crate::views::project::ProjectViewCommand;
use crate::widgets::alarm_text;
use crate::widgets::icons::{Icon, IconButton};
use crate::widgets::right_aligned;
use gsk_messages::{Language, Message, say};

/// Widget name of the group at the right end of the bar.
const RIGHT_GROUP: &str = "bar right";
/// Width of the bar below which the program menus become one menu, points.
const NARROW_WIDTH: f32 = 620.0;
/// Smallest width of the name of the opened file, points: room for an ellipsis.
const MIN_FILE_NAME_WIDTH: f32 = 16.0;

/// Width of the window from which the buttons at the right end show their names, points.
const NAMED_BUTTONS_WIDTH: f32 = 1000.0;
/// The same where the bar has the name of the control model.
const NAMED_BUTTONS_WIDTH_WITH_MODEL: f32 = 1150.0;

/// A request of the operator in the top bar.
#[derive(Clone, Debug)]
pub enum TopBarRequest {
    /// Show a dialog to choose a program file, and open the file.
    ChooseProgram,
    /// Open this file as a program or project.
    Open(PathBuf),
    /// Open a sample program.
    Sample(&'static ProgramSample),
    /// Carry out a command of the project view.
    Project(ProjectViewCommand),
    /// Switch the main window to this layout.
    Layout(WindowLayout),
    /// Switch between the light and the dark theme.
    ToggleLight,
    /// Set the volume of the machine's sound, per cent; `None` switches the sound off.
    Sound(Option<u8>),
    /// Switch between keys as large as a finger and keys of any size.
    ToggleFingers,
    /// Set the zoom, per cent; `None` lets the size of the monitor choose it.
    Zoom(Option<u16>),
    /// Open or close a view.
    ToggleView(ViewId),
    /// Show or hide the time line.
    ToggleTimeline,
    /// Open or close the pane of the network.
    ToggleNetwork,
    /// Open or close the lessons.
    ToggleLessons,
    /// End the lesson and return to the learner's own machine.
    LeaveLesson,
    /// Set the speed at which programs run.
    Speed(RunSpeed),
    /// Release all forced PLC bits.
    ReleaseBits,
    /// Clear all lathe faults and release all forced inputs.
    ClearFaults,
    /// Switch the current control off and this control model on.
    Model(ModelId),
    /// Show the questions of the first start again.
    FirstStart,
    /// Show or hide the map of the PC keys.
    ToggleKeyMap,
    /// Open the help window.
    Help,
    /// Switch the language of the window to the other one.
    SwitchLanguage,
}

impl TopBarRequest {
    /// Whether the request opens a view or window that the questions of the first start would
    /// cover.
    pub const fn needs_window_area(&self) -> bool {
        matches!(
            self,
            Self::ChooseProgram
                | Self::Open(_)
                | Self::Sample(_)
                | Self::Layout(_)
                | Self::ToggleView(_)
                | Self::ToggleLessons
                | Self::Model(_)
        )
    }
}

/// The control models between which the operator can switch.
#[derive(Clone, Debug)]
pub struct ModelChoice {
    /// The control model that is switched on.
    pub current: ModelId,
    /// Whether the menu offers any other model.
    pub is_offered: bool,
    /// The reason why no other model can be switched on at the moment; `None` if it is possible.
    pub refusal: Option<Message>,
}

/// Draws the top bar and returns the operator's request; `None` without one.
pub fn show(
    ui: &mut Ui,
    settings: &WindowSettings,
    opened: Option<&PathBuf>,
    snapshot: Option<&PanelSnapshot>,
    models: &ModelChoice,
) -> Option<TopBarRequest> {
    let (language, layouts) = (settings.language, &settings.layouts);
    let imposed = snapshot.map(|picture| picture.forced).unwrap_or_default();
    let is_open = |view| layouts.is_open(view);
    let mut request = None;
    ui.horizontal_centered(|ui| {
        // Menus that do not fit beside the right group scroll: nothing overlaps.
        let right_width = right_aligned::last_width(ui, RIGHT_GROUP, 320.0);
        let menu_width =
            (ui.available_width() - right_width - ui.spacing().item_spacing.x).max(40.0);
        let menu_right = ui.cursor().left() + menu_width;
        ScrollArea::horizontal()
            .id_salt("bar")
            .max_width(menu_width)
            .scroll_bar_visibility(ScrollBarVisibility::AlwaysHidden)
            .show(ui, |ui| {
                ui.horizontal_centered(|ui| {
                    if menu_width < NARROW_WIDTH {
                        ui.menu_button(say::program_file().text(language), |ui| {
                            request = menus::show_programs(ui, settings, models.current, opened);
                        });
                    } else {
                        request = menus::show_programs(ui, settings, models.current, opened);
                    }
                    ui.menu_button(say::window_layouts().text(language), |ui| {
                        request = menus::show_appearance(ui, settings, models).or(request.take());
                    });
                    ui.menu_button(say::window_views().text(language), |ui| {
                        request = menus::show_views(ui, settings).or(request.take());
                    });
                    if !models.current.is_main() {
                        let name = RichText::new(models.current.name().text(language))
                            .color(theme::WARNING);
                        ui.label(name)
                            .on_hover_text(say::model_is_on(models.current.name()).text(language));
                    }
                    if let Some(opened) = opened {
                        let name = opened.file_name().unwrap_or_default().to_string_lossy();
                        let name = RichText::new(name.as_ref()).color(theme::NOTE_TEXT);
                        let width = (menu_right - ui.cursor().left()).max(MIN_FILE_NAME_WIDTH);
                        ui.scope(|ui| {
                            ui.set_max_width(width);
                            ui.add(Label::new(name).truncate())
                                .on_hover_text(opened.display().to_string());
                        });
                    }
                });
                focus::scroll_to_focus(ui);
            });
        right_aligned::show(ui, RIGHT_GROUP, 320.0, |ui| {
            if imposed != ForcedState::default() {
                request = show_imposed_sign(ui, language, imposed, &is_open).or(request.take());
            }
            if snapshot.is_some_and(PanelSnapshot::is_at_practice_machine) {
                let exercise = snapshot.and_then(|it| it.exercise.as_ref());
                let is_shown =
                    layouts.is_open(ViewId::Lesson) && !layouts.is_covered(ViewId::Lesson);
                request = show_practice_sign(ui, language, exercise, is_shown).or(request.take());
            }
            if let Some(picture) = snapshot {
                request = show_speeds(ui, language, picture).or(request.take());
            }
            request = show_help_buttons(ui, language, models.current).or(request.take());
        });
    });
    request
}

/// Draws the buttons for help, key map and language. Returns the request of the clicked one,
/// if any.
fn show_help_buttons(ui: &mut Ui, language: Language, model: ModelId) -> Option<TopBarRequest> {
    let mut request = None;
    let width = match model.is_main() {
        true => NAMED_BUTTONS_WIDTH,
        false => NAMED_BUTTONS_WIDTH_WITH_MODEL,
    };
    let has_names = ui.ctx().content_rect().width() >= width;
    for (icon, name, hint, button_request) in [
        (
            Icon::HELP,
            say::window_help(),
            say::window_help_key(),
            TopBarRequest::Help,
        ),
        (
            Icon::KEYBOARD,
            say::window_keys(),
            say::window_keys_hint(),
            TopBarRequest::ToggleKeyMap,
        ),
        (
            Icon::LANGUAGE,
            say::window_other_language(),
            say::window_other_language_hint(),
            TopBarRequest::SwitchLanguage,
        ),
    ] {
        let button = IconButton {
            icon,
            name: name.text(language),
            hint: hint.text(language),
            is_selected: None,
        };
        if button.show(ui, has_names).clicked() {
            request = Some(button_request);
        }
    }
    request
}

/// Draws the menu of program speeds and returns the request to set one, if any. With a board
/// the speed is fixed.
fn show_speeds(ui: &mut Ui, language: Language, snapshot: &PanelSnapshot) -> Option<TopBarRequest> {
    let name = |speed: RunSpeed| match speed {
        RunSpeed::Percent(percent) => format!("{}x", f64::from(percent) / 100.0),
        RunSpeed::Fastest => say::window_speed_fastest().text(language),
    };
    let has_board = snapshot.board.is_some();
    let chosen = if has_board {
        RunSpeed::REAL
    } else {
        snapshot.speed
    };
    let label = match snapshot.speed_ratio {
        Some(SpeedRatio(times)) => {
            let measured = (times * 100.0).round() / 100.0;
            say::window_speed_now(name(chosen), measured).text(language)
        }
        None => say::window_speed(name(chosen)).text(language),
    };
    // An open menu must not move under the pointer as the figure grows.
    let id = ui.scope_id().with("speed label");
    let shown = Popup::is_any_open(ui.ctx()).then(|| ui.data(|data| data.get_temp(id)));
    let label: String = shown.flatten().unwrap_or(label);
    ui.data_mut(|data| data.insert_temp(id, label.clone()));
    let hint = match has_board {
        true => say::window_speed_of_board(),
        false => say::window_speed_hint(),
    };
    let mut request = None;
    let bar = ui.add_enabled_ui(!has_board, |ui| {
        ui.menu_button(label, |ui| {
            for speed in RunSpeed::CHOICES {
                let entry = egui::Button::selectable(speed == chosen, name(speed));
                if ui.add(entry).clicked() {
                    request = Some(TopBarRequest::Speed(speed));
                    ui.close();
                }
            }
        })
        .response
    });
    let hint = hint.text(language);
    bar.inner.on_hover_text(&hint).on_disabled_hover_text(&hint);
    request
}

/// Draws the sign that the practice machine replaces the learner's machine. Returns the request
/// from its menu; `None` without one.
fn show_practice_sign(
    ui: &mut Ui,
    language: Language,
    exercise: Option<&ExerciseState>,
    is_open: bool,
) -> Option<TopBarRequest> {
    let mut request = None;
    // The panel may cover the task: its time is always visible.
    let words = match exercise.filter(|exercise| !exercise.is_handed_in) {
        Some(exercise) => say::exercise_time_left(exercise.remaining_text()),
        None => say::window_lesson_menu(),
    };
    let text = RichText::new(words.text(language)).color(theme::TEXT_ON_BRIGHT);
    let button = egui::Button::new(text).fill(theme::WARNING);
    egui::containers::menu::MenuButton::from_button(button).ui(ui, |ui| {
        if let Some(exercise) = exercise {
            ui.strong(exercise.title.in_language(language));
        }
        ui.label(say::lesson_practice_hint().text(language));
        let entries = [
            (
                !is_open,
                say::window_lesson_open(),
                TopBarRequest::ToggleLessons,
            ),
            (true, say::lesson_leave(), TopBarRequest::LeaveLesson),
        ];
        for (shown, name, answer) in entries {
            if shown && ui.button(name.text(language)).clicked() {
                request = Some(answer);
                ui.close();
            }
        }
    });
    request
}

/// Draws the sign that bits or inputs are forced or faults are set, even while their view is
/// closed. Its menu opens the view or clears them; returns that request, if any.
fn show_imposed_sign(
    ui: &mut Ui,
    language: Language,
    imposed: ForcedState,
    is_open: &impl Fn(ViewId) -> bool,
) -> Option<TopBarRequest> {
    let forced = imposed.forced_bits + imposed.forced_inputs;
    let mut labels = Vec::new();
    if forced > 0 {
        labels.push(say::window_forced(forced).text(language));
    }
    if imposed.faults > 0 {
        labels.push(say::window_faults(imposed.faults).text(language));
    }
    let mut request = None;
    let text = RichText::new(labels.join("   ")).color(theme::TEXT_ON_BRIGHT);
    let button = egui::Button::new(text).fill(theme::WARNING);
    egui::containers::menu::MenuButton::from_button(button).ui(ui, |ui| {
        let mut entry = |ui: &mut Ui, words: String, answer: TopBarRequest| {
            if ui.button(words).clicked() {
                request = Some(answer);
                ui.close();
            }
        };
        if imposed.forced_bits > 0 {
            let words = say::window_release_bits(imposed.forced_bits).text(language);
            entry(ui, words, TopBarRequest::ReleaseBits);
        }
        let clearable = imposed.forced_inputs + imposed.faults;
        if clearable > 0 {
            let words = say::window_mend(clearable).text(language);
            entry(ui, words, TopBarRequest::ClearFaults);
        }
        for (view, count) in [
            (ViewId::Ladder, imposed.forced_bits),
            (ViewId::Bench, clearable),
        ] {
            let row = VIEWS.iter().find(|row| row.view == view);
            if let Some(row) = row.filter(|_| count > 0 && !is_open(view)) {
                let words = say::window_open_view((row.name)()).text(language);
                entry(ui, words, TopBarRequest::ToggleView(view));
            }
        }
    });
    request
}

/// Draws a message in the message line, or the hint if there is none.
pub fn show_hint(ui: &mut Ui, hint: &str) {
    ui.horizontal_centered(|ui| {
        let font = egui::TextStyle::Body.resolve(ui.style());
        let label = Label::new(fonts::layout_text(hint, font, theme::HINT_TEXT)).truncate();
        ui.add(label).on_hover_text(hint);
    });
}

/// Indicates that the computer is too slow for the machine: `percent` of its speed is reached.
pub fn show_slow_computer(ui: &mut Ui, percent: u32, language: Language) {
    let text = say::window_slow_computer(percent).text(language);
    let label = ui.label(RichText::new(text).color(theme::WARNING));
    label.on_hover_text(say::window_too_slow(percent).text(language));
}

/// Draws a crash that has stopped the lathe. The button is left of the text, where a long text
/// does not hide it. Returns true when the button is clicked.
pub fn show_crash(ui: &mut Ui, text: &str, language: Language) -> bool {
    ui.horizontal_centered(|ui| {
        let words =
            RichText::new(say::window_free_lathe().text(language)).color(theme::TEXT_ON_BRIGHT);
        let button = ui.add(egui::Button::new(words).fill(theme::WARNING));
        let hint = say::window_free_lathe_hint().text(language);
        let label = Label::new(RichText::new(text).color(theme::ALARM_TEXT)).truncate();
        ui.add(label).on_hover_text(text);
        button.on_hover_text(hint).clicked()
    })
    .inner
}

/// Draws the current alarm on the message line. Its tool tip with cause and remedy is drawn
/// over the LCD, so that it covers no key of the panel.
pub fn show_alarm(ui: &mut Ui, alarm: &Alarm, language: Language, lcd: Option<Rect>) {
    ui.horizontal_centered(|ui| {
        let text = RichText::new(alarm_text::one_line(alarm, language)).color(theme::ALARM_TEXT);
        let label = Label::new(text).truncate().show_tooltip_when_elided(false);
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
                ui.label(alarm_text::with_remedy(alarm, language));
            });
        });
    });
}
