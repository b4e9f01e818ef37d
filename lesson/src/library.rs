//! The lessons that come with the program.

use crate::Lesson;

macro_rules! lessons {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../assets/lessons/", $name)))),*]
    };
}

/// File names and texts of the built-in lessons of all control models, in the order in which a
/// learner takes them.
pub static LESSONS: [(&str, &str); 15] = lessons![
    "01-power-on.ron",
    "02-jog-and-handwheel.ron",
    "03-mdi.ron",
    "04-program.ron",
    "05-tool-setting.ron",
    "06-dry-run.ron",
    "07-alarms.ron",
    "08-offsets.ron",
    "09-threads.ron",
    "10-nose-radius.ron",
    "11-find-out-why.ron",
    "ncb08-1-keys-and-outputs.ron",
    "ncb08-2-teach-in.ron",
    "hx31-1-main-functions.ron",
    "hx31-2-programs.ron",
];

/// Parses the built-in lessons. A test checks that every one of them is valid.
pub fn built_in_lessons() -> Vec<Lesson> {
    let read = LESSONS.iter().map(|(name, text)| Lesson::read(name, text));
    read.filter_map(Result::ok).collect()
}
