//! Checks the program of a form as `check --part` does, and cuts its part.

use gsk_core::command::{ExecutedMove, ProgramId};
use gsk_core::memory::ToolOffset;
use gsk_core::program::{Program, ProgramMemory};
use gsk_core::setup::Setup;
use gsk_core::units::Point;
use gsk_forms::{FormValues, form_job, nose_offset, whole_program};
use gsk_runner::curves::RapidRates;
use gsk_runner::machining::Machining;
use gsk_runner::report::check_program;
use gsk_workpiece::measure::{Feature, MeasuredFeature, SectionSide, measure_with_outlines};

use super::TOLERANCE_MM;

/// A form, its text and its part.
pub struct CutPart {
    pub values: FormValues,
    pub section: String,
    machining: Machining,
}

impl CutPart {
    /// Cuts the part; panics if the check finds an alarm, a warning or a collision.
    pub fn cut(values: FormValues, section: String) -> Self {
        let mut setup = Setup::default().with_chuck();
        let mut programs = ProgramMemory::default();
        programs.open_external(Program::new(whole_program(1, &section)));
        programs.select(ProgramId::External);
        setup.memory.programs = programs;
        if let Some(nose) = nose_offset(&values) {
            let offset = ToolOffset {
                r: nose.radius,
                t: nose.tip,
                ..ToolOffset::default()
            };
            setup.memory.offsets.set(nose.number, offset).unwrap();
            setup.memory.parameters.set_bit(2, 1, true).unwrap();
        }
        let job = form_job(&values);
        job.check()
            .unwrap_or_else(|error| panic!("{values:?}: {error:?}"));
        let mut machining = Machining::new(job);
        let rates = RapidRates::from_memory(&setup.memory);
        let mut cut_move = |executed: &ExecutedMove| machining.execute_move(executed, rates);
        let report = check_program("form", &setup, None, &mut cut_move, &mut |_| true);
        assert!(!report.has_failed(), "{section}\n{report:?}");
        assert!(
            report.warnings.is_empty(),
            "{section}\n{:?}",
            report.warnings
        );
        let more = &report.path.as_ref().unwrap().more_alarms;
        assert!(more.is_empty(), "{section}\n{more:?}");
        let findings = machining.findings();
        assert!(findings.is_empty(), "{section}\n{findings:?}");
        Self {
            values,
            section,
            machining,
        }
    }

    /// The value of a field.
    pub fn number(&self, id: &str) -> f64 {
        self.text(id).parse().unwrap()
    }

    /// The text of a field.
    pub fn text(&self, id: &str) -> String {
        self.values.text(self.values.field(id).unwrap())
    }

    /// Whether the form cuts in a hole.
    pub fn is_inside(&self) -> bool {
        self.values.field("HOLE").is_ok() && self.values.field("SIDE").is_err()
            || self.values.field("SIDE").is_ok() && self.text("SIDE") == "IN"
    }

    fn measured(&self, side: SectionSide) -> Vec<MeasuredFeature> {
        measure_with_outlines(&self.machining.scene().part().section(), side)
    }

    /// The features of a side.
    pub fn features(&self, side: SectionSide) -> Vec<Feature> {
        self.measured(side)
            .into_iter()
            .map(|it| it.feature)
            .collect()
    }

    /// Asserts that the outline of a side passes a point; X is a diameter.
    pub fn assert_passes(&self, side: SectionSide, x: f64, z: f64) {
        let point = Point::new(x / 2.0, z);
        let measured = self.measured(side);
        let points: Vec<Point> = measured.into_iter().flat_map(|it| it.outline).collect();
        let distances = points
            .windows(2)
            .map(|pair| distance(point, pair[0], pair[1]));
        let nearest = distances.fold(f64::INFINITY, f64::min);
        assert!(
            nearest <= TOLERANCE_MM,
            "{}\nX{x} Z{z} is {nearest} mm off: {:?}",
            self.section,
            self.features(side),
        );
    }

    /// Least and greatest diameter of a side between two Z positions.
    pub fn diameters_within(&self, side: SectionSide, zone: (f64, f64)) -> (f64, f64) {
        let points = self.measured(side).into_iter().flat_map(|it| it.outline);
        let inside = points.filter(|it| (zone.0..=zone.1).contains(&it.z));
        inside.fold(
            (f64::INFINITY, f64::NEG_INFINITY),
            |(least, most), point| (least.min(2.0 * point.x), most.max(2.0 * point.x)),
        )
    }

    /// Z where a side becomes wider than a diameter on the way from the front to the back.
    pub fn rising_crossings(&self, side: SectionSide, diameter: f64, zone: (f64, f64)) -> Vec<f64> {
        let points = self.measured(side).into_iter().flat_map(|it| it.outline);
        let points: Vec<Point> = points
            .filter(|it| (zone.0..=zone.1).contains(&it.z))
            .collect();
        let height = |it: &Point| 2.0 * it.x - diameter;
        let crosses = points
            .windows(2)
            .filter(|it| height(&it[0]) < 0.0 && height(&it[1]) >= 0.0);
        let position = |pair: &[Point]| {
            let share = height(&pair[0]) / (height(&pair[0]) - height(&pair[1]));
            pair[0].z + (pair[1].z - pair[0].z) * share
        };
        crosses.map(position).collect()
    }

    /// Asserts that two dimensions are equal within the tolerance.
    pub fn assert_near(&self, found: f64, wanted: f64) {
        let off = (found - wanted).abs();
        assert!(
            off <= TOLERANCE_MM,
            "{}\n{found} is not {wanted}",
            self.section
        );
    }
}

/// Distance of a point from a line between two points.
fn distance(point: Point, from: Point, to: Point) -> f64 {
    let line = to - from;
    let length = line.x * line.x + line.z * line.z;
    let along = (point - from).x * line.x + (point - from).z * line.z;
    let share = if length > 0.0 {
        (along / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let nearest = from + line * share;
    (nearest - point).x.hypot((nearest - point).z)
}
