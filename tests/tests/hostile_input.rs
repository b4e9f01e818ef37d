//! Checks that no text panics the program or hangs it.

use gsk_core::preview::{
    FurtherAlarms, MAX_FURTHER_ALARMS, PreviewEnd, preview, preview_beyond_alarms,
};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::{Simulation, StopCondition};
use gsk_panel::script::Script;
use gsk_tests::setup;
use proptest::prelude::*;

/// Words that look like a program, and words that break one.
fn any_word() -> impl Strategy<Value = String> {
    prop_oneof![
        6 => "[GMTSNXZUWRIKFPQLO][0-9]{1,3}",
        4 => "[XZUWRIKF]-?[0-9]{1,3}\\.[0-9]{0,3}",
        2 => "G(00|01|02|03|04|28|50|90|94|96|97|98|99)",
        1 => "M(98 P[0-9]{1,8}|99|30|00)",
        1 => "[A-Z]",
        1 => "[;%/()*#.+-]",
        1 => "\\PC{1,3}",
        1 => "[0-9]{1,40}",
    ]
}

fn any_text() -> impl Strategy<Value = String> {
    let line = proptest::collection::vec(any_word(), 0..6).prop_map(|words| words.join(" "));
    proptest::collection::vec(line, 0..12).prop_map(|lines| lines.join("\n"))
}

fn start(text: &str) -> Setup {
    let mut start = Setup::default();
    start.memory.programs.open_external(Program::new(text));
    start
        .memory
        .programs
        .select(gsk_core::command::ProgramId::External);
    start
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_can_be_checked(text in any_text()) {
        let start = start(&text);
        let seen = preview(&start, &start.memory.programs, &mut |executed| {
            assert!(executed.to.x.is_finite() && executed.to.z.is_finite());
        });
        prop_assert!(seen.time_s.is_finite());
        prop_assert_eq!(seen.end == PreviewEnd::Alarm, seen.alarm.is_some());
        let mut beyond = preview_beyond_alarms(&start, &start.memory.programs, &mut |_| {}, &mut |at| {
            at.motionless < 100_000
        });
        let further = core::mem::take(&mut beyond.further);
        prop_assert!(further.alarms.len() <= MAX_FURTHER_ALARMS);
        prop_assert!(seen.alarm.is_some() || further == FurtherAlarms::default());
        prop_assert_eq!(&beyond.cautions[..seen.cautions.len()], &seen.cautions[..]);
        beyond.cautions.truncate(seen.cautions.len());
        if seen.end != PreviewEnd::Limit {
            prop_assert_eq!(beyond, seen, "what is up to the alarm stays");
        }
    }

    #[test]
    fn any_text_can_be_executed(text in any_text()) {
        let mut simulation = Simulation::new(start(&text));
        simulation.start_automatic();
        simulation.run_until(StopCondition::Stopped, 300);
        let position = simulation.cnc.position_machine();
        prop_assert!(position.x.is_finite() && position.z.is_finite());
    }

    #[test]
    fn any_text_can_be_stored_or_is_refused(text in "\\PC{0,200}") {
        let _ = setup::build_memory(&[text]);
    }

    #[test]
    fn any_text_can_be_read_as_a_script(text in "(press|hold|wait|expect|set|turn|@[0-9]{1,30}| |\\PC){0,12}") {
        let _ = Script::parse(&text);
    }
}

#[test]
fn files_without_a_program_are_refused() {
    let lines = "X".repeat(100_000);
    for text in [
        "",
        "\n\n\n",
        "%",
        "%\n%",
        "\u{0}\u{1}\u{7f}",
        ";;;;",
        "(",
        ")",
        "O",
        "O99999",
        &lines,
    ] {
        let start = start(text);
        let seen = preview(&start, &start.memory.programs, &mut |_| {});
        assert!(
            matches!(seen.end, PreviewEnd::Text | PreviewEnd::Alarm),
            "{:.20?}: {:?}",
            text,
            seen.end
        );
    }
}

#[test]
fn loops_without_motion_end() {
    for text in ["M99", "O1\nG98\nM99", "N1 M99 P1"] {
        let start = start(text);
        let seen = preview(&start, &start.memory.programs, &mut |_| {});
        assert!(
            matches!(seen.end, PreviewEnd::M99 | PreviewEnd::Limit),
            "{text}: {:?}",
            seen.end
        );
    }
    let texts = [
        "O1\nM98 P99990002\nM30".to_owned(),
        "O2\nM98 P99990003\nM99".to_owned(),
        "O3\nG98\nM99".to_owned(),
    ];
    let mut start = Setup::default();
    start.memory.programs = setup::build_memory(&texts).expect("programs");
    let seen = preview(&start, &start.memory.programs, &mut |_| {});
    assert_eq!(seen.end, PreviewEnd::Limit);
}
