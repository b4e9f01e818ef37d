//! The plot of the scope: a lane a quantity, PLC bits below, cursors over all.
//!
//! Every sample counts: where many fall on one column of dots, the least and the
//! greatest of them are drawn.

use egui::epaint::PathShape;
use egui::{
    Align2, Color32, FontId, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2,
};

use super::side::{BIT_COLOUR, CURSOR_COLOURS};
use super::trace::{Quantity, TRACES, Trace};
use super::{BitChannel, Scope};
use crate::cli::Language;
use crate::window::texts::say;

/// Room for the figures of a scale, points.
const GUTTER: f32 = 74.0;
/// Room for the time below, points.
const FOOT: f32 = 24.0;
/// Height of a bit, points.
const BIT: f32 = 24.0;
/// How near the pointer must be to a cursor, points.
const GRIP: f32 = 6.0;

const GRID: Color32 = Color32::from_gray(46);
const ZERO: Color32 = Color32::from_gray(74);
const FRAME: Color32 = Color32::from_gray(84);
const FIGURES: Color32 = Color32::from_gray(160);

/// What a lane shows from bottom to top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    low: f64,
    high: f64,
}

/// What the pointer has taken hold of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drag {
    /// Nothing.
    Nothing,
    /// The picture.
    Time,
    /// A cursor.
    Cursor(usize),
    /// A scale.
    Scale(usize),
}

impl Range {
    /// The least range of a quantity around a value.
    pub fn around(value: f64, quantity: Quantity) -> Self {
        let half = quantity.least_range() / 2.0;
        Self {
            low: value - half,
            high: value + half,
        }
    }

    fn span(self) -> f64 {
        self.high - self.low
    }

    /// The range for values from `low` to `high`: the present one while it fits, so
    /// that the picture stands still.
    fn follow(self, low: f64, high: f64, quantity: Quantity) -> Self {
        let needed = (high - low).max(quantity.least_range());
        let edge = self.span() * 0.04;
        let inside = self.low + edge <= low && self.high - edge >= high;
        let fits = inside && self.span() <= 2.5 * needed;
        if fits {
            return self;
        }
        let middle = f64::midpoint(low, high);
        let half = needed * 0.6;
        let step = nice_step(needed, 4.0);
        Self {
            low: ((middle - half) / step).floor() * step,
            high: ((middle + half) / step).ceil() * step,
        }
    }

    fn zoom(&mut self, factor: f64, at: f64) {
        let fixed = self.low + at * self.span();
        self.low = fixed - (fixed - self.low) * factor;
        self.high = fixed + (self.high - fixed) * factor;
    }

    fn shift(&mut self, share: f64) {
        let way = self.span() * share;
        self.low += way;
        self.high += way;
    }
}

/// A step of 1, 2 or 5 that divides a range into about `parts`.
fn nice_step(range: f64, parts: f64) -> f64 {
    let rough = (range / parts).max(1e-9);
    let ten = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .find(|step| step * ten >= rough * 0.999)
        .unwrap_or(10.0);
    step * ten
}

/// From ticks to dots.
#[derive(Clone, Copy)]
struct Time {
    left: f32,
    right: f32,
    first: u64,
    last: u64,
}

impl Time {
    fn x(self, tick: f64) -> f32 {
        let share = (tick - self.first as f64) / (self.last - self.first).max(1) as f64;
        self.left + (share as f32) * (self.right - self.left)
    }

    fn tick(self, x: f32) -> f64 {
        let share = f64::from((x - self.left) / (self.right - self.left).max(1.0));
        self.first as f64 + share * (self.last - self.first) as f64
    }
}

