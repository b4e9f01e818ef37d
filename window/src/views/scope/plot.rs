//! The plot of the scope: a lane for each quantity, PLC bits below, cursors over all.
//!
//! Every sample counts: where one column of pixels has several, their least and greatest value
//! are drawn.

use egui::epaint::PathShape;
use egui::{Align2, FontId, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::scale::{LaneRange, round_step, step_decimals};
use super::trace::{Quantity, TRACES, Trace};
use super::{BitChannel, Scope};
use crate::theme;
use gsk_messages::{Language, say};

/// Width of the column for the numbers of a scale, points.
const SCALE_WIDTH: f32 = 74.0;
/// Height of the row for the numbers of the time axis, points.
const TIME_HEIGHT: f32 = 24.0;
/// Height of the lane in which a bit is drawn, points.
const BIT_HEIGHT: f32 = 24.0;

/// Height of the name of a lane above its curves, points.
const NAME_HEIGHT: f32 = 17.0;
/// Width of the column for the names of low lanes, points.
const NAME_WIDTH: f32 = 84.0;
/// Height of a lane below which its name is beside its scale: the curves would be too flat, points.
const MIN_NAMED_LANE_HEIGHT: f32 = 38.0;

/// Converts ticks to x coordinates in the window and back.
#[derive(Clone, Copy)]
pub struct TimeScale {
    left: f32,
    right: f32,
    /// First tick that the picture shows.
    pub first_tick: u64,
    /// Last tick that the picture shows.
    pub last_tick: u64,
}

impl TimeScale {
    /// Returns the x coordinate of a tick, points.
    pub fn to_x(self, tick: f64) -> f32 {
        let share =
            (tick - self.first_tick as f64) / (self.last_tick - self.first_tick).max(1) as f64;
        self.left + (share as f32) * (self.right - self.left)
    }

    /// Returns the tick at an x coordinate, points.
    pub fn to_tick(self, x: f32) -> f64 {
        let share = f64::from((x - self.left) / (self.right - self.left).max(1.0));
        self.first_tick as f64 + share * (self.last_tick - self.first_tick) as f64
    }
}

impl Scope {
    pub(super) fn show_plot(&mut self, ui: &mut Ui, language: Language) {
        let plot_rect = ui.available_rect_before_wrap().shrink2(vec2(6.0, 6.0));
        let response = ui.interact(
            plot_rect,
            ui.scope_id().with("plot"),
            Sense::CLICK | Sense::DRAG,
        );
        response.widget_info(|| {
            let name = say::scope_picture().text(language);
            WidgetInfo::labeled(Role::Canvas, true, name)
        });
        let quantities = self.drawn_quantities();
        let lane_height = self.lane_height(plot_rect.height() - TIME_HEIGHT, quantities.len());
        let is_name_above = lane_height >= MIN_NAMED_LANE_HEIGHT;
        let names_width = if is_name_above { 0.0 } else { NAME_WIDTH };
        let area = Rect::from_min_max(
            plot_rect.min + vec2(names_width + SCALE_WIDTH, 0.0),
            plot_rect.max - vec2(4.0, TIME_HEIGHT),
        );
        let lanes = self.layout_lanes(area, &quantities, lane_height);
        let Some((first, last)) = self.visible_ticks() else {
            let words = say::scope_waits_for_samples().text(language);
            let font = FontId::proportional(theme::READING_SIZE);
            ui.painter().text(
                plot_rect.center(),
                Align2::CENTER_CENTER,
                words,
                font,
                theme::SCALE_TEXT,
            );
            return;
        };
        let time = TimeScale {
            left: area.left(),
            right: area.right(),
            first_tick: first,
            last_tick: last,
        };
        self.handle_pointer(ui, &response, area, &lanes, time);
        // The pointer may have moved the picture.
        let (first, last) = self.visible_ticks().unwrap_or((first, last));
        let time = TimeScale {
            first_tick: first,
            last_tick: last,
            ..time
        };
        self.draw_time_scale(ui, area, time);
        for (lane, place) in &lanes {
            match lane {
                Lane::Quantity(index) => {
                    self.draw_lane(ui, *index, (*place, is_name_above), time, language);
                }
                Lane::Bit(channel) => self.draw_bit_lane(ui, channel, *place, time),
            }
        }
        self.draw_cursors(ui, area, time);
    }

    /// The indices of the quantities that have traces, from top to bottom.
    fn drawn_quantities(&self) -> Vec<usize> {
        let drawn = |quantity| {
            let shown = TRACES.iter().zip(self.trace_enabled);
            shown
                .into_iter()
                .any(|(trace, on)| on && trace.quantity == quantity)
        };
        Quantity::ALL
            .iter()
            .enumerate()
            .filter(|(_, quantity)| drawn(**quantity))
            .map(|(index, _)| index)
            .collect()
    }

    /// The height of each of `count` lanes of quantities in a plot of this height, points.
    fn lane_height(&self, plot_height: f32, count: usize) -> f32 {
        let bits = self.bit_channels.len() as f32 * BIT_HEIGHT;
        ((plot_height - bits) / count.max(1) as f32).max(20.0)
    }

    /// The lanes from top to bottom, each with the rectangle of its curves. High lanes leave space
    /// for the names above the curves.
    fn layout_lanes(&self, area: Rect, quantities: &[usize], height: f32) -> Vec<(Lane, Rect)> {
        let mut top = area.top();
        let mut lanes = Vec::new();
        let mut add = |lane, height: f32| {
            let place =
                Rect::from_min_max(pos2(area.left(), top), pos2(area.right(), top + height));
            top += height;
            lanes.push((lane, place.shrink2(vec2(0.0, 3.0))));
        };
        for index in quantities {
            add(Lane::Quantity(*index), height);
        }
        for channel in &self.bit_channels {
            add(Lane::Bit(*channel), BIT_HEIGHT);
        }
        for (lane, place) in &mut lanes {
            if matches!(lane, Lane::Quantity(_)) {
                place.min.y += match height >= MIN_NAMED_LANE_HEIGHT {
                    true => NAME_HEIGHT,
                    false => 0.0,
                };
            }
        }
        lanes
    }

    fn draw_time_scale(&self, ui: &Ui, area: Rect, time: TimeScale) {
        let painter = ui.painter();
        let span = (time.last_tick - time.first_tick) as f64 / 1000.0;
        let step = round_step(span, f64::from(area.width() / 90.0));
        let from = (time.first_tick as f64 - self.origin_tick as f64) / 1000.0;
        let decimals = step_decimals(step);
        let mut count = (from / step).ceil();
        while count * step <= from + span * 1.000_001 {
            let seconds = count * step;
            let x = time.to_x(self.origin_tick as f64 + seconds * 1000.0);
            let colour = if count == 0.0 {
                theme::SCOPE_ZERO_LINE
            } else {
                theme::SCOPE_GRID
            };
            painter.vline(x, area.y_range(), Stroke::new(1.0, colour));
            let text = format!("{:.decimals$}", seconds + 0.0);
            let at = pos2(x, area.bottom() + 5.0);
            if x < area.right() - 22.0 {
                painter.text(
                    at,
                    Align2::CENTER_TOP,
                    text,
                    FontId::proportional(theme::ANNOTATION_SIZE),
                    theme::SCALE_TEXT,
                );
            }
            count += 1.0;
        }
        let at = pos2(area.right(), area.bottom() + 5.0);
        painter.text(
            at,
            Align2::RIGHT_TOP,
            "s",
            FontId::proportional(theme::ANNOTATION_SIZE),
            theme::SCALE_TEXT,
        );
    }

    fn draw_lane(
        &mut self,
        ui: &Ui,
        index: usize,
        (rect, is_name_above): (Rect, bool),
        time: TimeScale,
        language: Language,
    ) {
        let quantity = Quantity::ALL[index];
        let dots = (rect.width() * ui.pixels_per_point()).round().max(1.0);
        let lines: Vec<(&Trace, TraceLines)> = TRACES
            .iter()
            .zip(self.trace_enabled)
            .filter(|(trace, on)| *on && trace.quantity == quantity)
            .map(|(trace, _)| (trace, self.trace_lines(trace, time, dots as u64)))
            .collect();
        if self.autoscale {
            let values = lines.iter().flat_map(|(_, line)| line.iter().flatten());
            let (low, high) = values.fold((f64::MAX, f64::MIN), |(low, high), (_, value)| {
                (low.min(*value), high.max(*value))
            });
            if low <= high {
                self.ranges[index] = self.ranges[index].fit_values(low, high, quantity);
            }
        }
        let range = self.ranges[index];
        self.draw_value_scale(ui, rect, range);
        let painter = ui.painter().with_clip_rect(rect);
        let y = |value: f64| {
            let share = (value - range.low) / range.span();
            rect.bottom() - (share.clamp(-2.0, 3.0) as f32) * rect.height()
        };
        for (trace, line) in &lines {
            for polyline in line {
                let points: Vec<Pos2> = polyline
                    .iter()
                    .map(|(tick, value)| pos2(time.to_x(*tick), y(*value)))
                    .collect();
                let stroke = Stroke::new(1.3, trace.colour());
                painter.add(Shape::Path(PathShape::line(points, stroke)));
            }
        }
        let frame = Stroke::new(1.0, theme::SCOPE_FRAME);
        ui.painter()
            .rect_stroke(rect, 0.0, frame, egui::StrokeKind::Inside);
        let (name, size, anchor, at) = if is_name_above {
            let at = rect.min + vec2(2.0, -NAME_HEIGHT);
            let name = quantity.heading(language);
            (name, theme::LABEL_SIZE, Align2::LEFT_TOP, at)
        } else {
            let at = rect.left_center() - vec2(SCALE_WIDTH + NAME_WIDTH, 0.0);
            let name = quantity.name(language);
            (name, theme::ANNOTATION_SIZE, Align2::LEFT_CENTER, at)
        };
        let font = FontId::proportional(size);
        let colour = theme::SCOPE_LANE_TEXT;
        ui.painter().text(at, anchor, name, font, colour);
    }

    /// The connected lines that draw a trace, with at most two values per column of pixels.
    fn trace_lines(&self, trace: &Trace, time: TimeScale, dots: u64) -> TraceLines {
        let mut lines = Vec::new();
        let Some((record, (oldest, newest))) = self
            .record
            .as_ref()
            .and_then(|record| Some((record, record.tick_range()?)))
        else {
            return lines;
        };
        let (from, to) = (time.first_tick.max(oldest), time.last_tick.min(newest));
        let column = ((time.last_tick - time.first_tick) / dots).max(1);
        let mut line: Vec<(f64, f64)> = Vec::new();
        let mut tick = from;
        while tick <= to {
            let end = ((tick / column + 1) * column).min(to + 1);
            let values = (tick..end)
                .filter_map(|at| Some((at, record.trace_value(trace, at, self.average_ticks)?)));
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
                    line.push((first.0 as f64, first.1));
                    if second.0 != first.0 {
                        line.push((second.0 as f64, second.1));
                    }
                }
                _ if line.is_empty() => {}
                _ => lines.push(std::mem::take(&mut line)),
            }
            tick = end;
        }
        if !line.is_empty() {
            lines.push(line);
        }
        lines
    }

    fn draw_value_scale(&self, ui: &Ui, rect: Rect, range: LaneRange) {
        let painter = ui.painter();
        let parts = f64::from((rect.height() / 30.0).max(1.5));
        let step = round_step(range.span(), parts);
        let decimals = step_decimals(step);
        let mut count = (range.low / step).ceil();
        let mut figure_below = f32::INFINITY;
        while count * step <= range.high {
            let value = count * step;
            let share = ((value - range.low) / range.span()) as f32;
            let y = rect.bottom() - share * rect.height();
            let colour = if count == 0.0 {
                theme::SCOPE_ZERO_LINE
            } else {
                theme::SCOPE_GRID
            };
            painter.hline(rect.x_range(), y, Stroke::new(1.0, colour));
            let text = format!("{:.decimals$}", value + 0.0);
            let y = y.clamp(rect.top() + 6.0, rect.bottom() - 6.0);
            // A low lane has no room for each figure.
            if figure_below - y >= theme::ANNOTATION_SIZE {
                figure_below = y;
                painter.text(
                    pos2(rect.left() - 6.0, y),
                    Align2::RIGHT_CENTER,
                    text,
                    FontId::proportional(theme::ANNOTATION_SIZE),
                    theme::SCALE_TEXT,
                );
            }
            count += 1.0;
        }
    }

    fn draw_bit_lane(&self, ui: &Ui, channel: &BitChannel, rect: Rect, time: TimeScale) {
        let painter = ui.painter();
        let at = pos2(rect.left() - 6.0, rect.center().y);
        let name = channel.address.to_string();
        painter.text(
            at,
            Align2::RIGHT_CENTER,
            name,
            FontId::monospace(theme::BIT_NAME_SIZE),
            theme::SCOPE_BIT,
        );
        let Some(record) = &self.record else { return };
        let Some((oldest, newest)) = record.tick_range() else {
            return;
        };
        let state = |tick| {
            let sample = record.sample_at(tick);
            sample.is_some_and(|sample| sample.bits >> channel.bit_index & 1 == 1)
        };
        let y = |on: bool| {
            if on {
                rect.top() + 1.0
            } else {
                rect.bottom() - 1.0
            }
        };
        let (from, to) = (time.first_tick.max(oldest), time.last_tick.min(newest));
        if from > to {
            return;
        }
        let mut level_start = from;
        let mut points = vec![pos2(time.to_x(from as f64), y(state(from)))];
        for tick in from + 1..=to {
            if state(tick) == state(level_start) {
                continue;
            }
            let x = time.to_x(tick as f64);
            points.push(pos2(x, y(state(level_start))));
            points.push(pos2(x, y(state(tick))));
            self.fill_bit(ui, rect, (level_start, tick), state(level_start), time);
            level_start = tick;
        }
        self.fill_bit(ui, rect, (level_start, to), state(level_start), time);
        points.push(pos2(time.to_x(to as f64), y(state(level_start))));
        let stroke = Stroke::new(1.3, theme::SCOPE_BIT);
        painter.add(Shape::Path(PathShape::line(points, stroke)));
    }

    fn fill_bit(&self, ui: &Ui, rect: Rect, ticks: (u64, u64), on: bool, time: TimeScale) {
        if on {
            let left = time.to_x(ticks.0 as f64);
            let right = time.to_x(ticks.1 as f64);
            let part = Rect::from_x_y_ranges(left..=right, rect.y_range());
            let colour = theme::scope_bit_ground();
            ui.painter().rect_filled(part, 0.0, colour);
        }
    }

    fn draw_cursors(&self, ui: &Ui, area: Rect, time: TimeScale) {
        let Some(cursors) = self.cursors else { return };
        for (place, tick) in cursors.ticks.iter().enumerate() {
            let x = time.to_x(*tick as f64);
            if !area.x_range().contains(x) {
                continue;
            }
            let colour = theme::SCOPE_CURSORS[place];
            let width = if place == cursors.active { 1.6 } else { 1.0 };
            ui.painter()
                .vline(x, area.y_range(), Stroke::new(width, colour));
            let name = ["A", "B"][place];
            let flag = Rect::from_center_size(pos2(x, area.bottom() + 11.0), vec2(16.0, 16.0));
            ui.painter().rect_filled(flag, 3.0, colour);
            let font = FontId::proportional(theme::ANNOTATION_SIZE);
            let black = theme::TEXT_ON_BRIGHT;
            ui.painter()
                .text(flag.center(), Align2::CENTER_CENTER, name, font, black);
        }
    }
}

/// Connected lines, each a list of ticks and values. A line ends where the trace has no value.
type TraceLines = Vec<Vec<(f64, f64)>>;

/// A lane of the plot: a quantity or a bit.
#[derive(Clone, Copy, Debug)]
pub enum Lane {
    /// The lane of the quantity with this index in [`Quantity::ALL`].
    Quantity(usize),
    Bit(BitChannel),
}
