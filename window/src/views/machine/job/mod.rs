//! The job panel beside the picture: stock and tools. A change is clamped at once and can be
//! saved as the job file of the program.

mod fields;
mod library_list;
mod program_saver;
mod tool_drawing;
pub mod unknown_setting;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{Color32, ScrollArea, Ui};
use gsk_core::command::ProgramId;
use gsk_core::program::Program;
use gsk_help::{Subject, topic};
use gsk_host::job;
use gsk_host::kernel::Console;
use gsk_messages::{Language, Message, say};
use gsk_runner::text_format::short_description;
use gsk_workpiece::job::Job;
use gsk_workpiece::tool::Tool;

use crate::focus;
use crate::help;
use crate::theme;
use library_list::ToolLibraryList;
use program_saver::ProgramSaver;

/// The highest tool number of a job.
const MAX_TOOL_NUMBER: u8 = 99;

/// Height below which the whole panel scrolls and not only the fields of the selected item,
/// points.
const LOW_PANEL_HEIGHT: f32 = 400.0;

/// The item of the job (stock or a tool) whose fields are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum JobItem {
    #[default]
    Stock,
    Tool(u8),
    Library,
}

/// A kind of tool that can be added, as functions that return its name and its initial values.
type ToolTemplate = (fn() -> Message, fn() -> Tool);

const TOOL_TEMPLATES: [ToolTemplate; 5] = [
    (say::tool_kind_turning, Tool::turning),
    (say::tool_kind_boring, Tool::boring),
    (say::tool_kind_grooving, || Tool::grooving(3.0)),
    (say::tool_kind_threading, || Tool::threading(60.0)),
    (say::tool_kind_drill, || Tool::drill(10.0)),
];

/// The state of the lathe on which the job panel depends.
pub struct JobContext<'a> {
    /// The job of the part that is being cut.
    pub job: &'a Arc<Job>,
    /// Whether the job was guessed from the program and not read.
    pub is_guessed: bool,
    /// Whether the user has changed the job of the program.
    pub is_changed: bool,
    /// The selected program; `None` without one.
    pub program: Option<(ProgramId, &'a Program)>,
    /// The file of the program; `None` if the program has none.
    pub program_file: Option<&'a Path>,
    /// The tool numbers that the program uses.
    pub used_tools: Vec<u8>,
    pub is_running: bool,
    /// Whether the tool post is on the far side of the spindle.
    pub rear_tool_post: bool,
    /// The reason why the job file on the disk cannot be used; `None` if it can.
    pub file_error: Option<&'a Message>,
    pub console: &'a Console,
}

/// The panel in which the user edits stock and tools.
#[derive(Default)]
pub struct JobPanel {
    selected: JobItem,
    /// The job of the lathe with which the draft began; `None` without one.
    base_job: Option<Arc<Job>>,
    draft: Option<Job>,
    /// The draft that was clamped in the lathe last; `None` before the first one.
    clamped: Option<Job>,
    /// The job of the lathe before the first change in this panel; `None` before that change.
    original_job: Option<Job>,
    /// The path of the program's job file, whether the file exists or not; `None` without a program
    /// file.
    job_file: Option<PathBuf>,
    /// The job file that was read or written last, and its contents; `None` before that.
    saved: Option<(PathBuf, Job)>,
    message: Option<(Message, Color32)>,
    program_saver: ProgramSaver,
    library: ToolLibraryList,
}

