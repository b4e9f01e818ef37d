//! Altered results are refused, or marked as what they are.

use gsk_core::cnc::ControlRequest;
use gsk_core::machine::LatheFault;
use gsk_exercise::judge::judge;
use gsk_exercise::mark::{ResultMark, flag_repetitions, mark_result};
use gsk_exercise::mark_table::{MarkFormat, MarkTable};
use gsk_exercise::report::ExerciseReport;
use gsk_exercise::result_file::{ResultAuthor, write_result};
use gsk_exercise::seal::SealKey;
use gsk_exercise::solve::{SolutionScript, record_solution};
use gsk_exercise::task::ExerciseTask;
use gsk_history::moment::HistoryInput;
use gsk_history::recording::{RecordingEncoder, RecordingEvent, RecordingReader};
use gsk_messages::Language;
use gsk_panel::emulator::EmulatorInput;

use super::{read_file, read_task};

/// Numbers that look random and are the same in every run (xorshift).
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % limit as u64) as usize
    }
}

struct Solved {
    task: ExerciseTask,
    recording: Vec<u8>,
    report: ExerciseReport,
}

fn solve(name: &str, script: &str) -> Solved {
    let task = read_task(name);
    let script = SolutionScript::read(&read_file(name, script)).expect("a script");
    let recording = record_solution(&task, &script, "test").expect("recorded");
    let report = judge(&task, &recording).expect("judged");
    Solved {
        task,
        recording,
        report,
    }
}

fn seal(report: ExerciseReport, recording: &[u8], seed: u8) -> Vec<u8> {
    let author = ResultAuthor {
        program: "test".to_owned(),
        learner: "Anna".to_owned(),
        hints: Vec::new(),
        exam: None,
    };
    let key = SealKey::from_random(&[seed; 32], [seed; 8]);
    write_result(author, report, recording, &key).expect("a result")
}

fn mark(solved: &Solved, bytes: &[u8]) -> ResultMark {
    mark_result("anna.gskresult", bytes, core::slice::from_ref(&solved.task))
}

/// Alters bytes of a file: a bit, a byte, a piece that is removed, doubled or cut off.
fn alter_bytes(bytes: &[u8], numbers: &mut Numbers) -> Vec<u8> {
    let mut altered = bytes.to_vec();
    let at = numbers.below(bytes.len());
    let length = 1 + numbers.below(40);
    let end = (at + length).min(bytes.len());
    match numbers.below(5) {
        0 => altered[at] ^= 1 << numbers.below(8),
        1 => altered[at] = altered[at].wrapping_add(1 + numbers.below(255) as u8),
        2 => drop(altered.drain(at..end)),
        3 => altered
            .splice(at..at, bytes[at..end].to_vec())
            .for_each(drop),
        _ => altered.truncate(at),
    }
    altered
}

/// Claims another result in the report.
fn alter_report(report: &ExerciseReport, numbers: &mut Numbers) -> ExerciseReport {
    let mut altered = report.clone();
    let index = numbers.below(altered.verdicts.len());
    let verdict = &mut altered.verdicts[index];
    match numbers.below(4) {
        0 => verdict.is_met = !verdict.is_met,
        1 => verdict.points += 1,
        2 => altered.points += 1 + numbers.below(9) as u32,
        _ => altered.duration_ms += 1,
    }
    altered
}

fn events(recording: &[u8]) -> Vec<RecordingEvent> {
    let mut reader = RecordingReader::new(recording).expect("a recording");
    let mut events = Vec::new();
    while let Some(event) = reader.next_event().expect("an event") {
        events.push(event);
    }
    events
}

fn encode(events: &[RecordingEvent]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = RecordingEncoder::new(&mut bytes);
    for event in events {
        encoder.encode(event, &mut bytes).expect("encoded");
    }
    bytes
}

/// Alters the recorded session and writes it with valid checks.
fn alter_session(recording: &[u8], numbers: &mut Numbers) -> Vec<u8> {
    let mut events = events(recording);
    let is_input = |event: &RecordingEvent| matches!(event, RecordingEvent::Input(_));
    let inputs: Vec<usize> = (0..events.len())
        .filter(|at| is_input(&events[*at]))
        .collect();
    let at = inputs[numbers.below(inputs.len())];
    let other = match numbers.below(3) {
        0 => EmulatorInput::Fault(LatheFault::DriveX, true),
        1 => EmulatorInput::ClearFaults,
        _ => EmulatorInput::Request(Box::new(ControlRequest::StoreProgram("O1;".to_owned()))),
    };
    match numbers.below(4) {
        // An input less, with the hashes of the whole session.
        0 => drop(events.remove(at)),
        1 => {
            if let RecordingEvent::Input(recorded) = &mut events[at] {
                recorded.input = HistoryInput::Machine(other);
            }
        }
        2 => {
            let state = events
                .iter()
                .find(|it| matches!(it, RecordingEvent::State { .. }));
            let state = state.expect("a state").clone();
            events.insert(at, state);
        }
        _ => events.truncate(at),
    }
    encode(&events)
}

