//! Refuses results of a command that would overwrite what the command reads.

use std::path::{Component, Path, PathBuf};

use gsk_messages::{Message, say};

use crate::files::{models, subprograms};
use crate::output;
use crate::platform::same_file;

/// The files and folders that a command reads, which it must not overwrite.
#[derive(Clone, Debug, Default)]
pub struct CommandInputs<'a> {
    /// Files named on the command line or in a script.
    pub files: Vec<&'a Path>,
    /// The main program, whose folder is searched for subprograms; `None` without one.
    pub main_program: Option<&'a Path>,
    /// The data directory of the control; `None` if the command uses none.
    pub data_dir: Option<&'a Path>,
}

/// Returns those result paths that the command line contains.
pub fn collect_outputs<'a>(paths: &[&'a Option<PathBuf>]) -> Vec<&'a Path> {
    let requested = paths.iter().filter_map(|path| path.as_deref());
    requested.collect()
}

/// The reason why a result must not be written to a path.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum OverwriteError {
    /// Two results have the same path.
    DuplicateOutput(PathBuf),
    /// The command itself reads the file at this path.
    InputFile(PathBuf),
    /// The next run would read the file as a subprogram.
    Subprogram {
        /// Path of the result that is refused.
        path: PathBuf,
        /// Program number in the name or the text of the file.
        number: u16,
        /// Path of the main program.
        main: PathBuf,
    },
    /// The file belongs to the memory in a data directory.
    ControlMemory {
        /// Path of the result that is refused.
        path: PathBuf,
        data: PathBuf,
    },
}

impl OverwriteError {
    pub fn message(&self) -> Message {
        match self {
            Self::DuplicateOutput(path) => say::apart_twice(path.display()),
            Self::InputFile(path) => say::apart_read(path.display()),
            Self::Subprogram { path, number, main } => {
                say::apart_subprogram(path.display(), number, main.display())
            }
            Self::ControlMemory { path, data } => say::apart_memory(path.display(), data.display()),
        }
    }
}

/// Names of the folders in the data directory that hold the control's memory.
const MEMORY_FOLDERS: [&str; 5] = [
    "programs",
    "copies",
    "boards",
    models::MODELS_FOLDER,
    crate::log::FOLDER,
];
/// Names of the files in the data directory that hold the control's memory, besides `*.ron`.
const MEMORY_FILES: [&str; 4] = ["ladder.il", "link.log", "lock", models::MODEL_FILE];

/// Refuses results that would overwrite a file that the command reads, or another result.
///
/// # Errors
///
/// The first result that is refused, with the reason.
pub fn check_overwrites(
    inputs: &CommandInputs<'_>,
    outputs: &[&Path],
) -> Result<(), OverwriteError> {
    for (index, path) in outputs.iter().enumerate() {
        let earlier = &outputs[..index];
        if earlier
            .iter()
            .any(|other| other == path || same_file(other, path))
        {
            return Err(OverwriteError::DuplicateOutput(path.to_path_buf()));
        }
        if output::is_standard_output(Some(path)) {
            continue;
        }
        if inputs.files.iter().any(|source| same_file(source, path)) {
            return Err(OverwriteError::InputFile(path.to_path_buf()));
        }
        if let Some(main) = inputs.main_program
            && let Some(number) = find_subprogram_number(main, path)
        {
            return Err(OverwriteError::Subprogram {
                path: path.to_path_buf(),
                number,
                main: main.to_owned(),
            });
        }
        if let Some(data) = inputs.data_dir
            && is_memory_file(data, path)
        {
            return Err(OverwriteError::ControlMemory {
                path: path.to_path_buf(),
                data: data.to_owned(),
            });
        }
    }
    Ok(())
}

/// Returns the absolute path of an existing or new file, with symbolic links resolved.
fn resolve_path(path: &Path) -> PathBuf {
    let resolved = path.canonicalize().or_else(|error| {
        let name = path.file_name().ok_or(error)?;
        let folder = path.parent().filter(|folder| *folder != Path::new(""));
        folder
            .unwrap_or(Path::new("."))
            .canonicalize()
            .map(|folder| folder.join(name))
    });
    resolved.unwrap_or_else(|_| path.to_owned())
}

