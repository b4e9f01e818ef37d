//! Projects beside the panel: written, compared with the control, taken over. The control is
//! off while it takes one over, as it is for a new ladder.

use std::path::{Path, PathBuf};

use crossbeam::channel::{Receiver, bounded};
use egui::{Button, Context, ScrollArea, Ui};
use gsk_core::memory::Refusal;
use gsk_core::model::ModelId;
use gsk_messages::{Language, Message, say};
use gsk_project::{Difference, State, denied, diff, export, refused, sentence, whole_disk};

use super::files::{self, Wanted};
use crate::kernel::Console;
use crate::project::{self, ProjectError};

/// Size of the list, points.
const SIZE: [f32; 2] = [620.0, 380.0];

/// What is done with projects in the bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProjectCommand {
    /// Write one of a control as it is delivered.
    New,
    /// List what differs from the control.
    Compare,
    /// Write one of what the control holds.
    Save,
}

/// The entries of the menu.
pub const COMMANDS: [(ProjectCommand, fn() -> Message); 3] = [
    (ProjectCommand::New, say::project_menu_new),
    (ProjectCommand::Compare, say::project_menu_compare),
    (ProjectCommand::Save, say::project_menu_save),
];

/// Values of a project that the control is to take over.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// The folder of the project.
    pub folder: PathBuf,
    /// The values.
    pub differences: Vec<Difference>,
}

impl Chosen {
    /// Whether a value was chosen, as it was shown.
    pub fn has(&self, difference: &Difference) -> bool {
        let by_key = |it: &Difference| it.key.cmp(&difference.key);
        let found = self.differences.binary_search_by(by_key).ok();
        let found = found.and_then(|at| self.differences.get(at));
        found.is_some_and(|it| it.new == difference.new)
    }
}

/// A value that differs.
struct Row {
    difference: Difference,
    /// In Chinese and English: a ladder is not compiled for every picture.
    words: [String; 2],
    refusal: Option<Refusal>,
    taken: bool,
}

/// A project beside the control.
struct Compared {
    folder: PathBuf,
    rows: Vec<Row>,
}

/// The list of what differs.
#[derive(Default)]
pub struct Desk {
    reading: Option<Receiver<Compared>>,
    shown: Option<Compared>,
}

/// The folder that is meant by the file that was chosen: the one that `project.gpr` lies in,
/// else a folder of this name (manual GSKCC: a folder for each project).
fn folder_of(path: &Path) -> PathBuf {
    match (path.file_name(), path.parent()) {
        (Some(name), Some(folder)) if name == project::HEAD => folder.to_owned(),
        _ => path.with_extension(""),
    }
}

/// Writes a project where the user wants it.
pub fn save(command: ProjectCommand, console: &Console, language: Language, context: &Context) {
    let own = console.clone();
    let name = say::project_file_name().text(language);
    let wanted = Wanted::Save(format!("{name}.gpr"), "gpr");
    files::choose(context, language, &console.say, wanted, move |path| {
        let folder = folder_of(&path);
        let state = match command {
            ProjectCommand::New => State::of(&project::delivered(ModelId::default(), None)),
            ProjectCommand::Save | ProjectCommand::Compare => own.state()?.0,
        };
        let files = export(&state, language);
        if command == ProjectCommand::New && project::is_project(&folder) {
            return Some(ProjectError::Other(folder).message());
        }
        let written = project::write(&folder, &state, &files, &project::Encodings::new());
        Some(match written {
            Ok(it) => say::project_exported(folder.display(), it.files, it.removed),
            Err(error) => error.message(),
        })
    });
}

impl Desk {
    /// Lets the user choose a project and compares it with the control.
    pub fn choose(&mut self, console: &Console, language: Language, context: &Context) {
        let (deliver, reading) = bounded(1);
        self.reading = Some(reading);
        let own = console.clone();
        let wanted = Wanted::Open(say::project_files().text(language), vec!["gpr"]);
        files::choose(context, language, &console.say, wanted, move |path| {
            match compare(folder_of(&path), &own) {
                Ok(compared) => {
                    // A window that is gone shows nothing.
                    let _ = deliver.send(compared);
                    None
                }
                Err(said) => Some(said),
            }
        });
    }

    /// Compares a project with the control.
    pub fn compare(&mut self, folder: PathBuf, console: &Console, context: &Context) {
        let (deliver, reading) = bounded(1);
        self.reading = Some(reading);
        let own = console.clone();
        files::beside(context, &console.say, move || match compare(folder, &own) {
            Ok(compared) => {
                let _ = deliver.send(compared);
                None
            }
            Err(said) => Some(said),
        });
    }