impl Scope {
    pub(super) fn plot(&mut self, ui: &mut Ui, language: Language) {
        let room = ui.available_rect_before_wrap().shrink2(vec2(6.0, 6.0));
        let response = ui.interact(room, ui.scope_id().with("plot"), Sense::CLICK | Sense::DRAG);
        response.widget_info(|| {
            let name = say(language, "示波图", "Scope picture");
            WidgetInfo::labeled(Role::Canvas, true, name)
        });
        let area = Rect::from_min_max(room.min + vec2(GUTTER, 0.0), room.max - vec2(4.0, FOOT));
        let lanes = self.lanes(area);
        let Some((first, last)) = self.shown() else {
            let words = say(language, "等待采样…", "Waiting for samples …");
            let font = FontId::proportional(15.0);
            ui.painter()
                .text(room.center(), Align2::CENTER_CENTER, words, font, FIGURES);
            return;
        };
        let time = Time {
            left: area.left(),
            right: area.right(),
            first,
            last,
        };
        self.point(ui, &response, area, &lanes, time);
        // The pointer may have moved the picture.
        let (first, last) = self.shown().unwrap_or((first, last));
        let time = Time {
            first,
            last,
            ..time
        };
        self.time_scale(ui, area, time);
        for (lane, place) in &lanes {
            match lane {
                Lane::Quantity(index) => self.lane(ui, *index, *place, time, language),
                Lane::Bit(channel) => self.bit(ui, channel, *place, time),
            }
        }
        self.draw_cursors(ui, area, time);
    }

    /// The lanes that have something to show, from top to bottom.
    fn lanes(&self, area: Rect) -> Vec<(Lane, Rect)> {
        let drawn = |quantity| {
            let shown = TRACES.iter().zip(self.on);
            shown
                .into_iter()
                .any(|(trace, on)| on && trace.quantity == quantity)
        };
        let quantities: Vec<usize> = Quantity::ALL
            .iter()
            .enumerate()
            .filter(|(_, quantity)| drawn(**quantity))
            .map(|(index, _)| index)
            .collect();
        let bits = self.bits.len() as f32 * BIT;
        let height = (area.height() - bits) / quantities.len().max(1) as f32;
        let height = height.max(20.0);
        let mut top = area.top();
        let mut lanes = Vec::new();
        let mut add = |lane, height: f32| {
            let place =
                Rect::from_min_max(pos2(area.left(), top), pos2(area.right(), top + height));
            top += height;
            lanes.push((lane, place.shrink2(vec2(0.0, 3.0))));
        };
        for index in quantities {
            add(Lane::Quantity(index), height);
        }
        for channel in &self.bits {
            add(Lane::Bit(*channel), BIT);
        }
        lanes
    }

    fn time_scale(&self, ui: &Ui, area: Rect, time: Time) {
        let painter = ui.painter();
        let span = (time.last - time.first) as f64 / 1000.0;
        let step = nice_step(span, f64::from(area.width() / 90.0));
        let from = (time.first as f64 - self.origin as f64) / 1000.0;
        let decimals = decimals_of(step);
        let mut count = (from / step).ceil();
        while count * step <= from + span * 1.000_001 {
            let seconds = count * step;
            let x = time.x(self.origin as f64 + seconds * 1000.0);
            let colour = if count == 0.0 { ZERO } else { GRID };
            painter.vline(x, area.y_range(), Stroke::new(1.0, colour));
            let text = format!("{:.decimals$}", seconds + 0.0);
            let at = pos2(x, area.bottom() + 5.0);
            if x < area.right() - 22.0 {
                painter.text(
                    at,
                    Align2::CENTER_TOP,
                    text,
                    FontId::proportional(12.0),
                    FIGURES,
                );
            }
            count += 1.0;
        }
        let at = pos2(area.right(), area.bottom() + 5.0);
        painter.text(
            at,
            Align2::RIGHT_TOP,
            "s",
            FontId::proportional(12.0),
            FIGURES,
        );
    }

