//! Finds the cases in `cases/<subject>/<code>/<case>/`. The last name alone identifies a case.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Number of folders above the folder of a case: its subject and its code.
const FOLDERS_ABOVE: usize = 2;
/// The file that makes a folder a case.
const CASE_FILE: &str = "case.ron";

/// The folder of a test case, by name and by path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CaseFolder {
    /// Name of the case, which is that of its folder and unique.
    pub name: String,
    /// Path of the case as the runner shows it: `cycles/G71/roughing-turn-arc`.
    pub path: String,
    /// Path of the case's folder on disk.
    pub folder: PathBuf,
}

/// Returns the folder that contains all cases.
fn cases_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("cases")
}

/// Returns all test cases, sorted by path.
///
/// # Errors
/// Returns the faults in the tree of folders, a line each.
pub fn list_cases() -> Result<Vec<CaseFolder>, String> {
    list_cases_in(&cases_root())
}

/// Returns all test cases below a folder, sorted by path.
///
/// # Errors
/// Returns the faults, a line each: a folder without a case, a case at the wrong depth, a name
/// of two cases.
pub fn list_cases_in(root: &Path) -> Result<Vec<CaseFolder>, String> {
    let mut seen = CaseWalk::default();
    seen.walk(root, &mut Vec::new());
    seen.check_unique_names();
    if seen.faults.is_empty() {
        Ok(seen.cases)
    } else {
        Err(seen.faults.join("\n"))
    }
}

/// Returns the folder of the case with this name; `None` if there is none.
pub fn case_dir(name: &str) -> Option<PathBuf> {
    let codes = sorted_folders(&cases_root())
        .into_iter()
        .flat_map(|subject| sorted_folders(&subject));
    codes
        .map(|code| code.join(name))
        .find(|folder| folder.join(CASE_FILE).exists())
}

/// Returns the paths of the folders in a folder, sorted.
fn sorted_folders(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut folders: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| path.is_dir())
        .collect();
    folders.sort();
    folders
}

/// The cases and faults that a walk over the folders has found.
#[derive(Default)]
struct CaseWalk {
    cases: Vec<CaseFolder>,
    faults: Vec<String>,
}

impl CaseWalk {
    fn walk(&mut self, folder: &Path, above: &mut Vec<String>) {
        let below = sorted_folders(folder);
        let path = above.join("/");
        let is_case = folder.join(CASE_FILE).exists();
        if is_case && above.len() == FOLDERS_ABOVE + 1 {
            self.cases.push(CaseFolder {
                name: above.last().cloned().unwrap_or_default(),
                path: path.clone(),
                folder: folder.to_path_buf(),
            });
        } else if is_case {
            self.add_fault(
                &path,
                "a case lies in cases/<subject>/<code>/<case>/ and nowhere else",
            );
        } else if below.is_empty() {
            self.add_fault(&path, "the folder holds neither a case.ron nor folders");
        }
        for folder in below {
            let name = folder.file_name().unwrap_or_default();
            above.push(name.to_string_lossy().into_owned());
            self.walk(&folder, above);
            above.pop();
        }
    }

    fn check_unique_names(&mut self) {
        let mut paths: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for case in &self.cases {
            paths.entry(&case.name).or_default().push(&case.path);
        }
        let twice = paths.into_iter().filter(|(_, paths)| paths.len() > 1);
        let faults = twice.map(|(name, paths)| {
            format!("{name}: is the name of several cases: {}", paths.join(", "))
        });
        let faults: Vec<String> = faults.collect();
        self.faults.extend(faults);
    }

    fn add_fault(&mut self, path: &str, what: &str) {
        self.faults.push(format!("cases/{path}: {what}"));
    }
}
