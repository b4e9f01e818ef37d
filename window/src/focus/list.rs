//! A list that is one stop for Tab: the cursor keys move inside it (WINDOW-27).

use egui::style::ScrollAnimation;
use egui::{
    Button, Context, CursorIcon, Id, Key, Label, Rect, Response, RichText, Role, Sense, StrokeKind,
    Ui, WidgetInfo, pos2, vec2,
};

use super::{reserve_cursor_keys, take_keys};

/// Number of rows per page until the list has been drawn.
const DEFAULT_PAGE_ROWS: usize = 10;

/// State of a list that is kept between two frames: cursor and page size.
#[derive(Clone, Copy, Debug, Default)]
struct ListMemory {
    /// Index of the row that has the cursor.
    row: usize,
    /// Number of rows that are visible at a time.
    page_rows: usize,
}

/// A list with keyboard focus whose rows are being drawn.
#[derive(Debug)]
pub struct FocusList {
    id: Id,
    row: usize,
    has_focus: bool,
    has_moved: bool,
    is_entered: bool,
}

impl FocusList {
    /// Starts a list of `count` rows at the next widget position and, with the focus, handles
    /// its keys. `selected_row` is the selected row of a list in which moving the cursor
    /// selects. The caller draws the rows with [`ROW_SENSE`] as their sense, each followed by
    /// [`FocusList::show_cursor`].
    pub fn begin(
        ui: &Ui,
        salt: &str,
        name: &str,
        count: usize,
        selected_row: Option<usize>,
    ) -> Self {
        let id = ui.scope_id().with(salt);
        let mut list = Self {
            id,
            row: 0,
            has_focus: false,
            has_moved: false,
            is_entered: false,
        };
        if count == 0 {
            return list;
        }
        let memory = stored_memory(ui.ctx(), id);
        list.row = selected_row.unwrap_or(memory.row).min(count - 1);
        let bounds = ui.available_rect_before_wrap();
        let response = ui.interact(bounds, id, Sense::focusable_noninteractive());
        response.widget_info(|| WidgetInfo::labeled(Role::ListBox, true, name));
        list.has_focus = response.has_focus();
        if list.has_focus {
            reserve_cursor_keys(ui, id);
            let line = ui.visuals().widgets.hovered.bg_stroke;
            (ui.painter()).rect_stroke(bounds.expand(1.0), 2.0, line, StrokeKind::Inside);
            list.handle_keys(ui, count, memory.page_rows);
        }
        // Scrolls to the cursor when the list gains the focus.
        list.has_moved |= response.gained_focus();
        list.store(ui.ctx(), memory.page_rows);
        list
    }

    /// Handles the keys without modifiers that move the cursor in the list.
    fn handle_keys(&mut self, ui: &Ui, count: usize, page_rows: usize) {
        let page = match page_rows {
            0 => DEFAULT_PAGE_ROWS,
            page => page,
        };
        let (mut row, mut is_entered) = (self.row, false);
        take_keys(ui, |key| {
            let target = match key {
                Key::ArrowUp => row.saturating_sub(1),
                Key::ArrowDown => row + 1,
                Key::PageUp => row.saturating_sub(page),
                Key::PageDown => row + page,
                Key::Home => 0,
                Key::End => count - 1,
                Key::ArrowLeft | Key::ArrowRight => row,
                Key::Enter | Key::Space => {
                    is_entered = true;
                    row
                }
                _ => return false,
            };
            row = target.min(count - 1);
            true
        });
        self.has_moved = row != self.row;
        self.row = row;
        self.is_entered = is_entered;
    }

    /// The row to which the cursor has moved in this frame; `None` if it has not moved.
    pub fn moved_row(&self) -> Option<usize> {
        (self.has_focus && self.has_moved).then_some(self.row)
    }

    /// The row on which Enter or Space was pressed in this frame; `None` without such a key.
    pub fn entered_row(&self) -> Option<usize> {
        (self.has_focus && self.is_entered).then_some(self.row)
    }

    /// Whether the list has the focus and its cursor is on `row`.
    pub const fn is_cursor_on(&self, row: usize) -> bool {
        self.has_focus && self.row == row
    }

    /// Scrolls to the cursor in a list that draws only the visible rows. `first` is the index
    /// of the first of them, `height` the height of a row in points. The caller calls this
    /// before it draws that row.
    pub fn scroll_to_cursor(&self, ui: &Ui, first: usize, height: f32) {
        let pitch = height + ui.spacing().item_spacing.y;
        let visible = ui.clip_rect();
        let page = (visible.height() / pitch).floor() as usize;
        self.store(ui.ctx(), page.saturating_sub(1).max(1));
        if self.has_focus && self.has_moved {
            let top = ui.cursor().top() + (self.row as f32 - first as f32) * pitch;
            let left = visible.left();
            let row = Rect::from_min_size(pos2(left, top), vec2(1.0, height));
            ui.scroll_to_rect_animation(row, None, ScrollAnimation::none());
        }
    }

