//! Summarizes a program when it is opened: machine time, tools, extent of the cuts, first
//! alarm.

use gsk_core::alarm::Alarm;
use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::preview::{
    Bounds, Caution, End, Preview, Progress, preview_beyond_alarms, preview_while,
};
use gsk_core::setup::Setup;
use gsk_core::units::Point;
use gsk_messages::{Language, say};

use crate::moves::diameter_z;
use crate::report::AlarmReport;
use crate::times::Times;
use crate::words::clock_in_seconds;

/// Margin around the cuts on the graphic page, mm.
const MARGIN: f64 = 5.0;

/// The summary of a program from one preview.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstLook {
    /// Name of the program: its number, or the name of its file.
    pub name: String,
    /// How the preview ended.
    pub end: End,
    /// Machine time up to the end, s.
    pub time_s: f64,
    /// Number of tools that cut.
    pub tools: usize,
    /// Bounds of the cuts, in program coordinates; `None` without cuts.
    pub cuts: Option<Bounds>,
    /// The alarm that ended the program, in Chinese and English.
    alarm: Option<[AlarmReport; 2]>,
}

/// Previews the selected program of a set-up once. `goes_on` is called with the progress; it
/// returns false to cancel.
pub fn look(name: String, setup: &Setup, goes_on: &mut dyn FnMut(&Progress) -> bool) -> FirstLook {
    let mut seen = Seen::default();
    let programs = &setup.memory.programs;
    let preview = preview_while(setup, programs, &mut |it| seen.take(it), goes_on);
    seen.into_look(name, setup, &preview)
}

/// Like [`look`], but continues after alarms. Also returns all alarms, in their order, and the
/// likely mistakes.
pub fn look_beyond(
    name: String,
    setup: &Setup,
    goes_on: &mut dyn FnMut(&Progress) -> bool,
) -> (FirstLook, Vec<Alarm>, Vec<Caution>) {
    let mut seen = Seen::default();
    let programs = &setup.memory.programs;
    let preview = preview_beyond_alarms(setup, programs, &mut |it| seen.take(it), goes_on);
    let further = preview.further.alarms.iter();
    let alarms = preview.alarm.iter().chain(further).cloned().collect();
    let look = seen.into_look(name, setup, &preview);
    (look, alarms, preview.cautions)
}

/// What the summary adds up from the moves.
#[derive(Debug, Default)]
struct Seen {
    times: Times,
    cuts: Option<Bounds>,
}

impl Seen {
    fn take(&mut self, executed: &ExecutedMove) {
        self.times.push(executed);
        if !matches!(executed.kind, MoveKind::Rapid | MoveKind::Dwell) {
            Bounds::widen(&mut self.cuts, executed);
        }
    }

    fn into_look(self, name: String, setup: &Setup, preview: &Preview) -> FirstLook {
        let programs = &setup.memory.programs;
        let told = |alarm: &Alarm| {
            [Language::Zh, Language::En]
                .map(|language| AlarmReport::new(alarm, programs, Some(language)))
        };
        let tools = self.times.tools().iter();
        FirstLook {
            name,
            end: preview.end,
            time_s: preview.time_s,
            tools: tools.filter(|time| time.spent.cutting() > 0.0).count(),
            cuts: self.cuts,
            alarm: preview.alarm.as_ref().map(told),
        }
    }
}

impl FirstLook {
    /// Whether an alarm ended the program.
    pub const fn has_alarm(&self) -> bool {
        self.alarm.is_some()
    }

    /// Least and greatest point of the cuts with a margin of 5 mm. `None` for a program
    /// without cuts, and for a preview that reached its limit.
    pub fn extents(&self) -> Option<(Point, Point)> {
        let margin = Point::new(MARGIN, MARGIN);
        self.cuts
            .filter(|_| self.end != End::Limit)
            .map(|cuts| (cuts.least - margin, cuts.greatest + margin))
    }

    /// One line of text: `O0002, 3:27, 4 tools, X 20–60, Z -80–5, no alarm`, or the block that
    /// raises the alarm.
    pub fn line(&self, language: Language) -> String {
        if let Some([chinese, english]) = &self.alarm {
            let alarm = match language {
                Language::Zh => chinese,
                Language::En => english,
            };
            let sentence = alarm.sentence(Some(language));
            let sentence = sentence.lines().map(str::trim).collect::<Vec<_>>();
            return say::first_look_alarm(&self.name, sentence.join("; ")).text(language);
        }
        let tools = match self.tools {
            0 => say::first_look_no_tool(),
            1 => say::first_look_one_tool(),
            tools => say::first_look_tools(tools),
        };
        let reach = self.cuts.map(|cuts| {
            let ((x_least, z_least), (x_most, z_most)) =
                (diameter_z(cuts.least), diameter_z(cuts.greatest));
            say::first_look_reach(x_least, x_most, z_least, z_most).text(language)
        });
        let time = clock_in_seconds(self.time_s);
        let line = say::first_look(&self.name, time, tools, reach.unwrap_or_default());
        line.text(language)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::program::Program;

    fn look_at(text: &str) -> FirstLook {
        let mut setup = Setup::default();
        setup.memory.programs.open_external(Program::new(text));
        let most = |progress: &Progress| progress.moves < 10_000;
        look("O0002".to_owned(), &setup, &mut { most })
    }

    #[test]
    fn one_line_says_what_a_program_does() {
        let text = "O0002\nT0101 M03 S800\nG00 X40 Z5\nG01 Z-30 F100\nG00 X200\nT0202\nG00 X50 Z2\n\
                    G01 Z-80\nX60\nG00 X200 Z200\nM30\n";
        let look = look_at(text);
        let line = look.line(Language::En);
        assert!(line.starts_with("O0002, 1:"), "{line}");
        let rest = ", 2 tools, X 40–60, Z -80–5, no alarm";
        assert!(line.ends_with(rest), "{line}");
        let zh = look.line(Language::Zh);
        assert!(zh.contains("2 把刀") && zh.ends_with("无报警"), "{zh}");
        let (least, greatest) = look.extents().expect("cuts");
        assert_eq!((least.x, least.z), (15.0, -85.0));
        assert_eq!((greatest.x, greatest.z), (35.0, 10.0));
    }

    #[test]
    fn an_alarm_is_named_with_its_block() {
        let look = look_at("O0002\nG00 X40 Z5\nG01 Z-30\nM30\n");
        assert!(look.has_alarm());
        let line = look.line(Language::En);
        assert!(line.starts_with("O0002: P/S 011 "), "{line}");
        assert!(line.contains("line 3: G01 Z-30"), "{line}");
        assert_ne!(line, look.line(Language::Zh));
    }

    #[test]
    fn an_arc_counts_as_far_as_it_bulges() {
        let look = look_at("G00 X20 Z0\nG03 X20 Z-20 R10 F100\nM30\n");
        let cuts = look.cuts.expect("cuts");
        assert!((cuts.greatest.x - 20.0).abs() < 1e-6, "{cuts:?}");
    }

    #[test]
    fn without_cuts_or_end_there_are_no_extents() {
        let look = look_at("G00 X10\nM30\n");
        assert_eq!(look.extents(), None);
        assert!(look.line(Language::En).contains("no cut"), "{look:?}");
        let endless = look_at("N1 G01 U0.001 F6000\nG01 U-0.001\nG65 H80 P1\n");
        assert_eq!((endless.end, endless.extents()), (End::Limit, None));
    }
}
