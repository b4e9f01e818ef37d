//! The slim bar above the panel and the line of messages below it.

use std::path::PathBuf;

use egui::{Color32, RichText, Ui};

use super::texts::Text;
use super::views::{VIEWS, View, key_name};
use crate::cli::Language;

/// What was asked for in the bar.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Asked {
    /// Choose a program and open it.
    Choose,
    /// Open this program.
    Open(PathBuf),
    /// Open a view, or close it.
    View(View),
    /// Show the key map.
    Keys,
    /// The other language.
    Language,
}

/// Draws the bar.
pub fn show(
    ui: &mut Ui,
    language: Language,
    recent: &[PathBuf],
    opened: Option<&PathBuf>,
    is_open: impl Fn(View) -> bool,
) -> Option<Asked> {
    let mut asked = None;
    ui.horizontal_centered(|ui| {
        if ui.button(Text::Open.of(language)).clicked() {
            asked = Some(Asked::Choose);
        }
        ui.menu_button(Text::Recent.of(language), |ui| {
            if recent.is_empty() {
                ui.label(Text::RecentEmpty.of(language));
            }
            for path in recent {
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
        let reload = egui::Button::new(Text::Reload.of(language));
        if ui.add_enabled(opened.is_some(), reload).clicked() {
            asked = opened.cloned().map(Asked::Open);
        }
        ui.menu_button(Text::Views.of(language), |ui| {
            for row in &VIEWS {
                let entry = egui::Button::selectable(is_open(row.view), row.name.of(language))
                    .shortcut_text(key_name(row));
                if ui.add(entry).clicked() {
                    asked = Some(Asked::View(row.view));
                    ui.close();
                }
            }
        });
        if let Some(opened) = opened {
            let name = opened.file_name().unwrap_or_default().to_string_lossy();
            ui.label(RichText::new(name.as_ref()).color(Color32::from_gray(170)))
                .on_hover_text(opened.display().to_string());
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui.button(Text::Language.of(language)).clicked() {
                asked = Some(Asked::Language);
            }
            if ui.button(Text::Keys.of(language)).clicked() {
                asked = Some(Asked::Keys);
            }
        });
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
        let label = egui::Label::new(RichText::new(text).color(colour)).truncate();
        ui.add(label).on_hover_text(text);
    });
}
