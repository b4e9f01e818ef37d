//! The header line of a view: its name, and icons that dock it, move it to a separate window
//! or close it.

use egui::{
    Align, CornerRadius, Layout, Rect, RichText, Role, Sense, Stroke, StrokeKind, Ui, UiBuilder,
    Vec2, WidgetInfo, pos2, vec2,
};

use crate::theme;
use crate::view::{ViewRow, key_name};
use gsk_messages::{Language, say};

/// Height of the header line of a view, points.
pub const HEIGHT: f32 = 22.0;
/// Side of an icon, points. The constant after it is the size of its clickable area.
const ICON_SIDE: f32 = 10.0;
const ICON_AREA: Vec2 = vec2(28.0, HEIGHT);

/// Whether a view is docked in the main window or in a separate window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewPlacement {
    /// The view is docked in a pane of the main window, on a platform with separate windows.
    Docked,
    /// The view is in a pane of the main window, on a platform without separate windows.
    SingleWindow,
    /// The view is in a separate window, whose frame shows the name and a close button.
    Floating,
}

/// The button that the user has clicked in the header line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeaderAction {
    /// Move the view into the main window.
    Dock,
    /// Move the view into a separate window.
    Float,
    Close,
}

/// Draws the header line of a view. Returns the action of the icon that was clicked; `None` without
/// one.
pub fn show(
    ui: &mut Ui,
    row: &ViewRow,
    language: Language,
    placement: ViewPlacement,
) -> Option<HeaderAction> {
    let size = vec2(ui.available_width(), HEIGHT);
    let (header_rect, _) = ui.allocate_exact_size(size, Sense::HOVER);
    ui.painter()
        .rect_filled(header_rect, 0.0, theme::HEADER_GROUND);
    let icons: &[(HeaderAction, gsk_messages::Message)] = &match placement {
        ViewPlacement::Docked => vec![
            (HeaderAction::Float, say::window_view_float((row.name)())),
            (HeaderAction::Close, say::window_view_close((row.name)())),
        ],
        ViewPlacement::SingleWindow => {
            vec![(HeaderAction::Close, say::window_view_close((row.name)()))]
        }
        ViewPlacement::Floating => vec![(HeaderAction::Dock, say::window_view_dock((row.name)()))],
    };
    let line = header_rect.shrink2(vec2(8.0, 0.0));
    if placement != ViewPlacement::Floating {
        let inside = UiBuilder::new()
            .max_rect(line)
            .layout(Layout::left_to_right(Align::Center));
        ui.scope_builder(inside, |ui| {
            let name = (row.name)().text(language);
            ui.label(RichText::new(name).color(theme::SECONDARY_TEXT));
            if let Some(key) = row.key {
                ui.label(RichText::new(key_name(key)).weak().small());
            }
        });
    }
    let mut action = None;
    for (index, (what, name)) in icons.iter().enumerate() {
        let from_right = (icons.len() - index) as f32;
        let corner = pos2(line.right() - from_right * ICON_AREA.x, line.top());
        let rect = Rect::from_min_size(corner, ICON_AREA);
        if draw_icon(ui, rect, *what, &name.text(language)) {
            action = Some(*what);
        }
    }
    action
}

/// Draws a clickable icon with `name` as its hover text. Returns true if it was clicked.
fn draw_icon(ui: &Ui, rect: Rect, action: HeaderAction, name: &str) -> bool {
    let id = ui.scope_id().with((name, "sign"));
    let response = ui.interact(rect, id, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    if response.has_focus() {
        let line = ui.visuals().widgets.hovered.fg_stroke;
        let mark = rect.shrink2(vec2(1.0, 2.0));
        ui.painter()
            .rect_stroke(mark, 2.0, line, StrokeKind::Inside);
    }
    let ink = if response.hovered() {
        theme::BRIGHT_TEXT
    } else {
        theme::NOTE_TEXT
    };
    let stroke = Stroke::new(1.4, ink);
    let square = Rect::from_center_size(rect.center(), vec2(ICON_SIDE, ICON_SIDE));
    let painter = ui.painter();
    match action {
        HeaderAction::Close => {
            painter.line_segment([square.left_top(), square.right_bottom()], stroke);
            painter.line_segment([square.left_bottom(), square.right_top()], stroke);
        }
        HeaderAction::Float | HeaderAction::Dock => {
            let outer = CornerRadius::same(1);
            painter.rect_stroke(square, outer, stroke, StrokeKind::Inside);
            let half = match action {
                HeaderAction::Float => {
                    Rect::from_min_max(square.center_top(), square.right_center())
                }
                _ => Rect::from_min_max(square.center_top(), square.right_bottom()),
            };
            painter.rect_filled(half, 0.0, ink);
        }
    }
    response.on_hover_text(name).clicked()
}
