//! The form of a teacher that makes an exercise from the part in the lathe.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crossbeam::channel::{Receiver, Sender, unbounded};
use egui::{Button, DragValue, Grid, RichText, TextEdit, Ui};
use gsk_core::command::ProgramId;
use gsk_exercise::draft::{PartDraft, PickedDimension, propose_text, propose_title};
use gsk_host::files::exercises::{self, AvailableExercises};
use gsk_host::kernel::Console;
use gsk_host::kernel::part::PartView;
use gsk_lesson::LessonText;
use gsk_messages::{Language, Message, say};
use gsk_workpiece::measure::Feature;

use crate::theme;
use crate::widgets::files::run_in_thread;

/// Width of the fields for names and titles, points.
const FIELD_WIDTH: f32 = 220.0;
/// Number of rows of the field for the task's text.
const TEXT_ROWS: usize = 3;
/// Default time limit in a new form, minutes.
const USUAL_MINUTES: u32 = 60;
/// Greatest size and deviation that can be typed, mm.
const MAX_SIZE: f64 = 9999.0;

/// The form in which a teacher turns a part into an exercise.
#[derive(Clone)]
struct PartExerciseForm {
    name: String,
    title: LessonText,
    text: LessonText,
    minutes: u32,
    gives_program: bool,
    dimensions: Vec<PickedDimension>,
}

impl Default for PartExerciseForm {
    fn default() -> Self {
        let empty = || LessonText {
            zh: String::new(),
            en: String::new(),
        };
        Self {
            name: String::new(),
            title: empty(),
            text: empty(),
            minutes: USUAL_MINUTES,
            gives_program: false,
            dimensions: Vec::new(),
        }
    }
}

/// The exercises after one was written, and the message about it.
type WrittenExercise = Result<(AvailableExercises, Message), Message>;

/// The form for a new exercise under the list of exercises.
pub struct PartExercisePane {
    console: Console,
    data: Option<PathBuf>,
    form: PartExerciseForm,
    /// The surface that was clicked with the caliper; `None` without one.
    picked: Option<Feature>,
    message: Option<Message>,
    /// Whether the message was not shown yet: it is below the button, where the list may end.
    is_message_new: bool,
    sender: Sender<WrittenExercise>,
    receiver: Receiver<WrittenExercise>,
}

impl PartExercisePane {
    pub fn new(console: Console) -> Self {
        let (sender, receiver) = unbounded();
        Self {
            console,
            data: None,
            form: PartExerciseForm::default(),
            picked: None,
            message: None,
            is_message_new: false,
            sender,
            receiver,
        }
    }

    /// Sets the data folder in which exercises are written.
    pub fn set_data(&mut self, data: PathBuf) {
        self.data = Some(data);
    }

    /// Sets the surface that the teacher has clicked with the caliper.
    pub const fn set_picked(&mut self, picked: Option<Feature>) {
        self.picked = picked;
    }

    /// Takes the exercises after one was written; `None` if none was.
    pub fn receive(&mut self) -> Option<AvailableExercises> {
        let written = self.receiver.try_iter().last()?;
        self.is_message_new = true;
        match written {
            Ok((found, message)) => {
                self.form = PartExerciseForm::default();
                self.message = Some(message);
                Some(found)
            }
            Err(why) => {
                self.message = Some(why);
                None
            }
        }
    }

    /// Draws the form for an exercise from a part.
    pub fn show(&mut self, ui: &mut Ui, language: Language, part: Option<&Arc<PartView>>) {
        ui.add_space(8.0);
        let heading = say::exercise_part_heading().text(language);
        egui::CollapsingHeader::new(heading)
            .id_salt("part-exercise")
            .show(ui, |ui| {
                ui.label(say::exercise_part_intro().text(language));
                self.show_add(ui, language, part);
                show_dimensions(ui, language, &mut self.form.dimensions);
                show_fields(ui, language, &mut self.form);
                let write = Button::new(say::exercise_part_write().text(language));
                let is_ready = part.is_some() && !self.form.dimensions.is_empty();
                let write = ui.add_enabled(is_ready, write);
                let hint = say::exercise_part_add_hint().text(language);
                if write.on_disabled_hover_text(hint).clicked()
                    && let Some(part) = part
                {
                    self.write(ui, part);
                }
                if let Some(message) = &self.message {
                    let words = RichText::new(message.text(language));
                    let shown = ui.label(words.color(theme::LESSON_HINT_TEXT));
                    if core::mem::take(&mut self.is_message_new) {
                        shown.scroll_to_me(None);
                    }
                }
            });
    }

    /// Draws the button that adds the clicked surface as a dimension.
    fn show_add(&mut self, ui: &mut Ui, language: Language, part: Option<&Arc<PartView>>) {
        let Some(part) = part else {
            let why = say::exercise_part_no_part().text(language);
            ui.label(RichText::new(why).color(theme::NOTE_TEXT));
            return;
        };
        let is_new = |picked: &PickedDimension| {
            let mut listed = self.form.dimensions.iter();
            !listed.any(|it| it.dimension == picked.dimension)
        };
        let picked = self.picked.as_ref();
        let picked = picked.and_then(|it| PickedDimension::from_feature(&part.section, it));
        let words = match &picked {
            Some(picked) => say::exercise_part_add(picked.kind(), picked.size),
            None => say::exercise_part_add_none(),
        };
        let picked = picked.filter(is_new);
        let add = ui.add_enabled(picked.is_some(), Button::new(words.text(language)));
        let hint = say::exercise_part_add_hint().text(language);
        let add = add.on_hover_text(&hint).on_disabled_hover_text(&hint);
        if add.clicked() {
            self.form.dimensions.extend(picked);
        }
    }

