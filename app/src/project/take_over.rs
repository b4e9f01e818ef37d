//! A project taken over by a control that is off (decision PROJECT-6).

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

/// Whose rights count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Who<'a> {
    /// The operation level that the control has after power-on.
    AtPowerOn,
    /// That of a password, for this once.
    Password(&'a str),
    /// That in force when the control was switched off.
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

/// What is to be taken over.
#[derive(Clone, Copy, Debug)]
pub struct Taking<'a> {
    /// The folder of the project.
    pub project: &'a Path,
    /// The data directory of the control.
    pub directory: &'a Path,
    /// The model that the project must be of; none: any.
    pub model: Option<ModelId>,
    /// Whose rights count.
    pub who: Who<'a>,
    /// Nothing is written.
    pub dry_run: bool,
}

/// What came of it.
#[derive(Clone, Debug)]
pub struct Taken {
    /// What differs.
    pub differences: Vec<ProjectDifference>,
    /// What the rights of the control refuse: then nothing was written.
    pub denied: Vec<DeniedChange>,
    /// What the control held.
    pub old: ProjectState,
    /// What it holds with all of the differences.
    pub new: ProjectState,
    /// Where it keeps that.
    pub folder: PathBuf,
    /// Where what was there before stands; none where nothing was written.
    pub backup: Option<PathBuf>,
    /// What was wrong with its files.
    pub complaints: Vec<Message>,
}

impl Taken {
    /// How much was taken over, or that nothing was.
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

/// Takes over the values of a project that are wanted, all of them or none.
///
/// # Errors
/// The project or the data directory cannot be used, what could not be written.
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

/// A control that is off and is to take something over.
#[derive(Clone, Copy, Debug)]
pub struct Target<'a> {
    /// Its data directory.
    pub directory: &'a Path,
    /// The model whose memory is written; none: the one of the directory.
    pub model: Option<ModelId>,
    /// Whose rights count.
    pub who: Who<'a>,
    /// Nothing is written.
    pub dry_run: bool,
}

/// Its memory, opened.
#[derive(Debug)]
pub struct OpenedMemory {
    data: DataDir,
    folder: PathBuf,
    held: Held,
    level: Level,
    encodings: Encodings,
}

/// Opens what a control holds; unless nothing is to be written, nobody else can meanwhile.
///
/// # Errors
/// The data directory cannot be used, a password that opens nothing.
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
    /// All that it keeps.
    pub const fn memory(&self) -> &Memory {
        &self.held.memory
    }

    /// The same as a project has it.
    pub const fn state(&self) -> &ProjectState {
        &self.held.state
    }

    /// Takes over values, all of them or none; what was there before is kept as a project.
    ///
    /// # Errors
    /// What the whole would break, what could not be written.
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
