//! Compares the open project with the control or another project, and selects the differences
//! to take over.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use egui::{Button, RichText, ScrollArea, TextWrapMode, Ui};
use gsk_core::memory::{OperationLevel, WriteRefusal};
use gsk_host::kernel::Console;
use gsk_host::project::Encodings;
use gsk_messages::{Language, Message, say};
use gsk_project::{
    ProjectDifference, ProjectState, describe_difference, diff, find_denied_changes,
    find_whole_disk, refusal_message,
};

use super::document::{ProjectDocument, project_folder};
use super::tree::{LadderParts, ProjectNode};
use crate::focus;

/// Values of a project that the control is to take over.
#[derive(Clone, Debug, PartialEq)]
pub struct ProjectSelection {
    /// The folder of the project whose differences are selected.
    pub folder: PathBuf,
    /// The selected differences, sorted by key.
    pub differences: Vec<ProjectDifference>,
}

impl ProjectSelection {
    /// Whether the selection contains `difference` with the same new value.
    pub fn contains(&self, difference: &ProjectDifference) -> bool {
        let by_key = |it: &ProjectDifference| it.key.cmp(&difference.key);
        let index = self.differences.binary_search_by(by_key).ok();
        let found = index.and_then(|at| self.differences.get(at));
        found.is_some_and(|it| it.new == difference.new)
    }
}

/// The side with which the open project is compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ComparedWith {
    /// The project is compared with the running control.
    Control,
    /// The project is compared with the project in this folder.
    Folder(PathBuf),
}

/// The side into which the selected values are copied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TakeoverTarget {
    /// The values are copied from the project to the control: 传送至CNC.
    Control,
    /// The values are copied from the other side to the open project: 从CNC读入.
    Project,
}

/// The side with which the project was compared, and its values at that time.
pub struct ComparisonBasis {
    pub other: ComparedWith,
    /// The values of the compared side.
    pub state: ProjectState,
    /// Character encodings of the other side's program files, by program number.
    pub encodings: Encodings,
    /// Operation level of the control; `None` for a folder.
    level: Option<OperationLevel>,
}

impl ComparisonBasis {
    /// Reads the state of the other side. The call blocks.
    ///
    /// # Errors
    ///
    /// The control does not answer, or the folder is not a project.
    pub fn read(other: ComparedWith, console: &Console) -> Result<Self, Message> {
        let (state, encodings, level) = match &other {
            ComparedWith::Control => {
                let (state, level) = console.state().ok_or_else(say::project_no_answer)?;
                (state, Encodings::new(), Some(level))
            }
            ComparedWith::Folder(path) => {
                let document = ProjectDocument::read(&project_folder(path))?;
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
            ComparedWith::Control => String::new(),
            ComparedWith::Folder(path) => project_folder(path).display().to_string(),
        }
    }
}

struct DifferenceRow {
    difference: ProjectDifference,
    /// Description of the difference in Chinese, then in English. They are made only once,
    /// because that compiles the ladder.
    descriptions: [String; 2],
    refusal: Option<WriteRefusal>,
    is_taken: bool,
}

/// The comparison of the open project with another side, as the view shows it.
pub struct Comparison {
    pub basis: Arc<ComparisonBasis>,
    /// State of the project at the time of the comparison.
    pub project: Arc<ProjectState>,
    /// The side into which the selected values are copied.
    pub target: TakeoverTarget,
    rows: Vec<DifferenceRow>,
    parts: LadderParts,
    /// Number of differences per node of the tree; nodes without differences are missing.
    counts: BTreeMap<ProjectNode, usize>,
}

/// A request of the user in the list of differences.
pub enum ComparisonRequest {
    /// Repeat the comparison for this target of the copy.
    SetTarget(TakeoverTarget),
    /// Copy these selected differences to the target.
    TakeOver(Vec<ProjectDifference>),
}

impl Comparison {
    /// Computes the differences between a project and the other side. The call takes a
    /// noticeable time.
    ///
    /// # Errors
    ///
    /// The project is for another control model than the control.
    pub fn new(
        document: &ProjectDocument,
        basis: Arc<ComparisonBasis>,
        target: TakeoverTarget,
    ) -> Result<Self, Message> {
        let project = Arc::clone(&document.state);
        let other = &basis.state;
        let model = project.memory().model.id();
        if basis.other == ComparedWith::Control && model != other.memory().model.id() {
            let model = model.name();
            let folder = document.folder.display();
            return Err(say::project_other_model(folder, model));
        }
        let into_control =
            target == TakeoverTarget::Control && basis.other == ComparedWith::Control;
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
        let parts = LadderParts::compare(old, new);
        let rows = differences.into_iter().map(|difference| {
            let refusal = refusals.iter().find(|it| it.key == difference.key);
            let refusal = refusal.map(|it| it.refusal);
            let descriptions = [Language::Zh, Language::En]
                .map(|language| describe_difference(&difference, old, new, language));
            DifferenceRow {
                is_taken: refusal.is_none(),
                descriptions,
                refusal,
                difference,
            }
        });
        let rows: Vec<DifferenceRow> = rows.collect();
        let mut counts = BTreeMap::new();
        for row in &rows {
            for node in ProjectNode::containing(row.difference.key, parts) {
                *counts.entry(node).or_default() += 1;
            }
        }
        Ok(Self {
            project,
            target: match into_control {
                true => TakeoverTarget::Control,
                false => TakeoverTarget::Project,
            },
            rows,
            parts,
            counts,
            basis,
        })
    }

