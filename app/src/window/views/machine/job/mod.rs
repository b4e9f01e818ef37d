//! The job panel beside the picture: stock and tools. A change is clamped at once and can be
//! saved as the job file of the program.

mod fields;
mod tool_drawing;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{Color32, ScrollArea, Ui};
use gsk_messages::{Language, Message, say};
use gsk_runner::words::in_short;
use gsk_workpiece::job::Job;
use gsk_workpiece::tool::Tool;

use crate::job;
use crate::window::focus;

const WRONG: Color32 = Color32::from_rgb(255, 100, 90);
const DOUBTFUL: Color32 = Color32::from_rgb(255, 196, 90);
const GOOD: Color32 = Color32::from_rgb(110, 220, 120);
/// The highest T number.
const LAST_TOOL: u8 = 99;

/// The item that is being edited.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Item {
    #[default]
    Stock,
    Tool(u8),
}

/// A kind of tool that can be added: its name and its initial values.
type Kind = (fn() -> Message, fn() -> Tool);

const KINDS: [Kind; 5] = [
    (say::tool_kind_turning, Tool::turning),
    (say::tool_kind_boring, Tool::boring),
    (say::tool_kind_grooving, || Tool::grooving(3.0)),
    (say::tool_kind_threading, || Tool::threading(60.0)),
    (say::tool_kind_drill, || Tool::drill(10.0)),
];

/// What the job panel shows of the lathe.
pub struct Lathe<'a> {
    /// The job that is being cut.
    pub job: &'a Arc<Job>,
    /// The job was guessed from the program.
    pub guessed: bool,
    /// The file of the program, if it has one.
    pub program: Option<&'a Path>,
    /// T numbers that the program uses.
    pub named: Vec<u8>,
    pub running: bool,
    /// The error in the job file on the disk.
    pub trouble: Option<&'a Message>,
}

/// The state of the job panel.
#[derive(Default)]
pub struct JobPanel {
    item: Item,
    /// The lathe's job from which the draft was made.
    base: Option<Arc<Job>>,
    draft: Option<Job>,
    /// The draft that was clamped last.
    clamped: Option<Job>,
    /// The job of the lathe before any change in this panel.
    given: Option<Job>,
    /// The path of the program's job file, whether the file exists or not.
    path: Option<PathBuf>,
    /// The job file that was read or written, and its contents.
    saved: Option<(PathBuf, Job)>,
    said: Option<(Message, Color32)>,
}

impl JobPanel {
    /// Draws the panel. Returns a job that must be clamped.
    pub fn show(&mut self, ui: &mut Ui, lathe: &Lathe<'_>, language: Language) -> Option<Job> {
        self.take(lathe);
        let path = lathe.program.map(job::beside);
        if self.path != path {
            let read = path.as_deref().and_then(|path| job::read(path).ok());
            self.saved = path.clone().zip(read);
            self.path = path;
        }
        let mut job = self.draft.take()?;
        self.origin(ui, lathe, &job, language);
        if lathe.running {
            let words = say::job_while_running().text(language);
            ui.colored_label(DOUBTFUL, words);
        }
        ui.add_enabled_ui(!lathe.running, |ui| {
            self.list(ui, &mut job, lathe, language);
            ui.separator();
            ScrollArea::vertical()
                .auto_shrink([false, false])
                .show(ui, |ui| {
                    self.item(ui, &mut job, language);
                    focus::follow(ui);
                });
        });
        let rule = job.check();
        // Nothing is clamped while the pointer drags a value.
        let still = !ui.input(|input| input.pointer.any_down());
        let wanted = rule.is_ok() && still && !lathe.running && self.clamped.as_ref() != Some(&job);
        let clamp = wanted.then(|| job.clone());
        if clamp.is_some() {
            self.clamped.clone_from(&clamp);
        }
        self.draft = Some(job);
        clamp
    }

    /// Whether the edited job differs from its file or, without a file, from the lathe's job.
    pub fn is_unsaved(&self) -> bool {
        let kept = self.saved.as_ref().map(|(_, saved)| saved);
        let kept = kept.or(self.given.as_ref());
        let made = self.draft.as_ref().zip(kept);
        made.is_some_and(|(draft, kept)| draft != kept)
    }

    /// Whether `job` was edited in this panel.
    pub fn has_changed(&self, job: &Job) -> bool {
        self.given.as_ref() != Some(job) && self.clamped.as_ref() == Some(job)
    }

