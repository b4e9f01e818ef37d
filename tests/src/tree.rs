//! Finds the cases in `cases/<subject>/<code>/<case>/`. The last name alone identifies a case.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Number of folders above a case: its subject and its code.
const ABOVE: usize = 2;
/// The file that makes a folder a case.
const CASE: &str = "case.ron";

/// A case folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Its name, which is unique.
    pub name: String,
    /// Its path as the runner shows it: `cycles/G71/roughing-turn-arc`.
    pub path: String,
    /// The folder on disk.
    pub folder: PathBuf,
}

/// The folder of the cases.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("cases")
}

/// All cases, sorted by path.
///
/// # Errors
/// The faults of the folders, a line each.
pub fn cases() -> Result<Vec<Place>, String> {
    cases_in(&root())
}

/// All cases below a folder.
///
/// # Errors
/// A folder without a case, a case at the wrong depth, a name of two cases.
pub fn cases_in(root: &Path) -> Result<Vec<Place>, String> {
    let mut seen = Seen::default();
    seen.walk(root, &mut Vec::new());
    seen.two_of_a_name();
    if seen.faults.is_empty() {
        Ok(seen.cases)
    } else {
        Err(seen.faults.join("\n"))
    }
}

/// The folder of the case with a name.
pub fn case_dir(name: &str) -> Option<PathBuf> {
    let codes = folders(&root())
        .into_iter()
        .flat_map(|subject| folders(&subject));
    codes
        .map(|code| code.join(name))
        .find(|folder| folder.join(CASE).exists())
}

/// The folders in a folder, sorted.
fn folders(folder: &Path) -> Vec<PathBuf> {
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
struct Seen {
    cases: Vec<Place>,
    faults: Vec<String>,
}

impl Seen {
    fn walk(&mut self, folder: &Path, above: &mut Vec<String>) {
        let below = folders(folder);
        let path = above.join("/");
        let is_case = folder.join(CASE).exists();
        if is_case && above.len() == ABOVE + 1 {
            self.cases.push(Place {
                name: above.last().cloned().unwrap_or_default(),
                path: path.clone(),
                folder: folder.to_path_buf(),
            });
        } else if is_case {
            self.fault(
                &path,
                "a case lies in cases/<subject>/<code>/<case>/ and nowhere else",
            );
        } else if below.is_empty() {
            self.fault(&path, "the folder holds neither a case.ron nor folders");
        }
        for folder in below {
            let name = folder.file_name().unwrap_or_default();
            above.push(name.to_string_lossy().into_owned());
            self.walk(&folder, above);
            above.pop();
        }
    }

    fn two_of_a_name(&mut self) {
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

    fn fault(&mut self, path: &str, what: &str) {
        self.faults.push(format!("cases/{path}: {what}"));
    }
}
