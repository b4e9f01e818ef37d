//! Checks that the sample programs do what their comments describe, on both paths.

use gsk_core::model::{ControlModel, ModelId};
use gsk_core::setup::Setup;
use gsk_tests::execute::{PathResult, run_check, run_kernel};
use gsk_tests::{repository, setup};

fn start_setup(names: &[&str]) -> Setup {
    let folder = repository().join("assets/programs");
    let texts: Vec<String> = names
        .iter()
        .map(|name| std::fs::read_to_string(folder.join(name)).expect(name))
        .collect();
    let mut start = Setup::default();
    start.memory.programs = setup::build_memory(&texts).expect("programs");
    start
}

fn run_both_paths(names: &[&str]) -> [PathResult; 2] {
    let start = start_setup(names);
    [run_check(&start), run_kernel(&start)]
}

#[test]
fn clean_samples_end_at_their_start_point() {
    for (names, stops) in [
        (&["01-stepped-shaft.CNC"][..], 0),
        (&["02-bushing.CNC"], 0),
        (&["03-grooved-pin.CNC", "O1031.CNC"], 1),
    ] {
        for seen in run_both_paths(names) {
            assert_eq!(seen.result["end"], "M30", "{names:?}: {}", seen.result);
            assert_eq!(seen.result["parts"], 1, "{names:?}");
            assert_eq!(seen.result["stops"], stops, "{names:?}");
            assert_eq!(
                seen.result["final"]["abs"],
                serde_json::json!([120.0, 150.0])
            );
            assert_eq!(
                seen.result["final"]["machine"],
                serde_json::json!([300.0, 300.0])
            );
        }
    }
}

#[test]
fn the_example_of_the_manual_clamps_turns_and_releases() {
    let start = start_setup(&["04-manual-example.CNC"]);
    for seen in [run_check(&start), run_kernel(&start)] {
        assert_eq!(seen.result["alarm"]["number"], 1013, "no chuck");
        assert_eq!(seen.result["alarm"]["line"], 4);
    }
    let start = start.with_chuck();
    for seen in [run_check(&start), run_kernel(&start)] {
        assert_eq!(seen.result["end"], "M30", "{}", seen.result);
        assert_eq!(
            seen.result["final"]["abs"],
            serde_json::json!([150.0, 185.0])
        );
        assert_eq!(seen.result["stops"], 0);
        let threads = seen.moves.iter().filter(|one| one["kind"] == "thread");
        assert_eq!(threads.count(), 3);
    }
}

#[test]
fn check_and_run_see_the_same_moves() {
    for names in [
        &["01-stepped-shaft.CNC"][..],
        &["03-grooved-pin.CNC", "O1031.CNC"],
    ] {
        let [checked, executed] = run_both_paths(names);
        let without_time = |seen: &PathResult| {
            let moves = seen.moves.iter().cloned().map(|mut executed| {
                executed["t"] = serde_json::Value::Null;
                executed["dt"] = serde_json::Value::Null;
                executed
            });
            moves.collect::<Vec<_>>()
        };
        assert_eq!(without_time(&checked), without_time(&executed), "{names:?}");
    }
}

#[test]
fn the_stepped_shaft_has_two_arcs_and_no_cut_below_the_contour() {
    let [checked, _] = run_both_paths(&["01-stepped-shaft.CNC"]);
    let kind = |wanted: &str| checked.moves.iter().filter(|m| m["kind"] == wanted).count();
    assert_eq!((kind("cw"), kind("ccw")), (1, 1));
    // Roughing stays outside the finished contour: no cut ends below it.
    for executed in checked.moves.iter().filter(|m| m["kind"] == "feed") {
        let (x, z) = (
            executed["x"].as_f64().expect("x"),
            executed["z"].as_f64().expect("z"),
        );
        if z < -0.001 {
            let finished = contour_diameter(z);
            assert!(
                x > finished - 0.001,
                "X{x} Z{z} is below the contour {finished}"
            );
        }
    }
}

/// Finished diameter of the stepped shaft at a Z; the smaller one at a step.
fn contour_diameter(z: f64) -> f64 {
    match z {
        z if z > -2.0 => 16.0 - 2.0 * z,
        z if z >= -20.0 => 20.0,
        z if z > -35.0 => 20.0 + 10.0 * (-20.0 - z) / 15.0,
        z if z >= -50.0 => 30.0,
        z if z >= -55.0 => 40.0 - 2.0 * (25.0 - (z + 50.0).powi(2)).sqrt(),
        z if z > -59.0 => 42.0 + 2.0 * (16.0 - (z + 59.0).powi(2)).sqrt(),
        _ => 50.0,
    }
}

#[test]
fn faulty_samples_raise_the_alarm_they_name() {
    for (name, number, line) in [
        ("faulty/01-arc-too-small.CNC", 13, 8),
        ("faulty/02-no-feed.CNC", 11, 6),
        ("faulty/03-missing-subprogram.CNC", 78, 6),
    ] {
        for seen in run_both_paths(&[name]) {
            assert_eq!(seen.result["end"], "alarm", "{name}");
            assert_eq!(seen.result["alarm"]["number"], number, "{name}");
            assert_eq!(seen.result["alarm"]["line"], line, "{name}");
        }
    }
}

#[test]
fn samples_of_other_models_end_at_their_start_point() {
    for (model, name, start) in [
        (ModelId::Ncb08, "ncb08/01-stepped-pin.CNC", 100.0),
        (ModelId::Ncb08, "ncb08/02-outputs.CNC", 80.0),
        (ModelId::Hx31, "hx31/01-turned-pin.CNC", 100.0),
        (ModelId::Hx31, "hx31/02-grooves.CNC", 100.0),
    ] {
        let mut setup = start_setup(&[name]);
        setup.memory.model = ControlModel::new(model);
        let checked = run_check(&setup);
        assert_eq!(checked.result["warnings"], serde_json::json!([]), "{name}");
        for seen in [checked, run_kernel(&setup)] {
            assert_eq!(seen.result["end"], "M02", "{name}: {}", seen.result);
            assert_eq!(
                seen.result["final"]["abs"],
                serde_json::json!([start, start]),
                "{name}"
            );
        }
    }
}
