//! The project view, after GSKCC (manual PLC-V): the tree of a project, the content of its
//! nodes, the differences from the control or another project, and taking differences over.
//! The control is off while it takes values over, as for a new ladder.

mod commands;
mod comparison;
mod content;
mod document;
mod project_sheets;
mod tree;

use std::sync::Arc;

use crossbeam::channel::{Receiver, Sender, unbounded};
use egui::{
    Button, CentralPanel, ComboBox, Context, Panel, RichText, Role, ScrollArea, Ui, WidgetInfo,
};
use gsk_host::kernel::Console;
use gsk_host::project::Encodings;
use gsk_messages::{Language, Message, say};

use super::interface::{View, ViewFrame, ViewStart};
use crate::focus;
use crate::settings::ProjectSettings;
use crate::theme;
use crate::widgets::questions::Unsaved;
pub use commands::{COMMANDS, ProjectViewCommand};
use commands::{ComparisonCounter, ProjectEvent, ProjectQuestion};
pub use comparison::ProjectSelection;
use comparison::{ComparedWith, Comparison, ComparisonRequest, TakeoverTarget};
use content::NodeContent;
use document::{ProjectDocument, program_numbers};
use project_sheets::{ProjectSheets, differences_of_edits};
use tree::{NodeName, ProjectNode, tree_entries};

/// Width of the tree, points. The constant after it is the indent per level.
const TREE_WIDTH: f32 = 200.0;
const INDENT: f32 = 14.0;
/// Width of the view, points, below which the tree is a drop-down list.
const NARROW_WIDTH: f32 = 520.0;
/// Free height below an open drop-down list, points.
const LIST_MARGIN: f32 = 50.0;
/// Maximum number of recent projects (manual PLC-V 3: four).
const MAX_RECENT: usize = 4;

/// The tab of the project view that shows the selected node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum NodePage {
    /// Fields in which the values are edited. Nodes without fields show their content instead.
    Edit,
    Contents,
    Differences,
}

/// The view that edits a project and compares it with the control or another project.
pub struct ProjectView {
    console: Console,
    settings: ProjectSettings,
    document: Option<ProjectDocument>,
    comparison: Option<Comparison>,
    node: ProjectNode,
    page: NodePage,
    content: NodeContent,
    editing: ProjectSheets,
    question: Option<ProjectQuestion>,
    /// The reason why the control cannot be switched off at the moment; `None` if it can.
    why_not: Option<Message>,
    /// The selected values that the control takes over while it is off; `None` without any.
    selection: Option<ProjectSelection>,
    results: (Sender<ProjectEvent>, Receiver<ProjectEvent>),
    comparison_counter: ComparisonCounter,
}

impl View for ProjectView {
    fn create(start: ViewStart<'_>) -> Self {
        Self::new(start.console.clone(), start.settings.projects.clone())
    }

    fn show(&mut self, ui: &mut Ui, frame: ViewFrame<'_>) {
        self.draw(ui, frame.language);
    }

    fn unsaved(&self) -> Option<Unsaved> {
        let document = self.document.as_ref();
        document
            .is_some_and(|document| document.is_changed || self.editing.has_drafts())
            .then_some(Unsaved::Project)
    }
}

impl ProjectView {
    /// Creates the view, which reads no project before it is shown.
    pub fn new(console: Console, settings: ProjectSettings) -> Self {
        Self {
            console,
            settings,
            document: None,
            comparison: None,
            node: ProjectNode::Project,
            page: NodePage::Edit,
            content: NodeContent::default(),
            editing: ProjectSheets::default(),
            question: None,
            why_not: None,
            selection: None,
            results: unbounded(),
            comparison_counter: ComparisonCounter::default(),
        }
    }

    /// The open project and the recent ones, to be stored for the next start.
    pub const fn settings(&self) -> &ProjectSettings {
        &self.settings
    }

    /// Stores why the control cannot be turned off now; `None` if it can.
    pub fn set_refusal(&mut self, refusal: Option<Message>) {
        self.why_not = refusal;
    }

    /// Takes the values that the control is to take over while it is off, if there are any.
    pub const fn take_selection(&mut self) -> Option<ProjectSelection> {
        self.selection.take()
    }

    fn draw(&mut self, ui: &mut Ui, language: Language) {
        self.reopen_last(ui.ctx());
        let bottom = ui.max_rect().bottom();
        self.receive(ui.ctx());
        Panel::top("project bar")
            .frame(super::bar_frame())
            .show(ui, |ui| self.show_bar(ui, language));
        if self.document.is_some() && ui.available_width() < NARROW_WIDTH {
            Panel::top("project place")
                .frame(super::side_frame())
                .show(ui, |ui| self.show_node_list(ui, language, bottom));
        } else if self.document.is_some() {
            Panel::left("project tree")
                .exact_size(TREE_WIDTH)
                .resizable(false)
                .frame(super::side_frame())
                .show(ui, |ui| {
                    ScrollArea::vertical()
                        .id_salt("project tree")
                        .auto_shrink([false, false])
                        .show(ui, |ui| self.show_tree(ui, language));
                });
        }
        CentralPanel::default()
            .frame(super::side_frame())
            .show(ui, |ui| self.show_page(ui, language));
        self.show_question(ui.ctx(), language);
    }

