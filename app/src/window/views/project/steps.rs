//! Carries out project commands in threads, and asks for confirmation before something is
//! lost.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use egui::Context;
use gsk_core::model::ModelId;
use gsk_messages::{Language, Message, say};
use gsk_project::ProjectState;

use super::compared::{Basis, Compared, Other, Target};
use super::document::{Document, folder_of};
use super::editing::Editing;
use super::{MOST, Page, ProjectView};
use crate::project::{self, Encodings};
use crate::window::files::{self, Wanted};
use crate::window::questions;

/// A command for the project view.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ProjectCommand {
    /// Create a project with the values of a control as delivered.
    New,
    /// Create a project with the current values of the control.
    FromControl,
    /// Choose a project and open it.
    Open,
    /// Choose a project, open it and list its differences from the control.
    OpenAndCompare,
    /// Open the project in this folder.
    Folder(PathBuf),
    /// Close the open project.
    Close,
}

/// The commands of the menu with their names.
pub const COMMANDS: [(ProjectCommand, fn() -> Message); 3] = [
    (ProjectCommand::New, say::project_menu_new),
    (ProjectCommand::FromControl, say::project_view_from_control),
    (ProjectCommand::OpenAndCompare, say::project_menu_compare),
];

/// Results of the threads.
pub enum News {
    /// A project was opened or created. With `true` it is compared with the control next.
    Opened(Box<Document>, bool),
    /// The open project was written.
    Saved(Box<Document>),
    /// The result of the comparison with this number.
    Compared(u64, Box<Compared>),
    /// The folder for a new project already contains a project.
    Taken(Box<Document>),
}

/// Numbers the comparisons. Of two that run at once, the one that was started last counts,
/// whichever ends first.
#[derive(Clone, Debug, Default)]
pub(super) struct Begun(Arc<AtomicU64>);

impl Begun {
    /// Returns the number of a new comparison.
    fn next(&self) -> u64 {
        self.0.fetch_add(1, Ordering::Relaxed) + 1
    }

    /// Whether no later comparison has been started.
    fn is_newest(&self, number: u64) -> bool {
        self.0.load(Ordering::Relaxed) == number
    }
}

/// An open question.
pub enum Question {
    /// Whether to discard the unsaved project for this command.
    Discard(ProjectCommand),
    /// Whether to replace the project in the folder of this document.
    Replace(Box<Document>),
}

impl ProjectView {
    /// Carries out a command. Asks first if unsaved changes would be lost.
    pub fn command(&mut self, command: ProjectCommand, language: Language, context: &Context) {
        match self.is_unsaved() {
            true => self.question = Some(Question::Discard(command)),
            false => self.carry_out(command, language, context),
        }
    }

    fn carry_out(&mut self, command: ProjectCommand, language: Language, context: &Context) {
        match command {
            ProjectCommand::New | ProjectCommand::FromControl => {
                let delivered = command == ProjectCommand::New;
                let console = self.console.clone();
                self.put_where_chosen(language, context, move |folder| {
                    let (state, _) = console.state().ok_or_else(say::project_no_answer)?;
                    Ok(Document {
                        state: Arc::new(match delivered {
                            true => as_delivered(state.memory().model.id()),
                            false => state,
                        }),
                        folder,
                        encodings: Encodings::new(),
                        is_changed: true,
                    })
                });
            }
            ProjectCommand::Open => self.choose(language, context, false),
            ProjectCommand::OpenAndCompare => self.choose(language, context, true),
            ProjectCommand::Folder(folder) => self.open(folder, false, context),
            ProjectCommand::Close => {
                self.document = None;
                self.editing = Editing::default();
                self.compared = None;
                self.remembered.open = None;
            }
        }
    }

    /// Opens the project in `folder`. With `compare` it is compared with the control, too.
    pub fn open(&mut self, folder: PathBuf, compare: bool, context: &Context) {
        // Otherwise the project of the last session would open after this one.
        self.remembered.open = None;
        self.beside(context, move || {
            let document = Document::read(&folder)?;
            Ok(News::Opened(Box::new(document), compare))
        });
    }

