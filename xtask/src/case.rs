//! Creates cases: folders `tests/cases/<subject>/<code>/<case>/`.

use std::fs;
use std::path::Path;

use crate::error::TaskError;

const PROGRAM_CASE: &str = "\
// What is tested, and where the manual says it (manual I-3.2.2).
(
    programs: [\"part.nc\"],
)
";
const PROGRAM: &str = "O0001\nG00 X50 Z5\nG98 G01 Z-10 F200\nM30\n";
const RESULT: &str = "{ \"end\": \"M30\" }\n";
const SCRIPT_CASE: &str = "\
// What is tested, and where the manual says it (manual III-3.1).
(
    script: \"operate.txt\",
)
";
const SCRIPT: &str = "press AUTO\nexpect lamp AUTO on\nexpect alarm none\n";

/// Creates a case that passes, for the author to fill in, and returns what to do next.
///
/// # Errors
/// `path` does not have the form of a case, the folder exists, or it cannot be written.
pub fn create(root: &Path, path: &str, script: bool) -> Result<String, TaskError> {
    let parts: Vec<&str> = path.split('/').collect();
    let [_, _, name] = parts[..] else {
        return Err(TaskError::CaseParts(path.to_owned()));
    };
    let is_valid = |part: &&str| {
        !part.is_empty()
            && part
                .chars()
                .all(|letter| letter.is_ascii_alphanumeric() || letter == '-')
    };
    if !parts.iter().all(is_valid) {
        return Err(TaskError::CaseCharacters(path.to_owned()));
    }
    let folder = root.join("tests/cases").join(path);
    if folder.exists() {
        return Err(TaskError::Exists(folder));
    }
    let files: &[(&str, &str)] = if script {
        &[("case.ron", SCRIPT_CASE), ("operate.txt", SCRIPT)]
    } else {
        &[
            ("case.ron", PROGRAM_CASE),
            ("part.nc", PROGRAM),
            ("result.json", RESULT),
        ]
    };
    let failed = |error| TaskError::Write {
        path: folder.clone(),
        error,
    };
    fs::create_dir_all(&folder).map_err(failed)?;
    for (file, text) in files {
        fs::write(folder.join(file), text).map_err(failed)?;
    }
    Ok(format!(
        "{}\nrun it: cargo test -p gsk980td-tests --test cases -- {name}\nwork its \
         expectations out from the manual; UPDATE_CASES=1 rewrites the values of fields that \
         they already name",
        folder.display()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_paths_are_refused() {
        for path in [
            "roughing",
            "cycles/G71",
            "a/b/c/d",
            "../G71/x",
            "a//b",
            "a/b/c d",
        ] {
            assert!(
                create(Path::new("/nowhere"), path, false).is_err(),
                "{path}"
            );
        }
    }
}
