//! A restart with words of the operator, and one at a line that only calls a program.

use gsk_core::cnc::ControlRequest;
use gsk_core::command::{MoveKind, ProgramId};
use gsk_core::simulation::Simulation;
use gsk_core::units::Feed;
use gsk_messages::{Message, say};
use gsk_runner::machining::Machining;
use gsk_runner::machining::guess::{guess_program_job, practice_job};
use gsk_runner::machining::live_part::LivePart;
use gsk_runner::restart::{
    BlockState, LineWatcher, RestartPlan, RestartWord, RestartWords, find_block, plan_restart,
};

use super::programs::TestProgram;
use super::{AUTO_KEY, RecordedRun, START_KEY, setup};

const TURNED: &str = "O0001;\nG50 X100 Z100;\nG97 G98 S800 M03;\nT0101 M08;\nG00 X52 Z2;\n\
                      G01 X40 F120;\nZ-10;\nX48 F60;\nZ-20;\nG00 X100 Z100 M09;\nM30;\n";
const CALLING: &str = "O0001;\nG50 X100 Z100;\nT0101 S500 M03;\nG00 X52 Z2;\nM98 P31;\n\
                       G00 X60;\nM98 P20031;\nG00 X100 Z100;\nM30;\n";
const CALLED: &str = "O0031;\nG00 U-4;\nG01 W-5 F100;\nG00 U4;\nG00 W5;\nM99;\n";

