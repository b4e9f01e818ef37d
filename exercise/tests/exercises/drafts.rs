//! Exercises that are drafted from a program.

use gsk_core::command::ProgramId;
use gsk_core::setup::Setup;
use gsk_exercise::check::{SolutionContent, SolutionFile, check_task};
use gsk_exercise::draft::{ExerciseDraft, draft_exercise};
use gsk_exercise::task::ExerciseTask;
use gsk_workpiece::job::Job;
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::Tool;

/// A shaft of two diameters with a taper; its subprogram makes the last cut.
const PROGRAM: &str = "O0007 (SHAFT);\nG50 X100 Z60;\nT0101 M3 S600 (ROUGH);\nG0 X52 Z2;\n\
     G90 X46 Z-39.8 F200;\nX42;\nG0 X20 Z2;\nG1 Z0 F100;\nX30;\nX40 Z-20;\nM98 P8;\n\
     G0 X100 Z60;\nM5;\nM30;\n";
const SUBPROGRAM: &str = "O0008;\nG1 Z-40;\nX52;\nM99;\n";

fn draft(program: &str) -> Result<ExerciseDraft, String> {
    let mut setup = Setup::delivered();
    let number = setup.memory.programs.store(program.to_owned());
    let number = number.map_err(|alarm| alarm.reason().to_string())?;
    setup.memory.programs.select(ProgramId::Stored(number));
    let stored = setup.memory.programs.store(SUBPROGRAM.to_owned());
    stored.map_err(|alarm| alarm.reason().to_string())?;
    let mut job = Job::new(Stock::bar(50.0, 0.0, 100.0));
    job.tools.insert(1, Tool::turning());
    draft_exercise(&setup, &job).map_err(|why| why.to_string())
}

#[test]
fn a_program_becomes_an_exercise_that_its_own_check_accepts() {
    let draft = draft(PROGRAM).expect("a draft");
    let task = ExerciseTask::read("shaft", "task.ron", &draft.task).expect("a task");
    let solution = |name: &str, text: &str| SolutionFile {
        name: name.to_owned(),
        content: SolutionContent::Script(text.to_owned()),
    };
    let solutions = [
        solution("reference.txt", &draft.reference),
        solution("wrong-1.txt", &draft.wrong),
    ];
    let check = check_task(&task, &solutions);
    assert_eq!(check.faults, [], "{}", draft.task);
    let points: Vec<u32> = check.reports.iter().map(|(_, it)| it.points).collect();
    assert_eq!(points, [task.max_points(), 0]);
    let ids: Vec<&str> = task.criteria.iter().map(|it| it.id.as_str()).collect();
    assert_eq!(
        ids,
        ["angle-14-036", "diameter-40", "length-40", "no-crash"]
    );
    // The learner writes the program; its subprogram is there.
    assert!(!draft.task.contains("O0007 (SHAFT)") && draft.task.contains("O0008"));
    assert!(draft.reference.contains("type T0101M3S600\n"));
}

#[test]
fn a_program_that_cuts_nothing_becomes_no_exercise() {
    let error = draft("O0007;\nG50 X100 Z60;\nG0 X90;\nM30;\n").expect_err("no part");
    assert!(error.contains("cuts nothing"), "{error}");
}
