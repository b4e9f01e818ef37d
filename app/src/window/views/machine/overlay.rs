//! Writes the state of the lathe over the picture and marks collisions.

use egui::{Align2, Color32, FontId, Painter, Rect, Stroke, vec2};
use gsk_messages::{Language, Message, say};

use super::camera::Camera;
use super::{HIT, grid, place};
use crate::kernel::part::PartView;

const WORDS: Color32 = Color32::from_gray(190);

/// Writes tool, spindle and each state of the lathe that is not at rest into the upper right
/// corner.
pub fn states(painter: &Painter, room: Rect, part: &PartView, language: Language) {
    let font = FontId::monospace(13.0);
    let corner = room.right_top() + vec2(-8.0, 6.0);
    for (line, words) in of(part).into_iter().enumerate() {
        let at = corner + vec2(0.0, 18.0 * line as f32);
        let words = words.text(language);
        let galley = painter.layout_no_wrap(words, font.clone(), WORDS);
        let place = Align2::RIGHT_TOP.anchor_size(at, galley.size());
        painter.rect_filled(place.expand2(vec2(4.0, 0.0)), 2.0, grid::GROUND);
        painter.galley(place.min, galley, WORDS);
    }
}

/// The lines that `states` writes.
fn of(part: &PartView) -> Vec<Message> {
    let others = [
        (part.coolant, say::lathe_coolant()),
        (part.clamped, say::lathe_chuck_clamped()),
        (part.chuck_open, say::lathe_chuck_open()),
        (part.tailstock_forward, say::lathe_tailstock_out()),
        (part.door_open, say::lathe_door_open()),
    ];
    let others = others.into_iter().filter(|(holds, _)| *holds);
    core::iter::once(say::lathe_tool(part.tool, part.rpm))
        .chain(others.map(|(_, said)| said))
        .collect()
}

/// Marks the contact points of the collisions.
pub fn hits(painter: &Painter, camera: &Camera, part: &PartView) {
    for finding in &part.findings {
        let at = camera.screen(place(finding.collision.contact));
        painter.circle_stroke(at, 8.0, Stroke::new(2.0, HIT));
        let arm = vec2(5.0, 5.0);
        painter.line_segment([at - arm, at + arm], Stroke::new(2.0, HIT));
        let arm = vec2(5.0, -5.0);
        painter.line_segment([at - arm, at + arm], Stroke::new(2.0, HIT));
    }
}