    /// Draws the buttons of the project, and those for comparing it with the control or another
    /// project.
    fn show_bar(&mut self, ui: &mut Ui, language: Language) {
        ui.horizontal_wrapped(|ui| {
            for (command, name) in [
                (ProjectViewCommand::New, say::project_menu_new()),
                (
                    ProjectViewCommand::FromControl,
                    say::project_view_from_control(),
                ),
                (ProjectViewCommand::Open, say::project_view_open()),
            ] {
                if ui.button(name.text(language)).clicked() {
                    self.command(command, language, ui.ctx());
                }
            }
            let mut reopened = None;
            let recent = &self.settings.recent;
            if !recent.is_empty() {
                ui.menu_button(say::project_view_recent().text(language), |ui| {
                    for folder in recent {
                        let name = folder.file_name().unwrap_or_default().to_string_lossy();
                        let path = folder.display().to_string();
                        if ui.button(name.as_ref()).on_hover_text(path).clicked() {
                            reopened = Some(folder.clone());
                            ui.close();
                        }
                    }
                });
            }
            if let Some(folder) = reopened {
                self.command(ProjectViewCommand::OpenFolder(folder), language, ui.ctx());
            }
            let Some(document) = &self.document else {
                return;
            };
            let is_changed = document.is_changed;
            let save_refusal = match self.editing.has_drafts() {
                true => say::project_view_save_drafts(),
                false => say::project_view_saved(),
            };
            let save = Button::new(say::project_view_save().text(language));
            let save = ui.add_enabled(is_changed, save);
            let save = save.on_disabled_hover_text(save_refusal.text(language));
            if save.clicked() {
                self.save(language, ui.ctx());
            }
            if ui.button(say::project_menu_save().text(language)).clicked() {
                self.save_as(language, ui.ctx());
            }
            if ui
                .button(say::project_view_close().text(language))
                .clicked()
            {
                self.command(ProjectViewCommand::Close, language, ui.ctx());
            }
        });
        let Some(document) = &self.document else {
            return;
        };
        let folder = document.folder.display().to_string();
        let is_changed = document.is_changed;
        ui.horizontal_wrapped(|ui| {
            ui.weak(say::project_view_compare().text(language));
            let other = self.comparison.as_ref().map(|it| it.basis.other.clone());
            let is_control = matches!(other, Some(ComparedWith::Control));
            let label = say::project_view_control().text(language);
            if ui.selectable_label(is_control, label).clicked() {
                self.compare(ComparedWith::Control, TakeoverTarget::Control, ui.ctx());
            }
            let is_folder = matches!(other, Some(ComparedWith::Folder(_)));
            let label = say::project_view_folder().text(language);
            if ui.selectable_label(is_folder, label).clicked() {
                self.choose_and_compare(language, ui.ctx());
            }
            if let Some(compared) = &self.comparison
                && ui
                    .button(say::project_view_again().text(language))
                    .clicked()
            {
                let (other, target) = (compared.basis.other.clone(), compared.target);
                self.compare(other, target, ui.ctx());
            }
            if is_changed {
                let words = say::project_view_changed().text(language);
                ui.label(RichText::new(words).color(theme::UNSAVED_TEXT));
            }
            ui.weak(folder);
        });
    }

    /// The nodes of the tree with their indent level and name, which includes the number of
    /// differences.
    fn node_labels(&self, language: Language) -> Vec<(ProjectNode, u8, String)> {
        let Some(document) = &self.document else {
            return Vec::new();
        };
        let mut all = program_numbers(&document.state);
        if let Some(compared) = &self.comparison {
            all.extend(program_numbers(&compared.basis.state));
        }
        let all: Vec<u16> = all.into_iter().collect();
        let labels = tree_entries(&document.name(), &all, self.console.naming())
            .into_iter()
            .map(|place| {
                let name = match place.name {
                    NodeName::Text(text) => text.text(language),
                    NodeName::Program(name) => name,
                };
                let count = self
                    .comparison
                    .as_ref()
                    .map_or(0, |it| it.count_of(place.node));
                let label = match count {
                    0 => name,
                    _ => format!("{name} · {count}"),
                };
                (place.node, place.depth, label)
            });
        labels.collect()
    }

    /// Draws the tree. Returns true if Enter was pressed on a node.
    fn show_tree(&mut self, ui: &mut Ui, language: Language) -> bool {
        let places = self.node_labels(language);
        let chosen = places.iter().position(|(node, ..)| *node == self.node);
        let name = say::project_view_place().text(language);
        let list = focus::FocusList::begin(ui, "places", &name, places.len(), chosen);
        if let Some((node, ..)) = list.moved_row().and_then(|at| places.get(at)) {
            self.node = *node;
        }
        for (at, (node, depth, words)) in places.into_iter().enumerate() {
            ui.horizontal(|ui| {
                ui.add_space(f32::from(depth) * INDENT);
                let is_chosen = self.node == node;
                let row = focus::selectable_row(ui, is_chosen, words);
                if list.show_cursor(ui, at, &row) {
                    self.node = node;
                }
            });
        }
        list.entered_row().is_some()
    }

