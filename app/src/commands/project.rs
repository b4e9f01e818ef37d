//! `project`: writes, imports and compares the memory of a control as a folder.

use std::path::{Path, PathBuf};

use gsk_core::model::ModelId;
use gsk_host::files::data_dir::{self, DataDirError};
use gsk_host::project::{
    self, ImportRequest, ImportResult, ImportRights, ProjectError, ProjectWriteCounts,
};
use gsk_host::retained::project::DataDirContent;
use gsk_messages::{Language, Message, say};
use gsk_project::{
    DataSet, ProjectDifference, ProjectSection, ProjectState, ProjectValue, describe_difference,
    describe_text_changes, diff, export, find_whole_disk, label, refusal_message, unit,
};
use gsk_runner::report::message_text;
use serde_json::{Value as Json, json};

use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::{
    DiffFormat, ProjectDiffArgs, ProjectExportArgs, ProjectImportArgs, ProjectNewArgs,
    ProjectSubcommand,
};

pub fn project(
    command: &ProjectSubcommand,
    language: Option<Language>,
) -> Result<u8, CommandError> {
    match command {
        ProjectSubcommand::New(args) => new(args, language),
        ProjectSubcommand::Export(args) => export_control(args, language),
        ProjectSubcommand::Import(args) => import_project(args, language),
        ProjectSubcommand::Diff(args) => compare(args, language),
    }
}

fn print_message(message: &Message, language: Option<Language>) {
    output::print(&format!("{}\n", message_text(message, language)));
}

fn new(args: &ProjectNewArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let machine = args.machine.as_ref();
    let setup = project::factory_setup(args.model.unwrap_or_default(), machine);
    let state = ProjectState::from_setup(&setup).with_texts(read_machine(machine)?);
    if project::is_project(&args.folder) {
        return Err(ProjectError::NotEmpty(args.folder.clone()).into());
    }
    let files = export(&state, language.unwrap_or(Language::En));
    let written = project::write(&args.folder, &state, &files, &Default::default())?;
    report_written(written, &args.folder, language);
    Ok(EXIT_OK)
}

fn read_machine(
    path: Option<&PathBuf>,
) -> Result<Option<(gsk_project::ProjectKey, std::sync::Arc<str>)>, CommandError> {
    Ok(path
        .map(|path| project::read_machine_file(path))
        .transpose()?)
}

fn report_written(written: ProjectWriteCounts, folder: &Path, language: Option<Language>) {
    let folder = folder.display();
    print_message(
        &say::project_exported(folder, written.changed_files, written.removed_files),
        language,
    );
}

pub(super) fn data_directory(data: Option<&PathBuf>) -> Result<PathBuf, DataDirError> {
    match data {
        Some(path) => Ok(path.clone()),
        None => data_dir::default_data_path(),
    }
}

/// Prints the messages about damaged files of a data directory on standard error.
fn report_damages(held: &DataDirContent, language: Option<Language>) {
    for complaint in held.complaints() {
        complain!("gsk980td: {}", message_text(complaint, language));
    }
}

fn export_control(
    args: &ProjectExportArgs,
    language: Option<Language>,
) -> Result<u8, CommandError> {
    let held = project::read_control(&data_directory(args.data.as_ref())?, args.model)?;
    report_damages(&held, language);
    let mut files = export(&held.state, language.unwrap_or(Language::En));
    if let Some((key, text)) = read_machine(args.machine.as_ref())? {
        files.insert(key.name(), text.to_string());
    }
    let written = project::write(&args.folder, &held.state, &files, held.encodings())?;
    report_written(written, &args.folder, language);
    // Damaged files may be exported with factory contents.
    Ok(if held.complaints().is_empty() {
        EXIT_OK
    } else {
        EXIT_ALARM
    })
}

fn select_sections(
    differences: Vec<ProjectDifference>,
    only: &[ProjectSection],
) -> Vec<ProjectDifference> {
    let mut wanted = differences;
    wanted.retain(|it| only.is_empty() || only.contains(&it.section()));
    wanted
}

