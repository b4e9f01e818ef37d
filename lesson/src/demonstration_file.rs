//! Demonstrations: a practice machine shows key by key what a help topic describes. Each is a
//! short lesson that shows its own steps.

use std::sync::{Arc, LazyLock};

use gsk_panel::keys::Key;
use gsk_panel::script::ScriptAction;
use gsk_workpiece::job::Job;
use serde::Deserialize;

use crate::file::{LessonLocation, StepFile, check_text, parse_ron, parse_step};
use crate::practice_machine::{LessonStart, LessonStartFile};
use crate::{Lesson, LessonError, LessonStep, LessonText};

/// Name and text of the file with the demonstrations and their topics.
const EMBEDDED_FILE: (&str, &str) = ("shown.ron", include_str!("../../assets/help/shown.ron"));
/// Prefix of the lesson names of demonstrations; no lesson from a file has this prefix.
const NAME_PREFIX: &str = "shown/";

/// A demonstration that the help plays for its topics.
#[derive(Clone, Debug)]
pub struct Demonstration {
    /// Names of the help topics that play this demonstration, as in the help: `key POS`,
    /// `G01`, or a family of topics: `every data parameter`.
    pub topics: Vec<String>,
    /// The steps of the demonstration, in the form of a lesson.
    pub lesson: Arc<Lesson>,
}

/// A demonstration, as written in the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DemonstrationFile {
    name: String,
    topics: Vec<String>,
    title: LessonText,
    #[serde(default)]
    begins: LessonStartFile,
    #[serde(default)]
    job: Option<Job>,
    steps: Vec<DemonstrationStepFile>,
}

/// A step of a demonstration. The keys of its solution are marked, unless `keys` names others.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DemonstrationStepFile {
    text: LessonText,
    #[serde(default)]
    keys: Vec<String>,
    until: Vec<String>,
    solution: Vec<String>,
}

/// Parses demonstrations from RON. Messages call the text `file`.
///
/// # Errors
/// The line with a syntax error, or the step, field and rule that is broken.
pub fn read_demonstrations(file: &str, text: &str) -> Result<Vec<Demonstration>, LessonError> {
    let raw: Vec<DemonstrationFile> = parse_ron(file, text)?;
    raw.into_iter()
        .map(|raw| build_demonstration(file, raw))
        .collect()
}

/// All demonstrations of the program. A test checks every one of them.
pub fn demonstrations() -> &'static [Demonstration] {
    static ALL: LazyLock<Vec<Demonstration>> =
        LazyLock::new(|| read_demonstrations(EMBEDDED_FILE.0, EMBEDDED_FILE.1).unwrap_or_default());
    &ALL
}

/// The demonstration whose lesson is named `name`, `None` if there is none.
pub fn find_demonstration(name: &str) -> Option<&'static Demonstration> {
    let mut all = demonstrations().iter();
    all.find(|demonstration| demonstration.lesson.name == name)
}

fn build_demonstration(file: &str, raw: DemonstrationFile) -> Result<Demonstration, LessonError> {
    let file = format!("{file}: {}", raw.name);
    let location = |field| LessonLocation {
        file: &file,
        step: None,
        field,
    };
    check_text(&raw.title, &location("title"))?;
    let begins =
        LessonStart::read(raw.begins).map_err(|rule| location("begins").rule_error(rule))?;
    let steps = (1..).zip(raw.steps).map(|(number, step)| {
        let step = StepFile {
            hint: step.text.clone(),
            text: step.text,
            keys: step.keys,
            needs: Vec::new(),
            until: step.until,
            wrong: Vec::new(),
            solution: step.solution,
        };
        parse_step(&file, number, step).map(mark_pressed_keys)
    });
    let steps = steps.collect::<Result<_, _>>()?;
    Ok(Demonstration {
        topics: raw.topics,
        lesson: Arc::new(Lesson {
            name: format!("{NAME_PREFIX}{}", raw.name),
            about: raw.title.clone(),
            title: raw.title,
            start: begins,
            job: raw.job,
            steps,
        }),
    })
}

