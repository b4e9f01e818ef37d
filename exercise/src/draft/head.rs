//! Writes the head of a drafted task: texts, start state and job.

use std::collections::BTreeMap;

use gsk_core::memory::ToolOffset;
use gsk_core::setup::Setup;
use gsk_core::units::Point;
use gsk_lesson::LessonText;
use gsk_messages::{Language, Message, say};
use gsk_workpiece::job::Job;
use gsk_workpiece::stock::StockForm;

/// What the head of a task contains.
pub(super) struct TaskHead<'a> {
    pub(super) title: LessonText,
    pub(super) text: LessonText,
    /// The control whose parameters and offsets the learner gets.
    pub(super) setup: &'a Setup,
    pub(super) job: &'a Job,
    /// Position of the slides, machine coordinates.
    pub(super) slides: Point,
    /// What the display shows there.
    pub(super) absolute: Point,
    /// Texts of the stored programs; the first is selected.
    pub(super) programs: Vec<&'a str>,
}

impl TaskHead<'_> {
    /// Writes the head up to the job.
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

/// Proposes the title of a task: the part of a program.
pub fn propose_title(program: u16) -> LessonText {
    in_both_languages(&say::exercise_draft_title(program))
}

/// Proposes the text of a task: the learner writes the program. `start` is what the display
/// shows at the start.
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

/// Returns a message as a text of a task.
pub(super) fn in_both_languages(message: &Message) -> LessonText {
    LessonText {
        zh: message.text(Language::Zh),
        en: message.text(Language::En),
    }
}

/// Writes a text as a field of a task.
pub(super) fn write_text(text: &LessonText) -> String {
    format!("(zh: {:?}, en: {:?})", text.zh, text.en)
}

/// Rounds a size as a drawing has it.
pub(super) fn figure(value: f64) -> String {
    // No negative zero.
    format!("{}", (value * 1000.0).round() / 1000.0 + 0.0)
}
