//! The band of the time line: draws the marks and the handle, and follows pointer and keys.

use egui::{
    Color32, Key, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, StrokeKind, Ui,
    WidgetInfo, pos2, vec2,
};
use gsk_host::kernel::timeline::{TimelineMark, TimelineMarkKind, TimelineView};
use gsk_messages::{Language, Message, say};
use gsk_runner::text_format::format_whole_seconds as clock;

use super::{BAND_HEIGHT, SECOND_TICKS, to_seconds};
use crate::widgets::key_label::key_label;
use crate::{focus, theme};

/// Number of seconds by which a page key moves the handle of the time line.
const PAGE_SECONDS: u64 = 10;
/// Distance at which the pointer is on a mark, points.
const MARK_DISTANCE: f32 = 4.0;
/// Number of different lengths with which marks are drawn.
const LEVELS: usize = 5;

/// The state of the time line's band between two frames.
#[derive(Debug, Default)]
pub(super) struct Band {
    /// The tick to which the pointer has dragged the handle; `None` while it does not drag.
    dragged_to: Option<u64>,
    /// Whether the pointer has given the band the focus, until the present is shown again.
    has_pointer_focus: bool,
}

/// Converts ticks to horizontal positions on the time line.
#[derive(Clone, Copy)]
struct Scale {
    bounds: Rect,
    first: u64,
    last: u64,
}

impl Scale {
    fn x(self, tick: u64) -> f32 {
        let length = self.last.saturating_sub(self.first).max(1);
        let share = tick.saturating_sub(self.first) as f32 / length as f32;
        self.bounds.left() + share.min(1.0) * self.bounds.width()
    }

    fn tick(self, x: f32) -> u64 {
        let share = ((x - self.bounds.left()) / self.bounds.width()).clamp(0.0, 1.0);
        let length = self.last.saturating_sub(self.first);
        self.first + (f64::from(share) * length as f64).round() as u64
    }
}

impl Band {
    /// Draws the session from the tick `first` of `(view, first)` and the handle at the tick
    /// `shown`. Returns the tick to which the operator has moved the handle; `None` if he has
    /// not.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        width: f32,
        (view, first): (&TimelineView, u64),
        shown: u64,
        language: Language,
    ) -> Option<u64> {
        let sense = Sense::CLICK | Sense::DRAG | Sense::FOCUSABLE;
        let (bounds, response) = ui.allocate_exact_size(vec2(width, BAND_HEIGHT), sense);
        let time = time_text(view, shown);
        response.widget_info(|| {
            let name = say::timeline_name().text(language);
            let mut info = WidgetInfo::labeled(Role::Slider, true, name);
            info.current_text_value = Some(time.text(language));
            info.value = Some(to_seconds(shown));
            info
        });
        let scale = Scale {
            bounds: bounds.shrink2(vec2(3.0, 0.0)),
            first,
            last: view.end,
        };
        draw(ui, scale, view, shown, &response);
        let moved = self
            .follow_pointer(&response, scale, shown)
            .or_else(|| follow_keys(ui, &response, view, shown));
        let hint = hint_at_pointer(&response, scale, view, language);
        response.on_hover_ui_at_pointer(|ui| {
            if let Some(hint) = hint {
                ui.label(hint.text(language));
            }
            ui.weak(say::timeline_band_hint().text(language));
        });
        moved
    }

    fn follow_pointer(&mut self, response: &Response, scale: Scale, shown: u64) -> Option<u64> {
        // In the present the cursor keys stay with the panel (WINDOW-28).
        if self.has_pointer_focus && shown >= scale.last && !response.dragged() {
            self.has_pointer_focus = false;
            response.surrender_focus();
        }
        let is_moved = response.dragged() || response.clicked();
        let position = response.interact_pointer_pos().filter(|_| is_moved);
        let Some(position) = position else {
            self.dragged_to = None;
            return None;
        };
        let tick = scale.tick(position.x);
        if tick < scale.last && !response.has_focus() {
            self.has_pointer_focus = true;
            response.request_focus();
        }
        (self.dragged_to.replace(tick) != Some(tick)).then_some(tick)
    }
}

/// Handles the keys of the focused band. Returns the tick to which they move the handle.
fn follow_keys(ui: &Ui, response: &Response, view: &TimelineView, shown: u64) -> Option<u64> {
    if !response.has_focus() {
        return None;
    }
    focus::reserve_cursor_keys(ui, response.id);
    let mut tick = shown;
    let mut is_moved = false;
    focus::take_keys(ui, |key| {
        let marks = || view.marks.iter().map(|mark| mark.tick);
        let target = match key {
            Key::ArrowLeft => tick.saturating_sub(SECOND_TICKS),
            Key::ArrowRight => tick + SECOND_TICKS,
            Key::PageUp => tick.saturating_sub(PAGE_SECONDS * SECOND_TICKS),
            Key::PageDown => tick + PAGE_SECONDS * SECOND_TICKS,
            Key::ArrowUp => marks().rfind(|mark| *mark < tick).unwrap_or(view.start),
            Key::ArrowDown => marks().find(|mark| *mark > tick).unwrap_or(view.end),
            Key::Home => view.start,
            Key::End => view.end,
            _ => return false,
        };
        tick = target.clamp(view.start, view.end);
        is_moved = true;
        true
    });
    is_moved.then_some(tick)
}

