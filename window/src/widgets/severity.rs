//! How dangerous a message is, and the sign that says so by shape and colour.

use egui::{Color32, Painter, Pos2, Rect, Sense, Shape, Stroke, Ui, Vec2, pos2};
use gsk_messages::{Message, say};

use crate::theme;

/// Width and height of the sign, points.
const SIGN_SIZE: f32 = 14.0;

/// The severity of a message, from the least to the greatest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MessageSeverity {
    /// The message informs about an event, or about what could be done next.
    Information,
    /// The message explains why the control waits, or behaves otherwise than expected.
    Hint,
    /// The message explains that a key or a request had no effect.
    Refusal,
    /// The tool has collided, and the lathe continues.
    Collision,
    /// An alarm of the control, or a crash that has stopped the lathe.
    Alarm,
    /// Emergency stop, a key that stays down, a control that does not answer.
    Safety,
}

impl MessageSeverity {
    /// The name of the severity, for tool tips and screen readers.
    pub fn name(self) -> Message {
        match self {
            Self::Information => say::window_severity_information(),
            Self::Hint => say::window_severity_hint(),
            Self::Refusal => say::window_severity_refusal(),
            Self::Collision => say::window_severity_collision(),
            Self::Alarm => say::window_severity_alarm(),
            Self::Safety => say::window_severity_safety(),
        }
    }

    /// Returns the colour of a message's text.
    pub const fn color(self) -> Color32 {
        match self {
            Self::Information => theme::MESSAGE_TEXT,
            Self::Hint => theme::HINT_TEXT,
            Self::Refusal | Self::Collision => theme::WARNING,
            Self::Alarm | Self::Safety => theme::ALARM_TEXT,
        }
    }

    /// Whether the message history keeps messages of this severity. It keeps no hints: they
    /// come and go with the state of the machine.
    pub const fn is_kept(self) -> bool {
        !matches!(self, Self::Hint)
    }

    /// Draws the sign: an octagon, a triangle, a diamond, a barred circle, a ring or a dot.
    pub fn show_sign(self, ui: &mut Ui, name: String) {
        let (rect, response) = ui.allocate_exact_size(Vec2::splat(SIGN_SIZE), Sense::hover());
        self.paint(ui.painter(), rect.shrink(1.0));
        response.on_hover_text(name);
    }

    fn paint(self, painter: &Painter, rect: Rect) {
        let (center, radius, color) = (rect.center(), rect.width() / 2.0, self.color());
        let ink = Stroke::new(1.6, theme::BAR_GROUND);
        match self {
            Self::Information => {
                painter.circle_filled(center, radius * 0.4, color);
            }
            Self::Hint => {
                painter.circle_stroke(center, radius * 0.7, Stroke::new(1.4, color));
            }
            Self::Refusal => {
                painter.circle_filled(center, radius, color);
                let half = Vec2::new(radius * 0.55, 0.0);
                painter.line_segment([center - half, center + half], ink);
            }
            Self::Collision => {
                fill_polygon(painter, center, radius, 4, 0.0, color);
            }
            Self::Alarm => {
                let points = vec![
                    pos2(center.x, rect.top()),
                    rect.right_bottom(),
                    rect.left_bottom(),
                ];
                painter.add(Shape::convex_polygon(points, color, Stroke::NONE));
                let (top, end) = (rect.top() + radius * 0.75, rect.top() + radius * 1.35);
                painter.line_segment([pos2(center.x, top), pos2(center.x, end)], ink);
                painter.circle_filled(pos2(center.x, rect.top() + radius * 1.7), 0.9, ink.color);
            }
            Self::Safety => {
                fill_polygon(painter, center, radius, 8, 0.5, color);
                let half = Vec2::new(radius * 0.5, 0.0);
                painter.line_segment([center - half, center + half], ink);
            }
        }
    }
}

/// Fills a regular polygon. `turn` is its rotation, in corners.
fn fill_polygon(
    painter: &Painter,
    center: Pos2,
    radius: f32,
    corners: u8,
    turn: f32,
    color: Color32,
) {
    let step = std::f32::consts::TAU / f32::from(corners);
    let corner = |index: u8| center + radius * Vec2::angled((f32::from(index) + turn) * step);
    let points = (0..corners).map(corner).collect();
    painter.add(Shape::convex_polygon(points, color, Stroke::NONE));
}
