//! The description of a lathe at one moment: plain data, the only input of a picture.

use std::sync::Arc;

use crate::chips::ChipState;
use crate::part::outline::PartOutline;
use crate::tool_path::ToolPath;

/// The type of a drawn lathe: flat bed, slant bed or bench lathe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LatheKind {
    /// A horizontal bed with a tool post of four tools in front of the axis.
    #[default]
    FlatBed,
    /// An inclined bed with a turret of eight tools on the far side of the axis.
    SlantBed,
    /// A small lathe on a bench, with a tool post in front of the axis.
    Bench,
}

impl LatheKind {
    /// Returns the number of tools that the tool post or turret holds.
    pub const fn station_count(self) -> usize {
        match self {
            Self::FlatBed | Self::Bench => 4,
            Self::SlantBed => 8,
        }
    }
}

/// Dimensions from which the machine is built, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatheDimensions {
    /// Length of the bed from the front of the chuck body, mm.
    pub bed_length: f32,
    /// Height of the spindle axis above the bed, mm.
    pub centre_height: f32,
    /// Diameter of the chuck, mm.
    pub chuck_diameter: f32,
    /// Length of the chuck body, mm.
    pub chuck_length: f32,
    /// Distance by which the jaws project from the chuck body, mm.
    pub jaw_length: f32,
    /// Radial height of a jaw, mm.
    pub jaw_height: f32,
    /// Distance of the steady rest from the front of the chuck body, mm; `None` without a steady
    /// rest.
    pub steady_rest: Option<f32>,
}

impl Default for LatheDimensions {
    fn default() -> Self {
        Self {
            bed_length: 620.0,
            centre_height: 190.0,
            chuck_diameter: 200.0,
            chuck_length: 75.0,
            jaw_length: 34.0,
            jaw_height: 36.0,
            steady_rest: None,
        }
    }
}

impl LatheDimensions {
    /// Returns the dimensions with those replaced that are not finite or not plausible.
    #[must_use]
    pub fn sanitized(&self) -> Self {
        let usual = Self::default();
        let check = |value: f32, usual: f32, low: f32, high: f32| match value.is_finite() {
            true => value.clamp(low, high),
            false => usual,
        };
        let chuck_diameter = check(self.chuck_diameter, usual.chuck_diameter, 20.0, 1500.0);
        let centre_height = check(self.centre_height, usual.centre_height, 40.0, 1500.0);
        let bed_length = check(self.bed_length, usual.bed_length, 150.0, 8000.0);
        let steady_rest = self.steady_rest.filter(|it| it.is_finite());
        Self {
            bed_length,
            centre_height: centre_height.max(chuck_diameter * 0.5 + 15.0),
            chuck_diameter,
            chuck_length: check(self.chuck_length, usual.chuck_length, 10.0, 500.0),
            jaw_length: check(self.jaw_length, usual.jaw_length, 1.0, 300.0),
            jaw_height: check(self.jaw_height, usual.jaw_height, 1.0, 300.0),
            steady_rest: steady_rest.map(|it| it.clamp(0.0, bed_length)),
        }
    }
}

/// The form of a tool and of its holder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MountedToolForm {
    /// A turning tool with a square shank across the spindle axis.
    Shank,
    /// A boring bar along the spindle axis.
    Bar,
    /// A drill on the spindle axis.
    Drill {
        /// Diameter of the drill, mm.
        diameter: f32,
        /// Point angle of the drill, degrees.
        point: f32,
        /// Length of the flutes of the drill, mm.
        reach: f32,
    },
}

/// A tool in the tool post or turret. Its polygons are points (along the axis, away from the axis)
/// relative to its tip, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct MountedTool {
    /// Whether the tool is a turning tool, a boring bar or a drill.
    pub form: MountedToolForm,
    /// Polygons of the insert, mm.
    pub insert: Vec<Vec<[f32; 2]>>,
    /// Polygons of the holder, mm.
    pub holder: Vec<Vec<[f32; 2]>>,
}

/// The tailstock quill whose centre supports the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuillDescription {
    /// Distance of the centre's point from the front of the chuck body, mm.
    pub tip_x: f32,
    /// Diameter of the quill, mm.
    pub diameter: f32,
    /// Distance by which the quill is retracted from the part, mm.
    pub retraction: f32,
}

