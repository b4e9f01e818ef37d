//! The running transfer job: the dialog 文件传输 (manual V-3.3), with its question about an
//! existing file name.

use egui::{
    Color32, Context, Label, ProgressBar, Rect, RichText, ScrollArea, Sense, Shape, Stroke, Ui,
    vec2,
};
use gsk_messages::{Language, Message, say};
use gsk_transfer::{FileName, TransferProgress};

use super::naming::{Naming, window};
use super::{BAD, GOOD};
use crate::pc::Traffic;
use crate::pc::worker::{Answer, Choice, Fate, Kind, News, Question};

/// Height of the list of files, points.
const HEIGHT: f32 = 160.0;
/// Side of the status sign before a file, points.
const SIGN: f32 = 12.0;

/// A transfer job and its progress.
pub struct Job {
    kind: Kind,
    rows: Vec<(String, Option<Fate>)>,
    at: usize,
    progress: Option<TransferProgress>,
    /// Time of the first progress of the current file, seconds of the window's clock, and the
    /// bytes transferred by then.
    since: Option<(f64, usize)>,
    retries: u64,
    traffic: Traffic,
    last_error: Option<Message>,
    question: Option<Asking>,
    /// Set when the job has ended; the inner value is the error, if any.
    over: Option<Option<Message>>,
}

/// The open question about an existing file.
struct Asking {
    question: Question,
    of_all: bool,
    /// The fields for the new name in the control, while they are open.
    naming: Option<Naming>,
}

/// A request of the operator about the job.
pub enum Wish {
    /// Cancel the job.
    Cancel,
    /// Answer the question.
    Answer(Answer),
    /// Close the dialog of an ended job.
    Close,
}

impl Job {
    /// Creates the job when it starts. `names` are its files.
    pub fn new(kind: Kind, names: Vec<String>) -> Self {
        Self {
            kind,
            rows: names.into_iter().map(|name| (name, None)).collect(),
            at: 0,
            progress: None,
            since: None,
            retries: 0,
            traffic: Traffic::default(),
            last_error: None,
            question: None,
            over: None,
        }
    }

    /// Opens the question about an existing name.
    pub fn ask(&mut self, question: Question) {
        self.question = Some(Asking {
            question,
            of_all: false,
            naming: None,
        });
    }

    /// Handles an event of the thread.
    pub fn take(&mut self, news: News) {
        match news {
            News::At(at) => {
                self.at = at;
                self.progress = None;
                self.since = None;
            }
            News::Moves(progress, retries) => {
                self.progress = Some(progress);
                self.retries = retries;
            }
            News::Ended(at, fate) => {
                if let Fate::Refused(why) = &fate {
                    self.last_error = Some(why.clone());
                }
                if let Some(row) = self.rows.get_mut(at) {
                    row.1 = Some(fate);
                }
            }
            News::Traffic(traffic) => {
                self.traffic = traffic;
                self.retries = traffic.retries;
            }
            News::Over(why) => {
                if let Some(why) = &why {
                    self.last_error = Some(why.clone());
                }
                self.question = None;
                self.over = Some(why);
            }
            _ => {}
        }
    }

    /// The closing message of a job that has ended without errors.
    pub fn all_well(&self) -> Option<Message> {
        let well = matches!(self.over, Some(None)) && self.last_error.is_none();
        well.then(|| match self.kind {
            Kind::Delete => say::transfer_view_over(),
            Kind::Send | Kind::Receive => self.traffic.message(),
        })
    }

    /// Draws the dialog and the question. Returns the operator's request.
    pub fn show(&mut self, context: &Context, room: Rect, language: Language) -> Option<Wish> {
        let title = match self.kind {
            Kind::Send => say::transfer_view_job_send(),
            Kind::Receive => say::transfer_view_job_receive(),
            Kind::Delete => say::transfer_view_job_delete(),
        };
        let mut wish = None;
        window(context, room, &title, language, |ui| {
            ui.set_min_width(ui.available_width());
            self.list(ui, language);
            ui.separator();
            self.figures(ui, language);
            ui.add_space(6.0);
            ui.vertical_centered(|ui| {
                let (words, asked) = match self.over {
                    Some(_) => (say::transfer_view_close(), Wish::Close),
                    None => (say::window_cancel(), Wish::Cancel),
                };
                if ui.button(words.text(language)).clicked() {
                    wish = Some(asked);
                }
            });
        });
        if let Some(answer) = self.question(context, room, language) {
            self.question = None;
            wish = Some(Wish::Answer(answer));
        }
        wish
    }

