//! The description of a lathe at one moment: plain data, the only input of a picture.

use std::sync::Arc;

use crate::chips::ChipState;
use crate::part::outline::PartOutline;
use crate::tool_path::ToolPath;

/// The construction of a lathe.
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
    /// Number of tools that the lathe carries.
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
    /// Length of the bed from the front of the chuck's body.
    pub bed_length: f32,
    /// Height of the spindle axis above the bed.
    pub centre_height: f32,
    /// Diameter of the chuck.
    pub chuck_diameter: f32,
    /// Length of the chuck's body.
    pub chuck_length: f32,
    /// Distance of the jaws' front from the chuck's body.
    pub jaw_length: f32,
    /// Radial height of a jaw.
    pub jaw_height: f32,
    /// Distance of the steady rest from the front of the chuck's body; `None`: there is none.
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
    /// Replaces dimensions that are not finite, or out of all proportion.
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

/// How a tool cuts and how it is held.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MountedToolForm {
    /// A shank across the axis.
    Shank,
    /// A boring bar along the axis.
    Bar,
    /// A drill on the axis: diameter, mm, point angle, degrees, and length of the flutes, mm.
    Drill {
        /// Diameter, mm.
        diameter: f32,
        /// Point angle, degrees.
        point: f32,
        /// Length of the flutes, mm.
        reach: f32,
    },
}

/// A tool. Its polygons are points (along the axis, away from the axis) relative to its tip,
/// mm.
#[derive(Clone, Debug, PartialEq)]
pub struct MountedTool {
    /// How the tool is held.
    pub form: MountedToolForm,
    /// Polygons of the insert.
    pub insert: Vec<Vec<[f32; 2]>>,
    /// Polygons of the holder.
    pub holder: Vec<Vec<[f32; 2]>>,
}

/// The quill of the tailstock in the part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuillDescription {
    /// x of the point of the centre in the part, mm.
    pub tip_x: f32,
    /// Diameter of the quill, mm.
    pub diameter: f32,
    /// Distance by which the quill is retracted from the part, mm.
    pub retraction: f32,
}

/// A lamp of the signal tower, from below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TowerLamp {
    /// A program runs.
    Green,
    /// The machine waits.
    Yellow,
    /// An alarm.
    Red,
}

impl TowerLamp {
    /// All lamps, from below.
    pub const ALL: [Self; 3] = [Self::Green, Self::Yellow, Self::Red];
}

/// What happens beside the motion of the axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneEffects {
    /// Chips, flying or in the tray.
    pub chips: Vec<ChipState>,
    /// Angle by which a crash has bent the bar in the jaws, radians; 0 without one.
    pub bar_bend: f32,
    /// Turn of the tool carrier that remains until its station is in position, stations.
    pub station_offset: f32,
    /// Whether the spindle is too fast for the eye: its jaws are drawn as a haze.
    pub is_spindle_blurred: bool,
    /// Positions of collisions as (x, radius), mm.
    pub marks: Vec<[f32; 2]>,
    /// Which lamps of the signal tower are lit, from below: green, yellow, red.
    pub lit_lamps: [bool; 3],
    /// Detents of the electronic hand wheel, clockwise positive.
    pub wheel_detents: i32,
}

/// The sector that is cut out of the part. A cut part does not turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SectionCut {
    /// Nothing is cut out.
    #[default]
    Whole,
    /// A quarter on the side of the operator.
    Quarter,
    /// The half above the plane of the tool.
    Half,
}

impl SectionCut {
    /// All cuts.
    pub const ALL: [Self; 3] = [Self::Whole, Self::Quarter, Self::Half];
}

/// What is drawn in addition to the machine.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneOverlay {
    /// The sector that is cut out of the part.
    pub section_cut: SectionCut,
    /// The programmed path; `None`: it is hidden.
    pub path: Option<Arc<ToolPath>>,
}

/// Colours around the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SceneTheme {
    /// A dark workshop.
    #[default]
    Night,
    /// A bright workshop.
    Day,
}

/// Position of the tool tip in the scene, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TipPosition {
    /// Distance along the axis from the front of the chuck's body.
    pub x: f32,
    /// Distance from the axis, towards the tool post.
    pub radius: f32,
}

/// A lathe at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct LatheDescription {
    /// Construction.
    pub kind: LatheKind,
    /// Dimensions.
    pub dimensions: LatheDimensions,
    /// Angle of the spindle, radians.
    pub spindle_angle: f32,
    /// Radius at which the jaws hold, mm.
    pub jaw_radius: f32,
    /// Position of the tool tip.
    pub tip: TipPosition,
    /// Index of the tool in the working position.
    pub station: usize,
    /// The tools by station; `None`: an empty station.
    pub tools: Vec<Option<MountedTool>>,
    /// The quill in the part; `None`: the tailstock is parked.
    pub quill: Option<QuillDescription>,
    /// Whether coolant flows.
    pub has_coolant: bool,
    /// Opening of the guard, 0 (closed) to 1 (open).
    pub door_opening: f32,
    /// The half section of the part.
    pub part: Arc<PartOutline>,
    /// What is drawn in addition to the machine.
    pub overlay: SceneOverlay,
    /// Chips, damage and the like.
    pub effects: SceneEffects,
    /// Colours around the machine.
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
    /// The tool in the working position; `None` if the station is empty.
    pub fn current_tool(&self) -> Option<&MountedTool> {
        self.tools.get(self.station)?.as_ref()
    }
}
