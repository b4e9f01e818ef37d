//! Draws the menus of the top bar.

use std::path::PathBuf;

use egui::Ui;
use gsk_core::model::ModelId;
use gsk_host::platform;
use gsk_host::sound::VOLUMES;
use gsk_messages::{Language, say};

use super::{ModelChoice, TopBarRequest};
use crate::WindowSettings;
use crate::chrome::zoom;
use crate::layout::LAYOUTS;
use crate::samples::samples_of;
use crate::view::{VIEWS, ViewId, key_name};
use crate::views::project::COMMANDS;

/// Draws the menu entries for programs (open, recent, samples, lessons) and projects. Returns the
/// request of the chosen one; `None` without one.
pub fn show_programs(
    ui: &mut Ui,
    settings: &WindowSettings,
    model: ModelId,
    opened: Option<&PathBuf>,
) -> Option<TopBarRequest> {
    let language = settings.language;
    let mut request = None;
    let open = ui.button(say::window_open_program().text(language));
    if open.clicked() {
        request = Some(TopBarRequest::ChooseProgram);
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
                request = Some(TopBarRequest::Open(path.clone()));
                ui.close();
            }
        }
    });
    ui.menu_button(say::window_samples().text(language), |ui| {
        for sample in samples_of(model) {
            let description = sample.description_text(language);
            let entry = egui::Button::new(description).shortcut_text(sample.name);
            if ui.add(entry).clicked() {
                request = Some(TopBarRequest::Sample(sample));
                ui.close();
            }
        }
    });
    // It switches the view, unlike the menus beside it.
    let is_open = settings.layouts.is_open(ViewId::Lesson);
    let lessons = egui::Button::new(say::window_lessons().text(language)).selected(is_open);
    if ui.add(lessons).clicked() {
        request = Some(TopBarRequest::ToggleLessons);
    }
    let reload = egui::Button::new(say::window_reload().text(language));
    if ui.add_enabled(opened.is_some(), reload).clicked() {
        request = opened.cloned().map(TopBarRequest::Open);
    }
    if platform::has_folders() {
        ui.menu_button(say::project_menu().text(language), |ui| {
            for (command, name) in COMMANDS {
                if ui.button(name().text(language)).clicked() {
                    request = Some(TopBarRequest::Project(command));
                    ui.close();
                }
            }
        });
    }
    request
}

/// Draws the menu entries for the look of the window: layouts, theme, zoom, sound, control model.
/// Returns the request of the chosen one; `None` without one.
pub fn show_appearance(
    ui: &mut Ui,
    settings: &WindowSettings,
    models: &ModelChoice,
) -> Option<TopBarRequest> {
    let language = settings.language;
    let mut request = None;
    let layout = settings.layouts.current();
    for row in &LAYOUTS {
        let chosen = row.layout == layout;
        let mut entry = egui::Button::selectable(chosen, (row.name)().text(language));
        if let Some(key) = row.key {
            entry = entry.shortcut_text(key_name(key));
        }
        if ui.add(entry).clicked() {
            request = Some(TopBarRequest::Layout(row.layout));
            ui.close();
        }
    }
    ui.separator();
    let entry = egui::Button::selectable(settings.light, say::window_light().text(language));
    if ui.add(entry).clicked() {
        request = Some(TopBarRequest::ToggleLight);
        ui.close();
    }
    let entry = egui::Button::selectable(settings.fingers, say::window_fingers().text(language));
    let hint = say::window_fingers_hint().text(language);
    if ui.add(entry).on_hover_text(hint).clicked() {
        request = Some(TopBarRequest::ToggleFingers);
        ui.close();
    }
    request = show_zooms(ui, language, settings.zoom).or(request);
    if platform::has_sound() {
        request = show_volumes(ui, language, settings.sound).or(request);
    }
    ui.separator();
    let entry = egui::Button::new(say::window_first_start().text(language));
    let mut entry = ui.add_enabled(models.refusal.is_none(), entry);
    if let Some(refusal) = &models.refusal {
        entry = entry.on_disabled_hover_text(refusal.text(language));
    }
    if entry.clicked() {
        request = Some(TopBarRequest::FirstStart);
        ui.close();
    }
    if models.is_offered {
        ui.separator();
        request = show_models(ui, language, models).or(request);
    }
    request
}

