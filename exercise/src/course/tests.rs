//! Tests of courses: progress, limits, and the package.

use gsk_messages::say;
use miniz_oxide::inflate::decompress_to_vec;

use super::scorm::{MAX_SUSPEND_CHARACTERS, platform_values, write_package};
use super::*;
use crate::library::EXERCISES;
use crate::report::ExerciseReport;

fn course_file(count: usize, mastery_per_cent: Option<u32>) -> CourseFile {
    let tasks = EXERCISES.iter().take(count);
    let tasks = tasks
        .map(|(id, text)| CourseTaskFile::new((*id).to_owned(), (*text).to_owned(), Some(b"png")));
    CourseFile {
        title: "A & B".to_owned(),
        mastery_per_cent,
        tasks: tasks.collect(),
    }
}

fn course(count: usize, mastery_per_cent: Option<u32>) -> Course {
    Course::read(course_file(count, mastery_per_cent)).expect("a course")
}

#[test]
fn progress_survives_the_platform_and_counts_the_best_attempt() {
    let course = course(2, Some(80));
    let [first, second] = [0, 1].map(|index| course.tasks[index].clone());
    let mut progress = CourseProgress::start(&course);
    assert_eq!(progress.to_text(), "");
    progress.record(&first.id, 1);
    progress.record(&first.id, first.max_points() + 9);
    progress.record("another", 1);
    assert_eq!(progress.state(), CourseState::Incomplete);
    progress.record(&first.id, 0);
    progress.record(&first.id, 0);
    let task = progress.task(&first.id).expect("a task");
    assert!(!task.has_attempts_left());
    assert_eq!(
        (task.attempts, task.best),
        (first.attempts, first.max_points())
    );
    progress.record(&second.id, 0);
    assert_eq!(progress.state(), CourseState::Failed);
    let text = progress.to_text();
    assert_eq!(CourseProgress::resume(&course, &text), progress);
    progress.record(&second.id, second.max_points());
    assert_eq!(progress.state(), CourseState::Passed);
    assert!((progress.score_per_cent() - 100.0).abs() < 1e-9);
}

#[test]
fn a_damaged_progress_loses_no_more_than_its_damaged_words() {
    let course = course(2, None);
    let mut progress = CourseProgress::start(&course);
    progress.record(&course.tasks[1].id, 1);
    let text = format!("x= 12345678=1/1 =/ {}=-1/2 {}", "é", progress.to_text());
    assert_eq!(CourseProgress::resume(&course, &text), progress);
    for end in 0..text.len() {
        if let Some(part) = text.get(..end) {
            // No part of a text is refused.
            let _ = CourseProgress::resume(&course, part);
        }
    }
    // Without a score to reach, the course is completed when all is handed in.
    progress.record(&course.tasks[0].id, 0);
    assert_eq!(progress.state(), CourseState::Completed);
}

#[test]
fn the_longest_progress_fits_into_the_platform() {
    let course = course(EXERCISES.len(), None);
    let mut progress = CourseProgress::start(&course);
    for task in &course.tasks {
        for _ in 0..task.attempts {
            progress.record(&task.id, task.max_points());
        }
    }
    assert!(progress.to_text().len() <= progress.longest_text());
    assert!(progress.longest_text() < MAX_SUSPEND_CHARACTERS);
    // 300 exercises do not fit; none is no course; one twice is an error.
    let mut many = course_file(1, None);
    let task = many.tasks[0].clone();
    many.tasks = (0..300)
        .map(|number| CourseTaskFile {
            id: format!("task-{number}"),
            ..task.clone()
        })
        .collect();
    assert!(Course::read(many.clone()).is_err());
    many.tasks.clear();
    assert!(Course::read(many.clone()).is_err());
    many.tasks = vec![task.clone(), task.clone()];
    let error = Course::read(many).expect_err("twice");
    assert_eq!(error, say::course_task_twice(task.id));
}