    fn lane(&mut self, ui: &Ui, index: usize, place: Rect, time: Time, language: Language) {
        let quantity = Quantity::ALL[index];
        let dots = (place.width() * ui.pixels_per_point()).round().max(1.0);
        let lines: Vec<(&Trace, Pieces)> = TRACES
            .iter()
            .zip(self.on)
            .filter(|(trace, on)| *on && trace.quantity == quantity)
            .map(|(trace, _)| (trace, self.line(trace, time, dots as u64)))
            .collect();
        if self.autoscale {
            let values = lines.iter().flat_map(|(_, line)| line.iter().flatten());
            let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), (_, value)| {
                (low.min(*value), high.max(*value))
            });
            if low <= high {
                self.ranges[index] = self.ranges[index].follow(low, high, quantity);
            }
        }
        let range = self.ranges[index];
        self.scale(ui, place, range);
        let painter = ui.painter().with_clip_rect(place);
        let y = |value: f64| {
            let share = (value - range.low) / range.span();
            place.bottom() - (share.clamp(-2.0, 3.0) as f32) * place.height()
        };
        for (trace, line) in &lines {
            for piece in line {
                let points: Vec<Pos2> = piece
                    .iter()
                    .map(|(tick, value)| pos2(time.x(*tick), y(*value)))
                    .collect();
                let stroke = Stroke::new(1.3, trace.colour());
                painter.add(Shape::Path(PathShape::line(points, stroke)));
            }
        }
        let frame = Stroke::new(1.0, FRAME);
        ui.painter()
            .rect_stroke(place, 0.0, frame, egui::StrokeKind::Inside);
        let name = format!("{}  {}", quantity.name(language), quantity.unit());
        let font = FontId::proportional(13.0);
        let name = ui
            .painter()
            .layout_no_wrap(name, font, Color32::from_gray(205));
        let corner = place.min + vec2(6.0, 3.0);
        let back = Rect::from_min_size(corner, name.size()).expand2(vec2(3.0, 1.0));
        let shade = Color32::from_black_alpha(150);
        ui.painter().rect_filled(back, 2.0, shade);
        ui.painter().galley(corner, name, FIGURES);
    }

    /// The pieces of a trace: at most two values a column of dots.
    fn line(&self, trace: &Trace, time: Time, dots: u64) -> Pieces {
        let mut pieces = Vec::new();
        let Some((record, (oldest, newest))) = self
            .record
            .as_ref()
            .and_then(|record| Some((record, record.ticks()?)))
        else {
            return pieces;
        };
        let (from, to) = (time.first.max(oldest), time.last.min(newest));
        let column = ((time.last - time.first) / dots).max(1);
        let mut piece: Vec<(f64, f64)> = Vec::new();
        let mut tick = from;
        while tick <= to {
            let end = ((tick / column + 1) * column).min(to + 1);
            let values =
                (tick..end).filter_map(|at| Some((at, record.value(trace, at, self.over)?)));
            let (mut least, mut most) = (None, None);
            for (at, value) in values {
                if least.is_none_or(|(_, known)| value < known) {
                    least = Some((at, value));
                }
                if most.is_none_or(|(_, known)| value > known) {
                    most = Some((at, value));
                }
            }
            match (least, most) {
                (Some(least), Some(most)) => {
                    let (first, second) = if least.0 <= most.0 {
                        (least, most)
                    } else {
                        (most, least)
                    };
                    piece.push((first.0 as f64, first.1));
                    if second.0 != first.0 {
                        piece.push((second.0 as f64, second.1));
                    }
                }
                _ if piece.is_empty() => {}
                _ => pieces.push(std::mem::take(&mut piece)),
            }
            tick = end;
        }
        if !piece.is_empty() {
            pieces.push(piece);
        }
        pieces
    }

    fn scale(&self, ui: &Ui, place: Rect, range: Range) {
        let painter = ui.painter();
        let parts = f64::from((place.height() / 30.0).max(1.5));
        let step = nice_step(range.span(), parts);
        let decimals = decimals_of(step);
        let mut count = (range.low / step).ceil();
        while count * step <= range.high {
            let value = count * step;
            let share = ((value - range.low) / range.span()) as f32;
            let y = place.bottom() - share * place.height();
            let colour = if count == 0.0 { ZERO } else { GRID };
            painter.hline(place.x_range(), y, Stroke::new(1.0, colour));
            let text = format!("{:.decimals$}", value + 0.0);
            let y = y.clamp(place.top() + 6.0, place.bottom() - 6.0);
            let at = pos2(place.left() - 6.0, y);
            painter.text(
                at,
                Align2::RIGHT_CENTER,
                text,
                FontId::proportional(12.0),
                FIGURES,
            );
            count += 1.0;
        }
    }

    fn bit(&self, ui: &Ui, channel: &BitChannel, place: Rect, time: Time) {
        let painter = ui.painter();
        let at = pos2(place.left() - 6.0, place.center().y);
        let name = channel.address.to_string();
        painter.text(
            at,
            Align2::RIGHT_CENTER,
            name,
            FontId::monospace(11.5),
            BIT_COLOUR,
        );
        let Some(record) = &self.record else { return };
        let Some((oldest, newest)) = record.ticks() else {
            return;
        };
        let state = |tick| {
            let sample = record.at(tick);
            sample.is_some_and(|sample| sample.bits >> channel.place & 1 == 1)
        };
        let y = |on: bool| {
            if on {
                place.top() + 1.0
            } else {
                place.bottom() - 1.0
            }
        };
        let (from, to) = (time.first.max(oldest), time.last.min(newest));
        if from > to {
            return;
        }
        let mut begun = from;
        let mut points = vec![pos2(time.x(from as f64), y(state(from)))];
        for tick in from + 1..=to {
            if state(tick) == state(begun) {
                continue;
            }
            let x = time.x(tick as f64);
            points.push(pos2(x, y(state(begun))));
            points.push(pos2(x, y(state(tick))));
            self.fill(ui, place, (begun, tick), state(begun), time);
            begun = tick;
        }
        self.fill(ui, place, (begun, to), state(begun), time);
        points.push(pos2(time.x(to as f64), y(state(begun))));
        let stroke = Stroke::new(1.3, BIT_COLOUR);
        painter.add(Shape::Path(PathShape::line(points, stroke)));
    }

    fn fill(&self, ui: &Ui, place: Rect, ticks: (u64, u64), on: bool, time: Time) {
        if on {
            let left = time.x(ticks.0 as f64);
            let right = time.x(ticks.1 as f64);
            let part = Rect::from_x_y_ranges(left..=right, place.y_range());
            let colour = BIT_COLOUR.gamma_multiply(0.25);
            ui.painter().rect_filled(part, 0.0, colour);
        }
    }

    fn draw_cursors(&self, ui: &Ui, area: Rect, time: Time) {
        let Some(cursors) = self.cursors else { return };
        for (place, tick) in cursors.at.iter().enumerate() {
            let x = time.x(*tick as f64);
            if !area.x_range().contains(x) {
                continue;
            }
            let colour = CURSOR_COLOURS[place];
            let width = if place == cursors.active { 1.6 } else { 1.0 };
            ui.painter()
                .vline(x, area.y_range(), Stroke::new(width, colour));
            let name = ["A", "B"][place];
            let flag = Rect::from_center_size(pos2(x, area.bottom() + 11.0), vec2(16.0, 16.0));
            ui.painter().rect_filled(flag, 3.0, colour);
            let font = FontId::proportional(12.0);
            let black = Color32::BLACK;
            ui.painter()
                .text(flag.center(), Align2::CENTER_CENTER, name, font, black);
        }
    }

    /// What mouse and fingers do.
    fn point(
        &mut self,
        ui: &Ui,
        response: &egui::Response,
        area: Rect,
        lanes: &[(Lane, Rect)],
        time: Time,
    ) {
        let scale_at = |at: Pos2| {
            lanes.iter().find_map(|(lane, place)| match lane {
                Lane::Quantity(index) if place.y_range().contains(at.y) => {
                    Some((*index, *place)).filter(|_| at.x < area.left())
                }
                _ => None,
            })
        };
        let cursor_at = |scope: &Self, at: Pos2| {
            let cursors = scope.cursors?;
            let near = |tick: &u64| (time.x(*tick as f64) - at.x).abs() <= GRIP;
            cursors.at.iter().position(near)
        };
        if let Some(at) = response.hover_pos() {
            let icon = if cursor_at(self, at).is_some() {
                Some(egui::CursorIcon::ResizeHorizontal)
            } else if !self.autoscale && scale_at(at).is_some() {
                Some(egui::CursorIcon::ResizeVertical)
            } else {
                None
            };
            if let Some(icon) = icon {
                ui.ctx().set_cursor_icon(icon);
            }
            let scrolled = ui.input(|input| input.smooth_scroll_delta().y);
            let notch = ui.input(|input| wheel_notches(&input.events));
            match scale_at(at) {
                Some((index, place)) if !self.autoscale && scrolled != 0.0 => {
                    let share = f64::from((place.bottom() - at.y) / place.height());
                    let factor = f64::from(scrolled * -0.005).exp();
                    self.ranges[index].zoom(factor, share);
                }
                _ if notch != 0 => {
                    let share = f64::from((at.x - area.left()) / area.width());
                    self.zoom(-notch, share.clamp(0.0, 1.0));
                }
                _ => {}
            }
        }
        let Some(at) = response.interact_pointer_pos() else {
            return;
        };
        if response.drag_started() {
            let from = ui.input(|input| input.pointer.press_origin()).unwrap_or(at);
            self.drag = match (cursor_at(self, from), scale_at(from)) {
                (Some(cursor), _) => Drag::Cursor(cursor),
                (None, Some((index, _))) if !self.autoscale => Drag::Scale(index),
                _ if area.contains(from) => Drag::Time,
                _ => Drag::Nothing,
            };
        }
        let tick = time.tick(at.x).clamp(time.first as f64, time.last as f64);
        if response.clicked() && area.contains(at) {
            self.put_cursor(None, tick.round() as u64);
        }
        if !response.dragged() {
            return;
        }
        let way = response.drag_delta();
        match self.drag {
            Drag::Cursor(cursor) => self.put_cursor(Some(cursor), tick.round() as u64),
            Drag::Time => {
                let ticks = time.tick(area.left() + way.x) - time.first as f64;
                self.pan(ticks.round() as i64);
            }
            Drag::Scale(index) => {
                let lane =
                    |(lane, _): &&(Lane, Rect)| matches!(lane, Lane::Quantity(at) if *at == index);
                let height = lanes
                    .iter()
                    .find(lane)
                    .map_or(100.0, |(_, place)| place.height());
                self.ranges[index].shift(f64::from(way.y / height));
            }
            Drag::Nothing => {}
        }
    }

    /// Puts a cursor, or the active one, on a tick.
    fn put_cursor(&mut self, cursor: Option<usize>, tick: u64) {
        if let Some(cursors) = &mut self.cursors {
            cursors.active = cursor.unwrap_or(cursors.active);
            if let Some(at) = cursors.at.get_mut(cursors.active) {
                *at = tick;
            }
        }
    }
}

