//! Summarizes a program when it is opened: machine time, tools, extent of the cuts, first
//! alarm.

use gsk_core::alarm::Alarm;
use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::preview::{
    Caution, PathBounds, Preview, PreviewEnd, PreviewProgress, preview_beyond_alarms,
    preview_with_progress,
};
use gsk_core::setup::Setup;
use gsk_core::units::Point;
use gsk_messages::{Language, say};

use crate::move_output::diameter_z;
use crate::report::AlarmReport;
use crate::text_format::format_whole_seconds;
use crate::times::ProgramTimes;

/// Margin around the cuts in the range for the graphic page, mm.
const MARGIN_MM: f64 = 5.0;

/// The result of the preview of a program: its end, time, tools and bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramSummary {
    /// Name of the program: the number, or the name of the program file.
    pub name: String,
    /// How the preview ended: at the program end, with an alarm, or at a limit.
    pub end: PreviewEnd,
    /// Machine time up to the end of the preview, s.
    pub time_s: f64,
    /// Number of tools that cut.
    pub cutting_tools: usize,
    /// Bounds of the cuts, in program coordinates, mm; `None` without cuts.
    pub cut_bounds: Option<PathBounds>,
    /// The alarm that ended the program, with texts in Chinese and English; `None` without an
    /// alarm.
    alarm: Option<[AlarmReport; 2]>,
}

/// Previews the selected program of a set-up once. `can_continue` receives the progress and
/// returns false to cancel.
pub fn summarize(
    name: String,
    setup: &Setup,
    can_continue: &mut dyn FnMut(&PreviewProgress) -> bool,
) -> ProgramSummary {
    let mut totals = MoveTotals::default();
    let programs = &setup.memory.programs;
    let preview =
        preview_with_progress(setup, programs, &mut |it| totals.add_move(it), can_continue);
    totals.into_summary(name, setup, &preview)
}

/// Previews like [`summarize`], but continues after alarms. Also returns all alarms, in their
/// order, and the likely mistakes.
pub fn summarize_past_alarms(
    name: String,
    setup: &Setup,
    can_continue: &mut dyn FnMut(&PreviewProgress) -> bool,
) -> (ProgramSummary, Vec<Alarm>, Vec<Caution>) {
    let mut totals = MoveTotals::default();
    let programs = &setup.memory.programs;
    let preview =
        preview_beyond_alarms(setup, programs, &mut |it| totals.add_move(it), can_continue);
    let further = preview.further.alarms.iter();
    let alarms = preview.alarm.iter().chain(further).cloned().collect();
    let summary = totals.into_summary(name, setup, &preview);
    (summary, alarms, preview.cautions)
}

/// Sums over the moves of a preview: times, and bounds of the cuts.
#[derive(Debug, Default)]
struct MoveTotals {
    times: ProgramTimes,
    cut_bounds: Option<PathBounds>,
}

impl MoveTotals {
    fn add_move(&mut self, executed: &ExecutedMove) {
        self.times.add_move(executed);
        if !matches!(executed.kind, MoveKind::Rapid | MoveKind::Dwell) {
            PathBounds::extend_by_move(&mut self.cut_bounds, executed);
        }
    }

    fn into_summary(self, name: String, setup: &Setup, preview: &Preview) -> ProgramSummary {
        let programs = &setup.memory.programs;
        let alarm_reports = |alarm: &Alarm| {
            [Language::Zh, Language::En]
                .map(|language| AlarmReport::new(alarm, programs, Some(language)))
        };
        let tools = self.times.tools().iter();
        ProgramSummary {
            name,
            end: preview.end,
            time_s: preview.time_s,
            cutting_tools: tools.filter(|time| time.times.cutting_s() > 0.0).count(),
            cut_bounds: self.cut_bounds,
            alarm: preview.alarm.as_ref().map(alarm_reports),
        }
    }
}

impl ProgramSummary {
    /// Whether an alarm ended the program.
    pub const fn has_alarm(&self) -> bool {
        self.alarm.is_some()
    }

    /// Least and greatest point of the cuts with a margin of 5 mm; X is a radius. `None` for a
    /// program without cuts, and for a preview that reached its limit.
    pub fn cut_extents(&self) -> Option<(Point, Point)> {
        let margin = Point::new(MARGIN_MM, MARGIN_MM);
        self.cut_bounds
            .filter(|_| self.end != PreviewEnd::Limit)
            .map(|cuts| (cuts.least - margin, cuts.greatest + margin))
    }

