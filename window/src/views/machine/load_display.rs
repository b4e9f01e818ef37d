//! Shows the load of the program: a bar over its time, and the path coloured by force.

use std::sync::Arc;

use egui::{Painter, Rect, RichText, Role, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};
use gsk_messages::{Language, say};
use gsk_runner::text_format::format_whole_seconds as clock;
use gsk_workpiece::job::Job;

use super::camera::Camera;
use super::load_curve::{LoadCurve, LoadMoment};
use super::path::{DrawnPath, SegmentKind};
use crate::theme;

/// Number of columns of the bar.
const COLUMN_COUNT: usize = 300;
/// Height of the bar, points.
const BAR_HEIGHT: f32 = 28.0;
/// Width of the coloured path, points.
const PATH_WIDTH: f32 = 2.5;

/// The load on the screen, and the switch that shows it.
#[derive(Default)]
pub struct LoadDisplay {
    /// Whether the load is shown.
    pub is_shown: bool,
    /// Whether a cut above the limits breaks something.
    pub breaks_on_overload: bool,
    curve: Option<Arc<LoadCurve>>,
    /// Path and job for which the curve was requested last.
    requested: Option<(Arc<DrawnPath>, Arc<Job>)>,
    /// The heaviest moment of each column of the bar.
    columns: Vec<Option<LoadMoment>>,
    /// The coloured path, and what it was made for.
    drawn_for: Option<(Camera, Arc<DrawnPath>)>,
    shapes: Vec<Shape>,
}

impl LoadDisplay {
    /// Whether the load of a path and a job must be requested. Records the request.
    pub fn needs_curve(&mut self, path: &Arc<DrawnPath>, job: &Arc<Job>) -> bool {
        let last = self.requested.as_ref();
        let is_same = |(of, with): &(Arc<DrawnPath>, Arc<Job>)| {
            Arc::ptr_eq(of, path) && Arc::ptr_eq(with, job)
        };
        if !self.is_shown || path.is_partial || last.is_some_and(is_same) {
            return false;
        }
        self.requested = Some((Arc::clone(path), Arc::clone(job)));
        true
    }

    /// Stores a curve that the background thread has finished.
    pub fn set_curve(&mut self, curve: Arc<LoadCurve>) {
        self.curve = Some(curve);
        self.columns.clear();
        self.drawn_for = None;
    }

    /// Discards the curve, because another program is shown.
    pub fn clear(&mut self) {
        self.curve = None;
        self.requested = None;
        self.columns.clear();
        self.drawn_for = None;
    }

    /// Draws the bar under the time bar. `total_s` is the machine time of the program, s, and
    /// `now` the share of it that has passed; `None` while no program runs.
    pub fn show_bar(&mut self, ui: &mut Ui, total_s: f32, now: Option<f32>, language: Language) {
        if !self.is_shown || total_s <= 0.0 {
            return;
        }
        let Some(curve) = self.curve.clone() else {
            // The load of a path that ends at the limit of the work is never requested.
            if self.requested.is_none() {
                return;
            }
            let words = say::lathe_load_pending().text(language);
            ui.label(RichText::new(words).color(theme::STATE_TEXT));
            return;
        };
        if self.columns.is_empty() {
            let width_s = total_s / COLUMN_COUNT as f32;
            let column = |index| {
                let from_s = index as f32 * width_s;
                curve.heaviest(from_s, from_s + width_s)
            };
            self.columns = (0..COLUMN_COUNT).map(column).collect();
        }
        let size = vec2(ui.available_width(), BAR_HEIGHT);
        let (rect, response) = ui.allocate_exact_size(size, Sense::HOVER);
        response.widget_info(|| {
            let name = say::lathe_load_bar().text(language);
            WidgetInfo::labeled(Role::ProgressIndicator, true, name)
        });
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, theme::time_column(theme::DWELL));
        let width = rect.width() / COLUMN_COUNT as f32;
        for (index, moment) in self.columns.iter().enumerate() {
            let Some(moment) = moment else { continue };
            let left = rect.left() + index as f32 * width;
            let top = rect.bottom() - curve.share(*moment) * rect.height();
            let column =
                Rect::from_min_max(pos2(left, top), pos2(left + width + 0.5, rect.bottom()));
            painter.rect_filled(column, 0.0, color_of(&curve, *moment));
        }
        if let Some(now) = now {
            let x = rect.left() + now * rect.width();
            painter.vline(x, rect.y_range(), Stroke::new(2.0, theme::TIME_CURSOR));
        }
        let pointed = response.hover_pos().and_then(|at| {
            let column = ((at.x - rect.left()) / width) as usize;
            *self.columns.get(column)?
        });
        if let Some(moment) = pointed {
            let words = say::lathe_load_at(
                clock(f64::from(moment.time_s)),
                format_args!("{:.0}", moment.force_n),
                format_args!("{:.2}", moment.power_kw),
                format_args!("{:.1}", moment.torque_nm),
            );
            response.on_hover_text(words.text(language));
        }
        let words = say::several(curve.messages()).text(language);
        let is_overload = curve.is_overload(curve.greatest);
        let color = match is_overload {
            true => theme::COLLISION,
            false => theme::SECONDARY_TEXT,
        };
        ui.label(RichText::new(words).color(color));
    }

    /// Draws the cuts of the path in the colours of their force.
    pub fn draw_path(&mut self, painter: &Painter, camera: &Camera, path: &Arc<DrawnPath>) {
        let Some(curve) = self.curve.clone().filter(|_| self.is_shown) else {
            return;
        };
        let known = self.drawn_for.as_ref();
        if !known.is_some_and(|(made, of)| made == camera && Arc::ptr_eq(of, path)) {
            self.shapes = path_shapes(&curve, camera, path);
            self.drawn_for = Some((*camera, Arc::clone(path)));
        }
        painter.extend(self.shapes.iter().cloned());
    }
}

