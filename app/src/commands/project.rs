//! `project`: writes, imports and compares the memory of a control as a folder.

use std::path::{Path, PathBuf};

use gsk_core::model::ModelId;
use gsk_messages::{Language, Message, say};
use gsk_project::{
    DataSet, ProjectDifference, ProjectSection, ProjectState, ProjectValue, describe_difference,
    describe_text_changes, diff, export, find_whole_disk, label, refusal_message, unit,
};
use gsk_runner::report::said;
use serde_json::{Value as Json, json};

use super::{ALARM, CommandError, FINE, output};
use crate::cli::{
    DiffFormat, ProjectCommand, ProjectDiffArgs, ProjectExportArgs, ProjectImportArgs,
    ProjectNewArgs,
};
use crate::files::data_dir::{self, DataError};
use crate::project::{self, ProjectError, Taken, Taking, Who, Written};
use crate::retained::project::Held;

pub fn project(command: &ProjectCommand, language: Option<Language>) -> Result<u8, CommandError> {
    match command {
        ProjectCommand::New(args) => new(args, language),
        ProjectCommand::Export(args) => write_control(args, language),
        ProjectCommand::Import(args) => take_over(args, language),
        ProjectCommand::Diff(args) => compare(args, language),
    }
}

fn say(message: &Message, language: Option<Language>) {
    output::print(&format!("{}\n", said(message, language)));
}

fn new(args: &ProjectNewArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let machine = args.machine.as_ref();
    let setup = project::delivered(args.model.unwrap_or_default(), machine);
    let state = ProjectState::from_setup(&setup).with_texts(machine_of(machine)?);
    if project::is_project(&args.folder) {
        return Err(ProjectError::Other(args.folder.clone()).into());
    }
    let files = export(&state, language.unwrap_or(Language::En));
    let written = project::write(&args.folder, &state, &files, &Default::default())?;
    tell_written(written, &args.folder, language);
    Ok(FINE)
}

fn machine_of(
    path: Option<&PathBuf>,
) -> Result<Option<(gsk_project::ProjectKey, std::sync::Arc<str>)>, CommandError> {
    Ok(path.map(|path| project::machine_text(path)).transpose()?)
}

fn tell_written(written: Written, folder: &Path, language: Option<Language>) {
    let folder = folder.display();
    say(
        &say::project_exported(folder, written.files, written.removed),
        language,
    );
}

pub(super) fn directory(data: Option<&PathBuf>) -> Result<PathBuf, DataError> {
    match data {
        Some(path) => Ok(path.clone()),
        None => data_dir::default_path(),
    }
}

/// Reports damaged files of a data directory.
fn complain_of(held: &Held, language: Option<Language>) {
    for complaint in held.complaints() {
        complain!("gsk980td: {}", said(complaint, language));
    }
}

fn write_control(args: &ProjectExportArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let held = project::of_data(&directory(args.data.as_ref())?, args.model)?;
    complain_of(&held, language);
    let mut files = export(&held.state, language.unwrap_or(Language::En));
    if let Some((key, text)) = machine_of(args.machine.as_ref())? {
        files.insert(key.name(), text.to_string());
    }
    let written = project::write(&args.folder, &held.state, &files, held.encodings())?;
    tell_written(written, &args.folder, language);
    // Damaged files may be exported with factory contents.
    Ok(if held.complaints().is_empty() {
        FINE
    } else {
        ALARM
    })
}

fn wanted(differences: Vec<ProjectDifference>, only: &[ProjectSection]) -> Vec<ProjectDifference> {
    let mut wanted = differences;
    wanted.retain(|it| only.is_empty() || only.contains(&it.section()));
    wanted
}

fn take_over(args: &ProjectImportArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let directory = directory(args.data.as_ref())?;
    let only = &args.only;
    let taking = Taking {
        project: &args.folder,
        directory: &directory,
        model: None,
        who: match &args.password {
            Some(password) => Who::Password(password),
            None => Who::AtPowerOn,
        },
        dry_run: args.dry_run,
    };
    let wanted = |it: &ProjectDifference| only.is_empty() || only.contains(&it.section());
    let taken = project::take_over(&taking, &wanted)?;
    for complaint in &taken.complaints {
        complain!("gsk980td: {}", said(complaint, language));
    }
    if !taken.denied.is_empty() {
        tell_denied(&taken, language);
        return Ok(ALARM);
    }
    list(&taken.differences, &taken.old, &taken.new, language);
    let (count, shown) = (taken.differences.len(), taken.folder.display());
    match &taken.backup {
        Some(backup) => {
            say(&say::project_applied(shown, count), language);
            say(&say::project_backup(backup.display()), language);
        }
        None if count > 0 => say(&say::project_would_apply(shown, count), language),
        None => say(&say::project_apply_nothing(args.folder.display()), language),
    }
    Ok(FINE)
}