    /// The summary as one line of text: `O0002, 3:27, 4 tools, cuts X 20 to 60, Z -80 to 5, no
    /// alarm`, or the block that raises the alarm.
    pub fn summary_line(&self, language: Language) -> String {
        if let Some([chinese, english]) = &self.alarm {
            let (alarm, separator) = match language {
                Language::Zh => (chinese, "；"),
                Language::En => (english, "; "),
            };
            let sentence = alarm.sentence(Some(language));
            let sentence = sentence.lines().map(str::trim).collect::<Vec<_>>();
            return say::first_look_alarm(&self.name, sentence.join(separator)).text(language);
        }
        let tools = match self.cutting_tools {
            0 => say::first_look_no_tool(),
            1 => say::first_look_one_tool(),
            tools => say::first_look_tools(tools),
        };
        let reach = self.cut_bounds.map(|cuts| {
            let ((x_least, z_least), (x_most, z_most)) =
                (diameter_z(cuts.least), diameter_z(cuts.greatest));
            say::first_look_reach(x_least, x_most, z_least, z_most).text(language)
        });
        let time = format_whole_seconds(self.time_s);
        let reach = reach.unwrap_or_default();
        let line = match self.name.is_empty() {
            true => say::first_look_unnamed(time, tools, reach),
            false => say::first_look(&self.name, time, tools, reach),
        };
        line.text(language)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::program::Program;

    fn summarize_text(text: &str) -> ProgramSummary {
        let mut setup = Setup::default();
        setup.memory.programs.open_external(Program::new(text));
        let most = |progress: &PreviewProgress| progress.moves < 10_000;
        summarize("O0002".to_owned(), &setup, &mut { most })
    }

    #[test]
    fn one_line_says_what_a_program_does() {
        let text = "O0002\nT0101 M03 S800\nG00 X40 Z5\nG01 Z-30 F100\nG00 X200\nT0202\nG00 X50 Z2\n\
                    G01 Z-80\nX60\nG00 X200 Z200\nM30\n";
        let look = summarize_text(text);
        let line = look.summary_line(Language::En);
        assert!(line.starts_with("O0002, 1:"), "{line}");
        let rest = ", 2 tools, cuts X 40 to 60, Z -80 to 5, no alarm";
        assert!(line.ends_with(rest), "{line}");
        let zh = look.summary_line(Language::Zh);
        assert!(zh.contains("2 把刀") && zh.ends_with("无报警"), "{zh}");
        let (least, greatest) = look.cut_extents().expect("cuts");
        assert_eq!((least.x, least.z), (15.0, -85.0));
        assert_eq!((greatest.x, greatest.z), (35.0, 10.0));
    }

    #[test]
    fn the_line_of_a_text_without_a_number_begins_with_its_time() {
        let unnamed = ProgramSummary {
            name: String::new(),
            ..summarize_text("G00 X10\nM30\n")
        };
        for language in [Language::En, Language::Zh] {
            let line = unnamed.summary_line(language);
            assert!(line.starts_with("0:0"), "{line}");
        }
    }

    #[test]
    fn an_alarm_is_named_with_its_block() {
        let look = summarize_text("O0002\nG00 X40 Z5\nG01 Z-30\nM30\n");
        assert!(look.has_alarm());
        let line = look.summary_line(Language::En);
        assert!(line.starts_with("O0002: P/S 011 "), "{line}");
        assert!(line.contains("line 3: G01 Z-30"), "{line}");
        assert_ne!(line, look.summary_line(Language::Zh));
    }

    #[test]
    fn an_arc_counts_as_far_as_it_bulges() {
        let look = summarize_text("G00 X20 Z0\nG03 X20 Z-20 R10 F100\nM30\n");
        let cuts = look.cut_bounds.expect("cuts");
        assert!((cuts.greatest.x - 20.0).abs() < 1e-6, "{cuts:?}");
    }

    #[test]
    fn without_cuts_or_end_there_are_no_extents() {
        let look = summarize_text("G00 X10\nM30\n");
        assert_eq!(look.cut_extents(), None);
        assert!(
            look.summary_line(Language::En).contains("no cut"),
            "{look:?}"
        );
        let endless = summarize_text("N1 G01 U0.001 F6000\nG01 U-0.001\nG65 H80 P1\n");
        assert_eq!(
            (endless.end, endless.cut_extents()),
            (PreviewEnd::Limit, None)
        );
    }
}
