//! Cuts above the limits that a task gives to its lathe.

use gsk_exercise::judge::judge;
use gsk_exercise::solve::{SolutionScript, record_solution};
use gsk_exercise::task::ExerciseTask;

/// A pass of 2 mm with 1.25 mm a turn, more than a nose of 0.4 mm bears, and a bar that is turned.
fn task(load: &str) -> ExerciseTask {
    let text = format!(
        r#"(
        title: (zh: "过载", en: "Overload"), text: (zh: "车削", en: "Turn"),
        begins: (
            referenced: true, offsets: ["1=-160,-220,0.4,3"],
            programs: ["O0030;\nT0101;\nM3S800;\nG0X54Z2;\nG90X46Z-40F1000;\nG0X100Z50;\nM5;\nM30;\n"],
            {load}
        ),
        job: (
            stock: (form: Bar(diameter: 50), face: 0, length: 120, overhang: 70),
            tools: {{ 1: (insert: Turning(letter: C, entering: 95, size: 12.7, nose: 0.4), tip: 3) }},
            zero: (x: -160, z: -220), lengths: {{ 1: (x: 0, z: 0) }},
        ),
        time_limit: 600,
        criteria: [
            (
                id: "size", points: 4, yes: (zh: "合格", en: "good"), no: (zh: "不合格", en: "bad"),
                rule: Diameter((z: -20, size: 46, tolerance: (0.05, -0.05))),
            ),
            (
                id: "broken", points: 1, yes: (zh: "折断", en: "broken"), no: (zh: "完好", en: "whole"),
                rule: Reached(["fault insert-broken on"]),
            ),
        ],
    )"#
    );
    ExerciseTask::read("overload", "task.ron", &text).expect("a task")
}

#[test]
fn a_cut_above_the_limits_breaks_the_insert_in_a_solution() {
    let script = SolutionScript::read("press AUTO\npress CS\nwait 20s\n").expect("a script");
    for (load, points) in [("", 4), ("load: (events: true),", 1)] {
        let task = task(load);
        let recording = record_solution(&task, &script, "test").expect("recorded");
        // The fault is the effect of the cut, so that the recording is one of an operator.
        let report = judge(&task, &recording).expect("judged");
        assert_eq!(report.points, points, "{load}: {report:?}");
    }
    // Only the cut itself breaks the insert.
    let by_hand = SolutionScript::read("fault insert-broken on\n");
    assert!(by_hand.is_err());
}

#[test]
fn a_limit_out_of_range_is_refused() {
    let text = "(title: (zh: \"一\", en: \"a\"), text: (zh: \"一\", en: \"a\"),\n\
                begins: (load: (power_kw: -1)), criteria: [])";
    let error = ExerciseTask::read("a", "task.ron", text).expect_err("a negative power");
    assert!(error.to_string().contains("load.power_kw"), "{error}");
}
