//! Icons of the Phosphor set, and buttons that show them. A group of buttons shows the names
//! beside the icons where the row is wide enough; otherwise the tool tips show them.

use egui::{
    Align2, Color32, FontFamily, FontId, Painter, Pos2, Response, Role, Sense, StrokeKind,
    TextStyle, Ui, WidgetInfo, vec2,
};

use crate::theme;

/// The icon font, whose characters are the icons.
pub static FONT: &[u8] = include_bytes!("../../../assets/fonts/icons.ttf");
/// Name of the font family of the icons.
pub const FAMILY: &str = "icons";

/// Height of a button with an icon, points.
const BUTTON_HEIGHT: f32 = 21.0;
/// Space between the edge of a button and its icon, points.
const BUTTON_MARGIN: f32 = 5.0;
/// Space between an icon and its name, points.
const NAME_SPACE: f32 = 4.0;
/// Radius of the corners of a button, points.
const CORNER_RADIUS: f32 = 4.0;

/// An icon: a character of the icon font.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Icon(char);

impl Icon {
    pub const FIT: Self = Self('\u{E0A2}');
    pub const SECTION: Self = Self('\u{EB16}');
    pub const SOLID: Self = Self('\u{E1DA}');
    pub const FOLLOW: Self = Self('\u{E1D6}');
    pub const STOCK: Self = Self('\u{E8FC}');
    pub const CRASH_STOP: Self = Self('\u{E57E}');
    pub const PATH: Self = Self('\u{E39C}');
    pub const MEASURE: Self = Self('\u{E6B8}');
    pub const COMPARE: Self = Self('\u{E882}');
    pub const TOOLS: Self = Self('\u{E5D4}');
    pub const HELP: Self = Self('\u{E3E8}');
    pub const KEYBOARD: Self = Self('\u{E2D8}');
    pub const LANGUAGE: Self = Self('\u{E4A2}');
    pub const SAMPLE: Self = Self('\u{E3D0}');
    pub const LESSON: Self = Self('\u{E62C}');
    pub const BOOK: Self = Self('\u{E0E6}');
    pub const WARNING: Self = Self('\u{E4E0}');
    pub const CODE: Self = Self('\u{E914}');
    pub const SCREEN: Self = Self('\u{E6D6}');
    pub const PARAMETER: Self = Self('\u{E628}');
    pub const SIGNAL: Self = Self('\u{E464}');
    pub const EXPORT: Self = Self('\u{EAF0}');
    pub const PAUSE: Self = Self('\u{E39E}');
    pub const DONE: Self = Self('\u{E184}');

    /// Draws the icon at its centre. `size` is its height, points.
    pub fn paint(self, painter: &Painter, center: Pos2, size: f32, color: Color32) {
        painter.text(center, Align2::CENTER_CENTER, self.0, font_id(size), color);
    }
}

fn font_id(size: f32) -> FontId {
    FontId::new(size, FontFamily::Name(FAMILY.into()))
}

/// A button with an icon, its name and its tool tip.
#[derive(Clone, Debug)]
pub struct IconButton {
    pub icon: Icon,
    pub name: String,
    /// Explanation under the name in the tool tip; may be empty.
    pub hint: String,
    /// Whether the button shows a state that is on; `None` for a button that acts once.
    pub is_selected: Option<bool>,
}

impl IconButton {
    /// Width of the button with or without its name, points.
    pub fn width(&self, ui: &Ui, has_name: bool) -> f32 {
        let icon = 2.0 * BUTTON_MARGIN + theme::ICON_SIZE;
        if !has_name {
            return icon;
        }
        let font = TextStyle::Button.resolve(ui.style());
        let galley = ui
            .painter()
            .layout_no_wrap(self.name.clone(), font, theme::TEXT);
        icon + NAME_SPACE + galley.size().x
    }

