//! The question whether the learner begins a task or an exam that the instructor of his class
//! offers, and the end of an exam at the instructor's request.

use std::sync::Arc;

use egui::Context;
use gsk_exercise::course::CourseTaskFile;
use gsk_exercise::exam::{Exam, ExamPin};
use gsk_exercise::task::ExerciseTask;
use gsk_host::kernel::{Command, SeatAction};
use gsk_host::network::class::seat_request::{SeatAnswer, SeatPin, SeatRefusal, SeatRequest};
use gsk_host::platform;
use gsk_messages::{Language, Message, say};

use crate::Window;
use crate::view::ViewId;
use crate::widgets::questions::show_question;

/// What the instructor offers.
enum OfferedWork {
    Task(Arc<ExerciseTask>),
    Exam {
        tasks: Vec<Arc<ExerciseTask>>,
        pin: ExamPin,
    },
}

/// An offer of the instructor that the learner has not answered yet.
pub struct ClassOffer {
    /// What the answer names.
    subject: String,
    work: OfferedWork,
}

impl ClassOffer {
    /// Title and text of the question.
    fn question(&self, language: Language) -> (Message, Message) {
        match &self.work {
            OfferedWork::Task(task) => (
                say::class_offer_title(),
                say::class_offer(task.title.in_language(language)),
            ),
            OfferedWork::Exam { tasks, .. } => {
                let time_ms: u64 = tasks.iter().map(|task| task.time_limit_ms).sum();
                let minutes = time_ms.div_ceil(60_000);
                (
                    say::class_exam_offer_title(),
                    say::class_exam_offer(tasks.len(), minutes),
                )
            }
        }
    }
}

impl Window {
    /// Takes an offer, or ends the exam. An earlier offer that is still open is refused.
    pub(crate) fn take_class_offer(&mut self, request: &SeatRequest) {
        let Some(subject) = request.subject() else {
            return;
        };
        let work = match request {
            SeatRequest::EndExam { pin } => {
                let exercises = self.views.lessons().exercises();
                let ended = exercises.end_exam_from_class(&exam_pin(pin));
                if ended.is_ok() {
                    self.show_message(say::class_exam_ended());
                }
                return self.answer_class(&subject, ended.err());
            }
            _ if self.is_in_exam() => Err(SeatRefusal::Exam),
            _ => self.find_offered_work(request),
        };
        match work {
            Ok(work) => {
                let offer = ClassOffer { subject, work };
                if let Some(earlier) = self.class_offer.replace(offer) {
                    self.answer_class(&earlier.subject, Some(SeatRefusal::Learner));
                }
            }
            Err(refusal) => self.answer_class(&subject, Some(refusal)),
        }
    }

    /// The exercises that a request names; an error if the seat does not have them.
    fn find_offered_work(&mut self, request: &SeatRequest) -> Result<OfferedWork, SeatRefusal> {
        let exercises = self.views.lessons().exercises();
        let found = match request {
            SeatRequest::Task { exercise } => exercises.task(exercise).map(OfferedWork::Task),
            SeatRequest::TaskFile { exercise, text } => {
                let file = CourseTaskFile::new(exercise.clone(), text.clone(), None);
                let task = file.read_task(exercise).ok();
                task.map(|task| OfferedWork::Task(Arc::new(task)))
            }
            // The recordings of an exam need a folder.
            SeatRequest::BeginExam {
                exercises: ids,
                pin,
            } if platform::has_folders() => {
                let tasks: Option<_> = ids.iter().map(|id| exercises.task(id)).collect();
                let pin = exam_pin(pin);
                tasks.map(|tasks| OfferedWork::Exam { tasks, pin })
            }
            _ => None,
        };
        found.ok_or(SeatRefusal::Unknown)
    }

    /// Draws the question, and carries out the answer.
    pub(crate) fn show_class_offer(&mut self, context: &Context) {
        let Some(offer) = &self.class_offer else {
            return;
        };
        let language = self.settings.language;
        let (title, text) = offer.question(language);
        let [title, text] = [title, text].map(|message| message.text(language));
        let answers = [
            say::class_offer_accept().text(language),
            say::class_offer_decline().text(language),
        ];
        let Some(answer) = show_question(context, "class offer", &title, &text, &answers) else {
            return;
        };
        let Some(ClassOffer { subject, work }) = self.class_offer.take() else {
            return;
        };
        let refusal = (answer != 0).then_some(SeatRefusal::Learner);
        self.answer_class(&subject, refusal);
        if refusal.is_some() {
            return;
        }
        let name = self.settings.network.class.name.clone();
        let exercises = self.views.lessons().exercises();
        match work {
            OfferedWork::Task(task) => exercises.begin_offered(task),
            OfferedWork::Exam { tasks, pin } => {
                let learner = match exercises.learner().trim() {
                    "" => name,
                    learner => learner.to_owned(),
                };
                let ids = tasks.iter().map(|task| task.id.clone()).collect();
                exercises.begin_offered_exam(Exam::new(learner, ids, pin));
            }
        }
        self.show_view(ViewId::Lesson);
    }

    fn answer_class(&self, subject: &str, refusal: Option<SeatRefusal>) {
        let answer = SeatAnswer {
            subject: subject.to_owned(),
            refusal,
        };
        self.console.send(Command::Seat(SeatAction::Answer(answer)));
    }
}

/// The PIN of a request.
fn exam_pin(pin: &SeatPin) -> ExamPin {
    ExamPin::from_hash(pin.salt, pin.hash.clone())
}