    fn list(&self, ui: &mut Ui, language: Language) {
        ScrollArea::vertical()
            .id_salt("transfer job")
            .max_height(HEIGHT)
            .auto_shrink([false, false])
            .show(ui, |ui| {
                for (at, (name, fate)) in self.rows.iter().enumerate() {
                    ui.horizontal(|ui| {
                        let here = at == self.at && self.over.is_none();
                        sign(ui, fate.as_ref(), here);
                        let words = match fate {
                            Some(Fate::Refused(why)) => why.clone(),
                            Some(Fate::Skipped) => {
                                say::subject_reason(name, say::transfer_view_skipped())
                            }
                            _ => say::as_written(name),
                        };
                        let label = ui.add(Label::new(words.text(language)).wrap());
                        if here && fate.is_none() {
                            label.scroll_to_me(None);
                        }
                    });
                }
            });
    }

    fn figures(&mut self, ui: &mut Ui, language: Language) {
        let done = self.rows.iter().filter(|(_, fate)| fate.is_some()).count();
        let moved = self.kind != Kind::Delete;
        if moved {
            let progress = self.progress.unwrap_or_default();
            let kilo = |bytes: usize| bytes.div_ceil(1024);
            let words = say::transfer_view_progress(kilo(progress.done), kilo(progress.total));
            ui.label(words.text(language));
            ui.add(ProgressBar::new(share(progress)).desired_height(10.0));
        }
        // The current file counts with its transferred share.
        let part = match done < self.rows.len() && self.over.is_none() {
            true => self.progress.map_or(0.0, share),
            false => 0.0,
        };
        let total = (done as f32 + part) / (self.rows.len().max(1) as f32);
        let percent = (total.clamp(0.0, 1.0) * 100.0).floor();
        ui.label(say::transfer_view_total(percent).text(language));
        ui.add(ProgressBar::new(total.clamp(0.0, 1.0)).desired_height(10.0));
        if moved {
            ui.horizontal(|ui| {
                ui.label(say::transfer_view_retries(self.retries).text(language));
                ui.separator();
                let rate = self.rate(ui.input(|input| input.time)).round();
                ui.label(say::transfer_view_rate(rate).text(language));
            });
        }
        if let Some(why) = &self.last_error {
            let words = say::transfer_view_last_error(why.clone()).text(language);
            ui.add(Label::new(RichText::new(words).color(BAD)).wrap());
        }
    }

    /// Transfer rate, bytes per second: of the current file, else of all files before it.
    fn rate(&mut self, now: f64) -> f64 {
        let progress = self
            .progress
            .filter(|it| it.done > 0 && self.over.is_none());
        let Some(progress) = progress else {
            return self.traffic.rate();
        };
        let (since, before) = *self.since.get_or_insert((now, progress.done));
        match now - since {
            passed if passed > 0.3 => progress.done.saturating_sub(before) as f64 / passed,
            _ => self.traffic.rate(),
        }
    }

