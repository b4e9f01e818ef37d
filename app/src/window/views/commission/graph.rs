//! Draws the pitch errors along an axis: the current correction, the measured deviation, the
//! proposed correction.

use egui::{Align2, Color32, FontId, Pos2, Rect, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};
use gsk_commission::DeviationCurve;
use gsk_messages::{Language, Message, say};

/// Height of the graph, points.
const HEIGHT: f32 = 190.0;
/// Width of the scale, points.
const GUTTER: f32 = 56.0;
/// Height of the positions below, and of the legend above, points.
const FOOT: f32 = 18.0;

const GRID: Color32 = Color32::from_gray(52);
const FIGURES: Color32 = Color32::from_gray(160);
const OLD: Color32 = Color32::from_gray(150);
const MEASURED: Color32 = Color32::from_rgb(255, 180, 90);
const NEW: Color32 = Color32::from_rgb(90, 200, 255);

/// The curves of an axis.
#[derive(Clone, Debug, Default)]
pub struct Curves {
    /// The current correction.
    pub old: DeviationCurve,
    /// The measured deviation.
    pub measured: DeviationCurve,
    /// The proposed correction.
    pub new: DeviationCurve,
}

impl Curves {
    fn rows(&self) -> [(&DeviationCurve, Color32, Message); 3] {
        [
            (&self.old, OLD, say::commission_legend_old()),
            (&self.measured, MEASURED, say::commission_legend_measured()),
            (&self.new, NEW, say::commission_legend_new()),
        ]
    }
}

pub fn show(ui: &mut Ui, language: Language, curves: &Curves) {
    let size = vec2(ui.available_width(), HEIGHT);
    let (room, response) = ui.allocate_exact_size(size, Sense::HOVER);
    response.widget_info(|| {
        WidgetInfo::labeled(Role::Canvas, true, say::commission_graph().text(language))
    });
    let area = Rect::from_min_max(room.min + vec2(GUTTER, FOOT), room.max - vec2(6.0, FOOT));
    let rows = curves.rows();
    let points = || rows.iter().flat_map(|(curve, ..)| curve.points());
    let (mut left, mut right) = (0.0_f64, 0.0_f64);
    let (mut low, mut high) = (-1.0_f64, 1.0_f64);
    for (at, value) in points() {
        (left, right) = (left.min(at.0), right.max(at.0));
        (low, high) = (low.min(value.0), high.max(value.0));
    }
    if right - left < 1e-9 {
        return;
    }
    let place = |at: f64, value: f64| -> Pos2 {
        let across = ((at - left) / (right - left)) as f32;
        let up = ((value - low) / (high - low)) as f32;
        pos2(
            area.left() + across * area.width(),
            area.bottom() - up * area.height(),
        )
    };
    let painter = ui.painter();
    let font = FontId::proportional(11.0);
    for value in [low, 0.0, high] {
        let y = place(left, value).y;
        painter.hline(area.x_range(), y, Stroke::new(1.0, GRID));
        let at = pos2(area.left() - 4.0, y);
        let words = format!("{value:.1} µm");
        painter.text(at, Align2::RIGHT_CENTER, words, font.clone(), FIGURES);
    }
    for (at, side) in [(left, Align2::LEFT_TOP), (right, Align2::RIGHT_TOP)] {
        let foot = pos2(place(at, low).x, area.bottom() + 2.0);
        painter.text(foot, side, format!("{at:.1} mm"), font.clone(), FIGURES);
    }
    let mut x = area.left();
    for (curve, colour, name) in &rows {
        let line: Vec<Pos2> = curve
            .points()
            .iter()
            .map(|(at, value)| place(at.0, value.0))
            .collect();
        if line.len() > 1 {
            painter.line(line, Stroke::new(1.5, *colour));
            let words = name.text(language);
            let drawn = painter.text(
                pos2(x, room.top()),
                Align2::LEFT_TOP,
                words,
                font.clone(),
                *colour,
            );
            x = drawn.right() + 14.0;
        }
    }
}
