//! Describes the lathe of the current job for the scene.

use std::sync::Arc;

use gsk_core::machine::LatheConstruction;
use gsk_host::kernel::part::PartView;
use gsk_runner::machining::live_part::ThreadZone;
use gsk_scene::description::{
    LatheDescription, LatheDimensions, LatheKind, MountedTool, MountedToolForm, QuillDescription,
    SceneEffects, SceneOverlay, SceneTheme, SectionCut, TipPosition,
};
use gsk_scene::effects::break_insert;
use gsk_scene::part::material::PartMaterial;
use gsk_scene::part::outline::PartOutline;
use gsk_scene::part::threads::ThreadDescription;
use gsk_workpiece::grid::{GridContour, from_grid};
use gsk_workpiece::job::Job;
use gsk_workpiece::region::Region;
use gsk_workpiece::stock::StockMaterial;
use gsk_workpiece::tool::{BodyPart, Holder, Insert, Tool, ToolShape};

use super::animation::{EffectsAnimation, broken_tool, is_blurred};
use super::path::ScenePath;
use crate::views::machine::path::DrawnPath;

/// Greatest diameter of a chuck for which a bench lathe is drawn, mm.
const BENCH_CHUCK_MM: f64 = 100.0;
/// Distance by which an open jaw is away from the stock, mm.
const JAW_TRAVEL_MM: f32 = 5.0;
/// Distance by which a retracted quill is away from the part, mm.
const QUILL_TRAVEL_MM: f32 = 45.0;
/// Time in which the machine guard opens or closes, s.
const DOOR_TIME_S: f32 = 0.8;
/// Cotangent of half the angle of a centre, 30 degrees.
const CENTER_COTANGENT: f64 = 1.732;

/// The data that determine the drawn tools: job, tool in use, machine, and the tool with a broken
/// insert.
type ToolsKey = (Arc<Job>, u8, LatheKind, Option<u8>);

/// Builds the descriptions from which the lathe is drawn; keeps the data that change only with the
/// job or the part.
#[derive(Default)]
pub struct SceneDescriber {
    section: Arc<Region>,
    outline: Arc<PartOutline>,
    outline_job: Option<Arc<Job>>,
    threads: Arc<Vec<ThreadZone>>,
    path: ScenePath,
    /// The sector that is cut out of the drawn part.
    pub section_cut: SectionCut,
    tools: Vec<Option<MountedTool>>,
    tools_key: Option<ToolsKey>,
    spindle_angle: f32,
    door_opening: f32,
    effects: EffectsAnimation,
}

impl SceneDescriber {
    /// Sets the programmed path; `None` hides it. `now_s`: time of the picture.
    pub fn set_path(&mut self, path: Option<&Arc<DrawnPath>>, now_s: f64) {
        self.path.set(path, now_s);
    }

    /// Describes the lathe of a part. `elapsed_s`: time since the last description.
    pub fn describe(
        &mut self,
        part: &PartView,
        theme: SceneTheme,
        elapsed_s: f32,
    ) -> LatheDescription {
        let stock = &part.job.stock;
        let face = stock.jaw_front() - stock.chuck.jaws;
        let kind = kind_of(part);
        self.update_outline(part, face);
        self.update_tools(part, kind);
        self.animate(part, elapsed_s);
        let quill = stock.tailstock.map(|tailstock| {
            let depth = tailstock.center.radius() * CENTER_COTANGENT;
            QuillDescription {
                tip_x: (stock.front() - depth - face) as f32,
                diameter: tailstock.quill.0 as f32,
                retraction: 0.0,
            }
        });
        let mut lathe = LatheDescription {
            kind,
            dimensions: make_dimensions(part),
            spindle_angle: self.spindle_angle,
            jaw_radius: stock.radius() as f32,
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
            overlay: SceneOverlay {
                section_cut: self.section_cut,
                path: self.path.get(face),
            },
            effects: SceneEffects::default(),
            theme,
        };
        lathe.effects = self.effects.advance(part, &lathe, face, elapsed_s);
        lathe.jaw_radius += self.effects.jaw_opening() * JAW_TRAVEL_MM;
        if let Some(quill) = &mut lathe.quill {
            quill.retraction = self.effects.quill_retraction() * QUILL_TRAVEL_MM;
        }
        lathe
    }

    fn update_outline(&mut self, part: &PartView, face: f64) {
        let is_same_job = self.outline_job.as_ref();
        let is_same_job = is_same_job.is_some_and(|job| Arc::ptr_eq(job, &part.job));
        let is_same_part =
            Arc::ptr_eq(&self.section, &part.section) && Arc::ptr_eq(&self.threads, &part.threads);
        if is_same_job && is_same_part {
            return;
        }
        self.threads = Arc::clone(&part.threads);
        self.section = Arc::clone(&part.section);
        self.outline_job = Some(Arc::clone(&part.job));
        let contours = self.section.contours().iter();
        let polygons: Vec<Vec<[f32; 2]>> = contours.map(|contour| polygon(contour, face)).collect();
        let radius = part.job.stock.radius() as f32;
        let threads = self.threads.iter().map(|zone| ThreadDescription {
            low: (zone.low - face) as f32,
            high: (zone.high - face) as f32,
            lead: zone.lead as f32,
            is_internal: zone.is_internal,
        });
        let threads: Vec<ThreadDescription> = threads.collect();
        let outline = PartOutline::with_threads(&polygons, radius, &threads);
        self.outline = Arc::new(outline.with_material(material_of(part.job.stock.material)));
    }