impl JobPanel {
    /// Draws the panel. Returns a changed job that must be clamped in the lathe, if there is
    /// one.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        context: &JobContext<'_>,
        language: Language,
    ) -> Option<Job> {
        if ui.rect_contains_pointer(ui.max_rect()) {
            help::point_at_topic(ui, topic(Subject::Notion("tools and stock")));
        }
        self.update_draft(context);
        let path = context.program_file.map(job::job_path);
        if self.job_file != path {
            let read = path.as_deref().and_then(|path| job::read(path).ok());
            self.saved = path.clone().zip(read);
            self.job_file = path;
        }
        let mut job = self.draft.take()?;
        if ui.available_height() < LOW_PANEL_HEIGHT {
            scroll(ui, "job", |ui| {
                self.show_head(ui, &mut job, context, language);
                ui.add_enabled_ui(!context.is_running, |ui| {
                    self.show_item(ui, &mut job, context, language);
                });
            });
        } else {
            self.show_head(ui, &mut job, context, language);
            ui.add_enabled_ui(!context.is_running, |ui| {
                // The fields of another item are shown from their beginning.
                let item = format!("{:?}", self.selected);
                scroll(ui, &item, |ui| {
                    self.show_item(ui, &mut job, context, language);
                });
            });
        }
        let rule = job.check();
        // Nothing is clamped while the pointer drags a value.
        let is_released = !ui.input(|input| input.pointer.any_down());
        let needs_clamping = rule.is_ok()
            && is_released
            && !context.is_running
            && self.clamped.as_ref() != Some(&job);
        let clamp = needs_clamping.then(|| job.clone());
        if clamp.is_some() {
            self.clamped.clone_from(&clamp);
        }
        self.draft = Some(job);
        clamp
    }

    /// Whether the edited job differs from its file or, without a file, from the lathe's
    /// original job.
    pub fn is_unsaved(&self) -> bool {
        let saved_job = self.saved.as_ref().map(|(_, saved)| saved);
        let reference_job = saved_job.or(self.original_job.as_ref());
        let jobs = self.draft.as_ref().zip(reference_job);
        jobs.is_some_and(|(draft, kept)| draft != kept)
    }

    /// Takes a program that had no file and was saved together with its job; `None` without one.
    pub fn take_saved_program(&self) -> Option<(ProgramId, PathBuf)> {
        self.program_saver.take_saved()
    }

    /// Whether `job` was edited in this panel and then clamped.
    pub fn is_own_change(&self, job: &Job) -> bool {
        self.original_job.as_ref() != Some(job) && self.clamped.as_ref() == Some(job)
    }

    /// Starts a new draft if the lathe has a job that does not come from this panel.
    fn update_draft(&mut self, lathe: &JobContext<'_>) {
        let same = self.base_job.as_ref();
        if same.is_some_and(|base| Arc::ptr_eq(base, lathe.job)) {
            return;
        }
        self.base_job = Some(Arc::clone(lathe.job));
        let job = lathe.job.as_ref();
        if self.clamped.as_ref() == Some(job) {
            return;
        }
        self.draft = Some(job.clone());
        self.clamped = Some(job.clone());
        self.original_job = Some(job.clone());
        (self.job_file, self.saved) = (None, None);
        self.message = None;
        if let JobItem::Tool(number) = self.selected
            && !job.tools.contains_key(&number)
        {
            self.selected = JobItem::Stock;
        }
    }

    /// Draws what is above the fields of the selected item: the origin of the job, and the list
    /// of stock and tools.
    fn show_head(
        &mut self,
        ui: &mut Ui,
        job: &mut Job,
        lathe: &JobContext<'_>,
        language: Language,
    ) {
        self.show_origin(ui, lathe, job, language);
        if lathe.is_running {
            let words = say::job_while_running().text(language);
            ui.colored_label(theme::WARNING, words);
        }
        ui.add_enabled_ui(!lathe.is_running, |ui| {
            self.show_list(ui, job, lathe, language);
        });
        ui.separator();
    }

    /// Draws the origin of the job (file or guess), the button that saves it, and the one that
    /// makes zero and tools unknown.
    fn show_origin(
        &mut self,
        ui: &mut Ui,
        lathe: &JobContext<'_>,
        job: &mut Job,
        language: Language,
    ) {
        let file = self.saved.as_ref().map(|(path, _)| file_name(path));
        let is_saved = self.saved.as_ref().is_some_and(|(_, saved)| saved == job);
        let (words, color) = match file {
            Some(file) if is_saved => (say::job_from_file(file), theme::JOB_VALID),
            Some(file) => (say::job_differs(file), theme::WARNING),
            None if lathe.is_changed || self.original_job.as_ref() != Some(job) => {
                (say::job_unsaved(), theme::WARNING)
            }
            None if lathe.is_guessed => (say::job_guessed(), theme::WARNING),
            None => (say::job_of_sample(), theme::JOB_VALID),
        };
        ui.colored_label(color, words.text(language));
        let rule = job.check().err();
        ui.horizontal_wrapped(|ui| {
            let can_save = rule.is_none() && !is_saved && lathe.program.is_some();
            let (name, hint) = match lathe.program_file {
                Some(_) => (say::job_save(), say::job_save_hint()),
                None => (say::job_save_as(), say::job_save_as_hint()),
            };
            let button = ui.add_enabled(can_save, egui::Button::new(name.text(language)));
            let button = button.on_hover_text(hint.text(language));
            if button.clicked() {
                self.save(ui, lathe, job, language);
            }
            let is_unknown = unknown_setting::is_unknown(job);
            let unknown = egui::Button::new(say::job_set_unknown().text(language));
            let unknown = ui.add_enabled(!lathe.is_running, unknown.selected(is_unknown));
            let hint = say::job_set_unknown_hint().text(language);
            if unknown.on_hover_text(hint).clicked() {
                match is_unknown {
                    true => unknown_setting::make_known(job),
                    false => unknown_setting::make_unknown(job),
                }
            }
        });
        if lathe.program.is_none() {
            ui.weak(say::job_without_program().text(language));
        }
        if let Some(rule) = rule {
            ui.colored_label(theme::JOB_ERROR, rule.text(language));
        } else if let Some((message, color)) = &self.message {
            ui.colored_label(*color, message.text(language));
        }
        ui.separator();
    }

    /// Saves the job beside the program, or both under a new name if the program has no file.
    fn save(&mut self, ui: &Ui, lathe: &JobContext<'_>, job: &Job, language: Language) {
        let Some(file) = lathe.program_file else {
            if let Some(program) = lathe.program {
                let saver = &self.program_saver;
                saver.save(program, job, lathe.console, ui.ctx(), language);
            }
            return;
        };
        if let Some(error) = lathe.file_error {
            // Saving would overwrite a misspelt file that a user has written.
            self.message = Some((say::job_file_in_trouble(error.clone()), theme::JOB_ERROR));
            return;
        }
        let path = job::job_path(file);
        self.message = Some(match job::write(&path, job) {
            Ok(()) => {
                let message = say::window_saved(path.display());
                self.saved = Some((path, job.clone()));
                (message, theme::JOB_VALID)
            }
            Err(error) => (error.message(), theme::JOB_ERROR),
        });
    }

    /// Draws the list of stock and tools, with buttons that add and remove tools.
    fn show_list(
        &mut self,
        ui: &mut Ui,
        job: &mut Job,
        lathe: &JobContext<'_>,
        language: Language,
    ) {
        let stock = say::job_stock().text(language);
        if ui
            .selectable_label(self.selected == JobItem::Stock, stock)
            .clicked()
        {
            self.selected = JobItem::Stock;
        }
        for (number, tool) in &job.tools {
            let words = format!("T{number:02}  {}", short_description(tool).text(language));
            let chosen = self.selected == JobItem::Tool(*number);
            if ui.selectable_label(chosen, words).clicked() {
                self.selected = JobItem::Tool(*number);
            }
        }
        let missing = lathe
            .used_tools
            .iter()
            .find(|it| !job.tools.contains_key(it));
        if let Some(number) = missing {
            let words = say::job_tool_missing(*number).text(language);
            ui.colored_label(theme::WARNING, words);
        }
        ui.horizontal_wrapped(|ui| {
            let number = free_number(job, lathe);
            ui.menu_button(say::job_tool_add().text(language), |ui| {
                for (name, tool) in &TOOL_TEMPLATES {
                    let Some(number) = number else { return };
                    if ui.button(name().text(language)).clicked() {
                        job.tools.insert(number, tool());
                        self.selected = JobItem::Tool(number);
                        ui.close();
                    }
                }
            });
            let library = say::tool_library_name().text(language);
            let is_shown = self.selected == JobItem::Library;
            if ui.selectable_label(is_shown, library).clicked() {
                self.selected = JobItem::Library;
            }
            if let JobItem::Tool(number) = self.selected
                && ui
                    .button(say::job_tool_remove(number).text(language))
                    .clicked()
            {
                job.tools.remove(&number);
                job.lengths.remove(&number);
                job.library.remove(&number);
                self.selected = JobItem::Stock;
            }
        });
    }

    /// Draws the fields of the selected item: with its picture for a tool, the tool library
    /// with the tools to use.
    fn show_item(
        &mut self,
        ui: &mut Ui,
        job: &mut Job,
        lathe: &JobContext<'_>,
        language: Language,
    ) {
        match self.selected {
            JobItem::Stock => {
                fields::show_stock(ui, &mut job.stock, language);
                ui.separator();
                match unknown_setting::is_unknown(job) {
                    true => show_hidden(ui, language),
                    false => fields::show_zero(ui, &mut job.zero, language),
                }
            }
            JobItem::Tool(number) => {
                let is_unknown = unknown_setting::is_unknown(job);
                let Some(tool) = job.tools.get_mut(&number) else {
                    return;
                };
                if let Some(id) = job.library.get(&number) {
                    ui.label(say::job_tool_of_library(id).text(language));
                }
                tool_drawing::show(ui, tool, lathe.rear_tool_post, language);
                let before = tool.clone();
                fields::show_tool(ui, tool, language);
                if *tool != before {
                    // It is no longer the tool of the library.
                    job.library.remove(&number);
                }
                ui.separator();
                match is_unknown {
                    true => show_hidden(ui, language),
                    false => fields::show_length(ui, &mut job.lengths, number, language),
                }
                if !job.library.contains_key(&number) {
                    self.library.show_keeping(ui, job, number, language);
                }
            }
            JobItem::Library => {
                let free = free_number(job, lathe);
                if let Some(number) = self.library.show(ui, job, free, lathe, language) {
                    self.selected = JobItem::Tool(number);
                }
            }
        }
    }
}

/// Says in place of zero and lengths that they are to be found by trial cuts.
fn show_hidden(ui: &mut Ui, language: Language) {
    ui.weak(say::job_unknown_hidden().text(language));
}

/// The first tool number of the program that the job does not describe, else the first free
/// one; `None` if all are taken.
fn free_number(job: &Job, lathe: &JobContext<'_>) -> Option<u8> {
    let is_free = |number: &u8| !job.tools.contains_key(number);
    let missing = lathe.used_tools.iter().copied().find(is_free);
    missing.or_else(|| (1..=MAX_TOOL_NUMBER).find(is_free))
}

/// Draws content in a scroll area that follows the keyboard focus.
fn scroll(ui: &mut Ui, id: &str, add: impl FnOnce(&mut Ui)) {
    let area = ScrollArea::vertical().auto_shrink([false, false]);
    area.id_salt(id).show(ui, |ui| {
        add(ui);
        focus::scroll_to_focus(ui);
    });
}

fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}
