//! The seats of a class as JSON for a page in a browser.

use gsk_messages::Language;
use serde::Serialize;

use super::class_roster::{ClassRoster, ClassSeat, SeatUrgency};
use super::class_table::{program_text, task_text};
use super::part_outline::CoarseOutline;

/// The state of a class.
#[derive(Serialize)]
struct PageState<'a> {
    online: usize,
    seats: usize,
    /// The seats, the most urgent first.
    tiles: Vec<PageTile<'a>>,
}

/// A seat on the page.
#[derive(Serialize)]
struct PageTile<'a> {
    name: &'a str,
    /// Name of the urgency, for the colour.
    urgency: &'static str,
    state: String,
    /// The trouble, or the mode.
    detail: &'a str,
    program: String,
    task: String,
    points: u32,
    part: &'a CoarseOutline,
}

/// Writes the seats of a class, the most urgent first.
pub fn write_page_state(roster: &ClassRoster, language: Language) -> String {
    let (online, seats) = roster.count();
    let tiles = roster.by_urgency().into_iter();
    let state = PageState {
        online,
        seats,
        tiles: tiles.map(|seat| page_tile(seat, language)).collect(),
    };
    serde_json::to_string(&state).unwrap_or_default()
}

fn page_tile(seat: &ClassSeat, language: Language) -> PageTile<'_> {
    let report = &seat.report;
    let trouble = report.trouble.as_ref();
    PageTile {
        name: &report.name,
        urgency: urgency_name(seat.urgency),
        state: seat.state_message().text(language),
        detail: trouble.map_or(report.mode.text(language), |it| it.text.text(language)),
        program: program_text(seat),
        task: task_text(seat, language),
        points: report.points,
        part: &seat.part,
    }
}

const fn urgency_name(urgency: SeatUrgency) -> &'static str {
    match urgency {
        SeatUrgency::Emergency => "emergency",
        SeatUrgency::Crash => "crash",
        SeatUrgency::Help => "help",
        SeatUrgency::Alarm => "alarm",
        SeatUrgency::Idle => "idle",
        SeatUrgency::Working => "working",
        SeatUrgency::Running => "running",
        SeatUrgency::Offline => "offline",
    }
}
