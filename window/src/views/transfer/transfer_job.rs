//! The running transfer job: the dialog 文件传输 (manual V-3.3), with its question about an
//! existing file name.

use egui::{
    Color32, Context, Label, ProgressBar, Rect, RichText, ScrollArea, Sense, Shape, Stroke, Ui,
    vec2,
};
use gsk_host::pc::TransferTotals;
use gsk_host::pc::worker::{
    FileJobKind, FileResult, NameConflict, NameConflictAnswer, NameConflictChoice, PcWorkerEvent,
};
use gsk_messages::{Language, Message, say};
use gsk_transfer::{FileName, TransferProgress};

use super::rename_fields::{RenameFields, show_window};
use crate::theme;

/// Height of the list of files, points.
const LIST_HEIGHT: f32 = 160.0;
/// Width and height of the status sign before a file, points.
const SIGN_SIZE: f32 = 12.0;

/// A transfer job with the progress of its files.
pub struct TransferJob {
    kind: FileJobKind,
    rows: Vec<(String, Option<FileResult>)>,
    current_row: usize,
    progress: Option<TransferProgress>,
    /// Time of the first progress of the current file, seconds of the window's clock, and the
    /// bytes transferred by then; `None` before.
    rate_start: Option<(f64, usize)>,
    retries: u64,
    traffic: TransferTotals,
    last_error: Option<Message>,
    question: Option<OpenQuestion>,
    /// Set when the job has ended; the inner value is the error, `None` after success.
    end: Option<Option<Message>>,
}

/// The open question about a file name that is taken.
struct OpenQuestion {
    question: NameConflict,
    for_all: bool,
    /// The fields for the new name of a file of the control; `None` until the operator chooses
    /// to rename.
    naming: Option<RenameFields>,
}

/// A request of the operator in the dialog of a job.
pub enum JobRequest {
    /// Cancel the job that is running.
    Cancel,
    /// Answer the question about a file name.
    Answer(NameConflictAnswer),
    /// Close the dialog of an ended job.
    Close,
}

impl TransferJob {
    /// Creates a job that has just started. `names` are those of its files.
    pub fn new(kind: FileJobKind, names: Vec<String>) -> Self {
        Self {
            kind,
            rows: names.into_iter().map(|name| (name, None)).collect(),
            current_row: 0,
            progress: None,
            rate_start: None,
            retries: 0,
            traffic: TransferTotals::default(),
            last_error: None,
            question: None,
            end: None,
        }
    }

    /// Opens the question about a file name that is taken.
    pub fn set_question(&mut self, question: NameConflict) {
        self.question = Some(OpenQuestion {
            question,
            for_all: false,
            naming: None,
        });
    }

    /// Updates the job with an event of the worker thread.
    pub fn handle_event(&mut self, news: PcWorkerEvent) {
        match news {
            PcWorkerEvent::FileBegun(at) => {
                self.current_row = at;
                self.progress = None;
                self.rate_start = None;
            }
            PcWorkerEvent::Progress(progress, retries) => {
                self.progress = Some(progress);
                self.retries = retries;
            }
            PcWorkerEvent::FileEnded(at, fate) => {
                if let FileResult::Refused(reason) = &fate {
                    self.last_error = Some(reason.clone());
                }
                if let Some(row) = self.rows.get_mut(at) {
                    row.1 = Some(fate);
                }
            }
            PcWorkerEvent::Totals(traffic) => {
                self.traffic = traffic;
                self.retries = traffic.retries;
            }
            PcWorkerEvent::JobFinished(reason) => {
                if let Some(why) = &reason {
                    self.last_error = Some(why.clone());
                }
                self.question = None;
                self.end = Some(reason);
            }
            _ => {}
        }
    }

    /// Returns the closing message of a job that has ended without errors; `None` for any
    /// other.
    pub fn success_message(&self) -> Option<Message> {
        let is_success = matches!(self.end, Some(None)) && self.last_error.is_none();
        is_success.then(|| match self.kind {
            FileJobKind::Delete => say::transfer_view_over(),
            FileJobKind::Send | FileJobKind::Receive => self.traffic.message(),
        })
    }

