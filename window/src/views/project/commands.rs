//! Carries out project commands in threads, and asks for confirmation before something is
//! lost.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use egui::Context;
use gsk_core::model::ModelId;
use gsk_host::project::{self, Encodings};
use gsk_messages::{Language, Message, say};
use gsk_project::ProjectState;

use super::comparison::{ComparedWith, Comparison, ComparisonBasis, TakeoverTarget};
use super::document::{ProjectDocument, project_folder};
use super::project_sheets::ProjectSheets;
use super::{MAX_RECENT, NodePage, ProjectView};
use crate::views::interface::View;
use crate::widgets::files::{self, FileChoice};
use crate::widgets::questions;

/// A command of the project menu.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ProjectViewCommand {
    /// Create a project with the values of a control as delivered.
    New,
    /// Create a project with the current values of the control.
    FromControl,
    /// Show a dialog to choose a project, and open it.
    Open,
    /// Choose a project, open it and list its differences from the control.
    OpenAndCompare,
    /// Open the project in this folder.
    OpenFolder(PathBuf),
    /// Close the open project.
    Close,
}

/// The commands of the project menu with the functions that return their names.
pub const COMMANDS: [(ProjectViewCommand, fn() -> Message); 3] = [
    (ProjectViewCommand::New, say::project_menu_new),
    (
        ProjectViewCommand::FromControl,
        say::project_view_from_control,
    ),
    (
        ProjectViewCommand::OpenAndCompare,
        say::project_menu_compare,
    ),
];

/// A result that a background thread reports to the project view.
pub enum ProjectEvent {
    /// A project was opened or created; `true`: the next step is to compare it with the
    /// control.
    Opened(Box<ProjectDocument>, bool),
    /// The open project was written to its folder.
    Saved(Box<ProjectDocument>),
    /// The comparison with this number has ended with this result.
    Compared(u64, Box<Comparison>),
    /// The folder for this new project already contains a project.
    FolderTaken(Box<ProjectDocument>),
}

/// Numbers the comparisons. Of two that run at once, only the result of the one that was
/// started last is used.
#[derive(Clone, Debug, Default)]
pub(super) struct ComparisonCounter(Arc<AtomicU64>);

impl ComparisonCounter {
    /// Returns the number for a new comparison.
    fn next_number(&self) -> u64 {
        self.0.fetch_add(1, Ordering::Relaxed) + 1
    }

    /// Whether the comparison with this number is the newest.
    fn is_newest(&self, number: u64) -> bool {
        self.0.load(Ordering::Relaxed) == number
    }
}

/// A question that the operator must answer in the project view.
pub enum ProjectQuestion {
    /// Whether to discard the unsaved changes of the project for this command.
    Discard(ProjectViewCommand),
    /// Whether to replace the project in the folder of this document.
    Replace(Box<ProjectDocument>),
}

impl ProjectView {
    /// Carries out a command. If unsaved changes would be lost, opens a question first.
    pub fn command(&mut self, command: ProjectViewCommand, language: Language, context: &Context) {
        match self.unsaved().is_some() {
            true => self.question = Some(ProjectQuestion::Discard(command)),
            false => self.carry_out(command, language, context),
        }
    }

    fn carry_out(&mut self, command: ProjectViewCommand, language: Language, context: &Context) {
        match command {
            ProjectViewCommand::New | ProjectViewCommand::FromControl => {
                let is_new = command == ProjectViewCommand::New;
                let console = self.console.clone();
                self.create_in_chosen_folder(language, context, move |folder| {
                    let (state, _) = console.state().ok_or_else(say::project_no_answer)?;
                    Ok(ProjectDocument {
                        state: Arc::new(match is_new {
                            true => delivered_project(state.memory().model.id()),
                            false => state,
                        }),
                        folder,
                        encodings: Encodings::new(),
                        is_changed: true,
                    })
                });
            }
            ProjectViewCommand::Open => self.choose_and_open(language, context, false),
            ProjectViewCommand::OpenAndCompare => self.choose_and_open(language, context, true),
            ProjectViewCommand::OpenFolder(folder) => self.open(folder, false, context),
            ProjectViewCommand::Close => {
                self.document = None;
                self.editing = ProjectSheets::default();
                self.comparison = None;
                self.settings.open = None;
            }
        }
    }

    /// Opens the project in `folder` in a thread. With `then_compare` the project is compared
    /// with the control, too.
    pub fn open(&mut self, folder: PathBuf, then_compare: bool, context: &Context) {
        // Otherwise the project of the last session would open after this one.
        self.settings.open = None;
        self.run_in_thread(context, move || {
            let document = ProjectDocument::read(&folder)?;
            Ok(ProjectEvent::Opened(Box::new(document), then_compare))
        });
    }

