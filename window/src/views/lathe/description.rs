//! Describes the lathe of the current job for the scene.

use std::sync::Arc;

use gsk_host::kernel::part::PartView;
use gsk_scene::description::{
    LatheDescription, LatheDimensions, LatheKind, MountedTool, MountedToolForm, QuillDescription,
    SceneTheme, TipPosition,
};
use gsk_scene::part_outline::PartOutline;
use gsk_workpiece::grid::{GridContour, from_grid};
use gsk_workpiece::job::Job;
use gsk_workpiece::region::Region;
use gsk_workpiece::tool::{BodyPart, Holder, Insert, Tool, ToolShape};

/// Greatest diameter of a chuck for which a bench lathe is drawn, mm.
const BENCH_CHUCK_MM: f64 = 100.0;
/// Distance by which an open jaw is away from the stock, mm.
const JAW_TRAVEL_MM: f64 = 5.0;
/// Maximum speed at which the spindle is drawn, r/min, at which the eye still sees the
/// direction.
const MAX_DRAWN_RPM: f32 = 110.0;
/// Time in which the guard opens or closes, s.
const DOOR_TIME_S: f32 = 0.8;
/// Cotangent of half the angle of a centre, 30 degrees.
const CENTER_COTANGENT: f64 = 1.732;

/// Builds descriptions; keeps what changes with the job or the part only.
#[derive(Default)]
pub struct SceneDescriber {
    section: Arc<Region>,
    outline: Arc<PartOutline>,
    outline_job: Option<Arc<Job>>,
    tools: Vec<Option<MountedTool>>,
    tools_key: Option<(Arc<Job>, u8, LatheKind)>,
    spindle_angle: f32,
    door_opening: f32,
}

impl SceneDescriber {
    /// Describes the lathe of a part. `elapsed_s`: time since the last description.
    pub fn describe(
        &mut self,
        part: &PartView,
        theme: SceneTheme,
        elapsed_s: f32,
    ) -> LatheDescription {
        let stock = &part.job.stock;
        let face = stock.jaw_front() - stock.chuck.jaws;
        let kind = match (
            part.rear_tool_post,
            stock.chuck.diameter.0 <= BENCH_CHUCK_MM,
        ) {
            (true, _) => LatheKind::SlantBed,
            (false, true) => LatheKind::Bench,
            (false, false) => LatheKind::FlatBed,
        };
        self.update_outline(part, face);
        self.update_tools(part, kind);
        self.animate(part, elapsed_s);
        let open = if part.chuck_open { JAW_TRAVEL_MM } else { 0.0 };
        let quill = stock.tailstock.map(|tailstock| {
            let depth = tailstock.center.radius() * CENTER_COTANGENT;
            QuillDescription {
                tip_x: (stock.front() - depth - face) as f32,
                diameter: tailstock.quill.0 as f32,
            }
        });
        LatheDescription {
            kind,
            dimensions: make_dimensions(&part.job),
            spindle_angle: self.spindle_angle,
            jaw_radius: (stock.radius() + open) as f32,
            tip: TipPosition {
                x: (part.tip.z - face) as f32,
                radius: part.tip.x as f32,
            },
            station: station_of(part.tool, kind),
            tools: self.tools.clone(),
            quill,
            has_coolant: part.coolant,
            door_opening: self.door_opening,
            part: Arc::clone(&self.outline),
            theme,
        }
    }

    fn update_outline(&mut self, part: &PartView, face: f64) {
        let is_same_job = self.outline_job.as_ref();
        let is_same_job = is_same_job.is_some_and(|job| Arc::ptr_eq(job, &part.job));
        if is_same_job && Arc::ptr_eq(&self.section, &part.section) {
            return;
        }
        self.section = Arc::clone(&part.section);
        self.outline_job = Some(Arc::clone(&part.job));
        let contours = self.section.contours().iter();
        let polygons: Vec<Vec<[f32; 2]>> = contours.map(|contour| polygon(contour, face)).collect();
        let radius = part.job.stock.radius() as f32;
        self.outline = Arc::new(PartOutline::from_polygons(&polygons, radius));
    }

    fn update_tools(&mut self, part: &PartView, kind: LatheKind) {
        let known = self.tools_key.as_ref();
        if known.is_some_and(|(job, tool, known_kind)| {
            Arc::ptr_eq(job, &part.job) && *tool == part.tool && *known_kind == kind
        }) {
            return;
        }
        self.tools_key = Some((Arc::clone(&part.job), part.tool, kind));
        let mut tools = vec![None; kind.station_count()];
        // A carrier has fewer stations than the control has tools: the tool in use is always
        // in its station.
        let all = part.job.tools.iter().rev();
        let current = part.job.tools.get_key_value(&part.tool);
        for (number, tool) in all.chain(current) {
            if let Some(station) = tools.get_mut(station_of(*number, kind)) {
                *station = Some(make_tool(tool));
            }
        }
        self.tools = tools;
    }

    fn animate(&mut self, part: &PartView, elapsed_s: f32) {
        let rpm = (part.spindle_rpm as f32).clamp(-MAX_DRAWN_RPM, MAX_DRAWN_RPM);
        let turn = rpm / 60.0 * core::f32::consts::TAU * elapsed_s;
        self.spindle_angle = (self.spindle_angle + turn) % core::f32::consts::TAU;
        let step = elapsed_s / DOOR_TIME_S;
        let target = if part.door_open { 1.0 } else { 0.0 };
        self.door_opening += (target - self.door_opening).clamp(-step, step);
    }
}

