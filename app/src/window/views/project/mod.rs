//! The project view, after GSKCC (manual PLC-V): the tree of a project, the content of its
//! nodes, the differences from the control or another project, and taking differences over.
//! The control is off while it takes values over, as for a new ladder.

mod compared;
mod content;
mod document;
mod editing;
mod steps;
mod tree;

use std::path::PathBuf;
use std::sync::Arc;

use crossbeam::channel::{Receiver, Sender, unbounded};
use egui::{
    Button, CentralPanel, Color32, ComboBox, Context, Panel, RichText, Role, ScrollArea, Ui,
    WidgetInfo,
};
use gsk_messages::{Language, Message, say};
use serde::{Deserialize, Serialize};

use crate::kernel::Console;
use crate::project::Encodings;
use crate::window::focus;
pub use compared::Chosen;
use compared::{Asked, Compared, Other, Target};
use content::Content;
use document::{Document, programs};
use editing::{Editing, differences};
use steps::{Begun, News, Question};
pub use steps::{COMMANDS, ProjectCommand};
use tree::{Name, Node, places};

/// Width of the tree, and the indent per level, points.
const TREE: f32 = 200.0;
const STEP: f32 = 14.0;
/// Below this width of the view the tree is a drop-down list, points.
const NARROW: f32 = 520.0;
/// Margin below the open drop-down list, points.
const LIST_ROOM: f32 = 50.0;
/// Greatest count of recent projects (manual PLC-V 3: four).
const MOST: usize = 4;
/// Colour of the sign for unsaved changes.
const CHANGED: Color32 = Color32::from_rgb(255, 214, 110);

/// The projects that the settings store for the next start.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Projects {
    /// The folder of the open project.
    pub open: Option<PathBuf>,
    /// The last projects, the newest first.
    pub recent: Vec<PathBuf>,
}

/// The tab of the selected node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Page {
    /// Fields to type into. Nodes without fields show their content instead.
    Edit,
    Contents,
    Differences,
}

/// The project view.
pub struct ProjectView {
    console: Console,
    remembered: Projects,
    document: Option<Document>,
    compared: Option<Compared>,
    node: Node,
    page: Page,
    content: Content,
    editing: Editing,
    question: Option<Question>,
    /// Why the control cannot be turned off now; `None`: it can.
    why_not: Option<Message>,
    /// What the control takes over while it is off.
    chosen: Option<Chosen>,
    news: (Sender<News>, Receiver<News>),
    begun: Begun,
}

impl ProjectView {
    /// Creates the view. It reads no project before it is shown.
    pub fn new(console: Console, remembered: Projects) -> Self {
        Self {
            console,
            remembered,
            document: None,
            compared: None,
            node: Node::Project,
            page: Page::Edit,
            content: Content::default(),
            editing: Editing::default(),
            question: None,
            why_not: None,
            chosen: None,
            news: unbounded(),
            begun: Begun::default(),
        }
    }

    /// The projects to store for the next start.
    pub const fn remembered(&self) -> &Projects {
        &self.remembered
    }

    /// Whether the project has changes that are not in its folder.
    pub fn is_unsaved(&self) -> bool {
        let document = self.document.as_ref();
        document.is_some_and(|document| document.is_changed || self.editing.has_drafts())
    }

    /// Sets why the control cannot be turned off now; `None`: it can.
    pub fn set_why_not(&mut self, why_not: Option<Message>) {
        self.why_not = why_not;
    }

    /// Takes the values that the control is to take over while it is off.
    pub const fn take_chosen(&mut self) -> Option<Chosen> {
        self.chosen.take()
    }

    pub fn show(&mut self, ui: &mut Ui, language: Language) {
        self.reopen(ui.ctx());
        let bottom = ui.max_rect().bottom();
        self.hear(ui.ctx());
        Panel::top("project bar")
            .frame(super::bar_frame())
            .show(ui, |ui| self.bar(ui, language));
        if self.document.is_some() && ui.available_width() < NARROW {
            Panel::top("project place")
                .frame(super::side_frame())
                .show(ui, |ui| self.place(ui, language, bottom));
        } else if self.document.is_some() {
            Panel::left("project tree")
                .exact_size(TREE)
                .resizable(false)
                .frame(super::side_frame())
                .show(ui, |ui| {
                    ScrollArea::vertical()
                        .id_salt("project tree")
                        .auto_shrink([false, false])
                        .show(ui, |ui| self.tree(ui, language));
                });
        }
        CentralPanel::default()
            .frame(super::side_frame())
            .show(ui, |ui| self.page(ui, language));
        self.ask(ui.ctx(), language);
    }