    /// Starts a thread that writes the files of the exercise.
    fn write(&mut self, ui: &Ui, part: &Arc<PartView>) {
        let Some(data) = self.data.clone() else {
            return;
        };
        let (form, part, to) = (self.form.clone(), Arc::clone(part), self.sender.clone());
        let console = self.console.clone();
        run_in_thread(ui.ctx(), &self.console.notice_sender, move || {
            // The send fails when the window is gone: the exercise is on the disk.
            let _ = to.send(write_exercise(&console, &form, &part, &data));
            None
        });
    }
}

/// Drafts the task from the current machine, writes it and reads all exercises again.
fn write_exercise(
    console: &Console,
    form: &PartExerciseForm,
    part: &PartView,
    data: &Path,
) -> WrittenExercise {
    let setup = console.setup().ok_or_else(say::exercise_part_no_part)?;
    let program = match setup.memory.programs.selected() {
        Some(ProgramId::Stored(number)) => number,
        _ => 0,
    };
    let proposed = propose_text(program, &part.job, setup.absolute.unwrap_or_default());
    let draft = PartDraft {
        title: fill_text(&form.title, propose_title(program)),
        text: fill_text(&form.text, proposed),
        time_limit_min: form.minutes,
        setup: &setup,
        job: &part.job,
        section: &part.section,
        dimensions: &form.dimensions,
        gives_program: form.gives_program,
    };
    let file = exercises::write_new(data, form.name.trim(), &draft.write()?)?;
    let message = say::exercise_part_written(file.display());
    Ok((exercises::load_exercises(Some(data)), message))
}

/// Fills a language that is empty with the other one, and both with a proposal.
fn fill_text(typed: &LessonText, proposed: LessonText) -> LessonText {
    let (zh, en) = (typed.zh.trim().to_owned(), typed.en.trim().to_owned());
    match (zh.is_empty(), en.is_empty()) {
        (true, true) => proposed,
        (true, false) => LessonText { zh: en.clone(), en },
        (false, true) => LessonText { en: zh.clone(), zh },
        (false, false) => LessonText { zh, en },
    }
}

/// Draws the selected dimensions with fields for their tolerances.
fn show_dimensions(ui: &mut Ui, language: Language, dimensions: &mut Vec<PickedDimension>) {
    if dimensions.is_empty() {
        return;
    }
    let mut removed = None;
    Grid::new("picked dimensions").striped(true).show(ui, |ui| {
        ui.label("");
        for heading in [
            say::exercise_part_column_size(),
            say::exercise_part_column_upper(),
            say::exercise_part_column_lower(),
            say::exercise_part_column_points(),
        ] {
            ui.label(heading.text(language));
        }
        ui.end_row();
        for (index, picked) in dimensions.iter_mut().enumerate() {
            ui.label(picked.kind().text(language));
            for value in [&mut picked.size, &mut picked.upper, &mut picked.lower] {
                let field = DragValue::new(value).speed(0.01).max_decimals(3);
                ui.add(field.range(-MAX_SIZE..=MAX_SIZE));
            }
            ui.add(DragValue::new(&mut picked.points).range(1..=100));
            if ui
                .small_button(say::exercise_part_remove().text(language))
                .clicked()
            {
                removed = Some(index);
            }
            ui.end_row();
        }
    });
    if let Some(index) = removed {
        dimensions.remove(index);
    }
}

/// Draws the fields for name, texts, time and program.
fn show_fields(ui: &mut Ui, language: Language, form: &mut PartExerciseForm) {
    let hint = say::exercise_part_proposed().text(language);
    let name = ui.label(say::exercise_part_name().text(language));
    ui.add(TextEdit::singleline(&mut form.name).desired_width(FIELD_WIDTH))
        .labelled_by(name.id)
        .on_hover_text(say::exercise_part_name_hint().text(language));
    for (label, value, rows) in [
        (say::exercise_part_title_en(), &mut form.title.en, 1),
        (say::exercise_part_title_zh(), &mut form.title.zh, 1),
        (say::exercise_part_text_en(), &mut form.text.en, TEXT_ROWS),
        (say::exercise_part_text_zh(), &mut form.text.zh, TEXT_ROWS),
    ] {
        let label = ui.label(label.text(language));
        let field = match rows {
            1 => TextEdit::singleline(value),
            _ => TextEdit::multiline(value).desired_rows(rows),
        };
        let field = field.desired_width(f32::INFINITY).hint_text(&hint);
        ui.add(field).labelled_by(label.id);
    }
    ui.horizontal(|ui| {
        let label = ui.label(say::exercise_part_minutes().text(language));
        ui.add(DragValue::new(&mut form.minutes).range(1..=600))
            .labelled_by(label.id);
    });
    ui.checkbox(
        &mut form.gives_program,
        say::exercise_part_gives().text(language),
    )
    .on_hover_text(say::exercise_part_gives_hint().text(language));
}
