//! The data directory: the battery-backed memory of the control on the disk.
//!
//! ```text
//! lock                one process at a time
//! manifest.ron        length and checksum of every file
//! programs/O0001.CNC  one program a file, as plain text
//! ladder.il           the ladder in place of the standard one, once one was saved
//! NAME.ron            parameters, offsets, counters, PLC memory, …
//! copies/             every file once more
//! ```
//!
//! Every write is atomic. A damaged or missing file is reported and its copy is read.
//! Without a good copy, this file alone gets its factory contents.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};

use gsk_core::plc::{CompileErrors, Ladder};
use gsk_core::units::{NonFinite, find_non_finite};
use gsk_messages::{Message, say};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::atomic::{self, FileAccess};
use super::decode::{self, TextEncoding};
use super::mirrored_files::{FileChange, FileDamage, FileReadResult, MirroredFiles};
use super::program_file;
use crate::message_format;
use crate::platform::{self, Lock};

const PROGRAMS: &str = "programs";
const LOCK: &str = "lock";
const LADDER: &str = "ladder.il";
/// Name of the file with the macro variables, the only one in which NaN is accepted: earlier
/// versions imported NaN from project folders.
const VARIABLES: &str = "variables";
/// Names of files with passwords, which only their owner may read.
const PRIVATE_FILES: [&str; 1] = ["authority.ron"];
/// Size limit of a file in the data directory, except programs, bytes.
const MAX_BYTES: u64 = 64 * 1024 * 1024;

/// An open data directory, which stays locked until this value is dropped.
#[derive(Debug)]
pub struct DataDir {
    path: PathBuf,
    _lock: Lock,
    files: MirroredFiles,
    /// Numbers of the programs whose last write was interrupted by a power failure.
    interrupted_programs: Vec<String>,
}

/// Why a data directory cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.message())]
pub enum DataDirError {
    /// The directory cannot be created, read or written.
    Unusable {
        path: PathBuf,
        /// The error that the operating system has returned.
        source: io::Error,
    },
    /// Another process has locked the data directory.
    InUse { path: PathBuf },
    /// The path is not a data directory, and none may be created there.
    Missing { path: PathBuf },
    /// The platform has no default folder for the data directory.
    NoDefault,
}

impl DataDirError {
    pub fn message(&self) -> Message {
        match self {
            Self::Unusable { path, source } => {
                say::data_dir_unusable(path.display(), message_format::describe_io_error(source))
            }
            Self::InUse { path } => platform::data_folder_in_use(path),
            Self::Missing { path } => say::data_dir_none(path.display()),
            Self::NoDefault => say::data_dir_no_default(),
        }
    }
}

/// The value loaded from a file of the directory, and whether the file was intact.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LoadedFile<T> {
    Value(T),
    /// The file is damaged or missing. Holds the value from its copy, or from the file without
    /// its invalid parts, and the damage.
    Recovered(T, FileDamage),
    /// The file does not exist in the directory.
    Missing,
    /// The file and its copy are damaged. The payload names the reason and the new name of the
    /// file.
    Damaged(FileDamage),
}

/// A program file of the data directory, with its contents.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredProgram {
    pub number: u16,
    pub text: String,
    pub encoding: TextEncoding,
}

/// Returns the default data directory of the platform. Returns an error if the platform does not
/// report one.
pub fn default_data_path() -> Result<PathBuf, DataDirError> {
    platform::data_folder("gsk980td").ok_or(DataDirError::NoDefault)
}

impl DataDir {
    /// Opens a directory for reading and changes nothing in it. It must already be a data
    /// directory: a mistyped path must not look like a control in its factory state.
    ///
    /// # Errors
    /// Why the directory cannot be read.
    pub fn open_read_only(path: &Path) -> Result<Self, DataDirError> {
        if !platform::is_taken(&path.join(LOCK)) {
            return Err(DataDirError::Missing {
                path: path.to_owned(),
            });
        }
        let lock = map_lock_error(Lock::shared(&path.join(LOCK)), path)?;
        Ok(Self {
            path: path.to_owned(),
            _lock: lock,
            files: MirroredFiles::open(path, true),
            interrupted_programs: Vec::new(),
        })
    }

