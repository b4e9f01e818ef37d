//! The data directory: the control's battery-backed memory on the disk.
//!
//! ```text
//! lock                one process at a time
//! programs/O0001.CNC  one program a file, as plain text
//! ladder.il           the ladder in place of the standard one, once one was saved
//! NAME.ron            parameters, offsets, counters, PLC memory, …
//! ```
//!
//! Every write is atomic. A damaged file is kept under another name, and the
//! defaults are loaded for that file alone.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use gsk_core::plc::Ladder;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::decode::{self, Encoding};
use super::{atomic, program_file};

/// An open data directory; it is locked as long as this value lives.
#[derive(Debug)]
pub struct DataDir {
    path: PathBuf,
    _lock: File,
    /// Programs whose writing was broken off: the power failed.
    interrupted: Vec<String>,
}

/// Why a data directory cannot be used, as a sentence.
#[derive(Debug, thiserror::Error)]
pub enum DataError {
    /// It cannot be made, read or written.
    #[error("the data directory {} cannot be used: {source}; choose another with --data DIR", .path.display())]
    Unusable {
        /// The directory.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Another process has it.
    #[error(
        "another gsk980td is using the data directory {}: close it, or choose another one with --data DIR",
        .path.display()
    )]
    InUse {
        /// The directory.
        path: PathBuf,
    },
    /// Nothing is to be made there.
    #[error("{} is no data directory: the panel makes one, with --data DIR", .path.display())]
    Missing {
        /// The directory.
        path: PathBuf,
    },
    /// The platform names no folder for data.
    #[error("this system names no folder for program data: choose one with --data DIR")]
    NoDefault,
}

/// What a file of the directory held.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Loaded<T> {
    /// A value.
    Value(T),
    /// There is no such file yet.
    Missing,
    /// It was damaged; the sentence says why and where it is kept now.
    Damaged(String),
}

/// A program of the directory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredProgram {
    /// Its number.
    pub number: u16,
    /// Its text.
    pub text: String,
    /// How it is written down.
    pub encoding: Encoding,
}

/// The platform's own place for the data.
pub fn default_path() -> Result<PathBuf, DataError> {
    directories::ProjectDirs::from("", "", "gsk980td")
        .map(|folders| folders.data_dir().to_owned())
        .ok_or(DataError::NoDefault)
}

impl DataDir {
    /// Opens a directory that is one already: who only reads makes none, and takes
    /// nobody's slip of the pen for a control as it was delivered.
    pub fn existing(path: &Path) -> Result<Self, DataError> {
        if !path.join("lock").is_file() {
            return Err(DataError::Missing {
                path: path.to_owned(),
            });
        }
        Self::open(path)
    }

