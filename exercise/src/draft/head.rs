//! Writes the head of a drafted task: texts, start state and job.

use std::collections::BTreeMap;

use gsk_core::memory::ToolOffset;
use gsk_core::setup::Setup;
use gsk_core::units::Point;
use gsk_lesson::LessonText;
use gsk_messages::{Language, Message, say};
use gsk_workpiece::job::Job;
use gsk_workpiece::stock::StockForm;

/// The beginning of a task file: control, positions and programs at the start.
pub(super) struct TaskHead<'a> {
    pub(super) title: LessonText,
    pub(super) text: LessonText,
    /// The control whose parameters and offsets the learner gets.
    pub(super) setup: &'a Setup,
    pub(super) job: &'a Job,
    /// Position of the slides at the start, machine coordinates, mm.
    pub(super) slides: Point,
    /// Absolute position that the display shows at the start, mm.
    pub(super) absolute: Point,
    /// Texts of the programs in memory at the start; the first is selected.
    pub(super) programs: Vec<&'a str>,
}

impl TaskHead<'_> {
    /// Writes the beginning of the task file, up to the job.
    pub(super) fn write(&self) -> Result<String, Message> {
        let options = ron::Options::default()
            .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
        let pretty = ron::ser::PrettyConfig::new()
            .depth_limit(2)
            .indentor("    ");
        let job = options.to_string_pretty(self.job, pretty);
        let job = job.map_err(say::as_written)?.replace('\n', "\n    ");
        let memory = &self.setup.memory;
        let offsets: Vec<String> = memory
            .offsets
            .iter()
            .filter(|(number, row)| *number > 0 && **row != ToolOffset::default())
            .map(|(number, row)| format!("\"{number}={},{},{},{}\"", row.x, row.z, row.r, row.t))
            .collect();
        let delivered: BTreeMap<u16, i32> = Setup::delivered().memory.parameters.iter().collect();
        let parameters: Vec<String> = memory
            .parameters
            .iter()
            .filter(|(number, value)| delivered.get(number) != Some(value))
            .map(|(number, value)| format!("\"{number}={value}\""))
            .collect();
        let programs: Vec<String> = self.programs.iter().map(|it| format!("{it:?}")).collect();
        let pair = |point: Point| format!("({}, {})", figure(point.diameter().0), figure(point.z));
        Ok(format!(
            "(\n    title: {},\n    text: {},\n    begins: (\n        referenced: true,\n        \
             slides: {},\n        absolute: {},\n        params: [{}],\n        offsets: [{}],\n        \
             programs: [{}],\n    ),\n    job: {job},\n",
            write_text(&self.title),
            write_text(&self.text),
            pair(self.slides),
            pair(self.absolute),
            parameters.join(", "),
            offsets.join(", "),
            programs.join(", "),
        ))
    }
}

/// Returns the proposed title of a task: to make the part of the program with this number.
pub fn propose_title(program: u16) -> LessonText {
    in_both_languages(&say::exercise_draft_title(program))
}

/// Returns the proposed text of a task in which the learner writes the program. `start` is the
/// absolute position that the display shows at the start.
pub fn propose_text(program: u16, job: &Job, start: Point) -> LessonText {
    let tools: Vec<String> = job.tools.keys().map(|it| format!("T{it:02}")).collect();
    in_both_languages(&say::exercise_draft_text(
        program,
        describe_stock(job),
        tools.join(" "),
        start.diameter().0,
        start.z,
    ))
}

/// The diameters of the stock, as `⌀50` or `⌀50/⌀20`.
fn describe_stock(job: &Job) -> String {
    match &job.stock.form {
        StockForm::Bar { diameter } => format!("⌀{}", figure(diameter.0)),
        StockForm::Tube { diameter, bore } => {
            format!("⌀{}/⌀{}", figure(diameter.0), figure(bore.0))
        }
        StockForm::Contour { corners, .. } => {
            let most = corners.iter().map(|(x, _)| x.0).fold(0.0, f64::max);
            format!("⌀{}", figure(most))
        }
    }
}

/// Returns a message in Chinese and English, as a text of a task.
pub(super) fn in_both_languages(message: &Message) -> LessonText {
    LessonText {
        zh: message.text(Language::Zh),
        en: message.text(Language::En),
    }
}

/// Formats a text as the value of a field in the task file.
pub(super) fn write_text(text: &LessonText) -> String {
    format!("(zh: {:?}, en: {:?})", text.zh, text.en)
}

/// Formats a size as on a drawing, with three decimals at most.
pub(super) fn figure(value: f64) -> String {
    // No negative zero.
    format!("{}", (value * 1000.0).round() / 1000.0 + 0.0)
}
