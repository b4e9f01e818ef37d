//! The question whether the learner begins a task that the instructor of his class offers.

use std::sync::Arc;

use egui::Context;
use gsk_exercise::course::CourseTaskFile;
use gsk_exercise::task::ExerciseTask;
use gsk_host::kernel::{Command, SeatAction};
use gsk_host::network::class::seat_request::{SeatAnswer, SeatRefusal, SeatRequest};
use gsk_messages::say;

use crate::Window;
use crate::view::ViewId;
use crate::widgets::questions::show_question;

/// A task that the instructor offers.
pub struct ClassOffer {
    task: Arc<ExerciseTask>,
}

impl Window {
    /// Takes an offer. An earlier one that is still open is refused.
    pub(crate) fn take_class_offer(&mut self, request: &SeatRequest) {
        let exercises = self.views.lessons().exercises();
        let (id, task) = match request {
            SeatRequest::Task { exercise } => (exercise, exercises.task(exercise)),
            SeatRequest::TaskFile { exercise, text } => {
                let file = CourseTaskFile::new(exercise.clone(), text.clone(), None);
                (exercise, file.read_task(exercise).ok().map(Arc::new))
            }
            _ => return,
        };
        let Some(task) = task else {
            return self.answer_class(id, Some(SeatRefusal::Unknown));
        };
        if let Some(earlier) = self.class_offer.replace(ClassOffer { task }) {
            self.answer_class(&earlier.task.id, Some(SeatRefusal::Learner));
        }
    }

    /// Draws the question, and carries out the answer.
    pub(crate) fn show_class_offer(&mut self, context: &Context) {
        let Some(offer) = &self.class_offer else {
            return;
        };
        let language = self.settings.language;
        let title = say::class_offer_title().text(language);
        let text = say::class_offer(offer.task.title.in_language(language)).text(language);
        let answers = [
            say::class_offer_accept().text(language),
            say::class_offer_decline().text(language),
        ];
        let Some(answer) = show_question(context, "class offer", &title, &text, &answers) else {
            return;
        };
        let Some(ClassOffer { task }) = self.class_offer.take() else {
            return;
        };
        let refusal = (answer != 0).then_some(SeatRefusal::Learner);
        self.answer_class(&task.id, refusal);
        if refusal.is_none() {
            self.views.lessons().exercises().begin_offered(task);
            self.show_view(ViewId::Lesson);
        }
    }

    fn answer_class(&self, subject: &str, refusal: Option<SeatRefusal>) {
        let answer = SeatAnswer {
            subject: subject.to_owned(),
            refusal,
        };
        self.console.send(Command::Seat(SeatAction::Answer(answer)));
    }
}
