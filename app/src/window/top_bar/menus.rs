//! Draws the menus of the top bar.

use std::path::PathBuf;

use egui::Ui;
use gsk_core::model::ModelId;
use gsk_messages::{Language, say};

use super::{Asked, ModelChoice};
use crate::platform;
use crate::sound::VOLUMES;
use crate::window::Settings;
use crate::window::layout::LAYOUTS;
use crate::window::samples::SAMPLES;
use crate::window::view::{VIEWS, key_name};
use crate::window::views::project::COMMANDS;
use crate::window::zoom;

/// Draws the entries for programs: open, recent, samples, lessons; and projects.
pub fn programs(ui: &mut Ui, settings: &Settings, opened: Option<&PathBuf>) -> Option<Asked> {
    let language = settings.language;
    let mut asked = None;
    let open = ui.button(say::window_open_program().text(language));
    if open.clicked() {
        asked = Some(Asked::Choose);
    }
    ui.menu_button(say::window_recent().text(language), |ui| {
        if settings.recent.is_empty() {
            ui.label(say::window_recent_empty().text(language));
        }
        for path in &settings.recent {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let entry = ui
                .button(name.as_ref())
                .on_hover_text(path.display().to_string());
            if entry.clicked() {
                asked = Some(Asked::Open(path.clone()));
                ui.close();
            }
        }
    });
    ui.menu_button(say::window_samples().text(language), |ui| {
        for sample in &SAMPLES {
            let shows = sample.shows(language);
            let entry = egui::Button::new(shows).shortcut_text(sample.name);
            if ui.add(entry).clicked() {
                asked = Some(Asked::Sample(sample));
                ui.close();
            }
        }
    });
    if ui.button(say::window_lessons().text(language)).clicked() {
        asked = Some(Asked::Lessons);
    }
    let reload = egui::Button::new(say::window_reload().text(language));
    if ui.add_enabled(opened.is_some(), reload).clicked() {
        asked = opened.cloned().map(Asked::Open);
    }
    if platform::has_folders() {
        ui.menu_button(say::project_menu().text(language), |ui| {
            for (command, name) in COMMANDS {
                if ui.button(name().text(language)).clicked() {
                    asked = Some(Asked::Project(command));
                    ui.close();
                }
            }
        });
    }
    asked
}

/// Draws the entries for the look of the window: layouts, theme, zoom, sound, control model.
pub fn looks(ui: &mut Ui, settings: &Settings, models: &ModelChoice) -> Option<Asked> {
    let language = settings.language;
    let mut asked = None;
    let layout = settings.layouts.current();
    for row in &LAYOUTS {
        let chosen = row.layout == layout;
        let entry = egui::Button::selectable(chosen, (row.name)().text(language))
            .shortcut_text(key_name(row.key));
        if ui.add(entry).clicked() {
            asked = Some(Asked::Layout(row.layout));
            ui.close();
        }
    }
    ui.separator();
    let entry = egui::Button::selectable(settings.light, say::window_light().text(language));
    if ui.add(entry).clicked() {
        asked = Some(Asked::Light);
        ui.close();
    }
    let entry = egui::Button::selectable(settings.fingers, say::window_fingers().text(language));
    let hint = say::window_fingers_hint().text(language);
    if ui.add(entry).on_hover_text(hint).clicked() {
        asked = Some(Asked::Fingers);
        ui.close();
    }
    asked = zooms(ui, language, settings.zoom).or(asked);
    if platform::has_sound() {
        asked = volumes(ui, language, settings.sound).or(asked);
    }
    ui.separator();
    let entry = egui::Button::new(say::window_first_start().text(language));
    let mut entry = ui.add_enabled(models.why_not.is_none(), entry);
    if let Some(why_not) = &models.why_not {
        entry = entry.on_disabled_hover_text(why_not.text(language));
    }
    if entry.clicked() {
        asked = Some(Asked::FirstStart);
        ui.close();
    }
    if models.offered {
        ui.separator();
        asked = models_of(ui, language, models).or(asked);
    }
    asked
}

/// Draws the entries for the views.
pub fn views(ui: &mut Ui, settings: &Settings) -> Option<Asked> {
    let language = settings.language;
    let mut asked = None;
    for row in VIEWS.iter().filter(|row| row.view.is_there()) {
        let open = settings.layouts.is_open(row.view);
        let mut entry = egui::Button::selectable(open, (row.name)().text(language));
        if let Some(key) = row.key {
            entry = entry.shortcut_text(key_name(key));
        }
        if ui.add(entry).clicked() {
            asked = Some(Asked::View(row.view));
            ui.close();
        }
    }
    asked
}

/// Draws the menu of zooms.
fn zooms(ui: &mut Ui, language: Language, chosen: Option<u16>) -> Option<Asked> {
    let mut asked = None;
    ui.menu_button(say::window_zoom().text(language), |ui| {
        let choices = core::iter::once(None).chain(zoom::CHOICES.map(Some));
        for per_cent in choices {
            let name = match per_cent {
                Some(per_cent) => format!("{per_cent} %"),
                None => say::window_zoom_monitor().text(language),
            };
            if ui
                .add(egui::Button::selectable(chosen == per_cent, name))
                .clicked()
            {
                asked = Some(Asked::Zoom(per_cent));
                ui.close();
            }
        }
    });
    asked
}

/// Draws the menu of volumes.
fn volumes(ui: &mut Ui, language: Language, chosen: Option<u8>) -> Option<Asked> {
    let mut asked = None;
    ui.menu_button(say::window_sound().text(language), |ui| {
        for volume in core::iter::once(None).chain(VOLUMES.map(Some)) {
            let name = match volume {
                Some(volume) => format!("{volume} %"),
                None => say::window_sound_off().text(language),
            };
            let entry = egui::Button::selectable(chosen == volume, name);
            if ui.add(entry).clicked() {
                asked = Some(Asked::Sound(volume));
                ui.close();
            }
        }
    });
    asked
}

/// Draws the control models. Another one can be turned on while nothing runs.
fn models_of(ui: &mut Ui, language: Language, models: &ModelChoice) -> Option<Asked> {
    let mut asked = None;
    for id in ModelId::ALL.into_iter().filter(|id| !id.is_mill()) {
        let chosen = id == models.shown;
        let name = say::window_model(id.name()).text(language);
        let enabled = chosen || models.why_not.is_none();
        let mut entry = ui.add_enabled(enabled, egui::Button::selectable(chosen, name));
        if let Some(why_not) = &models.why_not {
            entry = entry.on_disabled_hover_text(why_not.text(language));
        }
        if entry.clicked() {
            asked = (!chosen).then_some(Asked::Model(id));
            ui.close();
        }
    }
    asked
}