#[test]
fn the_platform_gets_score_state_and_attempt() {
    let course = course(3, Some(50));
    let mut progress = CourseProgress::start(&course);
    let task = &course.tasks[0];
    progress.record(&task.id, 1);
    let report = ExerciseReport {
        task: task.id.clone(),
        task_hash: task.hash.to_string(),
        points: 1,
        max_points: task.max_points(),
        duration_ms: 3_723_456,
        verdicts: Vec::new(),
        refused: None,
    };
    let values = platform_values(&progress, &report, 1);
    let stored = &values["values"];
    assert_eq!(stored["cmi.core.lesson_status"], "incomplete");
    assert_eq!(stored["cmi.core.score.max"], "100");
    assert_eq!(stored["cmi.suspend_data"], progress.to_text());
    let score: f64 = stored["cmi.core.score.raw"]
        .as_str()
        .and_then(|text| text.parse().ok())
        .expect("a number");
    assert!((score - progress.score_per_cent()).abs() < 0.006);
    let attempt = &values["attempt"];
    assert_eq!(attempt["id"], format!("{}-1", task.id));
    assert_eq!(attempt["latency"], "0001:02:03.45");
    assert_eq!(attempt["result"], "1");
}

/// Reads the names and contents of all files in a .zip archive.
fn unpack(archive: &[u8]) -> Vec<(String, Vec<u8>)> {
    let word = |at: usize| usize::from(u16::from_le_bytes([archive[at], archive[at + 1]]));
    let long = |at: usize| word(at) | word(at + 2) << 16;
    let end = archive.len() - 22;
    assert_eq!(archive[end..end + 4], *b"PK\x05\x06");
    let (count, mut entry) = (word(end + 10), long(end + 16));
    let mut files = Vec::new();
    for _ in 0..count {
        assert_eq!(archive[entry..entry + 4], *b"PK\x01\x02");
        let (packed, length, name) = (long(entry + 20), long(entry + 24), word(entry + 28));
        let at = long(entry + 42);
        assert_eq!(archive[at..at + 4], *b"PK\x03\x04");
        let start = at + 30 + name;
        let bytes = decompress_to_vec(&archive[start..start + packed]).expect("deflated");
        assert_eq!(bytes.len(), length);
        assert_eq!(crc32fast::hash(&bytes) as usize, long(entry + 16));
        let name = archive[entry + 46..entry + 46 + name].to_vec();
        files.push((String::from_utf8(name).expect("a name"), bytes));
        entry += 46 + word(entry + 28);
    }
    assert_eq!(entry, end);
    files
}

#[test]
fn a_package_has_the_page_the_course_and_a_manifest_that_lists_all() {
    let file = course(2, Some(80));
    let page = b"<p></p>\n<script type=\"module\">start</script>".to_vec();
    let page = vec![
        ("index.html".to_owned(), page),
        ("gsk980td_bg.wasm".to_owned(), vec![7; 100_000]),
    ];
    let archive = write_package(&file, page.clone()).expect("a package");
    assert_eq!(write_package(&file, page.clone()), Ok(archive.clone()));
    let files = unpack(&archive);
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let expected = "imsmanifest.xml index.html gsk980td_bg.wasm scorm.js course.json";
    assert_eq!(names.join(" "), expected);
    let text = |name: &str| {
        let (_, bytes) = files.iter().find(|it| it.0 == name).expect(name);
        String::from_utf8_lossy(bytes).into_owned()
    };
    let manifest = text("imsmanifest.xml");
    for name in &names[1..] {
        assert!(manifest.contains(&format!("href=\"{name}\"")), "{manifest}");
    }
    assert!(manifest.contains("<title>A &amp; B</title>"));
    let html = text("index.html");
    let adapter = html.find("scorm.js").expect("the adapter");
    assert!(adapter < html.find("module").expect("the script"));
    let read = Course::from_json(text("course.json").as_bytes()).expect("a course");
    assert_eq!(read.tasks[1].hash, course(2, None).tasks[1].hash);
    assert_eq!(read.tasks[1].drawing.as_deref(), Some(&b"png"[..]));
    let (_, without_page) = page.split_first().expect("a page");
    assert!(write_package(&file, without_page.to_vec()).is_err());
    let other = vec![("index.html".to_owned(), b"<p>".to_vec())];
    assert!(write_package(&file, other).is_err());
}
