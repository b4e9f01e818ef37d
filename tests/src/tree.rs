//! Finds the cases in `cases/<subject>/<code>/<case>/`. The last name alone identifies a case.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Number of folders above a case: its subject and its code.
const FOLDERS_ABOVE: usize = 2;
/// The file that makes a folder a case.
const CASE_FILE: &str = "case.ron";

/// A case folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CaseFolder {
    /// Its name, which is unique.
    pub name: String,
    /// Its path as the runner shows it: `cycles/G71/roughing-turn-arc`.
    pub path: String,
    /// The folder on disk.
    pub folder: PathBuf,
}

/// The folder of the cases.
fn cases_root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("cases")
}

/// All cases, sorted by path.
///
/// # Errors
/// The faults of the folders, a line each.
pub fn list_cases() -> Result<Vec<CaseFolder>, String> {
    list_cases_in(&cases_root())
}

/// All cases below a folder.
///
/// # Errors
/// A folder without a case, a case at the wrong depth, a name of two cases.
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

/// The folder of the case with a name.
pub fn case_dir(name: &str) -> Option<PathBuf> {
    let codes = sorted_folders(&cases_root())
        .into_iter()
        .flat_map(|subject| sorted_folders(&subject));
    codes
        .map(|code| code.join(name))
        .find(|folder| folder.join(CASE_FILE).exists())
}

/// The folders in a folder, sorted.
fn sorted_folders(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut folders: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| path.is_dir())
        .collect();
    folders.sort();
    folders
}

/// The result of a walk over the folders.
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