    fn update_tools(&mut self, part: &PartView, kind: LatheKind) {
        let broken = broken_tool(part);
        let known = self.tools_key.as_ref();
        if known.is_some_and(|(job, tool, known_kind, was_broken)| {
            Arc::ptr_eq(job, &part.job)
                && (*tool, *known_kind, *was_broken) == (part.tool, kind, broken)
        }) {
            return;
        }
        self.tools_key = Some((Arc::clone(&part.job), part.tool, kind, broken));
        let mut tools = vec![None; kind.station_count()];
        // A carrier has fewer stations than the control has tools: the tool in use is always
        // in its station.
        let all = part.job.tools.iter().rev();
        let current = part.job.tools.get_key_value(&part.tool);
        for (number, tool) in all.chain(current) {
            if let Some(station) = tools.get_mut(station_of(*number, kind)) {
                let mounted = make_tool(tool);
                *station = Some(match broken == Some(*number) {
                    true => break_insert(&mounted),
                    false => mounted,
                });
            }
        }
        self.tools = tools;
    }

    fn animate(&mut self, part: &PartView, elapsed_s: f32) {
        // A blurred spindle looks the same at all angles.
        let rpm = match is_blurred(part) {
            true => 0.0,
            false => part.spindle_rpm as f32,
        };
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

const fn material_of(stock: StockMaterial) -> PartMaterial {
    match stock {
        StockMaterial::Steel => PartMaterial::Steel,
        StockMaterial::Stainless => PartMaterial::Stainless,
        StockMaterial::CastIron => PartMaterial::CastIron,
        StockMaterial::Aluminium => PartMaterial::Aluminium,
        StockMaterial::Brass => PartMaterial::Brass,
        StockMaterial::Plastic => PartMaterial::Plastic,
    }
}

/// The construction by the machine file, or else by tool post and chuck.
fn kind_of(part: &PartView) -> LatheKind {
    match (part.fittings.construction, part.rear_tool_post) {
        (Some(LatheConstruction::SlantBed), _) | (None, true) => LatheKind::SlantBed,
        (Some(LatheConstruction::Bench), _) => LatheKind::Bench,
        (None, false) if part.job.stock.chuck.diameter.0 <= BENCH_CHUCK_MM => LatheKind::Bench,
        (Some(LatheConstruction::FlatBed), _) | (None, false) => LatheKind::FlatBed,
    }
}

/// Chooses a machine that suits the chuck and the length of the stock.
fn make_dimensions(part: &PartView) -> LatheDimensions {
    let (stock, chuck) = (&part.job.stock, &part.job.stock.chuck);
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
        steady_rest: part.fittings.steady_rest.map(|it| it as f32),
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
    use gsk_core::units::Point;
    use gsk_host::kernel::part::LatheFittings;
    use gsk_workpiece::stock::Stock;

    fn view(diameter: f64) -> PartView {
        let stock = Stock::bar(diameter, 0.0, 60.0);
        let section = Arc::new(stock.section());
        let mut job = Job::new(stock);
        job.tools.insert(1, Tool::turning());
        job.tools.insert(9, Tool::drill(10.0));
        PartView {
            alarms: Vec::new(),
            job: Arc::new(job),
            job_name: None,
            empty_chuck: None,
            section,
            threads: Arc::default(),
            tool: 9,
            tip: Point::new(12.0, -20.0),
            absolute: Point::new(12.0, -20.0),
            spindle_rpm: -900.0,
            coolant: true,
            clamped: true,
            chuck_open: false,
            tailstock_forward: false,
            door_open: true,
            rear_tool_post: false,
            fittings: LatheFittings::default(),
            findings: Vec::new(),
            crash: None,
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
    fn a_crash_breaks_the_insert_bends_the_bar_and_marks_the_place() {
        use gsk_runner::machining::CollisionFinding;
        use gsk_workpiece::collision::{Collision, Obstacle, TouchingPart};
        let mut part = view(50.0);
        part.tool = 1;
        let mut describer = SceneDescriber::default();
        let whole = describer.describe(&part, SceneTheme::Day, 0.1);
        assert!(whole.effects.marks.is_empty() && whole.effects.bar_bend == 0.0);
        let contact = Point::new(20.0, -5.0);
        let finding = CollisionFinding {
            source: None,
            tool: 1,
            collision: Collision {
                touching_part: TouchingPart::RapidInsert,
                obstacle: Obstacle::Stock,
                tip: contact,
                contact,
                depth: 2.0,
            },
        };
        part.findings = vec![finding];
        part.crash = Some(finding);
        let crashed = describer.describe(&part, SceneTheme::Day, 0.1);
        assert_ne!(crashed.current_tool(), whole.current_tool());
        assert!(crashed.effects.bar_bend > 0.0);
        let jaws = part.job.stock.chuck.jaws as f32;
        assert_eq!(crashed.effects.marks, [[60.0 + jaws - 5.0, 20.0]]);
        // The way out clears the crash; its place stays marked.
        part.crash = None;
        let clear = describer.describe(&part, SceneTheme::Day, 0.1);
        assert_eq!(clear.current_tool(), whole.current_tool());
        assert!(clear.effects.bar_bend == 0.0 && clear.effects.marks.len() == 1);
    }

    #[test]
    fn an_insert_broken_by_a_fault_is_drawn_broken_without_a_crash() {
        let mut part = view(50.0);
        part.tool = 1;
        let mut describer = SceneDescriber::default();
        let whole = describer.describe(&part, SceneTheme::Day, 0.1);
        part.fittings.broken_tool = Some(1);
        let broken = describer.describe(&part, SceneTheme::Day, 0.1);
        assert_ne!(broken.current_tool(), whole.current_tool());
        assert!(broken.effects.marks.is_empty() && broken.effects.bar_bend == 0.0);
        // It stays broken in its station while another tool works.
        part.tool = 3;
        let changed = describer.describe(&part, SceneTheme::Day, 9.0);
        assert_eq!(changed.tools[0], broken.tools[0]);
        part.fittings.broken_tool = None;
        let mended = describer.describe(&part, SceneTheme::Day, 0.1);
        assert_eq!(mended.tools[0], whole.tools[0]);
    }

    #[test]
    fn a_cut_throws_chips_and_a_tool_change_turns_the_carrier() {
        let mut part = view(50.0);
        part.tool = 1;
        let mut describer = SceneDescriber::default();
        describer.describe(&part, SceneTheme::Day, 0.03);
        for step in 0..20 {
            part.section = Arc::new(part.section.as_ref().clone());
            part.tip.z = -0.1 * f64::from(step);
            describer.describe(&part, SceneTheme::Day, 0.03);
        }
        let cutting = describer.describe(&part, SceneTheme::Day, 0.03);
        assert!(cutting.effects.chips.len() > 5 && cutting.effects.station_offset == 0.0);
        part.tool = 3;
        let turning = describer.describe(&part, SceneTheme::Day, 0.03);
        assert!(
            turning.effects.station_offset > 1.5,
            "{:?}",
            turning.effects
        );
        let seated = describer.describe(&part, SceneTheme::Day, 2.0);
        assert_eq!(seated.effects.station_offset, 0.0);
    }

    #[test]
    fn a_quill_that_was_extended_retracts_and_jaws_open_slowly() {
        use gsk_core::units::Diameter;
        use gsk_workpiece::stock::Tailstock;
        let mut part = view(50.0);
        let mut stock = Stock::bar(50.0, 0.0, 60.0);
        stock.tailstock = Some(Tailstock {
            quill: Diameter(40.0),
            center: Diameter(10.0),
        });
        part.job = Arc::new(Job::new(stock));
        let mut describer = SceneDescriber::default();
        let mut state = |part: &PartView, elapsed_s: f32| {
            let lathe = describer.describe(part, SceneTheme::Day, elapsed_s);
            (lathe.quill.unwrap().retraction, lathe.jaw_radius)
        };
        // A tailstock that was never moved by the control is set by hand.
        assert_eq!(state(&part, 9.0), (0.0, 25.0));
        part.tailstock_forward = true;
        assert_eq!(state(&part, 9.0), (0.0, 25.0));
        part.tailstock_forward = false;
        part.chuck_open = true;
        let (quill, jaws) = state(&part, 0.1);
        assert!(quill > 0.0 && quill < QUILL_TRAVEL_MM && jaws > 25.0 && jaws < 30.0);
        assert_eq!(state(&part, 9.0), (QUILL_TRAVEL_MM, 30.0));
    }

    #[test]
    fn the_machine_file_sets_construction_and_steady_rest_and_signals_light_the_tower() {
        let mut part = view(50.0);
        let mut describer = SceneDescriber::default();
        let usual = describer.describe(&part, SceneTheme::Day, 0.1);
        assert_eq!(usual.kind, LatheKind::FlatBed);
        assert_eq!(usual.dimensions.steady_rest, None);
        assert_eq!(usual.effects.lit_lamps, [false; 3]);
        part.fittings = LatheFittings {
            construction: Some(LatheConstruction::Bench),
            steady_rest: Some(70.0),
            lit_lamps: [true, false, true],
            wheel_detents: -12,
            broken_tool: None,
        };
        let fitted = describer.describe(&part, SceneTheme::Day, 0.1);
        assert_eq!(fitted.kind, LatheKind::Bench);
        assert_eq!(fitted.dimensions.steady_rest, Some(70.0));
        assert_eq!(fitted.effects.lit_lamps, [true, false, true]);
        assert_eq!(fitted.effects.wheel_detents, -12);
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