    /// Returns the number of differences in a node of the tree.
    pub fn count_of(&self, node: ProjectNode) -> usize {
        self.counts.get(&node).copied().unwrap_or(0)
    }

    /// Draws the differences of a node and returns the user's request; `None` without one.
    /// `refusal`: why a control cannot take values over now.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        language: Language,
        node: ProjectNode,
        refusal: Option<&Message>,
    ) -> Option<ComparisonRequest> {
        let mut request = self.show_heading(ui, language);
        if self.rows.is_empty() {
            ui.label(say::project_same().text(language));
            return request;
        }
        let is_in_node = |row: &DifferenceRow| node.contains(row.difference.key, self.parts);
        let shown = self
            .rows
            .iter()
            .enumerate()
            .filter(|(_, row)| is_in_node(row));
        let shown: Vec<usize> = shown.map(|(at, _)| at).collect();
        ui.horizontal_wrapped(|ui| {
            ui.label(say::project_differs(shown.len()).text(language));
            for (label, all) in [(say::project_all(), true), (say::project_none(), false)] {
                if ui.button(label.text(language)).clicked() {
                    self.check_rows(&shown, all);
                }
            }
        });
        ui.separator();
        if shown.is_empty() {
            ui.weak(say::project_view_same_here().text(language));
        }
        self.show_list(ui, language, &shown);
        ui.separator();
        request = self
            .show_take_over_button(ui, language, refusal)
            .or(request);
        request
    }

    /// Draws which sides are compared and the choice of the side that takes values over. Returns
    /// the request to change it; `None` without one.
    fn show_heading(&self, ui: &mut Ui, language: Language) -> Option<ComparisonRequest> {
        let mut request = None;
        let project = say::project_view_into_project().text(language);
        let control = say::project_view_control().text(language);
        ui.horizontal_wrapped(|ui| {
            let (from, to) = match (self.target, &self.basis.other) {
                (TakeoverTarget::Control, _) => (project, control),
                (TakeoverTarget::Project, ComparedWith::Control) => (control, project),
                (TakeoverTarget::Project, ComparedWith::Folder(_)) => (self.basis.name(), project),
            };
            let direction_text = say::project_view_from_to(from, to).text(language);
            ui.label(RichText::new(direction_text).strong());
            if self.basis.other != ComparedWith::Control {
                return;
            }
            ui.weak(say::project_view_into().text(language));
            for (target, label) in [
                (TakeoverTarget::Control, say::project_view_into_control()),
                (TakeoverTarget::Project, say::project_view_into_project()),
            ] {
                let chosen = self.target == target;
                if ui.selectable_label(chosen, label.text(language)).clicked() && !chosen {
                    request = Some(ComparisonRequest::SetTarget(target));
                }
            }
        });
        request
    }

