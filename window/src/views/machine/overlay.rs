//! Writes the state of the lathe over the picture and marks collisions.

use egui::{Align2, FontId, Painter, Rect, Stroke, vec2};
use gsk_host::kernel::part::PartView;
use gsk_messages::{Language, Message, say};
use gsk_runner::times::TimeUse;

use super::camera::Camera;
use super::to_pos2;
use crate::theme;

/// Length of a sample line in the legend, points.
const LEGEND_LINE: f32 = 14.0;

/// Writes tool number, spindle speed and each active state of the lathe into the upper right
/// corner.
pub fn draw_states(painter: &Painter, rect: Rect, part: &PartView, language: Language) {
    let font = FontId::monospace(theme::LABEL_SIZE);
    let corner = rect.right_top() + vec2(-8.0, 6.0);
    for (line, words) in state_messages(part).into_iter().enumerate() {
        let at = corner + vec2(0.0, 18.0 * line as f32);
        let words = words.text(language);
        let galley = painter.layout_no_wrap(words, font.clone(), theme::QUIET_TEXT);
        let label_rect = Align2::RIGHT_TOP.anchor_size(at, galley.size());
        painter.rect_filled(
            label_rect.expand2(vec2(4.0, 0.0)),
            2.0,
            theme::PICTURE_LABEL_GROUND,
        );
        painter.galley(label_rect.min, galley, theme::QUIET_TEXT);
    }
}

/// Writes the names of the kinds of moves into one row at the upper edge, each beside a line in the
/// colour of its path: a row covers neither chuck nor part.
pub fn draw_legend(painter: &Painter, rect: Rect, language: Language) {
    let font = FontId::proportional(theme::SCALE_SIZE);
    let layout = |text: String| painter.layout_no_wrap(text, font.clone(), theme::QUIET_TEXT);
    // Beside the name of X, which is in the corner.
    let name = layout(say::lathe_axis_x().text(language));
    let mut at = rect.left_top() + vec2(name.size().x + 14.0, 1.0);
    for (what, color) in [
        (TimeUse::Rapid, theme::RAPID_PATH),
        (TimeUse::Feed, theme::FEED_PATH),
        (TimeUse::Thread, theme::THREAD_PATH),
    ] {
        let galley = layout(what.message().text(language));
        let size = galley.size() + vec2(LEGEND_LINE + 10.0, 2.0);
        let label = Rect::from_min_size(at, size);
        painter.rect_filled(label, 2.0, theme::PICTURE_LABEL_GROUND);
        let line = label.left_center() + vec2(3.0, 0.0);
        let ends = [line, line + vec2(LEGEND_LINE, 0.0)];
        painter.line_segment(ends, Stroke::new(2.5, color));
        let text = label.left_top() + vec2(LEGEND_LINE + 7.0, 1.0);
        painter.galley(text, galley, theme::QUIET_TEXT);
        at.x += label.width() + 2.0;
    }
}

/// Returns the messages about the machine's state that [`draw_states`] draws.
fn state_messages(part: &PartView) -> Vec<Message> {
    let states = [
        (part.coolant, say::lathe_coolant()),
        (part.clamped, say::lathe_chuck_clamped()),
        (part.chuck_open, say::lathe_chuck_open()),
        (part.tailstock_forward, say::lathe_tailstock_out()),
        (part.door_open, say::lathe_door_open()),
    ];
    let others = states.into_iter().filter(|(is_active, _)| *is_active);
    core::iter::once(say::lathe_tool(part.tool, part.spindle_rpm))
        .chain(others.map(|(_, message)| message))
        .collect()
}

/// Marks the contact points of the collisions in the picture.
pub fn draw_hits(painter: &Painter, camera: &Camera, part: &PartView) {
    for finding in &part.findings {
        let at = camera.screen_position(to_pos2(finding.collision.contact));
        painter.circle_stroke(at, 8.0, Stroke::new(2.0, theme::COLLISION));
        let arm = vec2(5.0, 5.0);
        painter.line_segment([at - arm, at + arm], Stroke::new(2.0, theme::COLLISION));
        let arm = vec2(5.0, -5.0);
        painter.line_segment([at - arm, at + arm], Stroke::new(2.0, theme::COLLISION));
    }
}