fn import_project(
    args: &ProjectImportArgs,
    language: Option<Language>,
) -> Result<u8, CommandError> {
    let directory = data_directory(args.data.as_ref())?;
    let only = &args.only;
    let request = ImportRequest {
        project_folder: &args.folder,
        data_dir: &directory,
        model: None,
        rights: match &args.password {
            Some(password) => ImportRights::Password(password),
            None => ImportRights::AtPowerOn,
        },
        dry_run: args.dry_run,
    };
    let is_selected = |it: &ProjectDifference| only.is_empty() || only.contains(&it.section());
    let result = project::import_project(&request, &is_selected)?;
    for complaint in &result.complaints {
        complain!("gsk980td: {}", message_text(complaint, language));
    }
    if !result.denied_changes.is_empty() {
        report_denied_changes(&result, language);
        return Ok(EXIT_ALARM);
    }
    print_differences(
        &result.differences,
        &result.old_state,
        &result.new_state,
        language,
    );
    let (count, shown) = (result.differences.len(), result.model_folder.display());
    match &result.backup_folder {
        Some(backup) => {
            print_message(&say::project_applied(shown, count), language);
            print_message(&say::project_backup(backup.display()), language);
        }
        None if count > 0 => print_message(&say::project_would_apply(shown, count), language),
        None => print_message(&say::project_apply_nothing(args.folder.display()), language),
    }
    Ok(EXIT_OK)
}

/// Prints the changes of an import that the control refuses, each with the reason, and their
/// number.
pub(super) fn report_denied_changes(taken: &ImportResult, language: Option<Language>) {
    for it in &taken.denied_changes {
        let name = label(it.key, &taken.old_state, language.unwrap_or(Language::En));
        let text = message_text(
            &say::subject_reason(name, refusal_message(it.refusal)),
            language,
        );
        complain!("gsk980td: {text}");
    }
    let count = message_text(
        &say::project_not_applied(taken.denied_changes.len()),
        language,
    );
    complain!("gsk980td: {count}");
}

/// Reads one of the two states that are compared, from a project or a data directory. Returns an
/// error if it cannot be read.
fn read_side(
    path: &Path,
    model: Option<ModelId>,
    language: Option<Language>,
) -> Result<ProjectState, CommandError> {
    if project::is_project(path) {
        return Ok(project::read(path)?.0);
    }
    let held = project::read_control(path, model).map_err(|error| match error {
        DataDirError::Missing { path } => ProjectError::NotAProject(path),
        other => other.into(),
    })?;
    report_damages(&held, language);
    Ok(held.state)
}

fn compare(args: &ProjectDiffArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let old = read_side(&args.old, args.model, language)?;
    let new = match &args.new {
        Some(path) => read_side(path, args.model, language)?,
        None => read_side(&data_directory(args.data.as_ref())?, args.model, language)?,
    };
    let differences = select_sections(diff(&old, &new), &args.only);
    match args.format {
        DiffFormat::Json => {
            let rows = differences.iter().map(|it| to_json(it, &old, &new));
            let text = serde_json::to_string_pretty(&rows.collect::<Vec<_>>())?;
            output::print(&format!("{text}\n"));
        }
        DiffFormat::Human if differences.is_empty() => {
            print_message(&say::project_same(), language);
        }
        DiffFormat::Human => {
            print_differences(&differences, &old, &new, language);
            print_message(&say::project_differs(differences.len()), language);
        }
    }
    Ok(if differences.is_empty() {
        EXIT_OK
    } else {
        EXIT_ALARM
    })
}

/// Selects the state that names the value of a difference: the new state, or the old one if
/// the value was removed.
fn named_state<'a>(
    difference: &ProjectDifference,
    old: &'a ProjectState,
    new: &'a ProjectState,
) -> &'a ProjectState {
    if difference.new.is_some() { new } else { old }
}

/// Prints differences, one line each. A disk that is added or removed as a whole is one
/// line.
pub(super) fn print_differences(
    differences: &[ProjectDifference],
    old: &ProjectState,
    new: &ProjectState,
    language: Option<Language>,
) {
    let spoken = language.unwrap_or(Language::En);
    let mut out = String::new();
    let mut listed_disks: Vec<DataSet> = Vec::new();
    for difference in differences {
        if let Some(set) = find_whole_disk(difference) {
            if !listed_disks.contains(&set) {
                listed_disks.push(set);
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
    output::print(&output::escape_for_terminal(&out));
}

fn to_json(difference: &ProjectDifference, old: &ProjectState, new: &ProjectState) -> Json {
    let state = named_state(difference, old, new);
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
        "old": difference.old.as_ref().map(value_to_json),
        "new": difference.new.as_ref().map(value_to_json),
        "details_en": en,
        "details_zh": zh,
    })
}

fn value_to_json(value: &ProjectValue) -> Json {
    match value {
        ProjectValue::Whole(value) => json!(value),
        ProjectValue::Real(value) if value.is_finite() => json!(value),
        ProjectValue::Switch(on) => json!(on),
        ProjectValue::Text(text) => json!(&**text),
        other => json!(other.to_string()),
    }
}