    /// Draws the dialog of the job and its question. Returns the operator's request; `None` without
    /// one.
    pub fn show(
        &mut self,
        context: &Context,
        bounds: Rect,
        language: Language,
    ) -> Option<JobRequest> {
        let title = match self.kind {
            FileJobKind::Send => say::transfer_view_job_send(),
            FileJobKind::Receive => say::transfer_view_job_receive(),
            FileJobKind::Delete => say::transfer_view_job_delete(),
        };
        let mut request = None;
        show_window(context, bounds, &title, language, |ui| {
            ui.set_min_width(ui.available_width());
            self.show_files(ui, language);
            ui.separator();
            self.show_progress(ui, language);
            ui.add_space(6.0);
            ui.vertical_centered(|ui| {
                let (label, button_request) = match self.end {
                    Some(_) => (say::transfer_view_close(), JobRequest::Close),
                    None => (say::window_cancel(), JobRequest::Cancel),
                };
                if ui.button(label.text(language)).clicked() {
                    request = Some(button_request);
                }
            });
        });
        if let Some(answer) = self.show_question(context, bounds, language) {
            self.question = None;
            request = Some(JobRequest::Answer(answer));
        }
        request
    }

    fn show_files(&self, ui: &mut Ui, language: Language) {
        ScrollArea::vertical()
            .id_salt("transfer job")
            .max_height(LIST_HEIGHT)
            .auto_shrink([false, false])
            .show(ui, |ui| {
                for (at, (name, fate)) in self.rows.iter().enumerate() {
                    ui.horizontal(|ui| {
                        let is_current = at == self.current_row && self.end.is_none();
                        show_status_sign(ui, fate.as_ref(), is_current);
                        let text = match fate {
                            Some(FileResult::Refused(reason)) => reason.clone(),
                            Some(FileResult::Skipped) => {
                                say::subject_reason(name, say::transfer_view_skipped())
                            }
                            _ => say::as_written(name),
                        };
                        let label = ui.add(Label::new(text.text(language)).wrap());
                        if is_current && fate.is_none() {
                            label.scroll_to_me(None);
                        }
                    });
                }
            });
    }

    fn show_progress(&mut self, ui: &mut Ui, language: Language) {
        let done = self.rows.iter().filter(|(_, fate)| fate.is_some()).count();
        let shows_bytes = self.kind != FileJobKind::Delete;
        if shows_bytes {
            let progress = self.progress.unwrap_or_default();
            let kilo = |bytes: usize| bytes.div_ceil(1024);
            let text = say::transfer_view_progress(kilo(progress.done), kilo(progress.total));
            ui.label(text.text(language));
            ui.add(ProgressBar::new(transferred_share(progress)).desired_height(10.0));
        }
        // The current file counts with its transferred share.
        let current_share = match done < self.rows.len() && self.end.is_none() {
            true => self.progress.map_or(0.0, transferred_share),
            false => 0.0,
        };
        let total = (done as f32 + current_share) / (self.rows.len().max(1) as f32);
        let percent = (total.clamp(0.0, 1.0) * 100.0).floor();
        ui.label(say::transfer_view_total(percent).text(language));
        ui.add(ProgressBar::new(total.clamp(0.0, 1.0)).desired_height(10.0));
        if shows_bytes {
            ui.horizontal(|ui| {
                ui.label(say::transfer_view_retries(self.retries).text(language));
                ui.separator();
                let rate = self.bytes_per_second(ui.input(|input| input.time)).round();
                ui.label(say::transfer_view_rate(rate).text(language));
            });
        }
        if let Some(reason) = &self.last_error {
            let text = say::transfer_view_last_error(reason.clone()).text(language);
            ui.add(Label::new(RichText::new(text).color(theme::ALARM_TEXT)).wrap());
        }
    }

    /// Transfer rate, bytes per second: of the current file, else of all files before it.
    fn bytes_per_second(&mut self, now_s: f64) -> f64 {
        let progress = self.progress.filter(|it| it.done > 0 && self.end.is_none());
        let Some(progress) = progress else {
            return self.traffic.rate();
        };
        let (since, bytes_before) = *self.rate_start.get_or_insert((now_s, progress.done));
        match now_s - since {
            elapsed if elapsed > 0.3 => progress.done.saturating_sub(bytes_before) as f64 / elapsed,
            _ => self.traffic.rate(),
        }
    }