    /// Opens the project of the last session, once.
    pub fn reopen(&mut self, context: &Context) {
        if self.document.is_none()
            && let Some(folder) = self.remembered.open.take()
        {
            self.open(folder, false, context);
        }
    }

    fn choose(&self, language: Language, context: &Context, compare: bool) {
        let deliver = self.news.0.clone();
        let wanted = Wanted::Open(say::project_files().text(language), vec!["gpr"]);
        let say = &self.console.say;
        files::choose(context, language, say, wanted, move |path| {
            match Document::read(&folder_of(&path)) {
                Ok(document) => {
                    // A closed window shows nothing.
                    let _ = deliver.send(News::Opened(Box::new(document), compare));
                    None
                }
                Err(said) => Some(said),
            }
        });
    }

    /// Chooses the other project and compares with it.
    pub(super) fn choose_other(&self, language: Language, context: &Context) {
        let Some(document) = self.document.clone() else {
            return;
        };
        let (deliver, console) = (self.news.0.clone(), self.console.clone());
        let begun = self.begun.clone();
        let wanted = Wanted::Open(say::project_files().text(language), vec!["gpr"]);
        let say = &self.console.say;
        files::choose(context, language, say, wanted, move |path| {
            let number = begun.next();
            let basis = Basis::of(Other::Folder(path), &console);
            let compared =
                basis.and_then(|basis| Compared::new(&document, Arc::new(basis), Target::Project));
            match compared {
                Ok(compared) => {
                    let _ = deliver.send(News::Compared(number, Box::new(compared)));
                    None
                }
                Err(said) => Some(said),
            }
        });
    }

    /// Chooses a folder and writes the document that `make` returns into it. Asks first if the
    /// folder already contains a project.
    fn put_where_chosen(
        &self,
        language: Language,
        context: &Context,
        make: impl FnOnce(PathBuf) -> Result<Document, Message> + Send + 'static,
    ) {
        let deliver = self.news.0.clone();
        let name = say::project_file_name().text(language);
        let wanted = Wanted::Save(format!("{name}.gpr"), "gpr");
        let say = &self.console.say;
        files::choose(context, language, say, wanted, move |path| {
            let made = make(folder_of(&path)).and_then(|document| {
                if project::is_project(&document.folder) {
                    return Ok((News::Taken(Box::new(document)), None));
                }
                let (document, said) = document.write(language)?;
                Ok((News::Opened(Box::new(document), false), Some(said)))
            });
            match made {
                Ok((news, said)) => {
                    let _ = deliver.send(news);
                    said
                }
                Err(said) => Some(said),
            }
        });
    }

    /// 工程另存为: saves the project under another name. That project is open from then on.
    pub(super) fn save_as(&self, language: Language, context: &Context) {
        let Some(document) = self.document.clone() else {
            return;
        };
        self.put_where_chosen(language, context, move |folder| {
            Ok(Document { folder, ..document })
        });
    }

    /// 保存工程: saves the project in its folder.
    pub(super) fn save(&self, language: Language, context: &Context) {
        let Some(document) = self.document.clone() else {
            return;
        };
        self.write(document, language, context, News::Saved);
    }

    fn write(
        &self,
        document: Document,
        language: Language,
        context: &Context,
        done: fn(Box<Document>) -> News,
    ) {
        let deliver = self.news.0.clone();
        let say = &self.console.say;
        files::beside(context, say, move || match document.write(language) {
            Ok((document, said)) => {
                let _ = deliver.send(done(Box::new(document)));
                Some(said)
            }
            Err(said) => Some(said),
        });
    }

    /// Compares the open project with another side, in a thread.
    pub(super) fn compare(&self, other: Other, target: Target, context: &Context) {
        let Some(document) = self.document.clone() else {
            return;
        };
        let console = self.console.clone();
        let number = self.begun.next();
        self.beside(context, move || {
            let basis = Arc::new(Basis::of(other, &console)?);
            let compared = Compared::new(&document, basis, target)?;
            Ok(News::Compared(number, Box::new(compared)))
        });
    }

