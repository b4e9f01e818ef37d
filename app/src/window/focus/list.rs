//! A list that is one stop for Tab: the cursor keys move inside it (WINDOW-27).

use egui::style::ScrollAnimation;
use egui::{
    Button, Context, CursorIcon, Id, Key, Label, Rect, Response, RichText, Role, Sense, StrokeKind,
    Ui, WidgetInfo, pos2, vec2,
};

use super::{keep_keys, take_keys};

/// Rows per page before the list has been drawn.
const PAGE: usize = 10;

/// State of a list that is kept between frames.
#[derive(Clone, Copy, Debug, Default)]
struct Remembered {
    /// The row with the cursor.
    at: usize,
    /// Count of visible rows.
    page: usize,
}

/// A list whose rows are being drawn.
#[derive(Debug)]
pub struct List {
    id: Id,
    at: usize,
    focused: bool,
    moved: bool,
    entered: bool,
}

impl List {
    /// Starts a list of `count` rows at the next widget position and, with the focus, handles
    /// its keys. `chosen` is the selected row of a list in which moving selects. Draw the rows
    /// with [`ROW`] as their sense, each followed by [`List::row`].
    pub fn begin(ui: &Ui, salt: &str, name: &str, count: usize, chosen: Option<usize>) -> Self {
        let id = ui.scope_id().with(salt);
        let mut list = Self {
            id,
            at: 0,
            focused: false,
            moved: false,
            entered: false,
        };
        if count == 0 {
            return list;
        }
        let before = remembered(ui.ctx(), id);
        list.at = chosen.unwrap_or(before.at).min(count - 1);
        let place = ui.available_rect_before_wrap();
        let response = ui.interact(place, id, Sense::focusable_noninteractive());
        response.widget_info(|| WidgetInfo::labeled(Role::ListBox, true, name));
        list.focused = response.has_focus();
        if list.focused {
            keep_keys(ui, id);
            let line = ui.visuals().widgets.hovered.bg_stroke;
            (ui.painter()).rect_stroke(place.expand(1.0), 2.0, line, StrokeKind::Inside);
            list.keys(ui, count, before.page);
        }
        // Scrolls to the cursor when the list gains the focus.
        list.moved |= response.gained_focus();
        list.remember(ui.ctx(), before.page);
        list
    }

    /// Handles the keys without modifiers that move in the list.
    fn keys(&mut self, ui: &Ui, count: usize, page: usize) {
        let page = match page {
            0 => PAGE,
            page => page,
        };
        let (mut at, mut entered) = (self.at, false);
        take_keys(ui, |key| {
            let to = match key {
                Key::ArrowUp => at.saturating_sub(1),
                Key::ArrowDown => at + 1,
                Key::PageUp => at.saturating_sub(page),
                Key::PageDown => at + page,
                Key::Home => 0,
                Key::End => count - 1,
                Key::ArrowLeft | Key::ArrowRight => at,
                Key::Enter | Key::Space => {
                    entered = true;
                    at
                }
                _ => return false,
            };
            at = to.min(count - 1);
            true
        });
        self.moved = at != self.at;
        self.at = at;
        self.entered = entered;
    }

    /// The row to which the cursor has moved in this frame.
    pub fn moved(&self) -> Option<usize> {
        (self.focused && self.moved).then_some(self.at)
    }

    /// The row on which Enter or Space was pressed in this frame.
    pub fn entered(&self) -> Option<usize> {
        (self.focused && self.entered).then_some(self.at)
    }

    /// Whether the list has the focus and its cursor is on `row`.
    pub const fn is_at(&self, row: usize) -> bool {
        self.focused && self.at == row
    }

    /// Scrolls to the cursor in a list that draws only the visible rows. `first` is the first
    /// of them, `height` the height of a row in points. Call it before `first` is drawn.
    pub fn follow(&self, ui: &Ui, first: usize, height: f32) {
        let pitch = height + ui.spacing().item_spacing.y;
        let room = ui.clip_rect();
        let page = (room.height() / pitch).floor() as usize;
        self.remember(ui.ctx(), page.saturating_sub(1).max(1));
        if self.focused && self.moved {
            let top = ui.cursor().top() + (self.at as f32 - first as f32) * pitch;
            let left = room.left();
            let row = Rect::from_min_size(pos2(left, top), vec2(1.0, height));
            ui.scroll_to_rect_animation(row, None, ScrollAnimation::none());
        }
    }

