//! The open project: reads it from its folder and writes it there.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gsk_host::files::program_file;
use gsk_host::project::{self, Encodings, ProjectError};
use gsk_messages::{Language, Message, say};
use gsk_project::{ProjectDifference, ProjectKey, ProjectState, apply, export};

#[derive(Clone)]
pub struct ProjectDocument {
    pub folder: PathBuf,
    /// The values, programs and ladder of the project.
    pub state: Arc<ProjectState>,
    /// Character encodings of the project's program files, by program number.
    pub encodings: Encodings,
    /// Whether the project has changes that are not in its folder.
    pub is_changed: bool,
}

impl ProjectDocument {
    /// Reads a project from its folder.
    ///
    /// # Errors
    ///
    /// Everything that is wrong with the files.
    pub fn read(folder: &Path) -> Result<Self, Message> {
        let (state, encodings) = project::read(folder).map_err(|error| error.message())?;
        Ok(Self {
            folder: folder.to_owned(),
            state: Arc::new(state),
            encodings,
            is_changed: false,
        })
    }

    /// Writes the project into its folder and reads it back. Returns the new document and a
    /// message with the number of files.
    ///
    /// # Errors
    ///
    /// The folder contains other files, or a file could not be written.
    pub fn write(&self, language: Language) -> Result<(Self, Message), Message> {
        let files = export(&self.state, comment_language(&self.folder, language));
        let counts = project::write(&self.folder, &self.state, &files, &self.encodings);
        let written = counts.map_err(|error| error.message())?;
        let message = say::project_exported(
            self.folder.display(),
            written.changed_files,
            written.removed_files,
        );
        Ok((Self::read(&self.folder)?, message))
    }

    /// Applies differences to the project.
    ///
    /// # Errors
    ///
    /// The rules that the result would violate. The project is unchanged then.
    pub fn apply_differences(
        &mut self,
        differences: &[ProjectDifference],
        encodings: &Encodings,
    ) -> Result<(), Message> {
        let changed = apply(&self.state, differences);
        let changed = changed.map_err(|faults| ProjectError::InvalidValues(faults).message())?;
        self.state = Arc::new(changed);
        for (number, encoding) in encodings {
            self.encodings.entry(*number).or_insert(*encoding);
        }
        self.is_changed = true;
        Ok(())
    }

    /// The name of the project, which is that of its folder.
    pub fn name(&self) -> String {
        let name = self.folder.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }
}

/// The numbers of all programs of a project, and of its job files without a program.
pub fn program_numbers(state: &ProjectState) -> BTreeSet<u16> {
    let programs = state.memory().programs.iter();
    let jobs = state.texts().into_iter().flat_map(|texts| texts.keys());
    let jobs = jobs.filter_map(|key| match key {
        ProjectKey::Job(number) => Some(*number),
        _ => None,
    });
    programs.map(|(number, _)| number).chain(jobs).collect()
}

/// The project folder for a chosen file: the folder of `project.gpr`, else a folder with the
/// name of the file (manual GSKCC: a folder for each project).
pub fn project_folder(path: &Path) -> PathBuf {
    match (path.file_name(), path.parent()) {
        (Some(name), Some(folder)) if name == project::PROJECT_FILE => folder.to_owned(),
        _ => path.with_extension(""),
    }
}

/// The language of the comments in the folder's files, in which saving changes no comments;
/// `default` if they have none.
fn comment_language(folder: &Path, default: Language) -> Language {
    let Ok(head) = program_file::read(&folder.join(project::PROJECT_FILE)) else {
        return default;
    };
    let is_used = |language: &Language| {
        let heading = say::project_heading().text(*language);
        head.text.lines().any(|line| line.contains(&heading))
    };
    let language = [Language::Zh, Language::En].into_iter().find(is_used);
    language.unwrap_or(default)
}
