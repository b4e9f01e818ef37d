//! Exercises that are drafted from the part in the lathe.

use gsk_core::setup::Setup;
use gsk_core::units::{Diameter, Point};
use gsk_exercise::check::{REFERENCE_RECORDING, SolutionContent, SolutionFile, check_task};
use gsk_exercise::draft::{PartDraft, PickedDimension};
use gsk_exercise::solve::{SolutionScript, make_part, record_solution};
use gsk_exercise::task::ExerciseTask;
use gsk_lesson::LessonText;
use gsk_messages::{Language, say};
use gsk_workpiece::job::Job;
use gsk_workpiece::measure::{Feature, SectionSide, measure_features};
use gsk_workpiece::region::Region;
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::Tool;

use super::{read_file, read_task};

const PROGRAM: &str = "O0022;\nG0X60;\nM30;\n";

/// The part of an exercise that its reference solution makes, and a control to draft from.
fn machine() -> (Setup, Job, Region) {
    let mut setup = Setup::delivered();
    setup.start = Some(Point::from_diameter(Diameter(-60.0), -170.0));
    setup.absolute = Some(Point::from_diameter(Diameter(100.0), 50.0));
    let number = setup.memory.programs.store(PROGRAM.to_owned());
    let number = number.expect("stored");
    let id = gsk_core::command::ProgramId::Stored(number);
    setup.memory.programs.select(id);
    let other = setup.memory.programs.store("O0023;\nM99;\n".to_owned());
    other.expect("stored");
    let mut job = Job::new(Stock::bar(50.0, 0.0, 120.0));
    job.tools.insert(1, Tool::turning());
    let task = read_task("22-roughing-cycle");
    let script = SolutionScript::read(&read_file("22-roughing-cycle", "reference.txt"));
    let part = make_part(&task, &script.expect("a script")).expect("plays");
    (setup, job, part.expect("a part"))
}

fn features(part: &Region) -> Vec<Feature> {
    measure_features(part, SectionSide::Outside)
}

fn text(en: &str) -> LessonText {
    LessonText {
        zh: "题目".to_owned(),
        en: en.to_owned(),
    }
}

fn draft<'a>(
    (setup, job, section): &'a (Setup, Job, Region),
    dimensions: &'a [PickedDimension],
) -> PartDraft<'a> {
    PartDraft {
        title: text("A \"part\""),
        text: text("Turn it."),
        time_limit_min: 20,
        setup,
        job,
        section,
        dimensions,
        gives_program: true,
    }
}

#[test]
fn picked_dimensions_have_the_sizes_of_the_part() {
    let (_, _, part) = machine();
    let picked: Vec<_> = features(&part)
        .iter()
        .map(|it| PickedDimension::from_feature(&part, it))
        .collect();
    assert_eq!(picked[0], None, "lengths begin at the front face");
    let picked: Vec<(String, f64)> = picked
        .into_iter()
        .flatten()
        .map(|it| (it.kind().text(Language::En), it.size))
        .collect();
    for expected in [("Diameter", 24.0), ("Length", 20.0), ("Diameter", 36.0)] {
        let expected = (expected.0.to_owned(), expected.1);
        assert!(picked.contains(&expected), "{expected:?} in {picked:?}");
    }
}

#[test]
fn a_part_becomes_a_task_that_lacks_only_its_reference() {
    let machine = machine();
    let (part, mut dimensions) = (&machine.2, Vec::new());
    for feature in features(part).iter().take(4) {
        dimensions.extend(PickedDimension::from_feature(part, feature));
    }
    dimensions[0].upper = 0.0;
    dimensions[0].lower = -0.021;
    dimensions[0].points = 5;
    let written = draft(&machine, &dimensions).write().expect("a task");
    assert!(written.contains("outline:"), "{written}");
    assert!(written.contains("tolerance: (0, -0.021)"), "{written}");
    assert!(written.find("O0022") < written.find("O0023"), "{written}");
    let task = ExerciseTask::read("mine", "task.ron", &written).expect("a task");
    assert_eq!(task.max_points(), 5 + 2 * (dimensions.len() as u32 - 1));
    assert_eq!(task.title.en, "A \"part\"");
    let check = check_task(&task, &[]);
    assert_eq!(check.faults, [say::exercise_no_reference()]);
    // The learner writes the program himself; the other one is there.
    let mut without = draft(&machine, &dimensions);
    without.gives_program = false;
    let written = without.write().expect("a task");
    assert!(!written.contains("O0022") && written.contains("O0023"));
}

#[test]
fn a_size_that_the_part_does_not_have_leaves_the_drawing_out() {
    let machine = machine();
    let part = &machine.2;
    let mut dimensions: Vec<_> = features(part)
        .iter()
        .filter_map(|it| PickedDimension::from_feature(part, it))
        .take(1)
        .collect();
    dimensions[0].size += 0.5;
    let written = draft(&machine, &dimensions).write().expect("a task");
    assert!(!written.contains("outline:"), "{written}");
    assert_eq!(
        draft(&machine, &[]).write(),
        Err(say::exercise_draft_no_pick())
    );
}

#[test]
fn a_recording_is_a_reference_solution() {
    let task = read_task("22-roughing-cycle");
    let script = read_file("22-roughing-cycle", "reference.txt");
    let script = SolutionScript::read(&script).expect("a script");
    let recording = record_solution(&task, &script, "test").expect("recorded");
    let mut solution = SolutionFile {
        name: REFERENCE_RECORDING.to_owned(),
        content: SolutionContent::Recording(recording.clone()),
    };
    let report = solution.judge(&task).expect("judged");
    assert_eq!(report.points, task.max_points());
    assert_eq!(solution.make_part(&task), make_part(&task, &script));
    let check = check_task(&task, core::slice::from_ref(&solution));
    assert!(!check.faults.contains(&say::exercise_no_reference()));
    solution.content = SolutionContent::Recording(recording[..200].to_vec());
    assert!(solution.judge(&task).is_err());
}

#[test]
fn judging_in_slices_gives_the_same_report() {
    use gsk_exercise::judge::{SlicedJudging, judge};
    use std::sync::Arc;
    let task = Arc::new(read_task("04-spindle"));
    let script = read_file("04-spindle", "wrong-1.txt");
    let script = SolutionScript::read(&script).expect("a script");
    let recording = record_solution(&task, &script, "test").expect("recorded");
    let whole = judge(&task, &recording);
    for slice in [7, 1000, u64::MAX] {
        let mut sliced = SlicedJudging::new(&task, &recording).expect("a recording");
        let mut shares = vec![sliced.progress()];
        while !sliced.advance(slice) {
            shares.push(sliced.progress());
        }
        assert!(shares.is_sorted() && shares[0] == 0.0, "{shares:?}");
        assert!(shares.iter().all(|share| *share <= 1.0));
        assert_eq!(sliced.finish(), whole, "slices of {slice} ticks");
    }
    // What a damaged recording is refused for is the same, too.
    for length in [recording.len() / 2, recording.len() - 3] {
        let damaged = &recording[..length];
        let mut sliced = SlicedJudging::new(&task, damaged).expect("a recording");
        while !sliced.advance(50_000) {}
        assert_eq!(sliced.finish(), judge(&task, damaged));
    }
}