    /// Starts a new draft when the lathe has a job that does not come from this panel.
    fn take(&mut self, lathe: &Lathe<'_>) {
        let same = self.base.as_ref();
        if same.is_some_and(|base| Arc::ptr_eq(base, lathe.job)) {
            return;
        }
        self.base = Some(Arc::clone(lathe.job));
        let job = lathe.job.as_ref();
        if self.clamped.as_ref() == Some(job) {
            return;
        }
        self.draft = Some(job.clone());
        self.clamped = Some(job.clone());
        self.given = Some(job.clone());
        (self.path, self.saved) = (None, None);
        self.said = None;
        if let Item::Tool(number) = self.item
            && !job.tools.contains_key(&number)
        {
            self.item = Item::Stock;
        }
    }

    /// Draws where the job comes from and the button that saves it.
    fn origin(&mut self, ui: &mut Ui, lathe: &Lathe<'_>, job: &Job, language: Language) {
        let file = self.saved.as_ref().map(|(path, _)| file_name(path));
        let is_saved = self.saved.as_ref().is_some_and(|(_, saved)| saved == job);
        let (words, color) = match file {
            Some(file) if is_saved => (say::job_from_file(file), GOOD),
            Some(file) => (say::job_differs(file), DOUBTFUL),
            None if self.given.as_ref() != Some(job) => (say::job_unsaved(), DOUBTFUL),
            None if lathe.guessed => (say::job_guessed(), DOUBTFUL),
            None => (say::job_of_sample(), GOOD),
        };
        ui.colored_label(color, words.text(language));
        let rule = job.check().err();
        ui.horizontal_wrapped(|ui| {
            let may = rule.is_none() && !is_saved;
            let button = ui.add_enabled(may, egui::Button::new(say::job_save().text(language)));
            if button
                .on_hover_text(say::job_save_hint().text(language))
                .clicked()
            {
                self.save(lathe, job);
            }
        });
        if let Some(rule) = rule {
            ui.colored_label(WRONG, rule.text(language));
        } else if let Some((said, color)) = &self.said {
            ui.colored_label(*color, said.text(language));
        }
        ui.separator();
    }

    fn save(&mut self, lathe: &Lathe<'_>, job: &Job) {
        let Some(program) = lathe.program else {
            self.said = Some((say::job_without_program_file(), WRONG));
            return;
        };
        if let Some(trouble) = lathe.trouble {
            // Saving would overwrite a misspelt file that a user has written.
            self.said = Some((say::job_file_in_trouble(trouble.clone()), WRONG));
            return;
        }
        let path = job::beside(program);
        self.said = Some(match job::write(&path, job) {
            Ok(()) => {
                let said = say::window_saved(path.display());
                self.saved = Some((path, job.clone()));
                (said, GOOD)
            }
            Err(error) => (error.message(), WRONG),
        });
    }

    /// Draws the list of stock and tools, with the buttons that add and remove tools.
    fn list(&mut self, ui: &mut Ui, job: &mut Job, lathe: &Lathe<'_>, language: Language) {
        let stock = say::job_stock().text(language);
        if ui
            .selectable_label(self.item == Item::Stock, stock)
            .clicked()
        {
            self.item = Item::Stock;
        }
        for (number, tool) in &job.tools {
            let words = format!("T{number:02}  {}", in_short(tool).text(language));
            let chosen = self.item == Item::Tool(*number);
            if ui.selectable_label(chosen, words).clicked() {
                self.item = Item::Tool(*number);
            }
        }
        let missing = lathe.named.iter().find(|it| !job.tools.contains_key(it));
        if let Some(number) = missing {
            let words = say::job_tool_missing(*number).text(language);
            ui.colored_label(DOUBTFUL, words);
        }
        ui.horizontal_wrapped(|ui| {
            let free = (1..=LAST_TOOL).find(|number| !job.tools.contains_key(number));
            let number = missing.copied().or(free);
            ui.menu_button(say::job_tool_add().text(language), |ui| {
                for (name, tool) in &KINDS {
                    let Some(number) = number else { return };
                    if ui.button(name().text(language)).clicked() {
                        job.tools.insert(number, tool());
                        self.item = Item::Tool(number);
                        ui.close();
                    }
                }
            });
            if let Item::Tool(number) = self.item
                && ui
                    .button(say::job_tool_remove(number).text(language))
                    .clicked()
            {
                job.tools.remove(&number);
                job.lengths.remove(&number);
                self.item = Item::Stock;
            }
        });
    }

    /// Draws the fields of the selected item, and the drawing of a tool.
    fn item(&self, ui: &mut Ui, job: &mut Job, language: Language) {
        match self.item {
            Item::Stock => {
                fields::stock(ui, &mut job.stock, language);
                ui.separator();
                fields::zero(ui, &mut job.zero, language);
            }
            Item::Tool(number) => {
                let Some(tool) = job.tools.get_mut(&number) else {
                    return;
                };
                tool_drawing::show(ui, tool, language);
                fields::tool(ui, tool, language);
                ui.separator();
                fields::length(ui, &mut job.lengths, number, language);
            }
        }
    }
}

fn file_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}
