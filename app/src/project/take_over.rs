//! Imports a project into a control that is switched off (decision PROJECT-6).

use std::path::{Path, PathBuf};

use gsk_core::battery::Memory;
use gsk_core::memory::{Authority, Level};
use gsk_core::model::ModelId;
use gsk_messages::{Message, say};
use gsk_project::{
    DeniedChange, ProjectDifference, ProjectState, apply, diff, find_denied_changes,
};

use super::{Encodings, ProjectError, back_up, delivered, read};
use crate::files::data_dir::DataDir;
use crate::files::models;
use crate::retained::project::{Held, held};

/// Whose rights limit an import.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Who<'a> {
    /// The operation level of the control after power-on.
    AtPowerOn,
    /// The level of this password, for one import.
    Password(&'a str),
    /// The level that was active when the control was switched off.
    LoggedOn,
}

impl Who<'_> {
    fn level(self, authority: &Authority) -> Result<Level, ProjectError> {
        match self {
            Self::AtPowerOn => {
                let mut authority = authority.clone();
                authority.power_on();
                Ok(authority.level())
            }
            Self::LoggedOn => Ok(authority.level()),
            Self::Password(password) => authority
                .level_of(password)
                .ok_or(ProjectError::WrongPassword),
        }
    }
}

/// A request to import a project.
#[derive(Clone, Copy, Debug)]
pub struct Taking<'a> {
    /// The folder of the project.
    pub project: &'a Path,
    pub directory: &'a Path,
    /// The model that the project must have; `None` allows any.
    pub model: Option<ModelId>,
    pub who: Who<'a>,
    /// Compare only, write nothing.
    pub dry_run: bool,
}

/// The result of an import.
#[derive(Clone, Debug)]
pub struct Taken {
    /// The differences between the control and the project.
    pub differences: Vec<ProjectDifference>,
    /// The changes that the rights of the control refuse. If there is one, nothing is
    /// written.
    pub denied: Vec<DeniedChange>,
    /// The memory before the import.
    pub old: ProjectState,
    /// The memory with all differences applied.
    pub new: ProjectState,
    /// The folder of the model in the data directory.
    pub folder: PathBuf,
    /// The project with the old memory; `None` if nothing was written.
    pub backup: Option<PathBuf>,
    /// Damaged files of the data directory.
    pub complaints: Vec<Message>,
}

impl Taken {
    /// Reports how many changes were written, or that none was.
    pub fn message(&self) -> Message {
        match &self.backup {
            Some(backup) => {
                let count = self.differences.len();
                let done = say::project_applied(self.folder.display(), count);
                say::several(vec![done, say::project_backup(backup.display())])
            }
            None if self.denied.is_empty() => say::project_same(),
            None => say::project_not_applied(self.denied.len()),
        }
    }
}

/// Imports those values of a project that `wanted` selects: all of them or none.
///
/// # Errors
/// The project or the data directory cannot be used, or the changes cannot be written.
pub fn take_over(
    taking: &Taking<'_>,
    wanted: &dyn Fn(&ProjectDifference) -> bool,
) -> Result<Taken, ProjectError> {
    let (state, encodings) = read(taking.project)?;
    let model = state.memory().model.id();
    if taking.model.is_some_and(|it| it != model) {
        return Err(ProjectError::OtherModel(taking.project.to_owned(), model));
    }
    let mut opened = open(&Target {
        directory: taking.directory,
        model: Some(model),
        who: taking.who,
        dry_run: taking.dry_run,
    })?;
    opened.encodings = encodings;
    let mut differences = diff(opened.state(), &state.without_texts());
    differences.retain(wanted);
    opened.take_over(differences, taking.dry_run)
}

/// A switched-off control as the target of an import.
#[derive(Clone, Copy, Debug)]
pub struct Target<'a> {
    pub directory: &'a Path,
    /// The model whose memory is written; `None` selects the model of the directory.
    pub model: Option<ModelId>,
    pub who: Who<'a>,
    /// Compare only, write nothing.
    pub dry_run: bool,
}

/// The opened memory of a switched-off control.
#[derive(Debug)]
pub struct OpenedMemory {
    data: DataDir,
    folder: PathBuf,
    held: Held,
    level: Level,
    encodings: Encodings,
}

/// Opens the memory of a control. Without `dry_run` the data directory stays locked for
/// other processes.
///
/// # Errors
/// The data directory cannot be used, or the password is wrong.
pub fn open(target: &Target<'_>) -> Result<OpenedMemory, ProjectError> {
    let model = target
        .model
        .unwrap_or_else(|| models::chosen(target.directory));
    let folder = models::folder(target.directory, model);
    let data = match target.dry_run {
        true => DataDir::read_only(&folder)?,
        false => DataDir::open(&folder)?,
    };
    let held = held(&data, delivered(model, None));
    let level = target.who.level(&held.memory.authority)?;
    Ok(OpenedMemory {
        data,
        folder,
        held,
        level,
        encodings: Encodings::new(),
    })
}

impl OpenedMemory {
    /// The memory of the control.
    pub const fn memory(&self) -> &Memory {
        &self.held.memory
    }

    /// The memory of the control in the form of a project.
    pub const fn state(&self) -> &ProjectState {
        &self.held.state
    }

    /// Applies differences to the memory, all or none. The old memory is kept as a project
    /// in `backups`.
    ///
    /// # Errors
    /// A value would be invalid, or the changes cannot be written.
    pub fn take_over(
        self,
        differences: Vec<ProjectDifference>,
        dry_run: bool,
    ) -> Result<Taken, ProjectError> {
        let held = self.held;
        let mut taken = Taken {
            denied: find_denied_changes(&differences, &held.memory.parameters, self.level),
            old: held.state.clone(),
            new: held.state.clone(),
            folder: self.folder,
            backup: None,
            complaints: held.complaints().to_vec(),
            differences,
        };
        if taken.differences.is_empty() || !taken.denied.is_empty() {
            return Ok(taken);
        }
        taken.new = apply(&held.state, &taken.differences).map_err(ProjectError::Faults)?;
        if !dry_run {
            taken.backup = Some(back_up(&taken.folder, &held)?);
            held.replace(self.data, &taken.new, &self.encodings)?;
        }
        Ok(taken)
    }
}