/// Draws the menu entries that open and close views. Returns the request of the chosen one; `None`
/// without one.
pub fn show_views(ui: &mut Ui, settings: &WindowSettings) -> Option<TopBarRequest> {
    let language = settings.language;
    let mut request = None;
    for row in VIEWS.iter().filter(|row| row.view.is_available()) {
        let open = settings.layouts.is_open(row.view);
        let mut entry = egui::Button::selectable(open, (row.name)().text(language));
        if let Some(key) = row.key {
            entry = entry.shortcut_text(key_name(key));
        }
        if ui.add(entry).clicked() {
            request = Some(TopBarRequest::ToggleView(row.view));
            ui.close();
        }
    }
    ui.separator();
    let entry = egui::Button::selectable(settings.timeline, say::timeline_name().text(language));
    let hint = say::timeline_menu_hint().text(language);
    if ui.add(entry).on_hover_text(hint).clicked() {
        request = Some(TopBarRequest::ToggleTimeline);
        ui.close();
    }
    // A page in a browser cannot open connections.
    if platform::has_folders() && ui.button(say::network_menu().text(language)).clicked() {
        request = Some(TopBarRequest::ToggleNetwork);
        ui.close();
    }
    request
}

/// Draws the menu of zooms; `chosen` is the current one, per cent. Returns the request to set
/// another; `None` without one.
fn show_zooms(ui: &mut Ui, language: Language, chosen: Option<u16>) -> Option<TopBarRequest> {
    let mut request = None;
    ui.menu_button(say::window_zoom().text(language), |ui| {
        let choices = core::iter::once(None).chain(zoom::ZOOM_CHOICES.map(Some));
        for per_cent in choices {
            let name = match per_cent {
                Some(per_cent) => format!("{per_cent} %"),
                None => say::window_zoom_monitor().text(language),
            };
            if ui
                .add(egui::Button::selectable(chosen == per_cent, name))
                .clicked()
            {
                request = Some(TopBarRequest::Zoom(per_cent));
                ui.close();
            }
        }
    });
    request
}

/// Draws the menu of volumes; `chosen` is the current one, per cent. Returns the request to set
/// another; `None` without one.
fn show_volumes(ui: &mut Ui, language: Language, chosen: Option<u8>) -> Option<TopBarRequest> {
    let mut request = None;
    ui.menu_button(say::window_sound().text(language), |ui| {
        for volume in core::iter::once(None).chain(VOLUMES.map(Some)) {
            let name = match volume {
                Some(volume) => format!("{volume} %"),
                None => say::window_sound_off().text(language),
            };
            let entry = egui::Button::selectable(chosen == volume, name);
            if ui.add(entry).clicked() {
                request = Some(TopBarRequest::Sound(volume));
                ui.close();
            }
        }
    });
    request
}

/// Draws the menu of control models. Another model can be turned on while nothing runs. Returns
/// that request; `None` without one.
fn show_models(ui: &mut Ui, language: Language, models: &ModelChoice) -> Option<TopBarRequest> {
    let mut request = None;
    for id in ModelId::ALL.into_iter().filter(|id| !id.is_mill()) {
        let chosen = id == models.current;
        let name = say::window_model(id.name()).text(language);
        let enabled = chosen || models.refusal.is_none();
        let mut entry = ui.add_enabled(enabled, egui::Button::selectable(chosen, name));
        if let Some(refusal) = &models.refusal {
            entry = entry.on_disabled_hover_text(refusal.text(language));
        }
        if entry.clicked() {
            request = (!chosen).then_some(TopBarRequest::Model(id));
            ui.close();
        }
    }
    request
}