#[test]
fn a_result_is_marked_as_it_was_solved() {
    let solved = solve("04-spindle", "reference.txt");
    let full = mark(&solved, &seal(solved.report.clone(), &solved.recording, 1));
    assert!(full.flags.is_empty(), "{:?}", full.flags);
    assert_eq!(full.points(), solved.task.max_points());
    let wrong = solve("04-spindle", "wrong-1.txt");
    let less = mark(&wrong, &seal(wrong.report.clone(), &wrong.recording, 1));
    assert!(less.flags.is_empty(), "{:?}", less.flags);
    assert!(less.points() < wrong.task.max_points());
}

#[test]
fn a_measured_value_with_seventeen_digits_is_no_alteration() {
    // The taper has an angle that a reader of JSON rounds differently.
    let solved = solve("19-taper", "reference.txt");
    let measured = |report: &ExerciseReport| report.verdicts[0].evidence.measured;
    assert!(measured(&solved.report).is_some_and(|angle| angle.to_string().len() > 16));
    let honest = mark(&solved, &seal(solved.report.clone(), &solved.recording, 1));
    assert!(honest.flags.is_empty(), "{:?}", honest.flags);
    let mut altered = solved.report.clone();
    altered.verdicts[0].evidence.measured = measured(&solved.report).map(|angle| angle + 1e-9);
    let altered = mark(&solved, &seal(altered, &solved.recording, 1));
    assert_eq!(altered.flags.len(), 1, "{:?}", altered.flags);
}

#[test]
fn two_hundred_altered_results_are_flagged() {
    let solved = solve("04-spindle", "wrong-1.txt");
    let honest = seal(solved.report.clone(), &solved.recording, 1);
    let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15);
    let mut without_effect = 0;
    for round in 0..200 {
        // The forger has a key, so a seal over his file is valid.
        let altered = match round % 4 {
            0 | 1 => alter_bytes(&honest, &mut numbers),
            2 => seal(
                alter_report(&solved.report, &mut numbers),
                &solved.recording,
                2,
            ),
            _ => {
                let session = alter_session(&solved.recording, &mut numbers);
                seal(solved.report.clone(), &session, 2)
            }
        };
        if altered == honest {
            continue;
        }
        let mark = mark(&solved, &altered);
        assert!(
            mark.points() <= solved.report.points,
            "round {round} gains points"
        );
        if mark.flags.is_empty() {
            // A key less that changes nothing: `S600M3` can be entered as one line or as two. The
            // altered session is another way to the same state, and is marked as such.
            assert_eq!(round % 4, 3, "round {round} is not noticed");
            assert_eq!(mark.report.as_ref(), Some(&solved.report), "round {round}");
            without_effect += 1;
        }
    }
    assert!(without_effect <= 2, "{without_effect} of 50 sessions");
}

#[test]
fn a_solution_of_another_task_and_a_foreign_task_are_refused() {
    let solved = solve("04-spindle", "reference.txt");
    let other = read_task("06-mdi-move");
    assert!(judge(&other, &solved.recording).is_err());
    let mut claims = solved.report.clone();
    claims.task = "99-unknown".to_owned();
    let mark = mark(&solved, &seal(claims, &solved.recording, 1));
    assert_eq!((mark.flags.len(), mark.points()), (1, 0));
}

#[test]
fn copies_and_too_many_attempts_are_flagged() {
    let solved = solve("04-spindle", "reference.txt");
    let bytes = seal(solved.report.clone(), &solved.recording, 1);
    let mut marks: Vec<ResultMark> = (0..5).map(|_| mark(&solved, &bytes)).collect();
    flag_repetitions(&mut marks);
    let flags: Vec<usize> = marks.iter().map(|mark| mark.flags.len()).collect();
    assert_eq!(flags, [0, 1, 1, 2, 2], "the task permits three");
    let table = MarkTable {
        marks: &marks,
        tasks: core::slice::from_ref(&solved.task),
        language: Language::En,
    };
    let text = table.write(MarkFormat::Text);
    assert_eq!(text.lines().count(), 6, "{text}");
    assert!(
        table
            .write(MarkFormat::Csv)
            .contains("anna.gskresult,Anna,04-spindle,10,10,")
    );
    assert!(
        table
            .write(MarkFormat::Html)
            .contains("<tr class=\"flagged\">")
    );
    let statements = table.write(MarkFormat::Xapi);
    assert!(statements.contains("\"homePage\": \"https://gsk980td.invalid\""));
    assert_eq!(
        statements.matches("\"scaled\": 1.0").count(),
        statements.matches("\"id\": \"urn:").count()
    );
    let json = table.write(MarkFormat::Json);
    assert!(
        json.contains("\"sentence\": \"The spindle was stopped after it had run.\""),
        "{json}"
    );
}