/// The program number under which a run of `main` would find the file at `path` as a
/// subprogram; `None` if it would not.
fn find_subprogram_number(main: &Path, path: &Path) -> Option<u16> {
    let (main_at, at) = (resolve_path(main), resolve_path(path));
    let by_name = (main_at.parent() == at.parent())
        .then(|| subprograms::parse_number_in_name(&at))
        .flatten();
    by_name.or_else(|| {
        // A file without a number in its name can be a subprogram, too, and so can a second
        // link to one.
        path.is_file()
            .then(|| subprograms::index_folder(main))?
            .into_iter()
            .find_map(|(number, found)| same_file(&found, path).then_some(number))
    })
}

/// Whether the file at `path` belongs to the memory in the data directory `data`.
fn is_memory_file(data: &Path, path: &Path) -> bool {
    let resolved = resolve_path(path);
    let Ok(relative) = resolved.strip_prefix(resolve_path(data)) else {
        return false;
    };
    let mut names = relative.components().map(|part| match part {
        Component::Normal(name) => name.to_string_lossy(),
        _ => "".into(),
    });
    match (names.next(), names.next()) {
        (Some(file), None) => file.ends_with(".ron") || MEMORY_FILES.contains(&file.as_ref()),
        (Some(folder), Some(_)) => MEMORY_FOLDERS.contains(&folder.as_ref()),
        (None, _) => false,
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn inputs_with_files<'a>(files: &[&'a Path]) -> CommandInputs<'a> {
        CommandInputs {
            files: files.to_vec(),
            ..CommandInputs::default()
        }
    }

    #[test]
    fn input_files_are_not_overwritten() {
        let folder = gsk_tests::test_folder("apart");
        let (source, link) = (folder.join("a.nc"), folder.join("b.nc"));
        fs::write(&source, "G00").expect("write");
        fs::hard_link(&source, &link).expect("link");
        let new = folder.join("c.nc");
        let inputs = inputs_with_files(&[&source]);
        assert!(check_overwrites(&inputs, &[&new]).is_ok());
        assert!(check_overwrites(&inputs, &[&link]).is_err());
        assert!(check_overwrites(&inputs, &[&new, &new]).is_err());
    }

    #[test]
    fn subprogram_files_are_not_overwritten() {
        let folder = gsk_tests::test_folder("apart-subprograms");
        let write_file = |name: &str, text: &str| {
            let path = folder.join(name);
            fs::create_dir_all(path.parent().expect("folder")).expect("folder");
            fs::write(&path, text).expect("write");
            path
        };
        let main = write_file("main.CNC", "M98 P3\nM30\n");
        let by_word = write_file("groove.txt", "O0003\nM99\n");
        let result = write_file("path.csv", "t,x,z\n");
        let elsewhere = write_file("out/9001.CNC", "");
        let link = folder.join("out/groove.txt");
        fs::hard_link(&by_word, &link).expect("link");
        let inputs = CommandInputs {
            main_program: Some(&main),
            ..CommandInputs::default()
        };
        let refusal_text = |path: &Path| {
            let error = check_overwrites(&inputs, &[path]).err();
            error.map(|error| error.to_string()).unwrap_or_default()
        };
        // The file does not exist yet: the next run would find it.
        let new = folder.join("out/../9001.CNC");
        assert!(refusal_text(&new).contains("subprogram O9001"));
        assert!(refusal_text(&by_word).contains("subprogram O0003"));
        assert!(refusal_text(&link).contains("subprogram O0003"));
        for free in [&result, &elsewhere, &folder.join("new.ndjson")] {
            assert_eq!(refusal_text(free), "");
        }
    }

    #[test]
    fn memory_files_are_not_overwritten() {
        let data = gsk_tests::test_folder("apart-data");
        fs::create_dir_all(data.join("programs")).expect("folder");
        let inputs = CommandInputs {
            data_dir: Some(&data),
            ..CommandInputs::default()
        };
        let is_free = |name: &str| check_overwrites(&inputs, &[&data.join(name)]).is_ok();
        for memory_file in [
            "offsets.ron",
            "ladder.il",
            "control",
            "programs/O0001.CNC",
            "models/ncb08/offsets.ron",
        ] {
            assert!(!is_free(memory_file), "{memory_file}");
        }
        assert!(is_free("path.ndjson") && is_free("../offsets.ron"));
    }
}
