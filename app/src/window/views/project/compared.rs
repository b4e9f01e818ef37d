//! Compares the open project with the control or another project, and selects the differences
//! to take over.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use egui::{Button, RichText, ScrollArea, TextWrapMode, Ui};
use gsk_core::memory::{Level, Refusal};
use gsk_messages::{Language, Message, say};
use gsk_project::{
    ProjectDifference, ProjectState, describe_difference, diff, find_denied_changes,
    find_whole_disk, refusal_message,
};

use super::document::{Document, folder_of};
use super::tree::{LadderParts, Node};
use crate::kernel::Console;
use crate::project::Encodings;
use crate::window::focus;

/// Values of a project that the control is to take over.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// The folder of the project.
    pub folder: PathBuf,
    /// The selected differences, sorted by key.
    pub differences: Vec<ProjectDifference>,
}

impl Chosen {
    /// Whether `difference` is selected with the same new value.
    pub fn has(&self, difference: &ProjectDifference) -> bool {
        let by_key = |it: &ProjectDifference| it.key.cmp(&difference.key);
        let found = self.differences.binary_search_by(by_key).ok();
        let found = found.and_then(|at| self.differences.get(at));
        found.is_some_and(|it| it.new == difference.new)
    }
}

/// The other side of the comparison.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Other {
    /// The running control.
    Control,
    /// Another project, by a path inside it.
    Folder(PathBuf),
}

/// The side that takes values over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// The control: 传送至CNC.
    Control,
    /// The open project: 从CNC读入.
    Project,
}

/// State of the other side at the time of the comparison.
pub struct Basis {
    pub other: Other,
    /// Its values.
    pub state: ProjectState,
    /// Character encodings of its program files, by program number.
    pub encodings: Encodings,
    /// Operation level of the control; `None` for a folder.
    level: Option<Level>,
}

impl Basis {
    /// Reads the other side. The call blocks.
    ///
    /// # Errors
    ///
    /// The control does not answer, or the folder is not a project.
    pub fn of(other: Other, console: &Console) -> Result<Self, Message> {
        let (state, encodings, level) = match &other {
            Other::Control => {
                let (state, level) = console.state().ok_or_else(say::project_no_answer)?;
                (state, Encodings::new(), Some(level))
            }
            Other::Folder(path) => {
                let document = Document::read(&folder_of(path))?;
                ((*document.state).clone(), document.encodings, None)
            }
        };
        Ok(Self {
            other,
            state,
            encodings,
            level,
        })
    }

    fn name(&self) -> String {
        match &self.other {
            Other::Control => String::new(),
            Other::Folder(path) => folder_of(path).display().to_string(),
        }
    }
}

struct Row {
    difference: ProjectDifference,
    /// Descriptions in Chinese and English. They are made once: that compiles the ladder.
    words: [String; 2],
    refusal: Option<Refusal>,
    taken: bool,
}

/// The comparison of the project with the other side.
pub struct Compared {
    pub basis: Arc<Basis>,
    /// State of the project at the time of the comparison.
    pub project: Arc<ProjectState>,
    /// The side that takes values over.
    pub target: Target,
    rows: Vec<Row>,
    parts: LadderParts,
    /// Count of differences per node; nodes without differences are missing.
    counts: BTreeMap<Node, usize>,
}

/// A request from the list of differences.
pub enum Asked {
    /// Compare in the other direction.
    Turn(Target),
    /// Take over the checked differences.
    Take(Vec<ProjectDifference>),
}

impl Compared {
    /// Computes the differences. The call takes a noticeable time.
    ///
    /// # Errors
    ///
    /// The project is for another control model than the control.
    pub fn new(document: &Document, basis: Arc<Basis>, target: Target) -> Result<Self, Message> {
        let project = Arc::clone(&document.state);
        let other = &basis.state;
        let model = project.memory().model.id();
        if basis.other == Other::Control && model != other.memory().model.id() {
            let model = model.name();
            let folder = document.folder.display();
            return Err(say::project_other_model(folder, model));
        }
        let into_control = target == Target::Control && basis.other == Other::Control;
        let without_texts;
        let (old, new): (&ProjectState, &ProjectState) = match into_control {
            true => {
                without_texts = (*project).clone().without_texts();
                (other, &without_texts)
            }
            false => (&project, other),
        };
        let differences = diff(old, new);
        let refusals = match basis.level.filter(|_| into_control) {
            Some(level) => find_denied_changes(&differences, &old.memory().parameters, level),
            None => Vec::new(),
        };
        let parts = LadderParts::of(old, new);
        let rows = differences.into_iter().map(|difference| {
            let refusal = refusals.iter().find(|it| it.key == difference.key);
            let refusal = refusal.map(|it| it.refusal);
            let words = [Language::Zh, Language::En]
                .map(|language| describe_difference(&difference, old, new, language));
            Row {
                taken: refusal.is_none(),
                words,
                refusal,
                difference,
            }
        });
        let rows: Vec<Row> = rows.collect();
        let mut counts = BTreeMap::new();
        for row in &rows {
            for node in Node::with(row.difference.key, parts) {
                *counts.entry(node).or_default() += 1;
            }
        }
        Ok(Self {
            project,
            target: match into_control {
                true => Target::Control,
                false => Target::Project,
            },
            rows,
            parts,
            counts,
            basis,
        })
    }

    /// Count of differences of a node.
    pub fn count(&self, node: Node) -> usize {
        self.counts.get(&node).copied().unwrap_or(0)
    }

