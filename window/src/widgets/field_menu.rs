//! A menu with text fields.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{PopupCloseBehavior, Ui};

/// Draws a menu button whose menu has text fields: a click into it leaves the menu open.
pub fn field_menu(ui: &mut Ui, text: String, content: impl FnOnce(&mut Ui)) {
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    MenuButton::new(text).config(config).ui(ui, content);
}