fn draw(ui: &Ui, scale: Scale, view: &TimelineView, shown: u64, response: &Response) {
    let painter = ui.painter_at(response.rect.expand(2.0));
    let bounds = response.rect;
    painter.rect_filled(bounds, 2.0, theme::TIMELINE_GROUND);
    draw_marks(&painter, scale, &view.marks);
    if let Some((from, _)) = view.branch.filter(|(from, _)| *from >= scale.first) {
        let x = scale.x(from);
        let line = [pos2(x, bounds.top()), pos2(x, bounds.bottom())];
        let stroke = Stroke::new(1.5, theme::TIMELINE_BRANCH);
        painter.extend(Shape::dashed_line(&line, stroke, 3.0, 2.0));
    }
    let x = scale.x(shown);
    if shown < view.end {
        let later = Rect::from_min_max(pos2(x, bounds.top()), bounds.max);
        painter.rect_filled(later, 0.0, theme::TIMELINE_LATER_SHADE);
    }
    painter.vline(
        x,
        bounds.y_range(),
        Stroke::new(2.0, theme::TIMELINE_HANDLE),
    );
    let grip = [
        pos2(x - 5.0, bounds.top()),
        pos2(x + 5.0, bounds.top()),
        pos2(x, bounds.top() + 7.0),
    ];
    painter.add(Shape::convex_polygon(
        grip.to_vec(),
        theme::TIMELINE_HANDLE,
        Stroke::NONE,
    ));
    let frame = match response.has_focus() {
        true => ui.visuals().widgets.hovered.fg_stroke,
        false => Stroke::new(1.0, theme::SPLITTER),
    };
    painter.rect_stroke(bounds, 2.0, frame, StrokeKind::Inside);
}

/// Draws the marks from the most frequent to the rarest kind, one per kind and pixel.
fn draw_marks(painter: &Painter, scale: Scale, marks: &[TimelineMark]) {
    let bottom = scale.bounds.bottom() - 1.0;
    for level in 0..LEVELS {
        let mut last_x = f32::MIN;
        for mark in marks.iter().filter(|mark| mark.tick >= scale.first) {
            let (own_level, height, color) = style_of_mark(mark.kind);
            let x = scale.x(mark.tick);
            if own_level != level || x < last_x + 1.0 {
                continue;
            }
            last_x = x;
            let stroke = Stroke::new(if level < 3 { 1.0 } else { 2.0 }, color);
            let length = height * (BAND_HEIGHT - 2.0);
            painter.vline(x, bottom - length..=bottom, stroke);
            if mark.kind == TimelineMarkKind::Collision {
                painter.circle_filled(Pos2::new(x, bottom - length), 3.0, color);
            }
        }
    }
}

/// Returns the order, the share of the band's height and the colour of a mark.
const fn style_of_mark(kind: TimelineMarkKind) -> (usize, f32, Color32) {
    match kind {
        TimelineMarkKind::Block => (0, 0.35, theme::TIMELINE_BLOCK),
        TimelineMarkKind::Input => (1, 0.55, theme::TIMELINE_INPUT),
        TimelineMarkKind::Key(_) => (2, 0.55, theme::TIMELINE_KEY),
        TimelineMarkKind::Collision => (3, 0.75, theme::TIMELINE_COLLISION),
        TimelineMarkKind::Alarm(_) => (4, 1.0, theme::TIMELINE_ALARM),
    }
}

fn mark_text(kind: TimelineMarkKind, language: Language) -> Message {
    match kind {
        TimelineMarkKind::Block => say::timeline_mark_block(),
        TimelineMarkKind::Input => say::timeline_mark_input(),
        TimelineMarkKind::Key(key) => say::timeline_mark_key(key_label(key, language)),
        TimelineMarkKind::Collision => say::timeline_mark_collision(),
        TimelineMarkKind::Alarm(number) => say::timeline_mark_alarm(number),
    }
}

/// Returns the time of a tick, seen from the present.
fn time_text(view: &TimelineView, tick: u64) -> Message {
    match view.end.saturating_sub(tick) {
        0 => say::timeline_at_present(),
        age => say::timeline_before(clock(to_seconds(age))),
    }
}

/// Returns the time at the pointer, with the rarest mark there.
fn hint_at_pointer(
    response: &Response,
    scale: Scale,
    view: &TimelineView,
    language: Language,
) -> Option<Message> {
    let x = response.hover_pos()?.x;
    let is_near = |tick: u64| tick >= scale.first && (scale.x(tick) - x).abs() <= MARK_DISTANCE;
    let time = time_text(view, scale.tick(x));
    if view.branch.is_some_and(|(from, _)| is_near(from)) {
        return Some(say::timeline_mark(time, say::timeline_mark_branch()));
    }
    let near = view.marks.iter().filter(|mark| is_near(mark.tick));
    let rarest = near.max_by_key(|mark| style_of_mark(mark.kind).0);
    Some(match rarest {
        Some(mark) => {
            say::timeline_mark(time_text(view, mark.tick), mark_text(mark.kind, language))
        }
        None => time,
    })
}