    /// Draws the question with 是 (yes), 否 (no), 取消 (cancel). 否 for a file of the control first
    /// asks for its new name.
    fn question(&mut self, context: &Context, room: Rect, language: Language) -> Option<Answer> {
        let asking = self.question.as_mut()?;
        let (place, free, entries) = match &asking.question {
            Question::AtControl {
                place,
                free,
                entries,
            } => (Some(place), free.as_ref(), entries.as_slice()),
            Question::OnDisk(_) => (None, None, [].as_slice()),
        };
        if let (Some(naming), Some(place)) = (&mut asking.naming, place) {
            let rename = naming.show(context, room, language, place.partition, entries)?;
            return Some(Answer {
                // Cancelled: the file is skipped (manual V-3.3).
                choice: rename.map_or(Choice::Skip, |to| Choice::Rename(Some(to))),
                of_all: asking.of_all,
            });
        }
        let (title, hint) = match &asking.question {
            Question::AtControl { place, .. } => (
                say::transfer_view_exists_control(&place.name),
                say::transfer_view_exists_control_hint(),
            ),
            Question::OnDisk(path) => (
                say::transfer_view_exists_disk(path.display()),
                say::transfer_view_exists_disk_hint(),
            ),
        };
        let can_rename = place.is_none() || free.is_some();
        let clicked = three(
            context,
            room,
            [&title, &hint],
            language,
            can_rename,
            &mut asking.of_all,
        )?;
        let choice = match (clicked, place) {
            (0, _) => Choice::Overwrite,
            (1, Some(place)) if !asking.of_all => {
                let proposed = free.map(FileName::to_string).unwrap_or_default();
                asking.naming = Some(Naming::new(place.name.to_string(), proposed));
                return None;
            }
            (1, _) => Choice::Rename(None),
            _ => Choice::Skip,
        };
        Some(Answer {
            choice,
            of_all: asking.of_all,
        })
    }
}

/// Draws the status of a file: a tick, a cross or a dash; an arrow for the current file.
fn sign(ui: &mut Ui, fate: Option<&Fate>, here: bool) {
    let (place, _) = ui.allocate_exact_size(vec2(SIGN, SIGN), Sense::HOVER);
    let at = |x: f32, y: f32| place.lerp_inside(vec2(x, y));
    let stroke = |ink: Color32| Stroke::new(2.0, ink);
    let text = ui.visuals().text_color();
    let painter = ui.painter();
    match fate {
        Some(Fate::Done) => {
            painter.line_segment([at(0.1, 0.55), at(0.4, 0.85)], stroke(GOOD));
            painter.line_segment([at(0.4, 0.85), at(0.9, 0.2)], stroke(GOOD));
        }
        Some(Fate::Refused(_)) => {
            painter.line_segment([at(0.15, 0.15), at(0.85, 0.85)], stroke(BAD));
            painter.line_segment([at(0.85, 0.15), at(0.15, 0.85)], stroke(BAD));
        }
        Some(Fate::Skipped) => {
            painter.line_segment([at(0.2, 0.5), at(0.8, 0.5)], stroke(text));
        }
        None if here => {
            let corners = vec![at(0.25, 0.1), at(0.85, 0.5), at(0.25, 0.9)];
            painter.add(Shape::convex_polygon(corners, text, Stroke::NONE));
        }
        None => {}
    }
}

/// Transferred share of a file, 0–1.
fn share(progress: TransferProgress) -> f32 {
    match progress.total {
        0 => 0.0,
        total => progress.done as f32 / total as f32,
    }
}

/// Draws the question with its three answers. Returns the index of the clicked one.
fn three(
    context: &Context,
    room: Rect,
    words: [&Message; 2],
    language: Language,
    can_rename: bool,
    of_all: &mut bool,
) -> Option<usize> {
    let mut clicked = None;
    let [asked, hint] = words.map(|said| said.text(language));
    window(
        context,
        room,
        &say::transfer_view_exists(),
        language,
        |ui| {
            ui.label(asked);
            ui.add_space(4.0);
            ui.label(RichText::new(hint).weak());
            ui.add_space(6.0);
            ui.checkbox(of_all, say::transfer_view_all_same().text(language));
            ui.add_space(6.0);
            ui.horizontal(|ui| {
                let answers = [
                    (say::transfer_view_yes(), true),
                    (say::transfer_view_no(), can_rename),
                    (say::window_cancel(), true),
                ];
                for (at, (words, enabled)) in answers.into_iter().enumerate() {
                    let button = egui::Button::new(words.text(language));
                    if ui.add_enabled(enabled, button).clicked() {
                        clicked = Some(at);
                    }
                }
            });
        },
    );
    clicked
}