    /// Draws the button. `has_name`: the name is visible beside the icon.
    pub fn show(&self, ui: &mut Ui, has_name: bool) -> Response {
        let size = vec2(self.width(ui, has_name), BUTTON_HEIGHT);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click());
        let is_on = self.is_selected == Some(true);
        response.widget_info(|| match self.is_selected {
            Some(is_on) => WidgetInfo::selected(Role::Button, ui.is_enabled(), is_on, &self.name),
            None => WidgetInfo::labeled(Role::Button, ui.is_enabled(), &self.name),
        });
        let visuals = ui.style().interact_selectable(&response, is_on);
        let painter = ui.painter();
        if is_on || response.hovered() || response.has_focus() {
            painter.rect_filled(rect, CORNER_RADIUS, visuals.weak_bg_fill);
        }
        if response.has_focus() {
            let stroke = ui.visuals().widgets.hovered.fg_stroke;
            painter.rect_stroke(rect, CORNER_RADIUS, stroke, StrokeKind::Inside);
        }
        let color = match (is_on, response.hovered()) {
            (true, _) => theme::ACCENT,
            (false, true) => theme::BRIGHT_TEXT,
            (false, false) => theme::TEXT,
        };
        let at = rect.left_center() + vec2(BUTTON_MARGIN + theme::ICON_SIZE / 2.0, 0.0);
        self.icon.paint(painter, at, theme::ICON_SIZE, color);
        if has_name {
            let at = at + vec2(theme::ICON_SIZE / 2.0 + NAME_SPACE, 0.0);
            let font = TextStyle::Button.resolve(ui.style());
            painter.text(at, Align2::LEFT_CENTER, &self.name, font, color);
        }
        response.on_hover_ui(|ui| {
            ui.strong(&self.name);
            if !self.hint.is_empty() {
                ui.label(&self.hint);
            }
        })
    }
}

/// The width that buttons with these words take in a row, points.
pub fn word_buttons_width(ui: &Ui, words: &[String]) -> f32 {
    let font = TextStyle::Button.resolve(ui.style());
    let spacing = ui.spacing();
    let around = 2.0 * spacing.button_padding.x + spacing.item_spacing.x;
    let width = |word: &String| {
        let text = ui
            .painter()
            .layout_no_wrap(word.clone(), font.clone(), theme::TEXT);
        text.size().x + around
    };
    words.iter().map(width).sum()
}

/// Draws groups of buttons in one row, with a line between two groups. The names are visible
/// if all of them fit into the row, beside other buttons of the width `beside`. Returns the group
/// and the position of the button that was clicked, if any.
pub fn show_groups(ui: &mut Ui, groups: &[Vec<IconButton>], beside: f32) -> Option<(usize, usize)> {
    let space = ui.spacing().item_spacing.x;
    let line_width = 6.0 + space;
    let width = |has_names: bool| {
        let buttons = groups.iter().flatten();
        let buttons: f32 = buttons.map(|it| it.width(ui, has_names) + 2.0).sum();
        buttons + groups.len() as f32 * line_width
    };
    let has_names = width(true) + beside <= ui.available_width();
    let mut clicked = None;
    ui.horizontal(|ui| {
        for (group_index, group) in groups.iter().enumerate() {
            if group_index > 0 {
                ui.separator();
            }
            ui.spacing_mut().item_spacing.x = 2.0;
            for (index, button) in group.iter().enumerate() {
                if button.show(ui, has_names).clicked() {
                    clicked = Some((group_index, index));
                }
            }
            ui.spacing_mut().item_spacing.x = space;
        }
    });
    clicked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_font_has_every_icon() {
        let source = include_str!("icons.rs");
        let codes = source.split(r"Self('\u{").skip(1);
        let codes = codes.filter_map(|rest| rest.split_once('}'));
        let codes: Vec<u32> = codes
            .filter_map(|(code, _)| u32::from_str_radix(code, 16).ok())
            .collect();
        assert!(codes.len() > 10);
        let context = egui::Context::default();
        crate::fonts::set_up(&context);
        let mut missing = Vec::new();
        let mut output = context.run_ui(egui::RawInput::default(), |ui| {
            ui.ctx().fonts_mut(|fonts| {
                let is_missing = |code: &u32| {
                    let icon = char::from_u32(*code);
                    icon.is_none_or(|icon| !fonts.has_glyph(&font_id(theme::ICON_SIZE), icon))
                };
                missing = codes.iter().copied().filter(is_missing).collect();
            });
        });
        output.textures_delta.clear();
        assert!(missing.is_empty(), "{missing:x?}: run tools/icons.py");
    }
}