    /// Opens and locks a directory; creates it if it is missing.
    ///
    /// # Errors
    /// Why the directory cannot be used.
    pub fn open(path: &Path) -> Result<Self, DataDirError> {
        let unusable = |source| DataDirError::Unusable {
            path: path.to_owned(),
            source,
        };
        let programs = path.join(PROGRAMS);
        platform::make_folder(&programs).map_err(unusable)?;
        let lock = map_lock_error(Lock::exclusive(&path.join(LOCK)), path)?;
        // Report a read-only directory now, not at the first edit.
        let probe = programs.join(".gsk980td-probe");
        atomic::write(&probe, b"").map_err(unusable)?;
        platform::remove(&probe).map_err(unusable)?;
        for folder in ["", "copies", "copies/programs"] {
            atomic::remove_temporary_files(&path.join(folder));
        }
        let interrupted_programs = atomic::remove_temporary_files(&programs)
            .iter()
            .filter_map(|name| parse_program_number(name))
            .map(|number| format!("O{number:04}"))
            .collect();
        Ok(Self {
            path: path.to_owned(),
            _lock: lock,
            files: MirroredFiles::open(path, false),
            interrupted_programs,
        })
    }

    /// Numbers of the programs whose last write was interrupted by a power failure; their
    /// older texts are kept.
    pub fn interrupted_programs(&self) -> &[String] {
        &self.interrupted_programs
    }