/// Lines of ticks and values; one ends where nothing can be said.
type Pieces = Vec<Vec<(f64, f64)>>;

/// Part of the plot.
#[derive(Clone, Copy, Debug)]
enum Lane {
    /// Index in [`Quantity::ALL`].
    Quantity(usize),
    Bit(BitChannel),
}

/// Whole notches of the wheel, so that a span is one notch from the next.
fn wheel_notches(events: &[egui::Event]) -> i32 {
    let way: f32 = events
        .iter()
        .map(|event| match event {
            egui::Event::MouseWheel { delta, .. } => delta.y,
            _ => 0.0,
        })
        .sum();
    if way > 0.0 {
        1
    } else if way < 0.0 {
        -1
    } else {
        0
    }
}

/// Decimals that a step needs.
fn decimals_of(step: f64) -> usize {
    (-step.log10().floor()).clamp(0.0, 6.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round() {
        for (range, parts, step) in [
            (10.0, 5.0, 2.0),
            (1.0, 4.0, 0.5),
            (7.0, 7.0, 1.0),
            (0.03, 3.0, 0.01),
        ] {
            assert!(
                (nice_step(range, parts) - step).abs() < 1e-12,
                "{range} in {parts}"
            );
        }
        assert_eq!(
            (decimals_of(0.05), decimals_of(1.0), decimals_of(200.0)),
            (2, 0, 0)
        );
    }

    #[test]
    fn a_range_stands_still_while_it_fits() {
        let range = Range::around(0.0, Quantity::Speed).follow(-3000.0, 3000.0, Quantity::Speed);
        assert!(range.low <= -3000.0 && range.high >= 3000.0);
        assert_eq!(range.follow(-2800.0, 2900.0, Quantity::Speed), range);
        assert_ne!(range.follow(0.0, 10.0, Quantity::Speed), range);
        assert!(range.follow(0.0, 9000.0, Quantity::Speed).high >= 9000.0);
    }
}