    /// Opens the project of the last session at the first call.
    pub fn reopen_last(&mut self, context: &Context) {
        if self.document.is_none()
            && let Some(folder) = self.settings.open.take()
        {
            self.open(folder, false, context);
        }
    }

    fn choose_and_open(&self, language: Language, context: &Context, then_compare: bool) {
        let sender = self.results.0.clone();
        let choice = FileChoice::Open(say::project_files().text(language), vec!["gpr"]);
        let notices = &self.console.notice_sender;
        files::choose_file(context, language, notices, choice, move |path| {
            match ProjectDocument::read(&project_folder(&path)) {
                Ok(document) => {
                    // A closed window shows nothing.
                    let _ = sender.send(ProjectEvent::Opened(Box::new(document), then_compare));
                    None
                }
                Err(error) => Some(error),
            }
        });
    }

    /// Lets the user choose another project and compares the open one with it.
    pub(super) fn choose_and_compare(&self, language: Language, context: &Context) {
        let Some(document) = self.document.clone() else {
            return;
        };
        let (sender, console) = (self.results.0.clone(), self.console.clone());
        let counter = self.comparison_counter.clone();
        let choice = FileChoice::Open(say::project_files().text(language), vec!["gpr"]);
        let notices = &self.console.notice_sender;
        files::choose_file(context, language, notices, choice, move |path| {
            let number = counter.next_number();
            let basis = ComparisonBasis::read(ComparedWith::Folder(path), &console);
            let comparison = basis.and_then(|basis| {
                Comparison::new(&document, Arc::new(basis), TakeoverTarget::Project)
            });
            match comparison {
                Ok(compared) => {
                    let _ = sender.send(ProjectEvent::Compared(number, Box::new(compared)));
                    None
                }
                Err(error) => Some(error),
            }
        });
    }

    /// Lets the user choose a folder and writes the document that `make` returns into it. If
    /// the folder already contains a project, opens a question first.
    fn create_in_chosen_folder(
        &self,
        language: Language,
        context: &Context,
        make: impl FnOnce(PathBuf) -> Result<ProjectDocument, Message> + Send + 'static,
    ) {
        let sender = self.results.0.clone();
        let name = say::project_file_name().text(language);
        let choice = FileChoice::Save(format!("{name}.gpr"), "gpr");
        let notices = &self.console.notice_sender;
        files::choose_file(context, language, notices, choice, move |path| {
            let created = make(project_folder(&path)).and_then(|document| {
                if project::is_project(&document.folder) {
                    return Ok((ProjectEvent::FolderTaken(Box::new(document)), None));
                }
                let (document, message) = document.write(language)?;
                Ok((
                    ProjectEvent::Opened(Box::new(document), false),
                    Some(message),
                ))
            });
            match created {
                Ok((news, message)) => {
                    let _ = sender.send(news);
                    message
                }
                Err(error) => Some(error),
            }
        });
    }

    /// 工程另存为: saves the project under another name, which stays open from then on.
    pub(super) fn save_as(&self, language: Language, context: &Context) {
        let Some(document) = self.document.clone() else {
            return;
        };
        self.create_in_chosen_folder(language, context, move |folder| {
            Ok(ProjectDocument { folder, ..document })
        });
    }

    /// 保存工程: saves the project in its folder.
    pub(super) fn save(&self, language: Language, context: &Context) {
        let Some(document) = self.document.clone() else {
            return;
        };
        self.write(document, language, context, ProjectEvent::Saved);
    }

    fn write(
        &self,
        document: ProjectDocument,
        language: Language,
        context: &Context,
        to_event: fn(Box<ProjectDocument>) -> ProjectEvent,
    ) {
        let sender = self.results.0.clone();
        let notices = &self.console.notice_sender;
        files::run_in_thread(context, notices, move || match document.write(language) {
            Ok((document, message)) => {
                let _ = sender.send(to_event(Box::new(document)));
                Some(message)
            }
            Err(error) => Some(error),
        });
    }

    /// Compares the open project with another side in a thread.
    pub(super) fn compare(&self, other: ComparedWith, target: TakeoverTarget, context: &Context) {
        let Some(document) = self.document.clone() else {
            return;
        };
        let console = self.console.clone();
        let number = self.comparison_counter.next_number();
        self.run_in_thread(context, move || {
            let basis = Arc::new(ComparisonBasis::read(other, &console)?);
            let compared = Comparison::new(&document, basis, target)?;
            Ok(ProjectEvent::Compared(number, Box::new(compared)))
        });
    }