    /// Draws the tree as a drop-down list, for a narrow view. The open list reaches down to
    /// `bottom`, points.
    fn show_node_list(&mut self, ui: &mut Ui, language: Language, bottom: f32) {
        let places = self.node_labels(language);
        let chosen = places.into_iter().find(|(node, ..)| *node == self.node);
        let selected_label = chosen.map_or_else(String::new, |(_, _, words)| words);
        let list = ComboBox::from_id_salt("project place")
            .width(ui.available_width())
            .height(bottom - ui.cursor().top() - LIST_MARGIN)
            .selected_text(selected_label.as_str())
            .show_ui(ui, |ui| {
                if self.show_tree(ui, language) {
                    ui.close();
                }
            });
        let name = say::project_view_place().text(language);
        list.response.widget_info(|| WidgetInfo {
            current_text_value: Some(selected_label.clone()),
            ..WidgetInfo::labeled(Role::ComboBox, true, &name)
        });
    }

    /// Draws the tabs and the page of the selected node.
    fn show_page(&mut self, ui: &mut Ui, language: Language) {
        let Some(document) = &self.document else {
            ui.label(say::project_view_none().text(language));
            return;
        };
        let sheet_page = ProjectSheets::page_of(self.node);
        let difference_count = self.comparison.as_ref().map(|it| it.count_of(self.node));
        let tabs = [
            sheet_page.map(|_| (NodePage::Edit, say::project_view_edit())),
            Some((NodePage::Contents, say::project_view_contents())),
            difference_count
                .map(|count| (NodePage::Differences, say::project_view_differences(count))),
        ];
        // Nodes without fields show their content instead.
        let shown_page = match self.page {
            NodePage::Edit if sheet_page.is_none() => NodePage::Contents,
            NodePage::Differences if difference_count.is_none() => NodePage::Contents,
            page => page,
        };
        if sheet_page.is_some() || difference_count.is_some() {
            ui.horizontal_wrapped(|ui| {
                for (page, title) in tabs.into_iter().flatten() {
                    let tab = ui.selectable_label(shown_page == page, title.text(language));
                    if tab.clicked() {
                        self.page = page;
                    }
                }
            });
            ui.separator();
        }
        let request = match (shown_page, &mut self.comparison, sheet_page) {
            (NodePage::Edit, _, Some(sheet)) => {
                let state = Arc::clone(&document.state);
                if let Some(edit_request) = self.editing.show(ui, language, sheet, &state) {
                    self.apply_edits(&edit_request, ui.ctx());
                }
                return;
            }
            (NodePage::Differences, Some(compared), _) => {
                // The control is turned on again with the project folder: drafts would be
                // lost.
                let unsaved_refusal = match (document.is_changed, self.editing.has_drafts()) {
                    (true, _) => Some(say::project_view_save_first()),
                    (false, true) => Some(say::project_view_save_drafts()),
                    (false, false) => None,
                };
                let refusal = unsaved_refusal.as_ref().or(self.why_not.as_ref());
                compared.show(ui, language, self.node, refusal)
            }
            _ => {
                let state = Arc::clone(&document.state);
                self.content.show(ui, language, self.node, &state);
                None
            }
        };
        match request {
            Some(ComparisonRequest::SetTarget(target)) => self.compare_again(target, ui.ctx()),
            Some(ComparisonRequest::TakeOver(differences)) => self.take_over(differences, ui.ctx()),
            None => {}
        }
    }

    /// Writes the values that were typed into the project.
    fn apply_edits(&mut self, request: &super::data::WriteRequest, context: &Context) {
        let Some(document) = &mut self.document else {
            return;
        };
        let differences = differences_of_edits(&request.edits, &document.state);
        if let Err(error) = document.apply_differences(&differences, &Encodings::new()) {
            self.editing.show_refusal(error, request);
            return;
        }
        self.content.invalidate();
        if let Some(target) = self.comparison.as_ref().map(|it| it.target) {
            self.compare_again(target, context);
        }
    }

    /// Takes the checked differences over into the project or, for the control, selects them
    /// until it is off.
    fn take_over(&mut self, differences: Vec<gsk_project::ProjectDifference>, context: &Context) {
        let (Some(document), Some(compared)) = (&mut self.document, &self.comparison) else {
            return;
        };
        if compared.target == TakeoverTarget::Control {
            self.selection = Some(ProjectSelection {
                folder: document.folder.clone(),
                differences,
            });
            return;
        }
        let basis = Arc::clone(&compared.basis);
        let message = match document.apply_differences(&differences, &basis.encodings) {
            Ok(()) => say::project_view_taken_in(differences.len()),
            Err(error) => error,
        };
        self.content.invalidate();
        self.notify(message);
        self.compare_again(TakeoverTarget::Project, context);
    }

    fn notify(&self, message: Message) {
        // A full queue means that the window is closed: the message is dropped.
        let notice = gsk_host::kernel::Notice::Message(message);
        let _ = self.console.notice_sender.try_send(notice);
    }
}
