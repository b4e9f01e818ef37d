//! Draws the pitch errors along an axis: the current correction, the measured deviation, the
//! proposed correction.

use egui::{Align2, Color32, FontId, Pos2, Rect, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};
use gsk_commission::DeviationCurve;
use gsk_messages::{Language, Message, say};

use crate::theme;

/// Height of the graph, points.
const GRAPH_HEIGHT: f32 = 190.0;
/// Width of the scale at the left of the graph, points.
const SCALE_WIDTH: f32 = 56.0;
/// Height of the line of positions below the graph, and of the legend above, points.
const MARGIN_HEIGHT: f32 = 18.0;

/// The curves of one axis in the graph of pitch errors.
#[derive(Clone, Debug, Default)]
pub struct PitchCurves {
    /// The correction by the current pitch error table.
    pub current: DeviationCurve,
    /// The measured deviation of the screw.
    pub measured: DeviationCurve,
    /// The correction by the proposed pitch error table.
    pub proposed: DeviationCurve,
}

impl PitchCurves {
    fn rows(&self) -> [(&DeviationCurve, Color32, Message); 3] {
        [
            (
                &self.current,
                theme::CURVE_CURRENT,
                say::commission_legend_old(),
            ),
            (
                &self.measured,
                theme::CURVE_MEASURED,
                say::commission_legend_measured(),
            ),
            (
                &self.proposed,
                theme::CURVE_PROPOSED,
                say::commission_legend_new(),
            ),
        ]
    }
}

pub fn show(ui: &mut Ui, language: Language, curves: &PitchCurves) {
    let size = vec2(ui.available_width(), GRAPH_HEIGHT);
    let (bounds, response) = ui.allocate_exact_size(size, Sense::HOVER);
    response.widget_info(|| {
        WidgetInfo::labeled(Role::Canvas, true, say::commission_graph().text(language))
    });
    let area = Rect::from_min_max(
        bounds.min + vec2(SCALE_WIDTH, MARGIN_HEIGHT),
        bounds.max - vec2(6.0, MARGIN_HEIGHT),
    );
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
    let to_point = |at: f64, value: f64| -> Pos2 {
        let across = ((at - left) / (right - left)) as f32;
        let up = ((value - low) / (high - low)) as f32;
        pos2(
            area.left() + across * area.width(),
            area.bottom() - up * area.height(),
        )
    };
    let painter = ui.painter();
    let font = FontId::proportional(theme::SCALE_SIZE);
    for value in [low, 0.0, high] {
        let y = to_point(left, value).y;
        painter.hline(area.x_range(), y, Stroke::new(1.0, theme::CURVE_GRID));
        let at = pos2(area.left() - 4.0, y);
        let label = format!("{value:.1} µm");
        painter.text(
            at,
            Align2::RIGHT_CENTER,
            label,
            font.clone(),
            theme::SCALE_TEXT,
        );
    }
    for (at, side) in [(left, Align2::LEFT_TOP), (right, Align2::RIGHT_TOP)] {
        let foot = pos2(to_point(at, low).x, area.bottom() + 2.0);
        painter.text(
            foot,
            side,
            format!("{at:.1} mm"),
            font.clone(),
            theme::SCALE_TEXT,
        );
    }
    let mut x = area.left();
    for (curve, colour, name) in &rows {
        let line: Vec<Pos2> = curve
            .points()
            .iter()
            .map(|(at, value)| to_point(at.0, value.0))
            .collect();
        if line.len() > 1 {
            painter.line(line, Stroke::new(1.5, *colour));
            let label = name.text(language);
            let legend = painter.text(
                pos2(x, bounds.top()),
                Align2::LEFT_TOP,
                label,
                font.clone(),
                *colour,
            );
            x = legend.right() + 14.0;
        }
    }
}
