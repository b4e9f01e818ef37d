//! Loads lessons: the built-in ones and those of a teacher in the folder `lessons` of the
//! data directory.

use std::path::Path;

use gsk_lesson::{Lesson, built_in_lessons};
use gsk_messages::Message;

use super::program_file;
use crate::platform;

/// Name of the folder for a teacher's lessons in the data directory.
pub const FOLDER: &str = "lessons";
/// File extension of a lesson, without the dot.
const ENDING: &str = "ron";

/// The lessons that the window lists, and the errors of unusable ones.
#[derive(Debug, Default)]
pub struct AvailableLessons {
    /// The built-in lessons, then those of the data directory, sorted by name.
    pub lessons: Vec<Lesson>,
    /// One error for each file of the lesson folder that cannot be used.
    pub errors: Vec<Message>,
}

/// Reads a lesson file.
///
/// # Errors
/// The file cannot be read, or breaks a rule: the message names the position.
pub fn read(path: &Path) -> Result<Lesson, Message> {
    let file = program_file::read(path).map_err(|error| error.message())?;
    Lesson::read(&path.display().to_string(), &file.text).map_err(|error| error.message())
}

/// Loads all lessons: the built-in ones and those of a data directory.
pub fn load_lessons(data: Option<&Path>) -> AvailableLessons {
    let mut available = AvailableLessons {
        lessons: built_in_lessons(),
        errors: Vec::new(),
    };
    let listed = data.map(|data| platform::list(&data.join(FOLDER)));
    // Without the folder there are no lessons of a teacher.
    let mut paths = listed.and_then(Result::ok).unwrap_or_default();
    paths.retain(|path| {
        path.extension()
            .is_some_and(|it| it.eq_ignore_ascii_case(ENDING))
    });
    paths.sort();
    for path in paths {
        match read(&path) {
            Ok(lesson) => {
                // A lesson of the folder replaces the built-in one of the same name.
                available.lessons.retain(|known| known.name != lesson.name);
                available.lessons.push(lesson);
            }
            Err(message) => available.errors.push(message),
        }
    }
    available
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_tests::test_folder;

    const LESSON: &str = "(title: (zh: \"一\", en: \"One\"), about: (zh: \"一\", en: \"one\"), \
        steps: [(text: (zh: \"按\", en: \"press\"), hint: (zh: \"按\", en: \"press\"), \
        until: [\"mode 自动方式\"], solution: [\"press AUTO\"])])";

    #[test]
    fn lessons_of_a_teacher_come_last_and_errors_are_reported() {
        let folder = test_folder("lessons");
        assert_eq!(
            load_lessons(Some(&folder)).lessons.len(),
            built_in_lessons().len()
        );
        let own = folder.join(FOLDER);
        std::fs::create_dir_all(&own).expect("folder");
        std::fs::write(own.join("mine.ron"), LESSON).expect("written");
        std::fs::write(own.join("notes.txt"), "no lesson").expect("written");
        let wrong = LESSON.replace("press AUTO", "press AUT");
        std::fs::write(own.join("wrong.ron"), wrong).expect("written");
        let found = load_lessons(Some(&folder));
        assert_eq!(found.lessons.last().expect("a lesson").name, "mine");
        assert_eq!(found.errors.len(), 1);
        let message = found.errors[0].text(gsk_messages::Language::En);
        assert!(
            message.contains("wrong.ron: step 1, solution: line 1"),
            "{message}"
        );
    }
}