    /// Repeats the comparison with the same state of the other side, in the direction `target`
    /// or with a changed project.
    pub(super) fn turn(&self, target: Target, context: &Context) {
        let (Some(document), Some(compared)) = (self.document.clone(), &self.compared) else {
            return;
        };
        let basis = Arc::clone(&compared.basis);
        let number = self.begun.next();
        self.beside(context, move || {
            let compared = Compared::new(&document, basis, target)?;
            Ok(News::Compared(number, Box::new(compared)))
        });
    }

    fn beside(
        &self,
        context: &Context,
        job: impl FnOnce() -> Result<News, Message> + Send + 'static,
    ) {
        let deliver = self.news.0.clone();
        files::beside(context, &self.console.say, move || match job() {
            Ok(news) => {
                let _ = deliver.send(news);
                None
            }
            Err(said) => Some(said),
        });
    }

    /// Receives the results of the threads.
    pub(super) fn hear(&mut self, context: &Context) {
        while let Ok(news) = self.news.1.try_recv() {
            match news {
                News::Opened(document, compare) => {
                    self.remember(&document.folder);
                    self.document = Some(*document);
                    self.compared = None;
                    self.page = Page::Edit;
                    self.content.forget();
                    self.editing = Editing::default();
                    if compare {
                        self.compare(Other::Control, Target::Control, context);
                    }
                }
                News::Saved(document) => {
                    let own = self.document.as_ref();
                    if own.is_some_and(|own| own.folder == document.folder) {
                        self.document = Some(*document);
                        self.content.forget();
                        if let Some(compared) = &self.compared {
                            self.turn(compared.target, context);
                        }
                    }
                }
                // Another project may be open by now, or a later comparison may run.
                News::Compared(number, compared) => {
                    let own = self.document.as_ref();
                    let is_own = own.is_some_and(|own| Arc::ptr_eq(&own.state, &compared.project));
                    if is_own && self.begun.is_newest(number) {
                        let again = self.compared.replace(*compared).is_some();
                        // A comparison that is repeated while values are typed leaves the
                        // fields open.
                        if !(again && self.page == Page::Edit) {
                            self.page = Page::Differences;
                        }
                    }
                }
                News::Taken(document) => self.question = Some(Question::Replace(document)),
            }
        }
    }

    fn remember(&mut self, folder: &std::path::Path) {
        let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        let recent = &mut self.remembered.recent;
        recent.retain(|known| *known != folder);
        recent.insert(0, folder.clone());
        recent.truncate(MOST);
        self.remembered.open = Some(folder);
    }

    /// Draws the open question and carries out the answer.
    pub(super) fn ask(&mut self, context: &Context, language: Language) {
        let Some(question) = &self.question else {
            return;
        };
        let (title, loss, agree) = match question {
            Question::Discard(_) => (
                say::project_view_unsaved(),
                say::project_view_is_lost(),
                say::project_view_discard(),
            ),
            Question::Replace(document) => (
                say::project_view_replace(document.folder.display()),
                say::project_view_is_replaced(),
                say::project_view_replace_agree(),
            ),
        };
        let [title, loss] = [title, loss].map(|said| said.text(language));
        // The answer that loses nothing comes first, as in the question on closing the window.
        let answers = [say::window_cancel(), agree].map(|said| said.text(language));
        let Some(answer) = questions::ask(context, "project", &title, &loss, &answers) else {
            return;
        };
        match self.question.take() {
            Some(Question::Discard(command)) if answer == 1 => {
                self.carry_out(command, language, context);
            }
            Some(Question::Replace(document)) if answer == 1 => {
                let opened = |document| News::Opened(document, false);
                self.write(*document, language, context, opened);
            }
            _ => {}
        }
    }
}

/// The project of a control of this model as delivered.
fn as_delivered(model: ModelId) -> ProjectState {
    ProjectState::from_setup(&project::delivered(model, None))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_comparisons_the_one_begun_last_counts() {
        let begun = Begun::default();
        let slow = begun.clone().next();
        let quick = begun.next();
        assert!(begun.is_newest(quick));
        assert!(!begun.is_newest(slow));
    }
}
