//! The project that is open: read from its folder, written there.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gsk_messages::{Language, Message, say};
use gsk_project::{ProjectDifference, ProjectKey, ProjectState, apply, export};

use crate::files::program_file;
use crate::project::{self, Encodings, ProjectError};

/// An open project.
#[derive(Clone)]
pub struct Document {
    /// Its folder.
    pub folder: PathBuf,
    /// What it holds.
    pub state: Arc<ProjectState>,
    /// How its programs are written down.
    pub encodings: Encodings,
    /// It holds what its folder does not.
    pub is_changed: bool,
}

impl Document {
    /// Reads a folder.
    ///
    /// # Errors
    /// All that is wrong with it.
    pub fn read(folder: &Path) -> Result<Self, Message> {
        let (state, encodings) = project::read(folder).map_err(|error| error.message())?;
        Ok(Self {
            folder: folder.to_owned(),
            state: Arc::new(state),
            encodings,
            is_changed: false,
        })
    }

    /// Writes it into its folder, and reads what stands there then; how much was written.
    ///
    /// # Errors
    /// What the folder holds else, what could not be written.
    pub fn write(&self, language: Language) -> Result<(Self, Message), Message> {
        let files = export(&self.state, language_of(&self.folder, language));
        let written = project::write(&self.folder, &self.state, &files, &self.encodings);
        let written = written.map_err(|error| error.message())?;
        let said = say::project_exported(self.folder.display(), written.files, written.removed);
        Ok((Self::read(&self.folder)?, said))
    }

    /// Takes values over.
    ///
    /// # Errors
    /// The rules that the whole would break; nothing is changed then.
    pub fn take(
        &mut self,
        differences: &[ProjectDifference],
        encodings: &Encodings,
    ) -> Result<(), Message> {
        let changed = apply(&self.state, differences);
        let changed = changed.map_err(|faults| ProjectError::Faults(faults).message())?;
        self.state = Arc::new(changed);
        for (number, encoding) in encodings {
            self.encodings.entry(*number).or_insert(*encoding);
        }
        self.is_changed = true;
        Ok(())
    }

    /// What it is called: as its folder.
    pub fn name(&self) -> String {
        let name = self.folder.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }
}

/// The numbers of the programs of a state.
pub fn programs(state: &ProjectState) -> BTreeSet<u16> {
    let programs = state.memory().programs.iter();
    let jobs = state.texts().into_iter().flat_map(|texts| texts.keys());
    let jobs = jobs.filter_map(|key| match key {
        ProjectKey::Job(number) => Some(*number),
        _ => None,
    });
    programs.map(|(number, _)| number).chain(jobs).collect()
}

/// The folder that is meant by the file that was chosen: the one that `project.gpr` lies in,
/// else a folder of this name (manual GSKCC: a folder for each project).
pub fn folder_of(path: &Path) -> PathBuf {
    match (path.file_name(), path.parent()) {
        (Some(name), Some(folder)) if name == project::HEAD => folder.to_owned(),
        _ => path.with_extension(""),
    }
}

/// The language of the remarks that stand in a folder, so that saving changes none of them.
fn language_of(folder: &Path, otherwise: Language) -> Language {
    let Ok(head) = program_file::read(&folder.join(project::HEAD)) else {
        return otherwise;
    };
    let speaks = |language: &Language| {
        let heading = say::project_heading().text(*language);
        head.text.lines().any(|line| line.contains(&heading))
    };
    let found = [Language::Zh, Language::En].into_iter().find(speaks);
    found.unwrap_or(otherwise)
}