    /// Marks the row if the cursor is on it, and scrolls to it after a move. Returns whether
    /// the row was clicked.
    pub fn row(&self, ui: &Ui, row: usize, response: &Response) -> bool {
        if self.is_at(row) {
            let line = ui.visuals().widgets.hovered.fg_stroke;
            (ui.painter()).rect_stroke(response.rect, 2.0, line, StrokeKind::Inside);
            if self.moved {
                let place = response.rect.with_max_x(response.rect.left() + 1.0);
                ui.scroll_to_rect_animation(place, None, ScrollAnimation::none());
            }
            let active = response.id.accesskit_id();
            ui.ctx()
                .accesskit_node_builder(self.id, |node| node.set_active_descendant(active));
        }
        let clicked = response.clicked();
        if clicked {
            let before = remembered(ui.ctx(), self.id);
            let at = Remembered { at: row, ..before };
            ui.data_mut(|data| data.insert_temp(self.id, at));
        }
        clicked
    }

    fn remember(&self, context: &Context, page: usize) {
        let own = Remembered { at: self.at, page };
        context.data_mut(|data| data.insert_temp(self.id, own));
    }
}

fn remembered(context: &Context, id: Id) -> Remembered {
    let own = context.data(|data| data.get_temp(id));
    own.unwrap_or_default()
}

/// Draws a row as a selectable text.
pub fn row(ui: &mut Ui, chosen: bool, words: String) -> Response {
    let said = words.clone();
    let row = ui.add(Button::selectable(chosen, words).truncate().sense(ROW));
    row.widget_info(|| WidgetInfo::selected(Role::ListBoxOption, true, chosen, &said));
    row
}

/// Draws a row as an underlined link.
pub fn link(ui: &mut Ui, words: RichText) -> Response {
    let said = words.text().to_owned();
    let colour = ui.visuals().hyperlink_color;
    let label = Label::new(words.underline()).sense(ROW).wrap();
    let row = ui.scope(|ui| {
        ui.visuals_mut().override_text_color = Some(colour);
        ui.add(label)
    });
    let row = row.inner.on_hover_cursor(CursorIcon::PointingHand);
    row.widget_info(|| WidgetInfo::labeled(Role::Link, true, &said));
    row
}

/// Draws a row as a check box.
pub fn tick(ui: &mut Ui, ticked: bool, words: &str, height: f32) -> Response {
    let galley = egui::WidgetText::from(words).into_galley(
        ui,
        Some(egui::TextWrapMode::Extend),
        f32::INFINITY,
        egui::TextStyle::Body,
    );
    let spacing = ui.spacing();
    let (side, gap) = (spacing.icon_width, spacing.icon_spacing);
    let size = vec2(side + gap + galley.size().x, height);
    let (place, row) = ui.allocate_exact_size(size, ROW);
    let is_enabled = ui.is_enabled();
    row.widget_info(|| WidgetInfo::selected(Role::CheckBox, is_enabled, ticked, words));
    let style = ui.style().interact(&row);
    let middle = pos2(place.left() + side / 2.0, place.center().y);
    let square = Rect::from_center_size(middle, vec2(side, side)).shrink(1.0);
    let painter = ui.painter();
    painter.rect(
        square,
        2.0,
        style.bg_fill,
        style.bg_stroke,
        StrokeKind::Inside,
    );
    if ticked {
        let inner = square.shrink(3.0);
        let corners = [
            pos2(inner.left(), inner.center().y),
            pos2(inner.center().x, inner.bottom()),
            pos2(inner.right(), inner.top()),
        ];
        painter.line(corners.to_vec(), style.fg_stroke);
    }
    let top = place.center().y - galley.size().y / 2.0;
    let left = place.left() + side + gap;
    painter.galley(pos2(left, top), galley, style.text_color());
    row
}

/// The sense of a row: it reacts to clicks and is no Tab stop.
pub const ROW: Sense = Sense::CLICK;
