//! Paints the drawing of a task, each dimension in the colour of its state on the part.

use std::sync::Arc;

use egui::{
    Align2, Color32, ColorImage, FontId, Pos2, Rect, Sense, Shape, Stroke, TextureHandle,
    TextureOptions, Ui, pos2, vec2,
};
use gsk_exercise::drawing::{DrawingPen, PaperPoint, TaskDrawing, draw_task};
use gsk_exercise::part_size::MeasuredSize;
use gsk_exercise::task::{ExerciseTask, TaskHash};
use gsk_messages::{Language, say};
use gsk_plot::decode_png;

use crate::theme;

/// Height of the texts in the drawing, points.
const TEXT_HEIGHT: f64 = 12.0;
/// Greatest width of the drawing, points.
const MAX_WIDTH: f32 = 440.0;
/// Greatest width of a drawing made by hand, points.
const MAX_HAND_MADE_WIDTH: f32 = 900.0;
/// Lengths of the dashes and gaps of the axis, points.
const DASHES: [f32; 2] = [10.0, 3.0];
const GAPS: [f32; 2] = [3.0, 3.0];

/// The drawing of a task, laid out again only for another task or width.
#[derive(Default)]
pub struct DrawingPane {
    /// The task and the width of the drawing, and the drawing; no drawing if the task has none.
    laid_out: Option<(TaskHash, f32, Option<TaskDrawing>)>,
    /// The file of a hand-made drawing and its picture; no picture if it is damaged.
    hand_made: Option<(Arc<[u8]>, Option<TextureHandle>)>,
}

impl DrawingPane {
    /// Draws the part with its dimensions; does nothing if the task has no drawing. `sizes`: the
    /// dimensions as they are on the part.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        language: Language,
        task: &ExerciseTask,
        sizes: &[MeasuredSize],
    ) {
        if let Some(drawing) = &task.drawing
            && let Some(picture) = self.load(ui, drawing)
        {
            return show_hand_made(ui, language, picture);
        }
        let width = ui.available_width().min(MAX_WIDTH);
        let is_current =
            |it: &(TaskHash, f32, Option<TaskDrawing>)| it.0 == task.hash && it.1 == width;
        if !self.laid_out.as_ref().is_some_and(is_current) {
            let drawing = draw_task(task, f64::from(width), TEXT_HEIGHT);
            self.laid_out = Some((task.hash, width, drawing));
        }
        if let Some((_, _, Some(drawing))) = &self.laid_out {
            paint(ui, language, drawing, sizes);
        }
    }

    /// Returns the picture of a hand-made drawing, read once; `None` if it is damaged.
    fn load(&mut self, ui: &Ui, drawing: &Arc<[u8]>) -> Option<&TextureHandle> {
        let is_loaded = |it: &(Arc<[u8]>, Option<TextureHandle>)| Arc::ptr_eq(&it.0, drawing);
        if !self.hand_made.as_ref().is_some_and(is_loaded) {
            let picture = decode_png(drawing).map(|picture| {
                let image = ColorImage::from_rgba_unmultiplied(picture.size, &picture.rgba);
                let options = TextureOptions::LINEAR;
                ui.ctx().load_texture("hand-made drawing", image, options)
            });
            self.hand_made = Some((Arc::clone(drawing), picture));
        }
        self.hand_made.as_ref()?.1.as_ref()
    }
}

/// Shows the picture of a hand-made drawing, at most in its own size.
fn show_hand_made(ui: &mut Ui, language: Language, picture: &TextureHandle) {
    ui.strong(say::exercise_drawing().text(language));
    let size = picture.size_vec2();
    let width = ui.available_width().min(MAX_HAND_MADE_WIDTH);
    let size = size * (width / size.x.max(1.0)).min(1.0);
    ui.add(egui::Image::new((picture.id(), size)).fit_to_exact_size(size))
        .on_hover_text(say::exercise_drawing_hand_made().text(language));
    ui.add_space(6.0);
}

fn paint(ui: &mut Ui, language: Language, drawing: &TaskDrawing, sizes: &[MeasuredSize]) {
    let width = ui.available_width().min(MAX_WIDTH);
    ui.strong(say::exercise_drawing().text(language));
    let (rect, response) =
        ui.allocate_exact_size(vec2(width, drawing.height as f32), Sense::hover());
    response.on_hover_text(say::exercise_drawing_hint().text(language));
    let painter = ui.painter_at(rect);
    let at = |point: &PaperPoint| to_screen(rect, point);
    let color_of = |criterion: usize| dimension_color(sizes, criterion);
    for line in &drawing.lines {
        let points: Vec<Pos2> = line.points.iter().map(at).collect();
        let stroke = match line.pen {
            DrawingPen::Edge => Stroke::new(1.8, theme::BRIGHT_TEXT),
            DrawingPen::Thin | DrawingPen::Axis => Stroke::new(1.0, theme::NOTE_TEXT),
            DrawingPen::Hatch => Stroke::new(0.6, theme::NOTE_TEXT),
            DrawingPen::Dimension(criterion) => Stroke::new(1.0, color_of(criterion)),
        };
        match line.pen {
            DrawingPen::Axis => {
                painter.extend(Shape::dashed_line_with_offset(
                    &points, stroke, &DASHES, &GAPS, 0.0,
                ));
            }
            _ => {
                painter.line(points, stroke);
            }
        }
    }
    for arrow in &drawing.arrows {
        let corners = arrow.corners.iter().map(at).collect();
        let color = color_of(arrow.criterion);
        painter.add(Shape::convex_polygon(corners, color, Stroke::NONE));
    }
    let font = FontId::proportional(TEXT_HEIGHT as f32);
    for label in &drawing.labels {
        let color = color_of(label.criterion);
        let galley = painter.layout_no_wrap(label.text.clone(), font.clone(), color);
        let corner = Align2::CENTER_CENTER
            .anchor_size(at(&label.middle), galley.size())
            .min;
        let mut text = egui::epaint::TextShape::new(corner, galley, color);
        if label.is_upright {
            text = text.with_angle_and_anchor(-core::f32::consts::FRAC_PI_2, Align2::CENTER_CENTER);
        }
        painter.add(text);
    }
    ui.add_space(6.0);
}

fn to_screen(rect: Rect, point: &PaperPoint) -> Pos2 {
    pos2(
        rect.left() + point.right as f32,
        rect.top() + point.down as f32,
    )
}

fn dimension_color(sizes: &[MeasuredSize], criterion: usize) -> Color32 {
    let size = sizes.iter().find(|size| size.criterion == criterion);
    match size.is_some_and(MeasuredSize::is_met) {
        true => theme::SUCCESS,
        false => theme::TEXT,
    }
}