/// Marks the keys that the solution of a step presses, if the file names no keys for the step.
fn mark_pressed_keys(mut step: LessonStep) -> LessonStep {
    if !step.keys.is_empty() {
        return step;
    }
    let pressed = step
        .solution
        .lines
        .iter()
        .filter_map(|line| match line.action {
            ScriptAction::Press(key) | ScriptAction::Hold(key, _) | ScriptAction::Down(key) => {
                Some(key)
            }
            _ => None,
        });
    let mut keys: Vec<Key> = Vec::new();
    for key in pressed {
        if !keys.contains(&key) {
            keys.push(key);
        }
    }
    step.keys = keys;
    step
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use gsk_messages::Language;
    use gsk_panel::panel::KeyEvent;

    use super::*;
    use crate::solution_player::{self, StepResult};
    use crate::{Practice, are_all_met};

    #[test]
    fn every_demonstration_is_valid_and_completed_by_its_keys() {
        let all = read_demonstrations(EMBEDDED_FILE.0, EMBEDDED_FILE.1);
        let all = all.unwrap_or_else(|error| panic!("{error}"));
        let names: BTreeSet<&str> = all.iter().map(|it| it.lesson.name.as_str()).collect();
        assert_eq!(names.len(), all.len(), "a name is there twice");
        let mut faults = Vec::new();
        for shown in &all {
            let lesson = &shown.lesson;
            assert!(!shown.topics.is_empty(), "{}", lesson.name);
            let outcomes = match solution_player::play_lesson(lesson) {
                Ok(outcomes) => outcomes,
                Err(why) => {
                    faults.push(format!("{}: begins: {why}", lesson.name));
                    continue;
                }
            };
            for (step, outcome) in (1..).zip(&outcomes) {
                match outcome {
                    StepResult::Done(_) => {}
                    StepResult::DoneBefore => {
                        faults.push(format!("{}, step {step}: true before", lesson.name));
                    }
                    StepResult::Failed(why) => {
                        faults.push(format!("{}, step {step}: {why}", lesson.name));
                    }
                }
            }
        }
        assert!(faults.is_empty(), "{}", faults.join("\n"));
    }

    /// A demonstration that is played to its end advances from step to step automatically. A
    /// key of the learner ends it, and the remaining steps are not done.
    #[test]
    fn a_demonstration_continues_until_a_key_is_pressed() {
        let shown = find_demonstration("shown/page-position").expect("it is there");
        let steps = shown.lesson.steps.len();
        let (mut practice, mut machine) =
            Practice::demonstrate(Arc::clone(&shown.lesson)).expect("it begins");
        let mut seen = BTreeSet::new();
        let begun = machine.ticks();
        while practice.view().showing && machine.ticks() < begun + 60_000 {
            practice.tick(&mut machine);
            seen.insert(practice.view().step);
        }
        assert_eq!(seen.len(), steps + 1, "{seen:?}");
        assert!(are_all_met(&shown.lesson.steps[steps - 1].goals, &machine));
        // There is time to read the text before each first key.
        assert!(machine.ticks() - begun > steps as u64 * 1_000);

        let (mut practice, mut machine) =
            Practice::demonstrate(Arc::clone(&shown.lesson)).expect("it begins");
        for _ in 0..2_500 {
            practice.tick(&mut machine);
        }
        practice.interrupt(&mut machine);
        let at = practice.view().step;
        assert!(at < steps);
        machine.key(KeyEvent::ReleaseAll);
        for _ in 0..10_000 {
            practice.tick(&mut machine);
        }
        assert_eq!(practice.view().step, at);
        // Requested again, it continues from there to the end.
        practice.show_me(&mut machine);
        for _ in 0..60_000 {
            practice.tick(&mut machine);
        }
        assert_eq!(practice.view().step, steps);
    }

    #[test]
    fn what_is_wrong_with_a_demonstration_is_named() {
        let text = |until: &str| {
            format!(
                "[(name: \"one\", topics: [\"key POS\"], title: (zh: \"一\", en: \"One\"), \
                 steps: [(text: (zh: \"按\", en: \"press\"), until: [{until}], \
                 solution: [\"press POS\"])])]"
            )
        };
        let error = read_demonstrations("my.ron", &text("\"page nowhere\"")).expect_err("wrong");
        let message = error.message().text(Language::En);
        assert!(
            message.contains("my.ron: one") && message.contains("nowhere"),
            "{message}"
        );
        let one = read_demonstrations("my.ron", &text("\"page pos-rel\"")).expect("right");
        // The pressed keys are marked.
        assert_eq!(one[0].lesson.steps[0].keys, [Key::Position]);
    }
}
