//! Refuses results of a command that would overwrite what the command reads.

use std::path::{Component, Path, PathBuf};

use gsk_messages::{Message, say};

use crate::files::{models, subprograms};
use crate::output;
use crate::platform::same_file;

/// Files and folders that a command reads.
#[derive(Clone, Debug, Default)]
pub struct Read<'a> {
    /// Files named on the command line or in a script.
    pub files: Vec<&'a Path>,
    /// The main program: its folder is searched for subprograms.
    pub main: Option<&'a Path>,
    /// The data directory of the control.
    pub data: Option<&'a Path>,
}

/// The paths of those results that the command line requests.
pub fn results<'a>(paths: &[&'a Option<PathBuf>]) -> Vec<&'a Path> {
    let asked = paths.iter().filter_map(|path| path.as_deref());
    asked.collect()
}

/// Why a result must not be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.message())]
pub enum ApartError {
    /// Two results have the same path.
    Twice(PathBuf),
    /// The command reads this file.
    Read(PathBuf),
    /// The next run would read the file as a subprogram.
    Subprogram {
        /// Path of the result.
        path: PathBuf,
        /// Program number that the name or the file gives.
        number: u16,
        /// The main program.
        main: PathBuf,
    },
    /// The file belongs to the memory in a data directory.
    Memory {
        /// Path of the result.
        path: PathBuf,
        data: PathBuf,
    },
}

impl ApartError {
    pub fn message(&self) -> Message {
        match self {
            Self::Twice(path) => say::apart_twice(path.display()),
            Self::Read(path) => say::apart_read(path.display()),
            Self::Subprogram { path, number, main } => {
                say::apart_subprogram(path.display(), number, main.display())
            }
            Self::Memory { path, data } => say::apart_memory(path.display(), data.display()),
        }
    }
}

/// Folders of the data directory that hold the control's memory.
const MEMORY_FOLDERS: [&str; 5] = [
    "programs",
    "copies",
    "boards",
    models::FOLDER,
    crate::log::FOLDER,
];
/// Files of the data directory that hold the control's memory, besides `*.ron`.
const MEMORY_FILES: [&str; 4] = ["ladder.il", "link.log", "lock", models::CHOICE];

/// Refuses results that would overwrite what the command reads, or each other.
///
/// # Errors
/// The first result that is refused, with the reason.
pub fn keep_apart(read: &Read<'_>, written: &[&Path]) -> Result<(), ApartError> {
    for (index, path) in written.iter().enumerate() {
        let before = &written[..index];
        if before
            .iter()
            .any(|other| other == path || same_file(other, path))
        {
            return Err(ApartError::Twice(path.to_path_buf()));
        }
        if output::is_standard(Some(path)) {
            continue;
        }
        if read.files.iter().any(|source| same_file(source, path)) {
            return Err(ApartError::Read(path.to_path_buf()));
        }
        if let Some(main) = read.main
            && let Some(number) = subprogram(main, path)
        {
            return Err(ApartError::Subprogram {
                path: path.to_path_buf(),
                number,
                main: main.to_owned(),
            });
        }
        if let Some(data) = read.data
            && is_memory(data, path)
        {
            return Err(ApartError::Memory {
                path: path.to_path_buf(),
                data: data.to_owned(),
            });
        }
    }
    Ok(())
}

/// The absolute path of an existing or new file, symbolic links resolved.
fn place(path: &Path) -> PathBuf {
    let found = path.canonicalize().or_else(|error| {
        let name = path.file_name().ok_or(error)?;
        let folder = path.parent().filter(|folder| *folder != Path::new(""));
        folder
            .unwrap_or(Path::new("."))
            .canonicalize()
            .map(|folder| folder.join(name))
    });
    found.unwrap_or_else(|_| path.to_owned())
}

/// The program number under which a run of `main` would find the file as a subprogram;
/// `None` if it would not.
fn subprogram(main: &Path, path: &Path) -> Option<u16> {
    let (main_at, at) = (place(main), place(path));
    let by_name = (main_at.parent() == at.parent())
        .then(|| subprograms::number_in_name(&at))
        .flatten();
    by_name.or_else(|| {
        // A file without a number in its name can be a subprogram, too, and so can a second
        // link to one.
        path.is_file()
            .then(|| subprograms::beside(main))?
            .into_iter()
            .find_map(|(number, found)| same_file(&found, path).then_some(number))
    })
}

/// Whether a file belongs to the memory in a data directory.
fn is_memory(data: &Path, path: &Path) -> bool {
    let at = place(path);
    let Ok(inside) = at.strip_prefix(place(data)) else {
        return false;
    };
    let mut names = inside.components().map(|part| match part {
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

    fn read<'a>(files: &[&'a Path]) -> Read<'a> {
        Read {
            files: files.to_vec(),
            ..Read::default()
        }
    }

    #[test]
    fn what_is_read_is_not_written() {
        let folder = crate::files::test_folder("apart");
        let (source, link) = (folder.join("a.nc"), folder.join("b.nc"));
        fs::write(&source, "G00").expect("write");
        fs::hard_link(&source, &link).expect("link");
        let new = folder.join("c.nc");
        let read = read(&[&source]);
        assert!(keep_apart(&read, &[&new]).is_ok());
        assert!(keep_apart(&read, &[&link]).is_err());
        assert!(keep_apart(&read, &[&new, &new]).is_err());
    }

    #[test]
    fn subprograms_beside_a_program_are_not_written() {
        let folder = crate::files::test_folder("apart-subprograms");
        let put = |name: &str, text: &str| {
            let path = folder.join(name);
            fs::create_dir_all(path.parent().expect("folder")).expect("folder");
            fs::write(&path, text).expect("write");
            path
        };
        let main = put("main.CNC", "M98 P3\nM30\n");
        let by_word = put("groove.txt", "O0003\nM99\n");
        let result = put("path.csv", "t,x,z\n");
        let elsewhere = put("out/9001.CNC", "");
        let link = folder.join("out/groove.txt");
        fs::hard_link(&by_word, &link).expect("link");
        let read = Read {
            main: Some(&main),
            ..Read::default()
        };
        let refused = |path: &Path| {
            let error = keep_apart(&read, &[path]).err();
            error.map(|error| error.to_string()).unwrap_or_default()
        };
        // The file does not exist yet: the next run would find it.
        let new = folder.join("out/../9001.CNC");
        assert!(refused(&new).contains("the subprogram O9001"));
        assert!(refused(&by_word).contains("the subprogram O0003"));
        assert!(refused(&link).contains("the subprogram O0003"));
        for free in [&result, &elsewhere, &folder.join("new.ndjson")] {
            assert_eq!(refused(free), "");
        }
    }

    #[test]
    fn the_memory_is_not_written() {
        let data = crate::files::test_folder("apart-data");
        fs::create_dir_all(data.join("programs")).expect("folder");
        let read = Read {
            data: Some(&data),
            ..Read::default()
        };
        let is_free = |name: &str| keep_apart(&read, &[&data.join(name)]).is_ok();
        for own in [
            "offsets.ron",
            "ladder.il",
            "control",
            "programs/O0001.CNC",
            "models/ncb08/offsets.ron",
        ] {
            assert!(!is_free(own), "{own}");
        }
        assert!(is_free("path.ndjson") && is_free("../offsets.ron"));
    }
}