/// A lamp of the signal tower, from below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TowerLamp {
    /// The green lamp: a program runs.
    Green,
    /// The yellow lamp: the machine waits.
    Yellow,
    /// The red lamp: an alarm is active.
    Red,
}

impl TowerLamp {
    /// All lamps, from below.
    pub const ALL: [Self; 3] = [Self::Green, Self::Yellow, Self::Red];
}

/// Visible states besides the positions of the axes: chips, damage, lamps and handwheel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneEffects {
    /// The chips that fly or are in the tray.
    pub chips: Vec<ChipState>,
    /// Angle by which a crash has bent the bar in the jaws, radians; 0 without one.
    pub bar_bend: f32,
    /// Remaining turn of the tool post or turret until its station is in position, in stations.
    pub station_offset: f32,
    /// Whether the spindle is so fast that its jaws are drawn blurred.
    pub is_spindle_blurred: bool,
    /// Positions of collisions as (x, radius), mm; each is marked with a ring.
    pub marks: Vec<[f32; 2]>,
    /// Which lamps of the signal tower are lit, from below: green, yellow, red.
    pub lit_lamps: [bool; 3],
    /// Detents of the electronic hand wheel, clockwise positive.
    pub wheel_detents: i32,
}

/// The sector of the part that is cut out to show its inside. A cut part does not turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SectionCut {
    /// The whole part is drawn.
    #[default]
    Whole,
    /// A quarter of the part on the operator's side is cut out.
    Quarter,
    /// The half of the part above the plane of the tool is cut out.
    Half,
}

impl SectionCut {
    /// All section cuts.
    pub const ALL: [Self; 3] = [Self::Whole, Self::Quarter, Self::Half];
}

/// Section cut and programmed path, which are drawn in addition to the machine.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneOverlay {
    /// The sector that is cut out of the part.
    pub section_cut: SectionCut,
    /// The programmed path; `None` while it is hidden.
    pub path: Option<Arc<ToolPath>>,
}

/// The brightness of the workshop around the machine: night or day.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SceneTheme {
    /// The workshop is dark.
    #[default]
    Night,
    /// The workshop is bright.
    Day,
}

/// Position of the tool tip in the scene, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TipPosition {
    /// Distance along the axis from the front of the chuck body, mm.
    pub x: f32,
    /// Distance from the spindle axis, towards the tool post, mm.
    pub radius: f32,
}

/// Everything that a picture of a lathe shows at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct LatheDescription {
    /// Type of the lathe: flat bed, slant bed or bench lathe.
    pub kind: LatheKind,
    /// Dimensions of the lathe, mm.
    pub dimensions: LatheDimensions,
    /// Angle of the spindle, radians.
    pub spindle_angle: f32,
    /// Radius at which the jaws hold the part, mm.
    pub jaw_radius: f32,
    /// Position of the tool tip, mm.
    pub tip: TipPosition,
    /// Index of the station whose tool is in the working position, from 0.
    pub station: usize,
    /// The tool in each station; `None` for an empty station.
    pub tools: Vec<Option<MountedTool>>,
    /// The quill that supports the part; `None` while the tailstock is parked.
    pub quill: Option<QuillDescription>,
    /// Whether coolant flows.
    pub has_coolant: bool,
    /// Opening of the guard, 0 (closed) to 1 (open).
    pub door_opening: f32,
    /// Surfaces of the part, as a half section.
    pub part: Arc<PartOutline>,
    /// Section cut and programmed path.
    pub overlay: SceneOverlay,
    /// Chips, damage, lamps and handwheel.
    pub effects: SceneEffects,
    /// Brightness of the workshop around the machine.
    pub theme: SceneTheme,
}

impl Default for LatheDescription {
    fn default() -> Self {
        Self {
            kind: LatheKind::default(),
            dimensions: LatheDimensions::default(),
            spindle_angle: 0.0,
            jaw_radius: 25.0,
            tip: TipPosition {
                x: 150.0,
                radius: 45.0,
            },
            station: 0,
            tools: Vec::new(),
            quill: None,
            has_coolant: false,
            door_opening: 0.0,
            part: Arc::default(),
            overlay: SceneOverlay::default(),
            effects: SceneEffects::default(),
            theme: SceneTheme::default(),
        }
    }
}

impl LatheDescription {
    /// Returns the tool in the working position; `None` if the station is empty.
    pub fn current_tool(&self) -> Option<&MountedTool> {
        self.tools.get(self.station)?.as_ref()
    }
}