    /// Marks the row if the cursor is on it, and scrolls to it after a move. Returns true if
    /// the row was clicked.
    pub fn show_cursor(&self, ui: &Ui, row: usize, response: &Response) -> bool {
        if self.is_cursor_on(row) {
            let line = ui.visuals().widgets.hovered.fg_stroke;
            (ui.painter()).rect_stroke(response.rect, 2.0, line, StrokeKind::Inside);
            if self.has_moved {
                let bounds = response.rect.with_max_x(response.rect.left() + 1.0);
                ui.scroll_to_rect_animation(bounds, None, ScrollAnimation::none());
            }
            let active = response.id.accesskit_id();
            ui.ctx()
                .accesskit_node_builder(self.id, |node| node.set_active_descendant(active));
        }
        let clicked = response.clicked();
        if clicked {
            let memory = stored_memory(ui.ctx(), self.id);
            let updated = ListMemory { row, ..memory };
            ui.data_mut(|data| data.insert_temp(self.id, updated));
        }
        clicked
    }

    fn store(&self, context: &Context, page: usize) {
        let memory = ListMemory {
            row: self.row,
            page_rows: page,
        };
        context.data_mut(|data| data.insert_temp(self.id, memory));
    }
}

fn stored_memory(context: &Context, id: Id) -> ListMemory {
    let memory = context.data(|data| data.get_temp(id));
    memory.unwrap_or_default()
}

/// Draws a row as a selectable text and returns its response.
pub fn selectable_row(ui: &mut Ui, is_selected: bool, text: String) -> Response {
    let accessible_label = text.clone();
    let row = ui.add(
        Button::selectable(is_selected, text)
            .truncate()
            .sense(ROW_SENSE),
    );
    row.widget_info(|| {
        WidgetInfo::selected(Role::ListBoxOption, true, is_selected, &accessible_label)
    });
    row
}

/// Draws a row as an underlined link and returns its response.
pub fn link_row(ui: &mut Ui, text: RichText) -> Response {
    let accessible_label = text.text().to_owned();
    let colour = ui.visuals().hyperlink_color;
    let label = Label::new(text.underline()).sense(ROW_SENSE).wrap();
    let row = ui.scope(|ui| {
        ui.visuals_mut().override_text_color = Some(colour);
        ui.add(label)
    });
    let row = row.inner.on_hover_cursor(CursorIcon::PointingHand);
    row.widget_info(|| WidgetInfo::labeled(Role::Link, true, &accessible_label));
    row
}

/// Draws a row as a check box and returns its response.
pub fn check_row(ui: &mut Ui, is_checked: bool, text: &str, height: f32) -> Response {
    let galley = egui::WidgetText::from(text).into_galley(
        ui,
        Some(egui::TextWrapMode::Extend),
        f32::INFINITY,
        egui::TextStyle::Body,
    );
    let spacing = ui.spacing();
    let (side, gap) = (spacing.icon_width, spacing.icon_spacing);
    let size = vec2(side + gap + galley.size().x, height);
    let (bounds, row) = ui.allocate_exact_size(size, ROW_SENSE);
    let is_enabled = ui.is_enabled();
    row.widget_info(|| WidgetInfo::selected(Role::CheckBox, is_enabled, is_checked, text));
    let style = ui.style().interact(&row);
    let middle = pos2(bounds.left() + side / 2.0, bounds.center().y);
    let square = Rect::from_center_size(middle, vec2(side, side)).shrink(1.0);
    let painter = ui.painter();
    painter.rect(
        square,
        2.0,
        style.bg_fill,
        style.bg_stroke,
        StrokeKind::Inside,
    );
    if is_checked {
        let inner = square.shrink(3.0);
        let corners = [
            pos2(inner.left(), inner.center().y),
            pos2(inner.center().x, inner.bottom()),
            pos2(inner.right(), inner.top()),
        ];
        painter.line(corners.to_vec(), style.fg_stroke);
    }
    let top = bounds.center().y - galley.size().y / 2.0;
    let left = bounds.left() + side + gap;
    painter.galley(pos2(left, top), galley, style.text_color());
    row
}

/// The sense of a row: it reacts to clicks and is not a Tab stop.
pub const ROW_SENSE: Sense = Sense::CLICK;
