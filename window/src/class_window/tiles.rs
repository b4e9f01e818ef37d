//! The seats of a class as tiles, the most urgent first.

use egui::{
    Color32, CornerRadius, Rect, ScrollArea, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo,
};
use gsk_host::network::class::class_roster::{ClassRoster, ClassSeat, SeatUrgency};
use gsk_host::network::class::class_table::{program_text, task_text};
use gsk_messages::{Language, say};

use super::part_drawing;
use crate::theme;

/// Size of a tile, points.
const TILE_SIZE: Vec2 = Vec2::new(212.0, 132.0);
/// Width of the stripe with the colour of the state, points.
const STRIPE_WIDTH: f32 = 5.0;
/// Height of a line of text, points.
const LINE_HEIGHT: f32 = 17.0;
/// Height of the drawing of the part, points.
const PART_HEIGHT: f32 = 46.0;

/// Draws the tiles; returns the seat that was clicked.
pub fn show(
    ui: &mut Ui,
    language: Language,
    roster: &ClassRoster,
    selected: Option<&str>,
) -> Option<String> {
    let mut clicked = None;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.horizontal_wrapped(|ui| {
            for seat in roster.by_urgency() {
                if show_tile(ui, language, seat, selected == Some(&*seat.id)) {
                    clicked = Some(seat.id.clone());
                }
            }
        });
    });
    clicked
}

/// The colour of a state.
pub fn urgency_color(urgency: SeatUrgency) -> Color32 {
    match urgency {
        SeatUrgency::Emergency | SeatUrgency::Crash => theme::COLLISION,
        SeatUrgency::Help => theme::WARNING,
        SeatUrgency::Alarm => theme::ALARM_TEXT,
        SeatUrgency::Idle => theme::NOTE_TEXT,
        SeatUrgency::Working => theme::ACCENT,
        SeatUrgency::Running => theme::SUCCESS,
        SeatUrgency::Offline => theme::HINT_TEXT,
    }
}

/// Draws a tile; returns whether it was clicked.
fn show_tile(ui: &mut Ui, language: Language, seat: &ClassSeat, is_selected: bool) -> bool {
    let (area, response) = ui.allocate_exact_size(TILE_SIZE, Sense::click());
    let report = &seat.report;
    let state = seat.state_message().text(language);
    response.widget_info(|| {
        let name = format!("{}: {state}", report.name);
        WidgetInfo::selected(egui::Role::Button, true, is_selected, name)
    });
    if !ui.is_rect_visible(area) {
        return response.clicked();
    }
    let colour = urgency_color(seat.urgency);
    let painter = ui.painter().with_clip_rect(area.intersect(ui.clip_rect()));
    let corner = CornerRadius::same(4);
    painter.rect_filled(area, corner, theme::HEADER_GROUND);
    let edge = match (is_selected, response.hovered() || response.has_focus()) {
        (true, _) => Stroke::new(2.0, theme::ACCENT),
        (false, true) => Stroke::new(1.0, theme::NOTE_TEXT),
        (false, false) => Stroke::new(1.0, theme::SPLITTER),
    };
    let stripe = Rect::from_min_size(area.min, Vec2::new(STRIPE_WIDTH, area.height()));
    painter.rect_filled(stripe, corner, colour);
    painter.rect_stroke(area, corner, edge, StrokeKind::Inside);
    let trouble = report.trouble.as_ref();
    let trouble = trouble.map(|it| it.text.text(language).to_owned());
    let points = match report.points {
        0 => String::new(),
        points => format!("{} {points}", say::class_column_points().text(language)),
    };
    let mode = report.mode.text(language).to_owned();
    let lines = [
        (report.name.clone(), theme::BRIGHT_TEXT),
        (state, colour),
        (trouble.unwrap_or(mode), theme::SECONDARY_TEXT),
        (
            [program_text(seat), task_text(seat, language), points]
                .into_iter()
                .filter(|text| !text.is_empty())
                .collect::<Vec<String>>()
                .join("  "),
            theme::SECONDARY_TEXT,
        ),
    ];
    let font = egui::TextStyle::Body.resolve(ui.style());
    let mut top = area.min + Vec2::new(STRIPE_WIDTH + 6.0, 4.0);
    let width = area.right() - 6.0 - top.x;
    for (text, colour) in lines {
        let mut job = crate::fonts::layout_text(&text, font.clone(), colour);
        job.wrap = egui::text::TextWrapping::truncate_at_width(width);
        let galley = painter.layout_job(job);
        painter.galley(top, galley, colour);
        top.y += LINE_HEIGHT;
    }
    let room = Rect::from_min_size(
        egui::pos2(top.x, area.bottom() - PART_HEIGHT - 6.0),
        Vec2::new(width, PART_HEIGHT),
    );
    part_drawing::draw(&painter, room, &seat.part);
    response.clicked()
}
