//! The form with which the instructor begins and ends an exam at one seat or at all.

use std::collections::BTreeSet;

use egui::{RichText, ScrollArea, TextEdit, Ui};
use gsk_exercise::exam::ExamPin;
use gsk_exercise::task::ExerciseTask;
use gsk_host::network::class::class_address::ClassCode;
use gsk_host::network::class::class_roster::{ClassRoster, ClassSeat, SeatUrgency};
use gsk_host::network::class::seat_request::{SeatPin, SeatRequest};
use gsk_messages::{Language, say};

use super::seat_pane::refusal;
use crate::theme;

/// Width of the field for the PIN, points.
const PIN_WIDTH: f32 = 90.0;
/// Greatest height of the list of exercises, points.
const LIST_HEIGHT: f32 = 360.0;

/// A request, and the name in topics of the seat to which it goes.
type AddressedRequest = (String, SeatRequest);

/// What the instructor has entered.
#[derive(Default)]
pub struct ExamForm {
    pin: String,
    tasks: BTreeSet<String>,
}

impl ExamForm {
    /// Draws the form; returns the requests of a click.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        language: Language,
        tasks: &[ExerciseTask],
        code: &ClassCode,
        (roster, selected): (&ClassRoster, Option<&ClassSeat>),
    ) -> Vec<AddressedRequest> {
        let hint = say::class_exam_hint().text(language);
        ui.label(RichText::new(hint).color(theme::HINT_TEXT));
        ScrollArea::vertical()
            .max_height(LIST_HEIGHT)
            .show(ui, |ui| {
                for task in tasks {
                    let mut is_chosen = self.tasks.contains(&task.id);
                    let title = task.title.in_language(language);
                    if ui.checkbox(&mut is_chosen, title).changed() {
                        match is_chosen {
                            true => self.tasks.insert(task.id.clone()),
                            false => self.tasks.remove(&task.id),
                        };
                    }
                }
            });
        ui.horizontal(|ui| {
            let name = ui.label(say::exam_pin().text(language));
            let field = TextEdit::singleline(&mut self.pin).char_limit(12);
            let field = ui.add(field.desired_width(PIN_WIDTH)).labelled_by(name.id);
            field.on_hover_text(say::exam_pin_hint().text(language));
        });
        let pin = hash_pin(&self.pin, code);
        if pin.is_none() {
            let missing = say::exam_needs_pin().text(language);
            ui.label(RichText::new(missing).color(theme::NOTE_TEXT));
        }
        if self.tasks.is_empty() {
            let missing = say::exam_needs_tasks().text(language);
            ui.label(RichText::new(missing).color(theme::NOTE_TEXT));
        }
        let begin = pin.clone().filter(|_| !self.tasks.is_empty());
        // In the order of the list.
        let chosen = tasks.iter().map(|task| &task.id);
        let chosen = chosen.filter(|id| self.tasks.contains(*id)).cloned();
        let exercises: Vec<String> = chosen.collect();
        let begin = begin.map(|pin| SeatRequest::BeginExam { exercises, pin });
        let end = pin.map(|pin| SeatRequest::EndExam { pin });
        let mut requests = Vec::new();
        for (request, one, all) in [
            (begin, ExamButton::BeginOne, say::class_exam_begin_all()),
            (end, ExamButton::EndOne, say::class_exam_end_all()),
        ] {
            let seat = selected.filter(|_| request.is_some());
            if let (Some(seat), Some(request)) = (seat, &request) {
                let name = one.name(&seat.report.name).text(language);
                let button = egui::Button::new(name);
                let button = ui.add_enabled(can_receive(seat, request), button);
                if button.clicked() {
                    requests.push((seat.id.clone(), request.clone()));
                }
            }
            let button = egui::Button::new(all.text(language));
            let is_clicked = ui.add_enabled(request.is_some(), button).clicked();
            if let Some(request) = request.filter(|_| is_clicked) {
                let seats = roster.by_urgency().into_iter();
                let seats = seats.filter(|seat| can_receive(seat, &request));
                requests.extend(seats.map(|seat| (seat.id.clone(), request.clone())));
            }
        }
        requests
    }
}

/// A button for the selected seat.
#[derive(Clone, Copy)]
enum ExamButton {
    BeginOne,
    EndOne,
}

impl ExamButton {
    fn name(self, seat: &str) -> gsk_messages::Message {
        match self {
            Self::BeginOne => say::class_exam_begin_one(seat),
            Self::EndOne => say::class_exam_end_one(seat),
        }
    }
}

/// Whether a seat is connected and does not refuse a request, as its report says.
fn can_receive(seat: &ClassSeat, request: &SeatRequest) -> bool {
    let is_in_exam = seat.report.task.as_ref().is_some_and(|task| task.is_exam);
    let is_fitting = match request {
        SeatRequest::EndExam { .. } => is_in_exam,
        _ => true,
    };
    is_fitting
        && seat.urgency != SeatUrgency::Offline
        && refusal(seat, |rights| request.refusal(rights)).is_none()
}

/// The hash of a PIN; `None` for a text that is no PIN. The salt follows from the code of the
/// class, so that a view that was opened later can end the exam.
fn hash_pin(pin: &str, code: &ClassCode) -> Option<SeatPin> {
    let letters = code.to_string();
    let salt = letters
        .bytes()
        .fold(0, |salt: u64, byte| salt.rotate_left(7) ^ u64::from(byte));
    let pin = ExamPin::new(pin, salt)?;
    let (salt, hash) = pin.as_hash();
    Some(SeatPin {
        salt,
        hash: hash.to_owned(),
    })
}
