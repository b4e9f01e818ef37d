//! A course as a SCORM 1.2 package, and the values that a learning platform stores about it.

use core::fmt::Write as _;

use gsk_messages::{Message, say};
use serde_json::{Value, json};

use super::zip_archive::write_zip;
use super::{COURSE_FILE, Course, CourseProgress, CourseState};
use crate::drawing::escape_markup;
use crate::report::ExerciseReport;
use crate::task::TaskHash;

/// Greatest length of `cmi.suspend_data` in SCORM 1.2, characters.
pub const MAX_SUSPEND_CHARACTERS: usize = 4096;
/// Name of the page that a learning platform opens.
const PAGE_FILE: &str = "index.html";
/// Name of the script that connects the page to the learning platform.
const ADAPTER_FILE: &str = "scorm.js";
const ADAPTER: &str = include_str!("../../../web/scorm.js");
/// The start tag of the page's script, before which the SCORM adapter is inserted.
const PAGE_SCRIPT: &str = "<script type=\"module\">";
/// Name of the manifest file of a SCORM package.
const MANIFEST_FILE: &str = "imsmanifest.xml";

/// Creates a SCORM package from a course and the files of the browser page.
///
/// # Errors
///
/// The files contain no page, or are too large for a package.
pub fn write_package(course: &Course, page: Vec<(String, Vec<u8>)>) -> Result<Vec<u8>, Message> {
    let json = serde_json::to_vec(&course.to_file()).map_err(say::as_written)?;
    let identifier = TaskHash::from_bytes(&json).to_string();
    let mut files = Vec::new();
    let mut has_page = false;
    for (name, bytes) in page {
        let bytes = match name == PAGE_FILE {
            true => {
                has_page = true;
                add_adapter(&bytes)?
            }
            false => bytes,
        };
        files.push((name, bytes));
    }
    if !has_page {
        return Err(say::course_no_page(PAGE_FILE));
    }
    files.push((ADAPTER_FILE.to_owned(), ADAPTER.as_bytes().to_vec()));
    files.push((COURSE_FILE.to_owned(), json));
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let manifest = write_manifest(&course.title, &identifier, &names);
    files.insert(0, (MANIFEST_FILE.to_owned(), manifest.into_bytes()));
    write_zip(&files)
}

/// Inserts the tag that loads the SCORM adapter into the page.
///
/// # Errors
///
/// The page has no script tag.
fn add_adapter(page: &[u8]) -> Result<Vec<u8>, Message> {
    let text = core::str::from_utf8(page).unwrap_or_default();
    let Some((head, script)) = text.split_once(PAGE_SCRIPT) else {
        return Err(say::course_no_page(PAGE_FILE));
    };
    let adapter = format!("<script src=\"{ADAPTER_FILE}\"></script>");
    Ok(format!("{head}{adapter}\n{PAGE_SCRIPT}{script}").into_bytes())
}

fn write_manifest(title: &str, identifier: &str, files: &[&str]) -> String {
    let title = escape_markup(title);
    let mut list = String::new();
    for name in files {
        // Writing to a text cannot fail.
        let _ = writeln!(list, "      <file href=\"{}\"/>", escape_markup(name));
    }
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<manifest identifier="gsk980td-{identifier}" version="1.0"
    xmlns="http://www.imsproject.org/xsd/imscp_rootv1p1p2"
    xmlns:adlcp="http://www.adlnet.org/xsd/adlcp_rootv1p2">
  <metadata>
    <schema>ADL SCORM</schema>
    <schemaversion>1.2</schemaversion>
  </metadata>
  <organizations default="course">
    <organization identifier="course">
      <title>{title}</title>
      <item identifier="exercises" identifierref="page" isvisible="true">
        <title>{title}</title>
      </item>
    </organization>
  </organizations>
  <resources>
    <resource identifier="page" type="webcontent" adlcp:scormtype="sco" href="{PAGE_FILE}">
{list}    </resource>
  </resources>
</manifest>
"#
    )
}

/// What a platform stores after a solution was handed in, as JSON for the adapter: `values` by
/// their names, and the last solution as `attempt`.
///
/// A platform computes passed and failed itself if the manifest names a score, also for a
/// learner who is half done. Therefore the page computes both, when all is handed in.
pub fn platform_values(progress: &CourseProgress, last: &ExerciseReport, points: u32) -> Value {
    let state = match progress.state() {
        CourseState::Incomplete => "incomplete",
        CourseState::Completed => "completed",
        CourseState::Passed => "passed",
        CourseState::Failed => "failed",
    };
    let attempts = progress.task(&last.task).map_or(1, |task| task.attempts);
    let id = TaskHash::from_bytes(last.task.as_bytes()).to_string();
    let name = match last.task.bytes().all(is_plain) {
        true => &last.task,
        false => &id,
    };
    let result = match points == last.max_points {
        true => "correct".to_owned(),
        false => points.to_string(),
    };
    json!({
        "values": {
            "cmi.core.score.raw": format_number(progress.score_per_cent()),
            "cmi.core.score.min": "0",
            "cmi.core.score.max": "100",
            "cmi.core.lesson_status": state,
            "cmi.suspend_data": progress.to_text(),
        },
        "attempt": {
            "id": format!("{name}-{attempts}"),
            "type": "performance",
            "weighting": last.max_points.to_string(),
            "student_response": format!("{points}-{}", last.max_points),
            "result": result,
            "latency": format_time_span(last.duration_ms),
        },
    })
}

/// Whether a character is permitted in an identifier of the manifest without escaping.
const fn is_plain(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_')
}

/// Formats a number with at most two decimals.
fn format_number(number: f64) -> String {
    let text = format!("{number:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Formats a time in ms as `HHHH:MM:SS.SS`.
fn format_time_span(time_ms: u64) -> String {
    let (seconds, hundredths) = (time_ms / 1000, time_ms % 1000 / 10);
    let (minutes, hours) = (seconds / 60 % 60, (seconds / 3600).min(9999));
    format!(
        "{hours:04}:{minutes:02}:{:02}.{hundredths:02}",
        seconds % 60
    )
}