/// Reports the changes that the rights of the control refuse.
pub(super) fn tell_denied(taken: &Taken, language: Option<Language>) {
    for it in &taken.denied {
        let name = label(it.key, &taken.old, language.unwrap_or(Language::En));
        let said = said(
            &say::subject_reason(name, refusal_message(it.refusal)),
            language,
        );
        complain!("gsk980td: {said}");
    }
    let count = said(&say::project_not_applied(taken.denied.len()), language);
    complain!("gsk980td: {count}");
}

/// Reads one side of a comparison: a project or a data directory.
fn side(
    path: &Path,
    model: Option<ModelId>,
    language: Option<Language>,
) -> Result<ProjectState, CommandError> {
    if project::is_project(path) {
        return Ok(project::read(path)?.0);
    }
    let held = project::of_data(path, model).map_err(|error| match error {
        DataError::Missing { path } => ProjectError::NoProject(path),
        other => other.into(),
    })?;
    complain_of(&held, language);
    Ok(held.state)
}

fn compare(args: &ProjectDiffArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let old = side(&args.old, args.model, language)?;
    let new = match &args.new {
        Some(path) => side(path, args.model, language)?,
        None => side(&directory(args.data.as_ref())?, args.model, language)?,
    };
    let differences = wanted(diff(&old, &new), &args.only);
    match args.format {
        DiffFormat::Json => {
            let rows = differences.iter().map(|it| as_json(it, &old, &new));
            let text = serde_json::to_string_pretty(&rows.collect::<Vec<_>>())?;
            output::print(&format!("{text}\n"));
        }
        DiffFormat::Human if differences.is_empty() => say(&say::project_same(), language),
        DiffFormat::Human => {
            list(&differences, &old, &new, language);
            say(&say::project_differs(differences.len()), language);
        }
    }
    Ok(if differences.is_empty() { FINE } else { ALARM })
}

/// The state that has the name of a value: the new one, or the old one if the value was
/// removed.
fn known<'a>(
    difference: &ProjectDifference,
    old: &'a ProjectState,
    new: &'a ProjectState,
) -> &'a ProjectState {
    if difference.new.is_some() { new } else { old }
}

/// Prints differences, one line each. A disk that is added or removed as a whole is one
/// line.
pub(super) fn list(
    differences: &[ProjectDifference],
    old: &ProjectState,
    new: &ProjectState,
    language: Option<Language>,
) {
    let spoken = language.unwrap_or(Language::En);
    let mut out = String::new();
    let mut whole: Vec<DataSet> = Vec::new();
    for difference in differences {
        if let Some(set) = find_whole_disk(difference) {
            if !whole.contains(&set) {
                whole.push(set);
                let name = set.disk_name().unwrap_or_default();
                let text = match difference.old {
                    None => say::project_disk_added(name),
                    Some(_) => say::project_disk_removed(name),
                };
                out.push_str(&format!("{}\n", text.text(spoken)));
            }
            continue;
        }
        let text = describe_difference(difference, old, new, spoken);
        out.push_str(&format!("{text}\n"));
    }
    // Programs may contain control characters.
    output::print(&output::shown(&out));
}

fn as_json(difference: &ProjectDifference, old: &ProjectState, new: &ProjectState) -> Json {
    let state = known(difference, old, new);
    let key = difference.key;
    let details = describe_text_changes(difference);
    let [en, zh] = [Language::En, Language::Zh].map(|language| {
        details
            .iter()
            .map(|it| it.text(language))
            .collect::<Vec<_>>()
    });
    json!({
        "part": difference.section().word(),
        "file": key.path(),
        "name": key.name(),
        "label_en": label(key, state, Language::En),
        "label_zh": label(key, state, Language::Zh),
        "unit": unit(key, state.memory().model.id()),
        "old": difference.old.as_ref().map(value_of),
        "new": difference.new.as_ref().map(value_of),
        "details_en": en,
        "details_zh": zh,
    })
}

fn value_of(value: &ProjectValue) -> Json {
    match value {
        ProjectValue::Whole(value) => json!(value),
        ProjectValue::Real(value) if value.is_finite() => json!(value),
        ProjectValue::Switch(on) => json!(on),
        ProjectValue::Text(text) => json!(&**text),
        other => json!(other.to_string()),
    }
}
