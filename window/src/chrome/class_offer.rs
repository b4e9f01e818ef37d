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
use gsk_plot::decode_png;

use crate::Window;
use crate::view::ViewId;
use crate::widgets::questions::show_question;

/// What the instructor offers.
enum OfferedWork {
    Task(Arc<ExerciseTask>),
    /// An exercise of the instructor's own that the seat does not have.
    NewTask {
        task: Arc<ExerciseTask>,
        /// Its file `task.ron`.
        text: String,
    },
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
            OfferedWork::NewTask { task, .. } => {
                let title = task.title.in_language(language);
                let text = match platform::has_folders() {
                    true => say::class_offer_new(title),
                    false => say::class_offer_new_page(title),
                };
                (say::class_offer_title(), text)
            }
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
            Err(refusal) => {
                if refusal == SeatRefusal::Browser {
                    self.show_message(say::class_exam_in_browser());
                }
                self.answer_class(&subject, Some(refusal));
            }
        }
    }

    /// The exercises that a request names or contains; an error if the seat cannot begin them.
    fn find_offered_work(&mut self, request: &SeatRequest) -> Result<OfferedWork, SeatRefusal> {
        let exercises = self.views.lessons().exercises();
        let found = match request {
            SeatRequest::Task { exercise } => exercises.task(exercise).map(OfferedWork::Task),
            SeatRequest::TaskFile {
                exercise,
                text,
                drawing,
            } => {
                let task = read_sent_task(exercise, text, drawing.as_ref())?;
                let known = exercises.task(exercise);
                let is_known = known.is_some_and(|known| known.hash == task.hash);
                Some(match is_known {
                    true => OfferedWork::Task(task),
                    false => OfferedWork::NewTask {
                        task,
                        text: text.clone(),
                    },
                })
            }
            // The recordings of an exam need a folder.
            SeatRequest::BeginExam { .. } if !platform::has_folders() => {
                return Err(SeatRefusal::Browser);
            }
            SeatRequest::BeginExam {
                exercises: ids,
                pin,
            } => {
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
            OfferedWork::NewTask { task, text } => {
                let kept = exercises.keep_offered(&task, &text);
                exercises.begin_offered(task);
                if let Some(message) = kept {
                    self.show_message(message);
                }
            }
            OfferedWork::Exam { tasks, pin } => {
                let learner = match exercises.learner().trim() {
                    "" => name,
                    learner => learner.to_owned(),
                };
                let ids = tasks.iter().map(|task| task.id.clone()).collect();
                exercises.begin_offered_exam(Exam::new(learner, ids, pin));
            }
        }
        // The pane in which the learner has joined would cover the exercise.
        self.network.close();
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

/// Reads an exercise that a request contains, and its drawing.
fn read_sent_task(
    id: &str,
    text: &str,
    drawing: Option<&String>,
) -> Result<Arc<ExerciseTask>, SeatRefusal> {
    let file = CourseTaskFile {
        id: id.to_owned(),
        text: text.to_owned(),
        drawing: drawing.cloned(),
    };
    let task = file.read_task(id).map_err(|_| SeatRefusal::Malformed)?;
    let is_readable = (task.drawing.as_ref()).is_none_or(|drawing| decode_png(drawing).is_some());
    is_readable
        .then(|| Arc::new(task))
        .ok_or(SeatRefusal::Malformed)
}

/// The PIN of a request.
fn exam_pin(pin: &SeatPin) -> ExamPin {
    ExamPin::from_hash(pin.salt, pin.hash.clone())
}
