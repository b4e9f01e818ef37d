//! The watched values of the program view: a menu that adds and removes them, and their values
//! above the text.

use egui::{RichText, Ui};
use gsk_debugger::watch::WatchTarget;
use gsk_host::kernel::{Command, Console, WatchReading};
use gsk_messages::{Language, say};

use super::list_entry::{EntryTexts, ListEntry, MENU_WIDTH};
use crate::theme;
use crate::widgets::field_menu::field_menu;

/// The values that the operator watches.
pub struct WatchList {
    console: Console,
    targets: Vec<WatchTarget>,
    /// The names of the values, for the settings.
    names: Vec<String>,
    readings: Vec<WatchReading>,
    entry: ListEntry,
}

impl WatchList {
    /// Creates the list of the last session. A name that is not one is dropped.
    pub fn new(console: Console, names: &[String]) -> Self {
        let targets = names
            .iter()
            .filter_map(|name| WatchTarget::parse(name).ok());
        let mut list = Self {
            console,
            targets: targets.collect(),
            names: Vec::new(),
            readings: Vec::new(),
            entry: ListEntry::default(),
        };
        if !list.targets.is_empty() {
            list.send();
        }
        list
    }

    /// The names of the values.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Stores the newest values.
    pub fn take_readings(&mut self, readings: &[WatchReading]) {
        if self.readings != readings {
            readings.clone_into(&mut self.readings);
        }
    }

    fn send(&mut self) {
        let names = self.targets.iter().map(|target| target.name().to_owned());
        self.names = names.collect();
        self.console.send(Command::Watch(self.targets.clone()));
    }

    /// Draws the menu with the list of values and the field for another one.
    pub fn show_menu(&mut self, ui: &mut Ui, language: Language) {
        let name = say::watch_menu(self.targets.len()).text(language);
        field_menu(ui, name, |ui| {
            ui.set_min_width(MENU_WIDTH);
            let mut removed = None;
            for (index, target) in self.targets.iter().enumerate() {
                ui.horizontal(|ui| {
                    let remove = say::watch_remove(target.name()).text(language);
                    if ui.small_button("✕").on_hover_text(remove).clicked() {
                        removed = Some(index);
                    }
                    ui.monospace(target.name());
                });
            }
            if let Some(index) = removed {
                self.targets.remove(index);
                self.send();
            }
            let texts = EntryTexts {
                examples: "#100, X, Y1.2, T1.X",
                hint: say::watch_entry_hint(),
                add: say::watch_add(),
            };
            if let Some(target) = self.entry.show(ui, language, &texts, WatchTarget::parse) {
                self.targets.push(target);
                self.send();
            }
        });
    }

    /// Draws the values, if any is watched.
    pub fn show_values(&self, ui: &mut Ui, language: Language) {
        if self.targets.is_empty() {
            return;
        }
        ui.horizontal_wrapped(|ui| {
            for WatchReading { name, value } in &self.readings {
                match value {
                    Ok(value) => ui.monospace(format!("{name} = {value}")),
                    Err(why) => {
                        let text = format!("{name}: {}", why.text(language));
                        ui.label(RichText::new(text).color(theme::CODE_ALARM_TEXT))
                    }
                };
            }
        });
    }
}