    /// Draws the buttons of the project, and those for the other side of the comparison.
    fn bar(&mut self, ui: &mut Ui, language: Language) {
        ui.horizontal_wrapped(|ui| {
            for (command, name) in [
                (ProjectCommand::New, say::project_menu_new()),
                (
                    ProjectCommand::FromControl,
                    say::project_view_from_control(),
                ),
                (ProjectCommand::Open, say::project_view_open()),
            ] {
                if ui.button(name.text(language)).clicked() {
                    self.command(command, language, ui.ctx());
                }
            }
            let mut again = None;
            let recent = &self.remembered.recent;
            if !recent.is_empty() {
                ui.menu_button(say::project_view_recent().text(language), |ui| {
                    for folder in recent {
                        let name = folder.file_name().unwrap_or_default().to_string_lossy();
                        let path = folder.display().to_string();
                        if ui.button(name.as_ref()).on_hover_text(path).clicked() {
                            again = Some(folder.clone());
                            ui.close();
                        }
                    }
                });
            }
            if let Some(folder) = again {
                self.command(ProjectCommand::Folder(folder), language, ui.ctx());
            }
            let Some(document) = &self.document else {
                return;
            };
            let is_changed = document.is_changed;
            let why_not = match self.editing.has_drafts() {
                true => say::project_view_save_drafts(),
                false => say::project_view_saved(),
            };
            let save = Button::new(say::project_view_save().text(language));
            let save = ui.add_enabled(is_changed, save);
            let save = save.on_disabled_hover_text(why_not.text(language));
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
                self.command(ProjectCommand::Close, language, ui.ctx());
            }
        });
        let Some(document) = &self.document else {
            return;
        };
        let folder = document.folder.display().to_string();
        let is_changed = document.is_changed;
        ui.horizontal_wrapped(|ui| {
            ui.weak(say::project_view_compare().text(language));
            let other = self.compared.as_ref().map(|it| it.basis.other.clone());
            let control = matches!(other, Some(Other::Control));
            let words = say::project_view_control().text(language);
            if ui.selectable_label(control, words).clicked() {
                self.compare(Other::Control, Target::Control, ui.ctx());
            }
            let folder_too = matches!(other, Some(Other::Folder(_)));
            let words = say::project_view_folder().text(language);
            if ui.selectable_label(folder_too, words).clicked() {
                self.choose_other(language, ui.ctx());
            }
            if let Some(compared) = &self.compared
                && ui
                    .button(say::project_view_again().text(language))
                    .clicked()
            {
                let (other, target) = (compared.basis.other.clone(), compared.target);
                self.compare(other, target, ui.ctx());
            }
            if is_changed {
                let words = say::project_view_changed().text(language);
                ui.label(RichText::new(words).color(CHANGED));
            }
            ui.weak(folder);
        });
    }

    /// The nodes of the tree with their depth and name. The name includes the count of
    /// differences.
    fn places(&self, language: Language) -> Vec<(Node, u8, String)> {
        let Some(document) = &self.document else {
            return Vec::new();
        };
        let mut all = programs(&document.state);
        if let Some(compared) = &self.compared {
            all.extend(programs(&compared.basis.state));
        }
        let all: Vec<u16> = all.into_iter().collect();
        let places = places(&document.name(), &all).into_iter().map(|place| {
            let name = match place.name {
                Name::Said(said) => said.text(language),
                Name::Program(name) => name,
            };
            let count = self.compared.as_ref().map_or(0, |it| it.count(place.node));
            let words = match count {
                0 => name,
                _ => format!("{name} · {count}"),
            };
            (place.node, place.depth, words)
        });
        places.collect()
    }

    /// Draws the tree. Returns whether Enter was pressed on a node.
    fn tree(&mut self, ui: &mut Ui, language: Language) -> bool {
        let places = self.places(language);
        let chosen = places.iter().position(|(node, ..)| *node == self.node);
        let name = say::project_view_place().text(language);
        let list = focus::List::begin(ui, "places", &name, places.len(), chosen);
        if let Some((node, ..)) = list.moved().and_then(|at| places.get(at)) {
            self.node = *node;
        }
        for (at, (node, depth, words)) in places.into_iter().enumerate() {
            ui.horizontal(|ui| {
                ui.add_space(f32::from(depth) * STEP);
                let is_chosen = self.node == node;
                let row = focus::row(ui, is_chosen, words);
                if list.row(ui, at, &row) {
                    self.node = node;
                }
            });
        }
        list.entered().is_some()
    }

    /// Draws the tree as a drop-down list, in a narrow view. The open list reaches down to
    /// `bottom`.
    fn place(&mut self, ui: &mut Ui, language: Language, bottom: f32) {
        let places = self.places(language);
        let chosen = places.into_iter().find(|(node, ..)| *node == self.node);
        let words = chosen.map_or_else(String::new, |(_, _, words)| words);
        let shown = ComboBox::from_id_salt("project place")
            .width(ui.available_width())
            .height(bottom - ui.cursor().top() - LIST_ROOM)
            .selected_text(words.as_str())
            .show_ui(ui, |ui| {
                if self.tree(ui, language) {
                    ui.close();
                }
            });
        let name = say::project_view_place().text(language);
        shown.response.widget_info(|| WidgetInfo {
            current_text_value: Some(words.clone()),
            ..WidgetInfo::labeled(Role::ComboBox, true, &name)
        });
    }

    /// Draws the tabs and the page of the selected node.
    fn page(&mut self, ui: &mut Ui, language: Language) {
        let Some(document) = &self.document else {
            ui.label(say::project_view_none().text(language));
            return;
        };
        let sheet = Editing::page(self.node);
        let counted = self.compared.as_ref().map(|it| it.count(self.node));
        let tabs = [
            sheet.map(|_| (Page::Edit, say::project_view_edit())),
            Some((Page::Contents, say::project_view_contents())),
            counted.map(|count| (Page::Differences, say::project_view_differences(count))),
        ];
        // Nodes without fields show their content instead.
        let shown = match self.page {
            Page::Edit if sheet.is_none() => Page::Contents,
            Page::Differences if counted.is_none() => Page::Contents,
            page => page,
        };
        if sheet.is_some() || counted.is_some() {
            ui.horizontal_wrapped(|ui| {
                for (page, said) in tabs.into_iter().flatten() {
                    let tab = ui.selectable_label(shown == page, said.text(language));
                    if tab.clicked() {
                        self.page = page;
                    }
                }
            });
            ui.separator();
        }
        let asked = match (shown, &mut self.compared, sheet) {
            (Page::Edit, _, Some(sheet)) => {
                let state = Arc::clone(&document.state);
                if let Some(asked) = self.editing.show(ui, language, sheet, &state) {
                    self.put(&asked, ui.ctx());
                }
                return;
            }
            (Page::Differences, Some(compared), _) => {
                // The control is turned on again with the project folder: drafts would be
                // lost.
                let first = match (document.is_changed, self.editing.has_drafts()) {
                    (true, _) => Some(say::project_view_save_first()),
                    (false, true) => Some(say::project_view_save_drafts()),
                    (false, false) => None,
                };
                let why_not = first.as_ref().or(self.why_not.as_ref());
                compared.show(ui, language, self.node, why_not)
            }
            _ => {
                let state = Arc::clone(&document.state);
                self.content.show(ui, language, self.node, &state);
                None
            }
        };
        match asked {
            Some(Asked::Turn(target)) => self.turn(target, ui.ctx()),
            Some(Asked::Take(differences)) => self.take(differences, ui.ctx()),
            None => {}
        }
    }

    /// Puts typed values into the project.
    fn put(&mut self, asked: &super::data::Asked, context: &Context) {
        let Some(document) = &mut self.document else {
            return;
        };
        let differences = differences(&asked.edits, &document.state);
        if let Err(said) = document.take(&differences, &Encodings::new()) {
            self.editing.refuse(said, asked);
            return;
        }
        self.content.forget();
        if let Some(target) = self.compared.as_ref().map(|it| it.target) {
            self.turn(target, context);
        }
    }

    /// Selects the checked differences for the control, or takes them over into the project.
    fn take(&mut self, differences: Vec<gsk_project::ProjectDifference>, context: &Context) {
        let (Some(document), Some(compared)) = (&mut self.document, &self.compared) else {
            return;
        };
        if compared.target == Target::Control {
            self.chosen = Some(Chosen {
                folder: document.folder.clone(),
                differences,
            });
            return;
        }
        let basis = Arc::clone(&compared.basis);
        let said = match document.take(&differences, &basis.encodings) {
            Ok(()) => say::project_view_taken_in(differences.len()),
            Err(said) => said,
        };
        self.content.forget();
        self.say(said);
        self.turn(Target::Project, context);
    }

    fn say(&self, said: Message) {
        // A full queue means that the window is closed: the message is dropped.
        let notice = crate::kernel::Notice::Said(said);
        let _ = self.console.say.try_send(notice);
    }
}
