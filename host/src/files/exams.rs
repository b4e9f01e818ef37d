//! The folders of exams in the data directory: the exam itself, the recording of the current
//! exercise, and the sealed results.
//!
//! ```text
//! exams/0001-Li/
//!   exam.ron           learner, exercises, PIN, how far it has come
//!   1-04-spindle.gskrec
//!   1-04-spindle.gskresult
//! ```

use std::path::{Path, PathBuf};

use gsk_exercise::exam::{Exam, ExamPin};
use gsk_exercise::report::ExerciseReport;
use gsk_exercise::result_file::{RESULT_EXTENSION, ResultAuthor, write_result};
use gsk_messages::{Message, say};

use super::{atomic, exercise_key, program_file};
use crate::output::WriteError;
use crate::platform;

/// Name of the folder for exams in the data directory.
pub const FOLDER: &str = "exams";
/// Name of the file of an exam in its folder.
const EXAM_FILE: &str = "exam.ron";
/// File extension of the recordings of an exam, without the dot.
const RECORDING_EXTENSION: &str = "gskrec";

/// The exam of a data directory that has not ended, or why its file cannot be read.
pub type UnfinishedExam = Result<Option<ExamFolder>, Message>;

/// Stores the PIN of an exam with a random salt.
///
/// # Errors
/// It is not 4 to 12 digits, or the system gives no random numbers.
pub fn store_pin(pin: &str) -> Result<ExamPin, Message> {
    let mut salt = [0; 8];
    getrandom::fill(&mut salt).map_err(say::exercise_no_random)?;
    ExamPin::new(pin, u64::from_le_bytes(salt)).ok_or_else(say::exam_begin_hint)
}

/// An exam, and the folder in which it is stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExamFolder {
    /// The exam: its exercises and its progress.
    pub exam: Exam,
    /// The folder in which the exam is stored.
    pub path: PathBuf,
    data: PathBuf,
}

impl ExamFolder {
    /// Creates the folder of an exam in a data directory.
    ///
    /// # Errors
    /// The folder or the file cannot be written.
    pub fn create(data: &Path, exam: Exam) -> Result<Self, Message> {
        let before = platform::list(&data.join(FOLDER)).unwrap_or_default();
        let numbers = before.iter().filter_map(|path| number_of(path));
        let number = numbers.max().map_or(1, |last| last + 1);
        let learner: String = exam
            .learner
            .chars()
            .filter(|c| c.is_alphanumeric())
            .collect();
        let path = data.join(FOLDER).join(format!("{number:04}-{learner}"));
        platform::make_folder(&path).map_err(|error| WriteError::new(&path, error).message())?;
        let folder = Self {
            exam,
            path,
            data: data.to_owned(),
        };
        folder.save()?;
        Ok(folder)
    }

    /// Finds the exam in a data directory that has not ended; `None` if there is none.
    ///
    /// # Errors
    /// The file of an exam is damaged.
    pub fn find_unfinished(data: &Path) -> UnfinishedExam {
        // Without the folder there was no exam.
        let mut folders = platform::list(&data.join(FOLDER)).unwrap_or_default();
        folders.sort();
        for path in folders.into_iter().rev() {
            let file = path.join(EXAM_FILE);
            if !platform::is_taken(&file) {
                continue;
            }
            let text = program_file::read(&file).map_err(|error| error.message())?;
            let damaged = |reason| say::exam_file_damaged(file.display(), reason);
            let exam = Exam::from_text(&text.text).map_err(damaged)?;
            if !exam.is_over {
                let data = data.to_owned();
                return Ok(Some(Self { exam, path, data }));
            }
        }
        Ok(None)
    }

    /// Writes the state of the exam.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn save(&self) -> Result<(), Message> {
        let file = self.path.join(EXAM_FILE);
        atomic::write(&file, self.exam.to_text()?.as_bytes())
            .map_err(|error| WriteError::new(&file, error).message())
    }

    /// Returns the path of the recording of the current exercise.
    pub fn recording_path(&self) -> PathBuf {
        self.current_file(RECORDING_EXTENSION)
    }

    /// Returns the recording of the current exercise as far as it has come; `None` before it was
    /// begun.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read_recording(&self) -> Result<Option<Vec<u8>>, Message> {
        let path = self.recording_path();
        if !platform::is_taken(&path) {
            return Ok(None);
        }
        let bytes = program_file::read_bytes(&path).map_err(|error| error.message())?;
        Ok(Some(bytes))
    }

    /// Seals and writes the result of the current exercise, and continues with the next one.
    /// Returns the bytes of the result.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn finish_task(
        &mut self,
        report: ExerciseReport,
        recording: &[u8],
        program: &str,
    ) -> Result<Vec<u8>, Message> {
        let (key, _) = exercise_key::load_or_make(&self.data)?;
        let author = ResultAuthor {
            program: program.to_owned(),
            learner: self.exam.learner.clone(),
            hints: Vec::new(),
            exam: Some(self.exam.note),
        };
        let bytes = write_result(author, report, recording, &key)?;
        let path = self.current_file(RESULT_EXTENSION);
        atomic::write(&path, &bytes).map_err(|error| WriteError::new(&path, error).message())?;
        self.exam.finish_task();
        self.save()?;
        Ok(bytes)
    }

    fn current_file(&self, ending: &str) -> PathBuf {
        let task = self.exam.current().unwrap_or_default();
        let number = self.exam.done + 1;
        self.path.join(format!("{number}-{task}.{ending}"))
    }
}

/// The number with which the name of an exam's folder begins.
fn number_of(folder: &Path) -> Option<u32> {
    let name = folder.file_name()?.to_str()?;
    name.split_once('-')?.0.parse().ok()
}

#[cfg(test)]
mod tests {
    use gsk_tests::test_folder;

    use super::*;

    #[test]
    fn an_exam_that_has_not_ended_is_found_again() {
        let data = test_folder("exam-folder");
        assert_eq!(ExamFolder::find_unfinished(&data), Ok(None));
        let pin = ExamPin::new("4711", 1).expect("a PIN");
        let exam = Exam::new("Li Ming".to_owned(), vec!["04-spindle".to_owned()], pin);
        let mut created = ExamFolder::create(&data, exam).expect("a folder");
        assert_eq!(created.read_recording(), Ok(None));
        let found = ExamFolder::find_unfinished(&data).expect("readable");
        assert_eq!(found.as_ref(), Some(&created));
        created.exam.finish_task();
        created.save().expect("written");
        assert_eq!(ExamFolder::find_unfinished(&data), Ok(None));
        atomic::write(&created.path.join(EXAM_FILE), b"(").expect("written");
        let error = ExamFolder::find_unfinished(&data).expect_err("damaged");
        assert!(error.to_string().contains("exam.ron"), "{error}");
    }
}