    /// Repeats the comparison with the same state of the other side, for another `target` or a
    /// changed project.
    pub(super) fn compare_again(&self, target: TakeoverTarget, context: &Context) {
        let (Some(document), Some(compared)) = (self.document.clone(), &self.comparison) else {
            return;
        };
        let basis = Arc::clone(&compared.basis);
        let number = self.comparison_counter.next_number();
        self.run_in_thread(context, move || {
            let compared = Comparison::new(&document, basis, target)?;
            Ok(ProjectEvent::Compared(number, Box::new(compared)))
        });
    }

    fn run_in_thread(
        &self,
        context: &Context,
        job: impl FnOnce() -> Result<ProjectEvent, Message> + Send + 'static,
    ) {
        let sender = self.results.0.clone();
        files::run_in_thread(context, &self.console.notice_sender, move || match job() {
            Ok(news) => {
                let _ = sender.send(news);
                None
            }
            Err(error) => Some(error),
        });
    }

    /// Receives the results of the background threads.
    pub(super) fn receive(&mut self, context: &Context) {
        while let Ok(news) = self.results.1.try_recv() {
            match news {
                ProjectEvent::Opened(document, then_compare) => {
                    self.store_recent(&document.folder);
                    self.document = Some(*document);
                    self.comparison = None;
                    self.page = NodePage::Edit;
                    self.content.invalidate();
                    self.editing = ProjectSheets::default();
                    if then_compare {
                        self.compare(ComparedWith::Control, TakeoverTarget::Control, context);
                    }
                }
                ProjectEvent::Saved(document) => {
                    let current = self.document.as_ref();
                    if current.is_some_and(|own| own.folder == document.folder) {
                        self.document = Some(*document);
                        self.content.invalidate();
                        if let Some(compared) = &self.comparison {
                            self.compare_again(compared.target, context);
                        }
                    }
                }
                // Another project may be open by now, or a later comparison may run.
                ProjectEvent::Compared(number, compared) => {
                    let current = self.document.as_ref();
                    let is_current =
                        current.is_some_and(|own| Arc::ptr_eq(&own.state, &compared.project));
                    if is_current && self.comparison_counter.is_newest(number) {
                        let had_comparison = self.comparison.replace(*compared).is_some();
                        // A comparison that is repeated while values are typed leaves the
                        // fields open.
                        if !(had_comparison && self.page == NodePage::Edit) {
                            self.page = NodePage::Differences;
                        }
                    }
                }
                ProjectEvent::FolderTaken(document) => {
                    self.question = Some(ProjectQuestion::Replace(document));
                }
            }
        }
    }

    fn store_recent(&mut self, folder: &std::path::Path) {
        let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        let recent = &mut self.settings.recent;
        recent.retain(|known| *known != folder);
        recent.insert(0, folder.clone());
        recent.truncate(MAX_RECENT);
        self.settings.open = Some(folder);
    }

    /// Draws the open question and carries out the answer.
    pub(super) fn show_question(&mut self, context: &Context, language: Language) {
        let Some(question) = &self.question else {
            return;
        };
        let (title, loss, agree) = match question {
            ProjectQuestion::Discard(_) => (
                say::project_view_unsaved(),
                say::project_view_is_lost(),
                say::project_view_discard(),
            ),
            ProjectQuestion::Replace(document) => (
                say::project_view_replace(document.folder.display()),
                say::project_view_is_replaced(),
                say::project_view_replace_agree(),
            ),
        };
        let [title, loss] = [title, loss].map(|message| message.text(language));
        // The answer that loses nothing comes first, as in the question on closing the window.
        let answers = [say::window_cancel(), agree].map(|message| message.text(language));
        let Some(answer) = questions::show_question(context, "project", &title, &loss, &answers)
        else {
            return;
        };
        match self.question.take() {
            Some(ProjectQuestion::Discard(command)) if answer == 1 => {
                self.carry_out(command, language, context);
            }
            Some(ProjectQuestion::Replace(document)) if answer == 1 => {
                let opened = |document| ProjectEvent::Opened(document, false);
                self.write(*document, language, context, opened);
            }
            _ => {}
        }
    }
}

/// The project of a control of this model in its delivered state.
fn delivered_project(model: ModelId) -> ProjectState {
    ProjectState::from_setup(&project::factory_setup(model, None))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_started_comparison_counts() {
        let counter = ComparisonCounter::default();
        let slow = counter.clone().next_number();
        let quick = counter.next_number();
        assert!(counter.is_newest(quick));
        assert!(!counter.is_newest(slow));
    }
}