fn color_of(curve: &LoadCurve, moment: LoadMoment) -> egui::Color32 {
    match curve.is_overload(moment) {
        true => theme::COLLISION,
        false => theme::load_color(curve.share(moment)),
    }
}

/// The lines of the cuts that are visible, each piece of a move in the colour of its force. The
/// chords of an arc have the times of the whole arc, so each has the colour of its greatest
/// force.
fn path_shapes(curve: &LoadCurve, camera: &Camera, path: &DrawnPath) -> Vec<Shape> {
    let rect = camera.rect.expand(4.0);
    let mut shapes = Vec::new();
    let mut segments = path.segments().peekable();
    let mut last_start_s = None;
    while let Some((from, piece)) = segments.next() {
        let next_start_s = segments.peek().map(|(_, next)| next.start_s);
        let is_chord = [last_start_s, next_start_s].contains(&Some(piece.start_s));
        last_start_s = Some(piece.start_s);
        let (begin, end) = (
            camera.screen_position(from),
            camera.screen_position(piece.end),
        );
        if !matches!(piece.kind, SegmentKind::Feed | SegmentKind::Thread)
            || !Rect::from_two_pos(begin, end).intersects(rect)
        {
            continue;
        }
        let mut add = |from_share: f32, to_share: f32, moment| {
            let at = |share: f32| begin + (end - begin) * share;
            let stroke = Stroke::new(PATH_WIDTH, color_of(curve, moment));
            shapes.push(Shape::line_segment([at(from_share), at(to_share)], stroke));
        };
        let moments = curve.between(piece.start_s, piece.end_s);
        let duration_s = piece.end_s - piece.start_s;
        if is_chord || duration_s <= 0.0 {
            if let Some(moment) = curve.heaviest(piece.start_s, piece.end_s) {
                add(0.0, 1.0, moment);
            }
            continue;
        }
        // A moment stands for the piece up to the middle between it and its neighbours.
        let share = |moment: &LoadMoment| (moment.time_s - piece.start_s) / duration_s;
        let spacing = match moments {
            [first, second, ..] => share(second) - share(first),
            _ => 1.0,
        };
        for moment in moments {
            let middle = share(moment);
            let from_share = (middle - spacing / 2.0).max(0.0);
            add(from_share, (middle + spacing / 2.0).min(1.0), *moment);
        }
    }
    shapes
}

#[cfg(test)]
mod tests {
    use egui::Context;
    use gsk_workpiece::stock::Stock;

    use super::super::path::PathBuilder;
    use super::*;

    /// The height of what is drawn for the bar, points.
    fn bar_height(load: &mut LoadDisplay) -> f32 {
        let mut height = f32::NAN;
        let mut output = Context::default().run_ui(egui::RawInput::default(), |ui| {
            let before = ui.cursor().top();
            load.show_bar(ui, 60.0, None, Language::En);
            height = ui.cursor().top() - before;
        });
        output.textures_delta.clear();
        height
    }

    #[test]
    fn a_path_that_ends_at_the_limit_of_work_promises_no_load() {
        let job = Arc::new(Job::new(Stock::bar(50.0, 0.0, 60.0)));
        let programs = gsk_core::setup::Setup::default().memory.programs;
        let cut_off = Arc::new(PathBuilder::default().build(&programs, true));
        assert!(cut_off.is_partial);
        let mut load = LoadDisplay {
            is_shown: true,
            ..LoadDisplay::default()
        };
        assert!(!load.needs_curve(&cut_off, &job));
        assert_eq!(bar_height(&mut load), 0.0, "nothing will come");
        // The path is complete later: the load is requested once, and its place says so.
        let complete = Arc::new(DrawnPath::default());
        assert!(load.needs_curve(&complete, &job));
        assert!(!load.needs_curve(&complete, &job));
        let pending = bar_height(&mut load);
        assert!(pending > 0.0);
        load.set_curve(Arc::new(LoadCurve::default()));
        assert!(bar_height(&mut load) > pending, "bar and text");
        load.clear();
        assert_eq!(bar_height(&mut load), 0.0);
    }
}
