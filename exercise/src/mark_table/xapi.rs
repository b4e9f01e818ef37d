//! Marks as statements for a learning record store (Experience API 1.0.3).

use gsk_messages::Language;
use serde_json::{Value, json};

use crate::mark::ResultMark;
use crate::task::ExerciseTask;

/// Home page of the learners' accounts in xAPI statements. An importer replaces it by that of the
/// school.
const HOME_PAGE: &str = "https://gsk980td.invalid";
/// Prefix of the identifiers of exercises and extensions.
const NAMES: &str = "urn:gsk980td";

/// Returns one xAPI statement for each result that was replayed.
pub fn statements(marks: &[ResultMark], tasks: &[ExerciseTask], language: Language) -> Value {
    let statements = marks.iter().filter_map(|mark| {
        let task = tasks.iter().find(|task| task.id == mark.task)?;
        statement(mark, task, language)
    });
    Value::Array(statements.collect())
}

fn statement(mark: &ResultMark, task: &ExerciseTask, language: Language) -> Option<Value> {
    let report = mark.report.as_ref()?;
    let flags: Vec<String> = mark.flags.iter().map(|flag| flag.text(language)).collect();
    let (points, most) = (mark.points(), mark.max_points());
    let scaled = f64::from(points) / f64::from(most.max(1));
    Some(json!({
        "id": statement_id(mark)?,
        "actor": {
            "objectType": "Agent",
            "name": mark.learner,
            "account": { "homePage": HOME_PAGE, "name": mark.learner },
        },
        "verb": {
            "id": "http://adlnet.gov/expapi/verbs/completed",
            "display": { "en": "completed", "zh": "完成" },
        },
        "object": {
            "objectType": "Activity",
            "id": format!("{NAMES}:exercise:{}", task.id),
            "definition": {
                "type": "http://adlnet.gov/expapi/activities/assessment",
                "name": { "en": task.title.en, "zh": task.title.zh },
                "description": { "en": task.text.en, "zh": task.text.zh },
            },
        },
        "result": {
            "score": { "scaled": scaled, "raw": points, "min": 0, "max": most },
            "completion": true,
            "duration": format!("PT{:.2}S", report.duration_ms as f64 / 1000.0),
            "extensions": { format!("{NAMES}:flags"): flags },
        },
    }))
}

/// Returns a UUID made from the hash of the recording, so that a result sent twice is one
/// statement; `None` without a hash. It has the form of version 5, because readers refuse newer
/// versions.
fn statement_id(mark: &ResultMark) -> Option<String> {
    let hash = mark.recording_hash()?.to_string();
    let part = |from: usize, to: usize| hash.get(from..to);
    Some(format!(
        "{}-{}-5{}-8{}-{}",
        part(0, 8)?,
        part(8, 12)?,
        part(12, 15)?,
        part(15, 18)?,
        part(18, 30)?
    ))
}