    fn check_rows(&mut self, shown: &[usize], is_taken: bool) {
        let mut disks = Vec::new();
        for at in shown {
            if let Some(row) = self.rows.get_mut(*at) {
                row.is_taken = is_taken && row.refusal.is_none();
                disks.extend(find_whole_disk(&row.difference));
            }
        }
        // A disk is taken over with all of its values or none.
        for row in &mut self.rows {
            if find_whole_disk(&row.difference).is_some_and(|set| disks.contains(&set)) {
                row.is_taken = is_taken && row.refusal.is_none();
            }
        }
    }

    fn show_list(&mut self, ui: &mut Ui, language: Language, shown: &[usize]) {
        let mut toggled = None;
        let height = ui.spacing().interact_size.y;
        let list_height = ui.available_height() - 2.0 * height;
        let name = say::project_differs(shown.len()).text(language);
        let list = focus::FocusList::begin(ui, "differences", &name, shown.len(), None);
        let entered = list.entered_row().and_then(|at| shown.get(at));
        if let Some(row) = entered.and_then(|at| Some((*at, self.rows.get(*at)?)))
            && row.1.refusal.is_none()
        {
            toggled = Some((row.0, !row.1.is_taken));
        }
        ScrollArea::both()
            .id_salt("project differences")
            .auto_shrink([false, false])
            .max_height(list_height.max(4.0 * height))
            .show_rows(ui, height, shown.len(), |ui, range| {
                // All rows have the same height. Longer texts scroll sideways.
                ui.style_mut().wrap_mode = Some(TextWrapMode::Extend);
                list.scroll_to_cursor(ui, range.start, height);
                let shown = shown.iter().enumerate();
                for (list_index, at) in shown.skip(range.start).take(range.len()) {
                    let Some(row) = self.rows.get(*at) else {
                        continue;
                    };
                    let [zh, en] = &row.descriptions;
                    let text = match language {
                        Language::Zh => zh,
                        Language::En => en,
                    };
                    let tick = ui.add_enabled_ui(row.refusal.is_none(), |ui| {
                        focus::check_row(ui, row.is_taken, text, height)
                    });
                    let tick = tick.inner;
                    if list.show_cursor(ui, list_index, &tick) {
                        toggled = Some((*at, !row.is_taken));
                    }
                    if let Some(refusal) = row.refusal {
                        tick.on_disabled_hover_text(refusal_message(refusal).text(language));
                    }
                }
            });
        if let Some((at, is_taken)) = toggled {
            self.check_rows(&[at], is_taken);
        }
    }

    /// Draws the button that takes over the checked differences. Returns that request when the
    /// button is clicked.
    fn show_take_over_button(
        &self,
        ui: &mut Ui,
        language: Language,
        refusal: Option<&Message>,
    ) -> Option<ComparisonRequest> {
        let taken = self.rows.iter().filter(|row| row.is_taken);
        let count = taken.clone().count();
        let (label, refusal) = match self.target {
            TakeoverTarget::Control => (say::project_take_over(count), refusal),
            TakeoverTarget::Project => (say::project_view_take_in(count), None),
        };
        let enabled = refusal.is_none() && count > 0;
        let mut button = ui.add_enabled(enabled, Button::new(label.text(language)));
        if let Some(why_not) = refusal {
            button = button.on_disabled_hover_text(why_not.text(language));
        }
        let clicked = button.clicked();
        clicked
            .then(|| ComparisonRequest::TakeOver(taken.map(|row| row.difference.clone()).collect()))
    }
}