    /// The damage of the manifest itself; `None` if it was intact.
    pub const fn manifest_damage(&self) -> Option<&FileDamage> {
        self.files.manifest_damage()
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads the file `NAME.ron`. A number that is not finite makes the file damaged; only the
    /// macro variables are loaded without it.
    pub fn load<T: DeserializeOwned>(&self, name: &str) -> LoadedFile<T> {
        let file = ron_file_name(name);
        let mut non_finite = None;
        let loaded = self.read(&file, MAX_BYTES, |bytes| {
            let text = String::from_utf8(bytes).map_err(say::as_written)?;
            non_finite = find_non_finite(&text);
            if let Some(found) = &non_finite
                && name != VARIABLES
            {
                return Err(say::in_line(
                    found.line,
                    say::number_not_finite(&found.token),
                ));
            }
            ron::from_str(&text)
                .map_err(|error| say::in_line(error.span.start.line, say::as_written(error.code)))
        });
        match (loaded, non_finite) {
            (LoadedFile::Value(value), Some(NonFinite { line, token })) => {
                let path = self.path.join(&file);
                let message = say::data_dir_variable_emptied(path.display(), line, token);
                LoadedFile::Recovered(value, FileDamage::new(&path, message))
            }
            (loaded, _) => loaded,
        }
    }

    /// Writes a value as the file `NAME.ron`, where NAME is `name`.
    ///
    /// # Errors
    /// The files that cannot be written.
    pub fn store<T: Serialize>(&self, name: &str, value: &T) -> Result<(), Message> {
        let failures = self.commit(vec![to_ron_change(name, value)?]);
        if failures.is_empty() {
            Ok(())
        } else {
            Err(say::several(failures))
        }
    }

    /// Writes the changes whose contents are new, each file independently. Returns one
    /// message for each file that cannot be written.
    pub fn commit(&self, changes: Vec<FileChange>) -> Vec<Message> {
        self.files.commit(changes)
    }

    /// Reads the operator's ladder, which replaces the standard ladder.
    pub fn load_ladder(&self) -> LoadedFile<Ladder> {
        self.read(LADDER, MAX_BYTES, |bytes| {
            let text = String::from_utf8(bytes).map_err(say::as_written)?;
            Ladder::compile(&text).map_err(|errors| describe_first_error(&errors))
        })
    }

    /// Reads all programs; returns the usable ones, and the damage of the others.
    pub fn load_programs(&self) -> (Vec<StoredProgram>, Vec<FileDamage>) {
        let mut programs = Vec::new();
        let mut damages = Vec::new();
        let mut numbers: BTreeSet<u16> = self.program_numbers().collect();
        let folder = self.path.join(PROGRAMS);
        match platform::list(&folder) {
            Ok(paths) => numbers.extend(
                paths
                    .iter()
                    .filter_map(|path| parse_program_number(path.file_name()?.to_str()?)),
            ),
            Err(error) => {
                let message =
                    say::data_dir_programs_unreadable(message_format::describe_io_error(&error));
                damages.push(FileDamage::new(&folder, message));
            }
        }
        for number in numbers {
            let name = program_name(number);
            let loaded = self.read(&name, program_file::MAX_BYTES, |bytes| {
                let decoded = decode::decode(bytes).map_err(|error| error.message())?;
                if decoded.text.trim().is_empty() {
                    return Err(say::file_content_empty());
                }
                Ok(StoredProgram {
                    number,
                    text: decoded.text,
                    encoding: decoded.encoding,
                })
            });
            match loaded {
                LoadedFile::Value(program) => programs.push(program),
                LoadedFile::Recovered(program, damage) => {
                    programs.push(program);
                    damages.push(damage);
                }
                LoadedFile::Missing => {}
                LoadedFile::Damaged(damage) => damages.push(damage),
            }
        }
        (programs, damages)
    }

    /// Returns the numbers of the programs in the manifest.
    fn program_numbers(&self) -> impl Iterator<Item = u16> {
        let names = self.files.names().into_iter();
        names.filter_map(|name| {
            parse_program_number(name.strip_prefix(PROGRAMS)?.strip_prefix('/')?)
        })
    }

    fn read<T>(
        &self,
        name: &str,
        max_bytes: u64,
        parse: impl FnOnce(Vec<u8>) -> Result<T, Message>,
    ) -> LoadedFile<T> {
        let FileReadResult {
            contents: content,
            damage,
        } = self.files.read(name, max_bytes);
        let Some(content) = content else {
            return damage.map_or(LoadedFile::Missing, LoadedFile::Damaged);
        };
        match (parse(content), damage) {
            (Ok(value), None) => LoadedFile::Value(value),
            (Ok(value), Some(damage)) => LoadedFile::Recovered(value, damage),
            (Err(reason), None) => LoadedFile::Damaged(self.files.mark_damaged(name, reason)),
            (
                Err(reason),
                Some(FileDamage {
                    file_name: name,
                    message,
                }),
            ) => LoadedFile::Damaged(FileDamage {
                file_name: name,
                message: say::file_copy_unusable(message, reason),
            }),
        }
    }
}

/// Formats the first error of a ladder that does not compile, as a reason for damage.
fn describe_first_error(errors: &CompileErrors) -> Message {
    let first = errors.errors.first();
    first.map_or_else(
        || say::as_written(errors),
        message_format::describe_ladder_error,
    )
}

/// A change that writes a value as `NAME.ron`.
///
/// # Errors
/// The value cannot be written as RON.
pub fn to_ron_change<T: Serialize>(name: &str, value: &T) -> Result<FileChange, Message> {
    let style = ron::ser::PrettyConfig::new().depth_limit(3);
    let text = ron::ser::to_string_pretty(value, style)
        .map_err(|error| say::subject_reason(name, say::as_written(error)))?;
    let name = ron_file_name(name);
    let readers = match PRIVATE_FILES.contains(&name.as_str()) {
        true => FileAccess::Owner,
        false => FileAccess::Any,
    };
    Ok(FileChange {
        name,
        contents: Some(text.into_bytes()),
        readers,
    })
}

/// A change that writes the ladder that replaces the standard one.
pub fn to_ladder_change(ladder: &Ladder) -> FileChange {
    FileChange {
        name: LADDER.to_owned(),
        contents: Some(ladder.source().as_bytes().to_vec()),
        readers: FileAccess::Any,
    }
}

/// A change that writes the text of a program; `None` deletes the program.
pub fn to_program_change(number: u16, text: Option<(&str, TextEncoding)>) -> FileChange {
    FileChange {
        name: program_name(number),
        contents: text.map(|(text, encoding)| decode::encode(text, encoding)),
        readers: FileAccess::Any,
    }
}

fn map_lock_error(lock: io::Result<Lock>, path: &Path) -> Result<Lock, DataDirError> {
    let path = path.to_owned();
    lock.map_err(|source| match source.kind() {
        io::ErrorKind::WouldBlock => DataDirError::InUse { path },
        _ => DataDirError::Unusable { path, source },
    })
}

fn ron_file_name(name: &str) -> String {
    format!("{name}.ron")
}

fn program_name(number: u16) -> String {
    format!("{PROGRAMS}/O{number:04}.CNC")
}

/// Parses the program number in a file name such as `O0001.CNC`; `None` for other names.
fn parse_program_number(name: &str) -> Option<u16> {
    let digits = name.strip_prefix('O')?.strip_suffix(".CNC")?;
    let is_number = digits.len() == 4 && digits.bytes().all(|byte| byte.is_ascii_digit());
    is_number.then(|| digits.parse().ok())?
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn values_and_programs_survive() {
        let folder = gsk_tests::test_folder("data");
        let data = DataDir::open(&folder).expect("open");
        assert_eq!(data.load::<Vec<u32>>("counters"), LoadedFile::Missing);
        data.store("counters", &vec![1u32, 2]).expect("store");
        assert_eq!(data.load("counters"), LoadedFile::Value(vec![1u32, 2]));
        let program = StoredProgram {
            number: 7,
            text: "O0007 (车)\n".to_owned(),
            encoding: TextEncoding::Gb18030,
        };
        let file = to_program_change(7, Some((&program.text, program.encoding)));
        assert_eq!(data.commit(vec![file]), []);
        assert_eq!(data.load_programs(), (vec![program], Vec::new()));
        for _ in 0..2 {
            assert_eq!(data.commit(vec![to_program_change(7, None)]), []);
        }
        assert_eq!(data.load_programs(), (Vec::new(), Vec::new()));
    }

    #[test]
    fn a_ladder_survives_as_instruction_list() {
        let folder = gsk_tests::test_folder("ladder");
        let data = DataDir::open(&folder).expect("open");
        assert_eq!(data.load_ladder(), LoadedFile::Missing);
        let text = "END1\nLD R1.0 ; 注释\nOUT R2.0\nEND2\n";
        let ladder = Ladder::compile(text).expect("compiles");
        assert_eq!(data.commit(vec![to_ladder_change(&ladder)]), []);
        let stored = fs::read_to_string(folder.join("ladder.il")).expect("read");
        assert_eq!(stored, text);
        assert_eq!(data.load_ladder(), LoadedFile::Value(ladder.clone()));
        fs::write(folder.join("ladder.il"), "LD").expect("write");
        let LoadedFile::Recovered(copy, damage) = data.load_ladder() else {
            panic!("damaged")
        };
        assert_eq!(copy, ladder);
        let message = damage.message.to_string();
        assert!(message.contains("ladder.il.damaged"), "{message}");
    }

    #[test]
    fn a_damaged_file_is_kept_under_another_name() {
        let folder = gsk_tests::test_folder("damaged");
        let data = DataDir::open(&folder).expect("open");
        fs::write(folder.join("offsets.ron"), "(1, 2").expect("write");
        fs::write(folder.join("programs/O0003.CNC"), "G00\0").expect("write");
        let LoadedFile::Damaged(damage) = data.load::<(u32, u32)>("offsets") else {
            panic!("damaged")
        };
        let message = damage.message.to_string();
        assert!(message.contains("offsets.ron.damaged"), "{message}");
        assert_eq!(data.load::<(u32, u32)>("offsets"), LoadedFile::Missing);
        let (programs, complaints) = data.load_programs();
        assert!(programs.is_empty());
        let message = complaints[0].message.to_string();
        assert!(message.contains("O0003.CNC.damaged"), "{message}");
    }

    #[test]
    fn an_interrupted_write_is_reported_and_the_old_text_stays() {
        let folder = gsk_tests::test_folder("broken-off");
        fs::create_dir_all(folder.join("programs")).expect("make");
        fs::write(folder.join("programs/O0003.CNC"), "O0003;\n").expect("write");
        fs::write(folder.join("programs/.O0003.CNC.gsk980td-new"), "O00").expect("write");
        let data = DataDir::open(&folder).expect("open");
        assert_eq!(data.interrupted_programs(), ["O0003"]);
        assert_eq!(data.load_programs().0.len(), 1);
        drop(data);
        let again = DataDir::open(&folder).expect("open");
        assert!(again.interrupted_programs().is_empty());
        drop(again);
    }

    #[test]
    fn a_second_process_and_a_read_only_path_are_refused() {
        let folder = gsk_tests::test_folder("lock");
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
    }
}