/// The station of a T number: numbers above the last station begin anew.
fn station_of(tool: u8, kind: LatheKind) -> usize {
    usize::from(tool.saturating_sub(1)) % kind.station_count()
}

/// Chooses a machine that suits the chuck and the length of the stock.
fn make_dimensions(job: &Job) -> LatheDimensions {
    let (stock, chuck) = (&job.stock, &job.stock.chuck);
    let diameter = chuck.diameter.0 as f32;
    let centre_height = (diameter * 0.82)
        .max(stock.radius() as f32 + 40.0)
        .max(90.0);
    let end = (stock.overhang + chuck.jaws) as f32;
    let scale = centre_height / 190.0;
    // Steps of 100 mm: a job with another part keeps its machine.
    let bed_length = (end + 460.0 * scale).max(diameter * 3.6);
    LatheDimensions {
        bed_length: (bed_length / 100.0).ceil() * 100.0,
        centre_height,
        chuck_diameter: diameter,
        chuck_length: chuck.length as f32,
        jaw_length: chuck.jaws as f32,
        jaw_height: chuck.jaw_height as f32,
    }
}

fn polygon(contour: &GridContour, zero: f64) -> Vec<[f32; 2]> {
    let points = contour.iter().map(|point| from_grid(*point));
    points
        .map(|point| [(point.z - zero) as f32, point.x as f32])
        .collect()
}

fn make_tool(tool: &Tool) -> MountedTool {
    let shape = ToolShape::from_tool(tool);
    let of_kind = |wanted: BodyPart| {
        let found = shape.body.iter().filter(move |(kind, _)| *kind == wanted);
        found.map(|(_, contour)| polygon(contour, 0.0))
    };
    let form = match (&tool.insert, tool.holder) {
        (
            Insert::Drill {
                diameter,
                point,
                reach,
            },
            _,
        ) => MountedToolForm::Drill {
            diameter: *diameter as f32,
            point: *point as f32,
            reach: *reach as f32,
        },
        (_, Holder::Bar { .. }) => MountedToolForm::Bar,
        (_, Holder::Shank { .. } | Holder::None) => MountedToolForm::Shank,
    };
    let cutting = polygon(&shape.cutting, 0.0);
    MountedTool {
        form,
        insert: of_kind(BodyPart::InsertBack).chain([cutting]).collect(),
        holder: of_kind(BodyPart::Holder).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::command::Frame;
    use gsk_core::units::Point;
    use gsk_workpiece::stock::Stock;

    fn view(diameter: f64) -> PartView {
        let stock = Stock::bar(diameter, 0.0, 60.0);
        let section = Arc::new(stock.section());
        let mut job = Job::new(stock);
        job.tools.insert(1, Tool::turning());
        job.tools.insert(9, Tool::drill(10.0));
        PartView {
            job: Arc::new(job),
            job_name: None,
            section,
            tool: 9,
            tip: Point::new(12.0, -20.0),
            zero: Point::new(0.0, 0.0),
            frame: Frame::default(),
            spindle_rpm: -2000.0,
            coolant: true,
            clamped: true,
            chuck_open: false,
            tailstock_forward: false,
            door_open: true,
            rear_tool_post: false,
            findings: Vec::new(),
            block: None,
        }
    }

    #[test]
    fn the_part_is_in_the_jaws_and_the_tool_where_the_control_has_it() {
        let part = view(50.0);
        let mut describer = SceneDescriber::default();
        let lathe = describer.describe(&part, SceneTheme::Day, 0.1);
        let jaws = part.job.stock.chuck.jaws as f32;
        // 60 mm in front of the jaws.
        let (_, end, radius) = lathe.part.bounds().unwrap();
        assert_eq!((end, radius), (60.0 + jaws, 25.0));
        assert_eq!(lathe.tip.x, 60.0 + jaws - 20.0);
        assert_eq!((lathe.tip.radius, lathe.jaw_radius), (12.0, 25.0));
    }

    #[test]
    fn the_tool_in_use_is_in_its_station_even_beyond_the_last_one() {
        let mut describer = SceneDescriber::default();
        let drill = |lathe: &LatheDescription| {
            matches!(
                lathe.current_tool().map(|it| it.form),
                Some(MountedToolForm::Drill { .. })
            )
        };
        let mut part = view(50.0);
        let lathe = describer.describe(&part, SceneTheme::Day, 0.0);
        assert!(lathe.station == 0 && drill(&lathe));
        part.tool = 1;
        part.rear_tool_post = true;
        let lathe = describer.describe(&part, SceneTheme::Day, 0.0);
        assert!(lathe.kind == LatheKind::SlantBed && !drill(&lathe));
        assert_eq!(
            lathe.current_tool().map(|it| it.form),
            Some(MountedToolForm::Shank)
        );
    }

    #[test]
    fn spindle_and_door_move_with_the_time() {
        let mut describer = SceneDescriber::default();
        let first = describer.describe(&view(50.0), SceneTheme::Day, 0.0);
        assert_eq!((first.spindle_angle, first.door_opening), (0.0, 0.0));
        let moved = describer.describe(&view(50.0), SceneTheme::Day, 0.1);
        assert!(moved.spindle_angle < 0.0 && moved.door_opening > 0.0);
        let open = describer.describe(&view(50.0), SceneTheme::Day, 9.0);
        assert_eq!(open.door_opening, 1.0);
    }
}
