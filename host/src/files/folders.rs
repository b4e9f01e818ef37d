//! Finds the part programs in folders.

use std::path::{Path, PathBuf};

use super::program_file::ProgramFileError;
use super::subprograms::{find_program_ending, read_number_in_head};
use crate::platform;

/// Extensions that other files use as well: a file with one of them counts as a program only
/// if it begins with an O word.
const COMMON_ENDINGS: [&str; 2] = ["", "txt"];

/// Replaces each folder in `paths` by the programs in it and below it, sorted by path; files
/// remain as given. Hidden files and links to folders are skipped. The second list has an
/// error for each folder that cannot be read or contains no program.
pub fn find_programs(paths: &[PathBuf]) -> (Vec<PathBuf>, Vec<ProgramFileError>) {
    let (mut programs, mut errors) = (Vec::new(), Vec::new());
    for path in paths {
        if !platform::path_facts(path).is_ok_and(|facts| facts.is_folder) {
            programs.push(path.clone());
            continue;
        }
        let before = (programs.len(), errors.len());
        collect_programs(path, &mut programs, &mut errors);
        if (programs.len(), errors.len()) == before {
            errors.push(ProgramFileError::NoPrograms { path: path.clone() });
        }
    }
    (programs, errors)
}

fn collect_programs(
    folder: &Path,
    programs: &mut Vec<PathBuf>,
    errors: &mut Vec<ProgramFileError>,
) {
    let mut paths = match platform::list(folder) {
        Ok(paths) => paths,
        Err(source) => {
            let path = folder.to_owned();
            return errors.push(ProgramFileError::System { path, source });
        }
    };
    paths.retain(|path| !is_hidden(path));
    paths.sort();
    for path in paths {
        match platform::path_facts(&path) {
            Ok(facts) if facts.is_folder && !platform::is_link(&path) => {
                collect_programs(&path, programs, errors);
            }
            Ok(facts) if facts.is_file && is_program(&path) => programs.push(path),
            _ => {}
        }
    }
}

fn is_hidden(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().starts_with('.')
}

fn is_program(path: &Path) -> bool {
    find_program_ending(path).is_some_and(|ending| {
        !COMMON_ENDINGS.contains(&ending) || read_number_in_head(path).is_some()
    })
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use gsk_tests::test_folder;

    #[test]
    fn programs_of_folders_are_sorted_and_other_files_are_skipped() {
        let folder = test_folder("folders");
        let below = folder.join("b");
        fs::create_dir_all(folder.join(".git")).expect("folder");
        fs::create_dir_all(folder.join("empty")).expect("folder");
        fs::create_dir_all(&below).expect("folder");
        for (name, text) in [
            ("c.CNC", "O1;\nM30;\n"),
            ("a.nc", "G00 X1;\n"),
            ("b/d.tap", "O2;\n"),
            ("b/notes.txt", "ask about the chuck\n"),
            ("b/O0003", "O0003;\nM30;\n"),
            ("b/job.ron", "()"),
            (".git/e.nc", "O4;\n"),
            (".f.nc", "O5;\n"),
        ] {
            fs::write(folder.join(name), text).expect("written");
        }
        let single = folder.join("b/job.ron");
        let paths = [single.clone(), folder.join("empty"), folder.to_path_buf()];
        let (found, wrong) = find_programs(&paths);
        let expected = ["a.nc", "b/O0003", "b/d.tap", "c.CNC"].map(|name| folder.join(name));
        assert_eq!(found[0], single);
        assert_eq!(found[1..], expected);
        let texts = wrong.iter().map(ToString::to_string).collect::<Vec<_>>();
        assert!(texts.len() == 1 && texts[0].contains("empty"), "{texts:?}");
    }
}