    /// Draws the differences of a node. `why_not`: why a control cannot take values over now.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        language: Language,
        node: Node,
        why_not: Option<&Message>,
    ) -> Option<Asked> {
        let mut asked = self.heading(ui, language);
        if self.rows.is_empty() {
            ui.label(say::project_same().text(language));
            return asked;
        }
        let own = |row: &Row| node.has(row.difference.key, self.parts);
        let shown = self.rows.iter().enumerate().filter(|(_, row)| own(row));
        let shown: Vec<usize> = shown.map(|(at, _)| at).collect();
        ui.horizontal_wrapped(|ui| {
            ui.label(say::project_differs(shown.len()).text(language));
            for (said, all) in [(say::project_all(), true), (say::project_none(), false)] {
                if ui.button(said.text(language)).clicked() {
                    self.tick(&shown, all);
                }
            }
        });
        ui.separator();
        if shown.is_empty() {
            ui.weak(say::project_view_same_here().text(language));
        }
        self.list(ui, language, &shown);
        ui.separator();
        asked = self.take(ui, language, why_not).or(asked);
        asked
    }

    /// Draws which sides are compared and in which direction values are taken over.
    fn heading(&self, ui: &mut Ui, language: Language) -> Option<Asked> {
        let mut asked = None;
        let project = say::project_view_into_project().text(language);
        let control = say::project_view_control().text(language);
        ui.horizontal_wrapped(|ui| {
            let (from, to) = match (self.target, &self.basis.other) {
                (Target::Control, _) => (project, control),
                (Target::Project, Other::Control) => (control, project),
                (Target::Project, Other::Folder(_)) => (self.basis.name(), project),
            };
            let words = say::project_view_from_to(from, to).text(language);
            ui.label(RichText::new(words).strong());
            if self.basis.other != Other::Control {
                return;
            }
            ui.weak(say::project_view_into().text(language));
            for (target, said) in [
                (Target::Control, say::project_view_into_control()),
                (Target::Project, say::project_view_into_project()),
            ] {
                let chosen = self.target == target;
                if ui.selectable_label(chosen, said.text(language)).clicked() && !chosen {
                    asked = Some(Asked::Turn(target));
                }
            }
        });
        asked
    }

    fn tick(&mut self, shown: &[usize], taken: bool) {
        let mut disks = Vec::new();
        for at in shown {
            if let Some(row) = self.rows.get_mut(*at) {
                row.taken = taken && row.refusal.is_none();
                disks.extend(find_whole_disk(&row.difference));
            }
        }
        // A disk is taken over with all of its values or none.
        for row in &mut self.rows {
            if find_whole_disk(&row.difference).is_some_and(|set| disks.contains(&set)) {
                row.taken = taken && row.refusal.is_none();
            }
        }
    }

    fn list(&mut self, ui: &mut Ui, language: Language, shown: &[usize]) {
        let mut turned = None;
        let height = ui.spacing().interact_size.y;
        let room = ui.available_height() - 2.0 * height;
        let name = say::project_differs(shown.len()).text(language);
        let list = focus::List::begin(ui, "differences", &name, shown.len(), None);
        let entered = list.entered().and_then(|at| shown.get(at));
        if let Some(row) = entered.and_then(|at| Some((*at, self.rows.get(*at)?)))
            && row.1.refusal.is_none()
        {
            turned = Some((row.0, !row.1.taken));
        }
        ScrollArea::both()
            .id_salt("project differences")
            .auto_shrink([false, false])
            .max_height(room.max(4.0 * height))
            .show_rows(ui, height, shown.len(), |ui, range| {
                // All rows have the same height. Longer texts scroll sideways.
                ui.style_mut().wrap_mode = Some(TextWrapMode::Extend);
                list.follow(ui, range.start, height);
                let shown = shown.iter().enumerate();
                for (place, at) in shown.skip(range.start).take(range.len()) {
                    let Some(row) = self.rows.get(*at) else {
                        continue;
                    };
                    let [zh, en] = &row.words;
                    let text = match language {
                        Language::Zh => zh,
                        Language::En => en,
                    };
                    let tick = ui.add_enabled_ui(row.refusal.is_none(), |ui| {
                        focus::tick(ui, row.taken, text, height)
                    });
                    let tick = tick.inner;
                    if list.row(ui, place, &tick) {
                        turned = Some((*at, !row.taken));
                    }
                    if let Some(refusal) = row.refusal {
                        tick.on_disabled_hover_text(refusal_message(refusal).text(language));
                    }
                }
            });
        if let Some((at, taken)) = turned {
            self.tick(&[at], taken);
        }
    }

    /// Draws the button that takes over the checked differences.
    fn take(&self, ui: &mut Ui, language: Language, why_not: Option<&Message>) -> Option<Asked> {
        let taken = self.rows.iter().filter(|row| row.taken);
        let count = taken.clone().count();
        let (words, why_not) = match self.target {
            Target::Control => (say::project_take_over(count), why_not),
            Target::Project => (say::project_view_take_in(count), None),
        };
        let enabled = why_not.is_none() && count > 0;
        let mut button = ui.add_enabled(enabled, Button::new(words.text(language)));
        if let Some(why_not) = why_not {
            button = button.on_disabled_hover_text(why_not.text(language));
        }
        let clicked = button.clicked();
        clicked.then(|| Asked::Take(taken.map(|row| row.difference.clone()).collect()))
    }
}