    /// Draws the question with 是 (yes), 否 (no), 取消 (cancel) and returns the answer; `None` without
    /// one. 否 for a file of the control first requests its new name.
    fn show_question(
        &mut self,
        context: &Context,
        bounds: Rect,
        language: Language,
    ) -> Option<NameConflictAnswer> {
        let open_question = self.question.as_mut()?;
        let (path, free_name, entries) = match &open_question.question {
            NameConflict::AtControl {
                location: place,
                free_name: free,
                entries,
            } => (Some(place), free.as_ref(), entries.as_slice()),
            NameConflict::OnDisk(_) => (None, None, [].as_slice()),
        };
        if let (Some(naming), Some(place)) = (&mut open_question.naming, path) {
            let rename = naming.show(context, bounds, language, place.partition, entries)?;
            return Some(NameConflictAnswer {
                // Cancelled: the file is skipped (manual V-3.3).
                choice: rename.map_or(NameConflictChoice::Skip, |to| {
                    NameConflictChoice::Rename(Some(to))
                }),
                for_all: open_question.for_all,
            });
        }
        let (title, hint) = match &open_question.question {
            NameConflict::AtControl {
                location: place, ..
            } => (
                say::transfer_view_exists_control(&place.name),
                say::transfer_view_exists_control_hint(),
            ),
            NameConflict::OnDisk(path) => (
                say::transfer_view_exists_disk(path.display()),
                say::transfer_view_exists_disk_hint(),
            ),
        };
        let can_rename = path.is_none() || free_name.is_some();
        let clicked = show_three_answers(
            context,
            bounds,
            [&title, &hint],
            language,
            can_rename,
            &mut open_question.for_all,
        )?;
        let choice = match (clicked, path) {
            (0, _) => NameConflictChoice::Overwrite,
            (1, Some(place)) if !open_question.for_all => {
                let proposed = free_name.map(FileName::to_string).unwrap_or_default();
                open_question.naming = Some(RenameFields::new(place.name.to_string(), proposed));
                return None;
            }
            (1, _) => NameConflictChoice::Rename(None),
            _ => NameConflictChoice::Skip,
        };
        Some(NameConflictAnswer {
            choice,
            for_all: open_question.for_all,
        })
    }
}

/// Draws the status of a file: a tick if done, a cross if refused, a dash if skipped; an arrow
/// for the current file.
fn show_status_sign(ui: &mut Ui, fate: Option<&FileResult>, is_current: bool) {
    let (bounds, _) = ui.allocate_exact_size(vec2(SIGN_SIZE, SIGN_SIZE), Sense::HOVER);
    let point = |x: f32, y: f32| bounds.lerp_inside(vec2(x, y));
    let stroke = |ink: Color32| Stroke::new(2.0, ink);
    let text = ui.visuals().text_color();
    let painter = ui.painter();
    match fate {
        Some(FileResult::Done) => {
            painter.line_segment([point(0.1, 0.55), point(0.4, 0.85)], stroke(theme::SUCCESS));
            painter.line_segment([point(0.4, 0.85), point(0.9, 0.2)], stroke(theme::SUCCESS));
        }
        Some(FileResult::Refused(_)) => {
            painter.line_segment(
                [point(0.15, 0.15), point(0.85, 0.85)],
                stroke(theme::ALARM_TEXT),
            );
            painter.line_segment(
                [point(0.85, 0.15), point(0.15, 0.85)],
                stroke(theme::ALARM_TEXT),
            );
        }
        Some(FileResult::Skipped) => {
            painter.line_segment([point(0.2, 0.5), point(0.8, 0.5)], stroke(text));
        }
        None if is_current => {
            let corners = vec![point(0.25, 0.1), point(0.85, 0.5), point(0.25, 0.9)];
            painter.add(Shape::convex_polygon(corners, text, Stroke::NONE));
        }
        None => {}
    }
}

/// Returns the share of a file that has been transferred, 0 to 1.
fn transferred_share(progress: TransferProgress) -> f32 {
    match progress.total {
        0 => 0.0,
        total => progress.done as f32 / total as f32,
    }
}

/// Draws the question with its three answers. Returns the index of the clicked one; `None`
/// while it is open.
fn show_three_answers(
    context: &Context,
    bounds: Rect,
    texts: [&Message; 2],
    language: Language,
    can_rename: bool,
    for_all: &mut bool,
) -> Option<usize> {
    let mut clicked = None;
    let [question, hint] = texts.map(|text| text.text(language));
    show_window(
        context,
        bounds,
        &say::transfer_view_exists(),
        language,
        |ui| {
            ui.label(question);
            ui.add_space(4.0);
            ui.label(RichText::new(hint).weak());
            ui.add_space(6.0);
            ui.checkbox(for_all, say::transfer_view_all_same().text(language));
            ui.add_space(6.0);
            ui.horizontal(|ui| {
                let answers = [
                    (say::transfer_view_yes(), true),
                    (say::transfer_view_no(), can_rename),
                    (say::window_cancel(), true),
                ];
                for (at, (label, enabled)) in answers.into_iter().enumerate() {
                    let button = egui::Button::new(label.text(language));
                    if ui.add_enabled(enabled, button).clicked() {
                        clicked = Some(at);
                    }
                }
            });
        },
    );
    clicked
}