    /// Opens a directory, making it if it is not there, and locks it.
    pub fn open(path: &Path) -> Result<Self, DataError> {
        let unusable = |source| DataError::Unusable {
            path: path.to_owned(),
            source,
        };
        fs::create_dir_all(path.join("programs")).map_err(unusable)?;
        let lock = OpenOptions::new()
            .create(true)
            .truncate(false)
            .write(true)
            .open(path.join("lock"))
            .map_err(unusable)?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(DataError::InUse {
                    path: path.to_owned(),
                });
            }
            Err(TryLockError::Error(source)) => return Err(unusable(source)),
        }
        // A directory that takes no file would fail at the first edit: say it now.
        let probe = path.join("programs").join("write-test");
        atomic::write(&probe, b"").map_err(unusable)?;
        fs::remove_file(&probe).map_err(unusable)?;
        Ok(Self {
            path: path.to_owned(),
            _lock: lock,
            interrupted: remove_unfinished(&path.join("programs")),
        })
    }

    /// Programs whose writing was broken off when the power failed; their last
    /// stored texts are there.
    pub fn interrupted(&self) -> &[String] {
        &self.interrupted
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads `NAME.ron`.
    pub fn load<T: DeserializeOwned>(&self, name: &str) -> Loaded<T> {
        let path = self.file(name);
        let text = match fs::read(&path) {
            Ok(bytes) => String::from_utf8(bytes).map_err(|error| error.to_string()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Loaded::Missing,
            Err(error) => Err(error.to_string()),
        };
        let value = text.and_then(|text| {
            ron::from_str(&text)
                .map_err(|error| format!("line {}: {}", error.span.start.line, error.code))
        });
        match value {
            Ok(value) => Loaded::Value(value),
            Err(reason) => Loaded::Damaged(keep_aside(&path, &reason)),
        }
    }

    /// Writes `NAME.ron`.
    pub fn store<T: Serialize>(&self, name: &str, value: &T) -> Result<(), String> {
        let text = ron::ser::to_string_pretty(value, ron::ser::PrettyConfig::new().depth_limit(3))
            .map_err(|error| error.to_string())?;
        self.write(&self.file(name), text.as_bytes())
    }

    /// Reads the ladder that was saved in place of the standard one.
    pub fn ladder(&self) -> Loaded<Ladder> {
        let path = self.ladder_file();
        let text = match fs::read(&path) {
            Ok(bytes) => String::from_utf8(bytes).map_err(|error| error.to_string()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Loaded::Missing,
            Err(error) => Err(error.to_string()),
        };
        let compiled = text.and_then(|text| {
            Ladder::compile(&text).map_err(|errors| {
                let first = errors.errors.first().map(ToString::to_string);
                first.unwrap_or_default()
            })
        });
        match compiled {
            Ok(ladder) => Loaded::Value(ladder),
            Err(reason) => Loaded::Damaged(keep_aside(&path, &reason)),
        }
    }

    /// Writes the ladder that runs in place of the standard one.
    pub fn store_ladder(&self, ladder: &Ladder) -> Result<(), String> {
        self.write(&self.ladder_file(), ladder.source().as_bytes())
    }

    fn ladder_file(&self) -> PathBuf {
        self.path.join("ladder.il")
    }

    /// Reads every program; the sentences name those that were damaged.
    pub fn programs(&self) -> (Vec<StoredProgram>, Vec<String>) {
        let mut programs = Vec::new();
        let mut complaints = Vec::new();
        let Ok(entries) = fs::read_dir(self.path.join("programs")) else {
            return (
                programs,
                vec!["the folder of programs cannot be read".to_owned()],
            );
        };
        for entry in entries.flatten() {
            let path = entry.path();
            let Some(number) = program_number(&path) else {
                continue;
            };
            match program_file::read(&path) {
                Ok(file) => programs.push(StoredProgram {
                    number,
                    text: file.text,
                    encoding: file.encoding,
                }),
                Err(error) => complaints.push(keep_aside(&path, &error.to_string())),
            }
        }
        programs.sort_by_key(|program| program.number);
        complaints.sort();
        (programs, complaints)
    }

    /// Writes a program.
    pub fn store_program(&self, program: &StoredProgram) -> Result<(), String> {
        let bytes = decode::encode(&program.text, program.encoding);
        self.write(&self.program_file(program.number), &bytes)
    }

    /// Deletes a program.
    pub fn remove_program(&self, number: u16) -> Result<(), String> {
        let path = self.program_file(number);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                Err(format!("{} cannot be deleted: {error}", path.display()))
            }
            _ => Ok(()),
        }
    }

    fn write(&self, path: &Path, bytes: &[u8]) -> Result<(), String> {
        atomic::write(path, bytes)
            .map_err(|error| format!("{} cannot be written: {error}", path.display()))
    }

    fn file(&self, name: &str) -> PathBuf {
        self.path.join(format!("{name}.ron"))
    }

    fn program_file(&self, number: u16) -> PathBuf {
        self.path.join("programs").join(format!("O{number:04}.CNC"))
    }
}

/// Removes files that were being written aside when the process was killed, and
/// names the programs among them.
fn remove_unfinished(folder: &Path) -> Vec<String> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.extension().is_none_or(|ending| ending != "new") {
            continue;
        }
        // What cannot be removed is overwritten by the next writing.
        let _ = fs::remove_file(&path);
        if let Some(number) = program_number(&path.with_extension("")) {
            names.push(format!("O{number:04}"));
        }
    }
    names.sort();
    names
}

/// The number in a name like `O0001.CNC`.
fn program_number(path: &Path) -> Option<u16> {
    let name = path.file_name()?.to_str()?;
    let digits = name.strip_prefix('O')?.strip_suffix(".CNC")?;
    let plain = digits.len() == 4 && digits.bytes().all(|byte| byte.is_ascii_digit());
    plain.then(|| digits.parse().ok())?
}

