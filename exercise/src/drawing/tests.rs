use super::*;
use crate::criterion::{PartDimension, PartSurface};
use crate::outline::locate;
use crate::task::ExerciseTask;

/// A solid part with every kind of piece, and its dimensions.
const OUTSIDE: &str = "outside: [Line(30, 0), Arc(40, -5, 5), Line(40, -12), Line(34, -12), \
     Line(34, -15), Line(40, -15), Thread(40, -30, 1.5), Line(50, -50), Line(50, -60), \
     Line(60, -60)]";

fn task_text(outline: &str, criteria: &str) -> String {
    format!(
        "(title: (zh: \"a\", en: \"a\"), text: (zh: \"a\", en: \"a\"), \
         outline: ({outline}), criteria: [{criteria}])"
    )
}

fn criterion(id: &str, rule: &str) -> String {
    format!(
        "(id: \"{id}\", points: 1, yes: (zh: \"a\", en: \"a\"), no: (zh: \"b\", en: \"b\"), \
         rule: {rule}),"
    )
}

fn read(outline: &str, rules: &[&str]) -> Result<ExerciseTask, String> {
    let criteria: Vec<String> = (1..)
        .zip(rules)
        .map(|(number, rule)| criterion(&format!("c{number}"), rule))
        .collect();
    let text = task_text(outline, &criteria.concat());
    ExerciseTask::read("t", "task.ron", &text).map_err(|error| error.to_string())
}

const RULES: [&str; 8] = [
    "Diameter((z: -10, size: 40, tolerance: (0.05, -0.05)))",
    "Diameter((z: -13, size: 34, tolerance: (0, -0.1)))",
    "Width((z: -13, size: 3, tolerance: (0.1, -0.1)))",
    "Length((diameter: 55, size: 60, tolerance: (0.1, -0.1)))",
    "Angle((z: -40, size: 14.036, tolerance: (0.1, -0.1)))",
    "Radius((z: -2, size: 5, tolerance: (0.1, -0.1)))",
    "Pitch((z: -20, size: 1.5, tolerance: (0.01, -0.01)))",
    "ThreadDepth((z: -20, size: 0.92, tolerance: (0.05, -0.05)))",
];

#[test]
fn every_dimension_is_drawn_with_its_text_inside_the_paper() {
    let task = read(OUTSIDE, &RULES).expect("a task");
    assert_eq!(check_outline(&task), []);
    for width in [300.0, 420.0, 900.0] {
        let drawing = draw_task(&task, width, 12.0).expect("a drawing");
        let mut texts: Vec<&str> = drawing.labels.iter().map(|it| it.text.as_str()).collect();
        texts.sort_unstable();
        let expected = [
            "14.036° ±0.1",
            "3 ±0.1",
            "60 ±0.1",
            "P1.5 ±0.01",
            "R5 ±0.1",
            "h0.92 ±0.05",
            "⌀34 +0/-0.1",
            "⌀40 ±0.05",
        ];
        assert_eq!(texts, expected);
        let points = drawing.lines.iter().flat_map(|line| &line.points);
        let labels = drawing.labels.iter().map(|label| &label.middle);
        let corners = drawing.arrows.iter().flat_map(|arrow| &arrow.corners);
        for point in points.chain(labels).chain(corners) {
            let is_inside = (0.0..=width).contains(&point.right)
                && (0.0..=drawing.height).contains(&point.down);
            assert!(is_inside, "{point:?} at {width}");
        }
        for criterion in 0..RULES.len() {
            assert!(drawing.arrows.iter().any(|it| it.criterion == criterion));
        }
    }
}

#[test]
fn the_part_is_drawn_to_scale_on_both_sides_of_the_axis() {
    let task = read(OUTSIDE, &RULES).expect("a task");
    let drawing = draw_task(&task, 900.0, 12.0).expect("a drawing");
    let axis = drawing.lines.iter().find(|it| it.pen == DrawingPen::Axis);
    let axis = axis.expect("an axis").points[0].down;
    let edges: Vec<PaperPoint> = drawing
        .lines
        .iter()
        .filter(|line| line.pen == DrawingPen::Edge)
        .flat_map(|line| line.points.clone())
        .collect();
    let top = edges.iter().map(|it| it.down).fold(f64::MAX, f64::min);
    let bottom = edges.iter().map(|it| it.down).fold(0.0, f64::max);
    assert!((axis - top - (bottom - axis)).abs() < 1e-9);
    let scale = (axis - top) / 30.0;
    let front = edges.iter().map(|it| it.right).fold(0.0, f64::max);
    let groove = PaperPoint {
        right: front - 12.0 * scale,
        down: axis - 17.0 * scale,
    };
    let is_groove =
        |it: &&PaperPoint| (it.right - groove.right).hypot(it.down - groove.down) < 1e-6;
    assert!(edges.iter().any(|it| is_groove(&it)), "{groove:?}");
}

