//! Imports a project into a control that is switched off (decision PROJECT-6).

use std::path::{Path, PathBuf};

use gsk_core::battery::BatteryMemory;
use gsk_core::memory::{Authority, OperationLevel};
use gsk_core::model::ModelId;
use gsk_messages::{Message, say};
use gsk_project::{
    DeniedChange, ProjectDifference, ProjectState, apply, diff, find_denied_changes,
};

use super::{Encodings, ProjectError, back_up, factory_setup, read};
use crate::files::data_dir::DataDir;
use crate::files::models;
use crate::retained::project::{DataDirContent, read_content};

/// The operation level whose rights limit what an import may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImportRights<'a> {
    /// The level that the control has after power-on.
    AtPowerOn,
    /// The level to which this password belongs, for one import.
    Password(&'a str),
    /// The level that was active when the control was switched off.
    LoggedOn,
}

impl ImportRights<'_> {
    fn resolve_level(self, authority: &Authority) -> Result<OperationLevel, ProjectError> {
        match self {
            Self::AtPowerOn => {
                let mut authority = authority.clone();
                authority.power_on();
                Ok(authority.level())
            }
            Self::LoggedOn => Ok(authority.level()),
            Self::Password(password) => authority
                .level_for(password)
                .ok_or(ProjectError::WrongPassword),
        }
    }
}

/// A request to import a project into a control.
#[derive(Clone, Copy, Debug)]
pub struct ImportRequest<'a> {
    /// The folder of the project to import.
    pub project_folder: &'a Path,
    pub data_dir: &'a Path,
    /// The model that the project must have; `None` allows any.
    pub model: Option<ModelId>,
    pub rights: ImportRights<'a>,
    /// Whether the import only compares and writes nothing.
    pub dry_run: bool,
}

/// The changes that an import has made or would make.
#[derive(Clone, Debug)]
pub struct ImportResult {
    /// The differences between the control and the project.
    pub differences: Vec<ProjectDifference>,
    /// The changes that the rights of the control refuse. If there is one, the import writes
    /// nothing.
    pub denied_changes: Vec<DeniedChange>,
    /// The state of the control before the import.
    pub old_state: ProjectState,
    /// The state of the control with all differences applied.
    pub new_state: ProjectState,
    /// The folder in the data directory that holds the memory of the model.
    pub model_folder: PathBuf,
    /// The folder of the project with the old memory; `None` if nothing was written.
    pub backup_folder: Option<PathBuf>,
    /// Messages for damaged files of the data directory.
    pub complaints: Vec<Message>,
}

impl ImportResult {
    /// Returns the message for the operator with the number of changes that were written.
    pub fn message(&self) -> Message {
        match &self.backup_folder {
            Some(backup) => {
                let count = self.differences.len();
                let done = say::project_applied(self.model_folder.display(), count);
                say::several(vec![done, say::project_backup(backup.display())])
            }
            None if self.denied_changes.is_empty() => say::project_same(),
            None => say::project_not_applied(self.denied_changes.len()),
        }
    }
}

/// Imports those values of a project that `is_selected` selects: all of them or none.
///
/// # Errors
/// The project or the data directory cannot be used, or the changes cannot be written.
pub fn import_project(
    request: &ImportRequest<'_>,
    is_selected: &dyn Fn(&ProjectDifference) -> bool,
) -> Result<ImportResult, ProjectError> {
    let (state, encodings) = read(request.project_folder)?;
    let model = state.memory().model.id();
    if request.model.is_some_and(|it| it != model) {
        return Err(ProjectError::OtherModel(
            request.project_folder.to_owned(),
            model,
        ));
    }
    let mut opened = open_control_memory(&ImportTarget {
        data_dir: request.data_dir,
        model: Some(model),
        rights: request.rights,
        dry_run: request.dry_run,
    })?;
    opened.encodings = encodings;
    let mut differences = diff(opened.state(), &state.without_texts());
    differences.retain(is_selected);
    opened.apply_differences(differences, request.dry_run)
}

/// The switched-off control that an import writes to.
#[derive(Clone, Copy, Debug)]
pub struct ImportTarget<'a> {
    pub data_dir: &'a Path,
    /// The model whose memory is written; `None` selects the model of the directory.
    pub model: Option<ModelId>,
    pub rights: ImportRights<'a>,
    /// Whether the import only compares and writes nothing.
    pub dry_run: bool,
}

/// The memory of a switched-off control, opened for an import.
#[derive(Debug)]
pub struct OpenedMemory {
    data: DataDir,
    folder: PathBuf,
    stored: DataDirContent,
    level: OperationLevel,
    encodings: Encodings,
}

/// Opens the memory of a control. Without `dry_run` the data directory stays locked for
/// other processes.
///
/// # Errors
/// The data directory cannot be used, or the password is wrong.
pub fn open_control_memory(target: &ImportTarget<'_>) -> Result<OpenedMemory, ProjectError> {
    let model = target
        .model
        .unwrap_or_else(|| models::read_selected_model(target.data_dir));
    let folder = models::memory_folder(target.data_dir, model);
    let data = match target.dry_run {
        true => DataDir::open_read_only(&folder)?,
        false => DataDir::open(&folder)?,
    };
    let held = read_content(&data, factory_setup(model, None));
    let level = target.rights.resolve_level(&held.memory.authority)?;
    Ok(OpenedMemory {
        data,
        folder,
        stored: held,
        level,
        encodings: Encodings::new(),
    })
}

impl OpenedMemory {
    /// Returns the battery-backed memory of the control.
    pub const fn memory(&self) -> &BatteryMemory {
        &self.stored.memory
    }

    /// The content of the control in the form of a project.
    pub const fn state(&self) -> &ProjectState {
        &self.stored.state
    }

    /// Applies differences to the memory, all or none. The old memory is kept as a project
    /// in `backups`.
    ///
    /// # Errors
    /// A value would be invalid, or the changes cannot be written.
    pub fn apply_differences(
        self,
        differences: Vec<ProjectDifference>,
        dry_run: bool,
    ) -> Result<ImportResult, ProjectError> {
        let held = self.stored;
        let mut taken = ImportResult {
            denied_changes: find_denied_changes(&differences, &held.memory.parameters, self.level),
            old_state: held.state.clone(),
            new_state: held.state.clone(),
            model_folder: self.folder,
            backup_folder: None,
            complaints: held.complaints().to_vec(),
            differences,
        };
        if taken.differences.is_empty() || !taken.denied_changes.is_empty() {
            return Ok(taken);
        }
        taken.new_state =
            apply(&held.state, &taken.differences).map_err(ProjectError::InvalidValues)?;
        if !dry_run {
            taken.backup_folder = Some(back_up(&taken.model_folder, &held)?);
            held.replace(self.data, &taken.new_state, &self.encodings)?;
        }
        Ok(taken)
    }
}
