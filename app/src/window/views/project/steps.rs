//! What is done with projects beside the window, and what is asked before something is lost.

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

/// What is done with projects.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ProjectCommand {
    /// Make one of a control as it is delivered.
    New,
    /// Make one of what the control holds.
    FromControl,
    /// Open one.
    Open,
    /// Open one and list what differs from the control.
    OpenAndCompare,
    /// Open this one.
    Folder(PathBuf),
    /// Close the one that is open.
    Close,
}

/// The entries of the menu.
pub const COMMANDS: [(ProjectCommand, fn() -> Message); 3] = [
    (ProjectCommand::New, say::project_menu_new),
    (ProjectCommand::FromControl, say::project_view_from_control),
    (ProjectCommand::OpenAndCompare, say::project_menu_compare),
];

/// What has been done beside the window.
pub enum News {
    /// A project was opened, or made; it is to be compared with the control.
    Opened(Box<Document>, bool),
    /// The one that is open was written.
    Saved(Box<Document>),
    /// It was compared, in the comparison of this number.
    Compared(u64, Box<Compared>),
    /// Its folder is a project already.
    Taken(Box<Document>),
}

/// The comparisons that were begun: of two at once the one begun last counts, whichever
/// comes first.
#[derive(Clone, Debug, Default)]
pub(super) struct Begun(Arc<AtomicU64>);

impl Begun {
    /// The number of another one.
    fn next(&self) -> u64 {
        self.0.fetch_add(1, Ordering::Relaxed) + 1
    }

    /// Whether none was begun after it.
    fn is_newest(&self, number: u64) -> bool {
        self.0.load(Ordering::Relaxed) == number
    }
}

/// What is asked.
pub enum Question {
    /// Whether the open project is given up for something else.
    Discard(ProjectCommand),
    /// Whether another project is replaced.
    Replace(Box<Document>),
}

impl ProjectView {
    /// Carries out a command; what would be lost is asked for.
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

    /// Opens a project; `compare`: with the control, too.
    pub fn open(&mut self, folder: PathBuf, compare: bool, context: &Context) {
        // The one of the last time would come after it.
        self.remembered.open = None;
        self.beside(context, move || {
            let document = Document::read(&folder)?;
            Ok(News::Opened(Box::new(document), compare))
        });
    }

    /// Opens what was open the last time.
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
                    // A window that is gone shows nothing.
                    let _ = deliver.send(News::Opened(Box::new(document), compare));
                    None
                }
                Err(said) => Some(said),
            }
        });
    }

    /// Chooses the other project, and compares.
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

    /// Asks for a folder and writes what is made for it; one that is a project already is
    /// asked for.
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

    /// 工程另存为: under another name, and that one is open from then on.
    pub(super) fn save_as(&self, language: Language, context: &Context) {
        let Some(document) = self.document.clone() else {
            return;
        };
        self.put_where_chosen(language, context, move |folder| {
            Ok(Document { folder, ..document })
        });
    }

    /// 保存工程.
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

    /// Compares the open project.
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

    /// Compares with the same once more, the other way round or with another project.
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

    /// Takes what has been done beside the window.
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
                // It may be another project by now, or another comparison may have begun.
                News::Compared(number, compared) => {
                    let own = self.document.as_ref();
                    let is_own = own.is_some_and(|own| Arc::ptr_eq(&own.state, &compared.project));
                    if is_own && self.begun.is_newest(number) {
                        let again = self.compared.replace(*compared).is_some();
                        // One made anew as values are typed leaves the fields open.
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

    /// Draws the question that stands, and does what was answered.
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
        // What loses nothing comes first, as in the question on closing the window.
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

/// A control of this model as it is delivered.
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