const fn program(text: &'static str, subprograms: &'static [&'static str]) -> TestProgram {
    TestProgram {
        name: "words",
        text,
        subprograms,
        macro_b: false,
    }
}

/// The machine after power-on, and the state before a line of the program.
fn find_line(program: &TestProgram, line: u32) -> (Simulation, BlockState) {
    let setup = setup(program);
    let job =
        guess_program_job(&setup, &mut |_| true).unwrap_or_else(|| practice_job(&setup.lathe));
    let part = LivePart::new(Machining::new(job));
    let now = Simulation::new(setup);
    let text = now.cnc.programs().get(ProgramId::External).unwrap();
    let mut watcher = LineWatcher::new(ProgramId::External, text, line);
    let found = find_block(&now, Some(part), &mut watcher, None);
    let found = found.unwrap_or_else(|why| panic!("line {line}: {why}"));
    (now, found)
}

fn plan_with(
    (now, found): &(Simulation, BlockState),
    words: &[&str],
) -> Result<RestartPlan, Message> {
    let mut changed = RestartWords::default();
    for word in words {
        changed.set(word)?;
    }
    plan_restart(now, found.part.as_ref(), found, &changed)
}

/// The value of a word before the block, and the one it replaces.
fn listed(plan: &RestartPlan, word: RestartWord) -> Option<(String, Option<String>)> {
    let difference = plan.differences.iter().find(|it| it.word == Some(word));
    difference.map(|it| (it.then.clone(), it.replaced.clone()))
}

/// Executes the plan up to its start point.
fn approach(now: &Simulation, found: &BlockState, plan: RestartPlan) -> RecordedRun {
    let mut run = RecordedRun::new(now.clone(), found.part.clone().unwrap());
    let request = ControlRequest::Restart(plan.restart);
    assert_eq!(run.simulation.cnc.request_refusal(&request), None);
    run.simulation.cnc.request(request).unwrap();
    run.press(AUTO_KEY);
    run.press(START_KEY);
    while run.simulation.cnc.has_restart() || run.simulation.cnc.is_moving() {
        assert!(run.path.len() < 200_000, "no approach");
        run.tick();
    }
    run
}

#[test]
fn changed_words_are_in_force_at_the_block_and_after_it() {
    let at = find_line(&program(TURNED, &[]), 7);
    let plan = plan_with(&at, &["S500", "F80", "M09", "T02"]).unwrap();
    let replaced = |then: &str, by: &str| Some((then.to_owned(), Some(by.to_owned())));
    assert_eq!(listed(&plan, RestartWord::Speed), replaced("500", "800"));
    assert_eq!(listed(&plan, RestartWord::Feed), replaced("80", "120"));
    assert_eq!(listed(&plan, RestartWord::Coolant), replaced("M09", "M08"));
    assert_eq!(listed(&plan, RestartWord::Tool), replaced("0201", "0101"));
    assert_eq!(
        listed(&plan, RestartWord::Spindle),
        Some(("M03".to_owned(), None))
    );
    let (now, found) = &at;
    let mut run = approach(now, found, plan);
    let cnc = &run.simulation.cnc;
    assert_eq!((cnc.tool(), cnc.spindle().s_word()), ((2, 1), 500.0));
    assert!((run.simulation.lathe.spindle_rpm() - 500.0).abs() < 15.0);
    assert!(!run.simulation.lathe.is_coolant_on());
    assert_eq!(run.simulation.lathe.station(), Some(2));
    let first = run.moves.len();
    run.press(START_KEY);
    run.run(600_000);
    assert!(run.is_over);
    // Z-10 with the changed F, then the F of the program.
    let feeds: Vec<Feed> = (run.moves[first..].iter())
        .filter(|it| it.kind == MoveKind::Feed)
        .filter_map(|it| it.feed)
        .collect();
    assert_eq!(feeds, [80.0, 60.0, 60.0].map(Feed::PerMinute));
}

#[test]
fn an_entry_that_is_left_out_keeps_the_value_of_the_machine() {
    let at = find_line(&program(TURNED, &[]), 7);
    let plan = plan_with(&at, &[]).unwrap();
    let keeping = |word| {
        let difference = plan.differences.iter().find(|it| it.word == Some(word));
        difference.unwrap().keeping_word()
    };
    assert_eq!(keeping(RestartWord::Feed), None, "F0 is no feed");
    let (spindle, coolant) = (RestartWord::Spindle, RestartWord::Coolant);
    let words = [spindle, coolant].map(|word| keeping(word).unwrap());
    assert_eq!(words, ["M05", "M09"]);
    let plan = plan_with(&at, &[&words[0], &words[1]]).unwrap();
    let kept = |then: &str, by: &str| Some((then.to_owned(), Some(by.to_owned())));
    assert_eq!(listed(&plan, spindle), kept("M05", "M03"));
    assert_eq!(listed(&plan, coolant), kept("M09", "M08"));
    let run = approach(&at.0, &at.1, plan);
    let lathe = &run.simulation.lathe;
    assert!(!lathe.is_coolant_on());
    assert_eq!(lathe.spindle_rpm(), 0.0);
}

#[test]
fn a_word_that_the_block_cannot_take_is_refused() {
    // X48 F60 has its own F.
    let at = find_line(&program(TURNED, &[]), 8);
    let refusal = |words: &[&str]| plan_with(&at, words).unwrap_err();
    assert_eq!(refusal(&["F80"]), say::restart_feed_is_read());
    assert_eq!(refusal(&["T0203"]), say::restart_offset_stays(1));
    assert_eq!(refusal(&["M30"]), say::restart_word_wrong("M30"));
    // The way is checked with the changed word: the post has four stations.
    let why = refusal(&["T09"]).text(gsk_messages::Language::En);
    assert!(why.contains("way to the start point"), "{why}");
}

#[test]
fn a_confirmation_belongs_to_one_list_of_differences() {
    let at = find_line(&program(TURNED, &[]), 7);
    let code = |words: &[&str]| plan_with(&at, words).unwrap().confirmation_code();
    assert_eq!(code(&[]).len(), 8);
    assert_eq!(code(&[]), code(&[]));
    assert_ne!(code(&[]), code(&["S500"]));
}

#[test]
fn a_line_that_only_calls_restarts_at_the_call() {
    for (line, runs_left) in [(5, 1), (7, 2)] {
        let at = find_line(&program(CALLING, &[CALLED]), line);
        let plan = plan_with(&at, &[]).unwrap();
        assert_eq!(
            (plan.block.program, plan.block.line),
            (ProgramId::Stored(31), 2)
        );
        let calls: Vec<_> = (plan.calls.iter())
            .map(|call| (call.caller, call.caller_line, call.runs_left))
            .collect();
        assert_eq!(calls, [(ProgramId::External, line, runs_left)]);
    }
    // The block before a call is not the call, though it is read together with it.
    let at = find_line(&program(CALLING, &[CALLED]), 4);
    let plan = plan_with(&at, &[]).unwrap();
    assert_eq!(
        (plan.block.program, plan.block.line),
        (ProgramId::External, 4)
    );
}