    /// Draws the list, if there is one; the values that are to be taken over. `why_not`: why
    /// the control cannot be switched off now.
    pub fn show(
        &mut self,
        context: &Context,
        language: Language,
        why_not: Option<&Message>,
    ) -> Option<Chosen> {
        if let Some(compared) = self.reading.as_ref().and_then(|it| it.try_recv().ok()) {
            self.shown = Some(compared);
            self.reading = None;
        }
        let compared = self.shown.as_mut()?;
        let (mut open, mut chosen) = (true, None);
        egui::Window::new(say::project_title(compared.folder.display()).text(language))
            .id(egui::Id::unique("project"))
            .collapsible(false)
            .default_size(SIZE)
            .open(&mut open)
            .show(context, |ui| chosen = compared.show(ui, language, why_not));
        if !open || chosen.is_some() {
            self.shown = None;
        }
        chosen
    }
}

fn compare(folder: PathBuf, console: &Console) -> Result<Compared, Message> {
    let (new, _) = project::read(&folder).map_err(|error| error.message())?;
    let new = new.without_texts();
    let (old, level) = console.state().ok_or_else(say::project_no_answer)?;
    if new.memory().model.id() != old.memory().model.id() {
        let model = &new.memory().model.record().name;
        return Err(say::project_other_model(folder.display(), model));
    }
    let differences = diff(&old, &new);
    let refusals = denied(&differences, &old.memory().parameters, level);
    let rows = differences.into_iter().map(|difference| {
        let refusal = refusals.iter().find(|it| it.key == difference.key);
        let refusal = refusal.map(|it| it.refusal);
        let words = [Language::Zh, Language::En]
            .map(|language| sentence(&difference, &old, &new, language));
        Row {
            taken: refusal.is_none(),
            words,
            refusal,
            difference,
        }
    });
    Ok(Compared {
        rows: rows.collect(),
        folder,
    })
}

impl Compared {
    fn show(
        &mut self,
        ui: &mut Ui,
        language: Language,
        why_not: Option<&Message>,
    ) -> Option<Chosen> {
        if self.rows.is_empty() {
            ui.label(say::project_same().text(language));
            return None;
        }
        ui.horizontal(|ui| {
            ui.label(say::project_differs(self.rows.len()).text(language));
            for (said, all) in [(say::project_all(), true), (say::project_none(), false)] {
                if ui.button(said.text(language)).clicked() {
                    for row in &mut self.rows {
                        row.taken = all && row.refusal.is_none();
                    }
                }
            }
        });
        ui.separator();
        let mut turned = None;
        let height = ui.spacing().interact_size.y;
        let room = ui.available_height() - 2.0 * height;
        ScrollArea::vertical()
            .auto_shrink([false, false])
            .max_height(room.max(4.0 * height))
            .show_rows(ui, height, self.rows.len(), |ui, rows| {
                for row in self.rows.get_mut(rows).unwrap_or_default() {
                    let [zh, en] = &row.words;
                    let text = match language {
                        Language::Zh => zh,
                        Language::En => en,
                    };
                    let tick = egui::Checkbox::new(&mut row.taken, text);
                    let shown = ui.add_enabled(row.refusal.is_none(), tick);
                    if shown.changed() {
                        turned = whole_disk(&row.difference).map(|set| (set, row.taken));
                    }
                    if let Some(refusal) = row.refusal {
                        shown.on_disabled_hover_text(refused(refusal).text(language));
                    }
                }
            });
        if let Some((set, taken)) = turned {
            // A disk has all of its values or none.
            for row in &mut self.rows {
                if whole_disk(&row.difference) == Some(set) {
                    row.taken = taken;
                }
            }
        }
        ui.separator();
        let taken = self.rows.iter().filter(|row| row.taken);
        let count = taken.clone().count();
        let words = say::project_take_over(count).text(language);
        let enabled = why_not.is_none() && count > 0;
        let mut button = ui.add_enabled(enabled, Button::new(words));
        if let Some(why_not) = why_not {
            button = button.on_disabled_hover_text(why_not.text(language));
        }
        button.clicked().then(|| Chosen {
            folder: self.folder.clone(),
            differences: taken.map(|row| row.difference.clone()).collect(),
        })
    }
}