#[test]
fn an_arc_bulges_away_from_the_material_unless_it_is_concave() {
    for (radius, expected) in [(5.0, 19.0), (-5.0, 16.0)] {
        let outline = format!("outside: [Line(30, 0), Arc(40, -5, {radius})]");
        let task = read(&outline, &[RULES[0]]).expect("a task");
        let outline = task.outline.as_ref().expect("an outline");
        let points = outline.points(PartSurface::Outside);
        // 3 and 4 along the axes from the centre: exact points of the circle.
        let nearest = points
            .iter()
            .map(|point| (point.z + if radius > 0.0 { 2.0 } else { 3.0 }, point.x))
            .min_by(|one, other| one.0.abs().total_cmp(&other.0.abs()))
            .expect("points");
        assert!((nearest.1 - expected).abs() < 0.3, "{radius}: {points:?}");
        for point in &points {
            let (x, z) = match radius > 0.0 {
                true => (point.x - 15.0, point.z + 5.0),
                false => (point.x - 20.0, point.z),
            };
            assert!((x.hypot(z) - 5.0).abs() < 1e-9, "{point:?}");
        }
    }
}

#[test]
fn the_hatch_lies_in_the_material_of_a_section() {
    let outline = "outside: [Line(40, 0), Line(40, -50)], bore: [Line(20, 0), Line(20, -50)]";
    let rules = ["Diameter((z: -15, size: 20, tolerance: (0.05, -0.05), surface: Bore))"];
    let task = read(outline, &rules).expect("a task");
    let drawing = draw_task(&task, 600.0, 12.0).expect("a drawing");
    let axis = drawing.lines.iter().find(|it| it.pen == DrawingPen::Axis);
    let axis = axis.expect("an axis").points[0].down;
    let scale = drawing
        .lines
        .iter()
        .filter(|line| line.pen == DrawingPen::Edge)
        .flat_map(|line| &line.points)
        .map(|point| axis - point.down)
        .fold(0.0, f64::max)
        / 20.0;
    let hatch = drawing
        .lines
        .iter()
        .filter(|it| it.pen == DrawingPen::Hatch);
    let mut count = 0;
    for point in hatch.flat_map(|line| &line.points) {
        let radius = (point.down - axis).abs() / scale;
        assert!((10.0 - 1e-6..=20.0 + 1e-6).contains(&radius), "{radius}");
        count += 1;
    }
    assert!(count > 40);
}

#[test]
fn an_outline_that_breaks_a_rule_is_refused_with_its_line() {
    let cases = [
        ("outside: [Line(40, 0)]", "two points"),
        ("outside: [Line(40, -1), Line(40, -5)]", "z 0"),
        (
            "outside: [Line(40, 0), Line(40, -5), Line(30, -4)]",
            "in front",
        ),
        ("outside: [Line(40, 0), Arc(60, -20, 5)]", "radius"),
        ("outside: [Line(40, 0), Thread(40, -20, 0)]", "pitch"),
        ("outside: [Line(-1, 0), Line(40, -20)]", "X-1"),
        ("outside: [Line(40, 0), Line(inf, -20)]", "inf"),
    ];
    for (outline, expected) in cases {
        let error = read(outline, &[RULES[0]]).expect_err(outline);
        assert!(
            error.contains(expected) && error.contains("line 1"),
            "{error}"
        );
    }
}

#[test]
fn an_outline_that_contradicts_a_criterion_is_reported() {
    let outline = "outside: [Line(40, 0), Line(40, -30), Line(50, -30)]";
    let rules = [
        "Diameter((z: -10, size: 41, tolerance: (0.05, -0.05)))",
        "Length((diameter: 60, size: 30, tolerance: (0.1, -0.1)))",
        "Length((diameter: 45, size: 30, tolerance: (0.1, -0.1)))",
    ];
    let task = read(outline, &rules).expect("a task");
    let faults: Vec<String> = check_outline(&task)
        .iter()
        .map(ToString::to_string)
        .collect();
    assert_eq!(faults.len(), 2, "{faults:?}");
    assert!(
        faults[0].contains("40.000") && faults[0].contains("c1"),
        "{faults:?}"
    );
    assert!(faults[1].contains("c2"), "{faults:?}");
}

#[test]
fn a_hidden_diameter_is_dimensioned_on_its_cylinder() {
    let task = read(OUTSIDE, &RULES).expect("a task");
    let outline = task.outline.as_ref().expect("an outline");
    let drawing = draw_task(&task, 900.0, 12.0).expect("a drawing");
    let right_of = |criterion: usize| {
        let label = drawing.labels.iter().find(|it| it.criterion == criterion);
        label.expect("a label").middle.right
    };
    let front = drawing
        .lines
        .iter()
        .filter(|line| line.pen == DrawingPen::Edge)
        .flat_map(|line| &line.points)
        .map(|point| point.right)
        .fold(0.0, f64::max);
    assert!(right_of(0) > front, "the collar beside the part");
    assert!(right_of(1) < front, "the groove inside it");
    let groove = PartDimension::Diameter {
        z: -13.0,
        surface: PartSurface::Outside,
    };
    let found = locate(outline, &groove).expect("the groove");
    assert_eq!(found.1, Some(34.0));
}

#[test]
fn the_file_of_a_drawing_has_its_texts() {
    let task = read(OUTSIDE, &RULES).expect("a task");
    let drawing = draw_task(&task, 900.0, 16.0).expect("a drawing");
    let svg = write_svg(&drawing, "A <part> & more");
    assert!(svg.contains("<title>A &lt;part&gt; &amp; more</title>"));
    assert_eq!(svg.matches("<text").count(), RULES.len());
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
}
