//! Mouse and touch input on the plot: moves cursors, time and scales.

use egui::{Pos2, Rect, Ui};

use super::Scope;
use super::plot::{Lane, TimeScale};

/// Maximum distance of the pointer from a cursor to grab it, points.
const CURSOR_REACH: f32 = 6.0;

/// The item that a drag of the pointer moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drag {
    Nothing,
    /// The drag moves the picture along the time axis.
    Time,
    /// The drag moves the cursor with this index, 0 or 1.
    Cursor(usize),
    /// The scale of the quantity with this index in [`Quantity::ALL`].
    Scale(usize),
}

impl Scope {
    /// Handles the mouse and touch input on the plot.
    pub(super) fn handle_pointer(
        &mut self,
        ui: &Ui,
        response: &egui::Response,
        area: Rect,
        lanes: &[(Lane, Rect)],
        time: TimeScale,
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
            let near = |tick: &u64| (time.to_x(*tick as f64) - at.x).abs() <= CURSOR_REACH;
            cursors.ticks.iter().position(near)
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
                    self.zoom_time(-notch, share.clamp(0.0, 1.0));
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
        let tick = time
            .to_tick(at.x)
            .clamp(time.first_tick as f64, time.last_tick as f64);
        if response.clicked() && area.contains(at) {
            self.move_cursor_to(None, tick.round() as u64);
        }
        if !response.dragged() {
            return;
        }
        let delta = response.drag_delta();
        match self.drag {
            Drag::Cursor(cursor) => self.move_cursor_to(Some(cursor), tick.round() as u64),
            Drag::Time => {
                let ticks = time.to_tick(area.left() + delta.x) - time.first_tick as f64;
                self.pan_time(ticks.round() as i64);
            }
            Drag::Scale(index) => {
                let lane =
                    |(lane, _): &&(Lane, Rect)| matches!(lane, Lane::Quantity(at) if *at == index);
                let height = lanes
                    .iter()
                    .find(lane)
                    .map_or(100.0, |(_, place)| place.height());
                self.ranges[index].shift(f64::from(delta.y / height));
            }
            Drag::Nothing => {}
        }
    }

    /// Moves the cursor with this index to a tick; `None` moves the active one.
    fn move_cursor_to(&mut self, cursor: Option<usize>, tick: u64) {
        if let Some(cursors) = &mut self.cursors {
            cursors.active = cursor.unwrap_or(cursors.active);
            if let Some(at) = cursors.ticks.get_mut(cursors.active) {
                *at = tick;
            }
        }
    }
}

/// Direction in which the wheel has turned, 1, 0 or -1: each notch changes the span by one
/// step.
fn wheel_notches(events: &[egui::Event]) -> i32 {
    let scrolled: f32 = events
        .iter()
        .map(|event| match event {
            egui::Event::MouseWheel { delta, .. } => delta.y,
            _ => 0.0,
        })
        .sum();
    if scrolled > 0.0 {
        1
    } else if scrolled < 0.0 {
        -1
    } else {
        0
    }
}