fn keep_aside(path: &Path, reason: &str) -> String {
    match atomic::set_aside(path) {
        Ok(kept) => format!(
            "{} is damaged ({reason}); it is kept as {}, and defaults are used instead",
            path.display(),
            kept.display()
        ),
        Err(error) => format!(
            "{} is damaged ({reason}) and cannot be renamed ({error}); defaults are used instead",
            path.display()
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_programs_survive() {
        let folder = crate::files::test_folder("data");
        let data = DataDir::open(&folder).expect("open");
        assert_eq!(data.load::<Vec<u32>>("counters"), Loaded::Missing);
        data.store("counters", &vec![1u32, 2]).expect("store");
        assert_eq!(data.load("counters"), Loaded::Value(vec![1u32, 2]));
        let program = StoredProgram {
            number: 7,
            text: "O0007 (车)\n".to_owned(),
            encoding: Encoding::Gb18030,
        };
        data.store_program(&program).expect("store");
        assert_eq!(data.programs(), (vec![program], Vec::new()));
        data.remove_program(7).expect("remove");
        data.remove_program(7).expect("already gone");
        assert_eq!(data.programs().0, []);
        fs::remove_dir_all(folder).expect("clean");
    }

    #[test]
    fn a_ladder_survives_as_instruction_list() {
        let folder = crate::files::test_folder("ladder");
        let data = DataDir::open(&folder).expect("open");
        assert_eq!(data.ladder(), Loaded::Missing);
        let text = "END1\nLD R1.0 ; 注释\nOUT R2.0\nEND2\n";
        let ladder = Ladder::compile(text).expect("compiles");
        data.store_ladder(&ladder).expect("store");
        let stored = fs::read_to_string(folder.join("ladder.il")).expect("read");
        assert_eq!(stored, text);
        assert_eq!(data.ladder(), Loaded::Value(ladder));
        fs::write(folder.join("ladder.il"), "LD").expect("write");
        let Loaded::Damaged(said) = data.ladder() else {
            panic!("damaged")
        };
        assert!(said.contains("ladder.il.damaged"), "{said}");
        assert_eq!(data.ladder(), Loaded::Missing);
        fs::remove_dir_all(folder).expect("clean");
    }

    #[test]
    fn a_damaged_file_is_kept_under_another_name() {
        let folder = crate::files::test_folder("damaged");
        let data = DataDir::open(&folder).expect("open");
        fs::write(folder.join("offsets.ron"), "(1, 2").expect("write");
        fs::write(folder.join("programs/O0003.CNC"), "G00\0").expect("write");
        let Loaded::Damaged(said) = data.load::<(u32, u32)>("offsets") else {
            panic!("damaged")
        };
        assert!(said.contains("offsets.ron.damaged"), "{said}");
        assert_eq!(data.load::<(u32, u32)>("offsets"), Loaded::Missing);
        let (programs, complaints) = data.programs();
        assert!(programs.is_empty());
        assert!(
            complaints[0].contains("O0003.CNC.damaged"),
            "{complaints:?}"
        );
        fs::remove_dir_all(folder).expect("clean");
    }

    #[test]
    fn a_broken_off_writing_is_named_and_the_old_text_stays() {
        let folder = crate::files::test_folder("broken-off");
        fs::create_dir_all(folder.join("programs")).expect("make");
        fs::write(folder.join("programs/O0003.CNC"), "O0003;\n").expect("write");
        fs::write(folder.join("programs/O0003.CNC.new"), "O00").expect("write");
        let data = DataDir::open(&folder).expect("open");
        assert_eq!(data.interrupted(), ["O0003"]);
        assert_eq!(data.programs().0.len(), 1);
        drop(data);
        let again = DataDir::open(&folder).expect("open");
        assert!(again.interrupted().is_empty());
        drop(again);
        fs::remove_dir_all(folder).expect("clean");
    }

    #[test]
    fn a_second_process_is_refused_and_so_is_an_unwritable_place() {
        let folder = crate::files::test_folder("lock");
        let first = DataDir::open(&folder).expect("open");
        let error = DataDir::open(&folder).expect_err("in use").to_string();
        assert!(error.starts_with("another gsk980td"), "{error}");
        drop(first);
        let again = DataDir::open(&folder).expect("free again");
        drop(again);
        let file = folder.join("file");
        fs::write(&file, "").expect("write");
        let error = DataDir::open(&file.join("data"))
            .expect_err("no folder")
            .to_string();
        assert!(error.contains("cannot be used"), "{error}");
        fs::remove_dir_all(folder).expect("clean");
    }
}
