//! Chooses the tools for their use in a program, the most usual ones first.

use std::collections::BTreeMap;

use gsk_core::memory::{Offsets, ToolOffset};
use gsk_workpiece::tool::{Holder, Insert, InsertLetter, Tool};

use super::tool_uses::{ToolUse, ToolWork};

/// Width of a grooving tool, mm, if the program does not show it.
const DEFAULT_GROOVE_WIDTH_MM: f64 = 3.0;
/// Overlap between neighbouring plunges that cut a wide groove, mm.
const GROOVE_OVERLAP_MM: f64 = 0.5;
/// Diameter of a drill, mm, if the program does not show it.
const DEFAULT_DRILL_DIAMETER_MM: f64 = 10.0;
/// Greatest depth of a drill that counts as a centre drill if another drill drills deeper, mm.
const MAX_CENTER_DRILL_DEPTH_MM: f64 = 8.0;
/// Diameter of a centre drill, mm.
const CENTER_DRILL_DIAMETER_MM: f64 = 4.0;
/// Extra length of a blade or drill beyond its depth of cut, mm.
const EXTRA_REACH_MM: f64 = 2.0;
/// Ratio of the diameter of a boring bar to the free diameter of the hole that it enters.
const BAR_TO_HOLE_RATIO: f64 = 0.7;
/// Entering angle of an insert that finishes a shoulder, degrees.
const SHOULDER_ANGLE_DEG: f64 = 90.0;
/// Entering angle of the usual insert of a boring bar, degrees.
const BORING_ANGLE_DEG: f64 = 93.0;
/// Ratio of the longest to the usual insert length of a boring bar.
const LONG_EDGE_RATIO: f64 = 4.0;
/// Depth of an internal groove, mm, if the program does not show it.
const DEFAULT_INSIDE_GROOVE_DEPTH_MM: f64 = 3.0;

/// How a guessed tool is mounted relative to the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ToolPose {
    /// Whether the tool cuts the inside of the part.
    pub(super) internal: bool,
    /// Whether the tool cuts away from the chuck.
    pub(super) left_hand: bool,
}

impl ToolPose {
    /// Returns the number of the imaginary tip, 1 to 4, of a tool in this pose; `beyond` is `true`
    /// if the tool cuts beyond the spindle axis.
    const fn tip_number(self, beyond: bool) -> u8 {
        match (self.internal != beyond, self.left_hand) {
            (false, false) => 3,
            (false, true) => 4,
            (true, false) => 2,
            (true, true) => 1,
        }
    }

    /// Returns the slimness levels with which the pose is tested, in their order. A square insert
    /// leaves nothing on shoulders and steps that a rapid would hit.
    pub(super) const fn slimness_levels(self) -> [u8; 3] {
        if self.internal {
            [0, SQUARE_BLADE_LEVEL, MAX_SLIMNESS]
        } else {
            [SQUARE_BLADE_LEVEL, 0, MAX_SLIMNESS]
        }
    }

    /// Returns all four mounting orientations for a use of a tool, the most probable first.
    fn probable_poses(used: &ToolUse) -> [Self; 4] {
        let (internal, left_hand) = (used.is_internal(), used.is_left_hand());
        let pose = |internal, left_hand| Self {
            internal,
            left_hand,
        };
        [
            pose(internal, left_hand),
            pose(internal, !left_hand),
            pose(!internal, left_hand),
            pose(!internal, !left_hand),
        ]
    }
}

/// The data that the guess of a tool uses besides its own moves: the other tools, the offsets and
/// the stock.
pub(super) struct ToolKnowledge<'a> {
    pub(super) uses: &'a BTreeMap<u8, ToolUse>,
    pub(super) offsets: &'a Offsets,
    /// Greatest radius of the stock, mm.
    pub(super) radius: f64,
    pub(super) front: f64,
}

impl ToolKnowledge<'_> {
    /// Returns the poses that a tool can have, the most probable first; only those of its tip
    /// number if the offset table has one.
    pub(super) fn possible_poses(&self, used: &ToolUse) -> Vec<ToolPose> {
        let all = ToolPose::probable_poses(used);
        match (used.work, self.offset_row(used).t) {
            (Some(ToolWork::Drill | ToolWork::FaceGroove), _) => vec![all[0]],
            (Some(ToolWork::Thread), 6 | 1 | 2) => vec![ToolPose {
                internal: !used.is_beyond_axis,
                ..all[0]
            }],
            (Some(ToolWork::Thread), 8 | 3 | 4) => vec![ToolPose {
                internal: used.is_beyond_axis,
                ..all[0]
            }],
            (_, tip @ 1..=4) => all
                .into_iter()
                .filter(|pose| pose.tip_number(used.is_beyond_axis) == tip)
                .collect(),
            (Some(ToolWork::Thread | ToolWork::Groove), _) => vec![all[0], all[2]],
            _ => all.to_vec(),
        }
    }

    fn offset_row(&self, used: &ToolUse) -> ToolOffset {
        self.offsets.get(used.offset)
    }

    /// Builds the tool for a use in a pose. `slimness` is 0 for the usual tool, up to
    /// [`MAX_SLIMNESS`] for the tool that touches least.
    pub(super) fn build_tool(&self, used: &ToolUse, pose: ToolPose, slimness: u8) -> Tool {
        let mut tool = match used.work {
            Some(ToolWork::Drill) => return self.build_drill(used),
            Some(ToolWork::FaceGroove) => self.build_face_groover(used),
            Some(ToolWork::Groove) => self.build_groover(used, pose, slimness),
            Some(ToolWork::Thread) => self.build_threading_tool(used, pose, slimness),
            Some(ToolWork::Turn) | None if pose.internal => self.build_boring_tool(used, slimness),
            Some(ToolWork::Turn) | None => build_turning_tool(used.steepest_deg, slimness),
        };
        let row = self.offset_row(used);
        let upright = matches!(used.work, Some(ToolWork::Thread | ToolWork::FaceGroove));
        tool.tip = match (row.t, upright) {
            (_, true) => tool.tip,
            (tip @ 1..=8, false) => tip,
            (_, false) => pose.tip_number(used.is_beyond_axis),
        };
        let nose = row.r.abs();
        if nose > 0.0 {
            match &mut tool.insert {
                Insert::Turning { nose: own, .. }
                | Insert::Grooving { nose: own, .. }
                | Insert::Threading { nose: own, .. } => *own = nose,
                Insert::Drill { .. } => {}
            }
        }
        if tool.check().is_ok() {
            tool
        } else {
            Tool::turning()
        }
    }

    /// Returns the depth of a tool's cuts from the face of the stock, mm; at least 0.
    fn cut_depth(&self, used: &ToolUse) -> f64 {
        (self.front - used.deepest_z).max(0.0)
    }

    fn build_drill(&self, used: &ToolUse) -> Tool {
        let depth = self.cut_depth(used);
        let deepest = |other: &ToolUse| other.is_drill() && self.cut_depth(other) > depth;
        let bored = self.uses.values().filter(|other| {
            other.is_internal() && !other.is_drill() && other.work != Some(ToolWork::FaceGroove)
        });
        let nearest = bored.filter_map(|other| other.nearest_mm).reduce(f64::min);
        let diameter = match nearest {
            _ if depth <= MAX_CENTER_DRILL_DEPTH_MM && self.uses.values().any(deepest) => {
                CENTER_DRILL_DIAMETER_MM
            }
            Some(radius) if radius > 0.5 => 2.0 * radius,
            _ => DEFAULT_DRILL_DIAMETER_MM,
        };
        let mut tool = Tool::drill(diameter.max(1.0));
        if let Insert::Drill { reach, .. } = &mut tool.insert {
            *reach = reach.max(depth + diameter + EXTRA_REACH_MM).min(1000.0);
        }
        tool
    }

    /// Builds a blade parallel to the spindle axis; its programmed point is the middle of the
    /// edge.
    fn build_face_groover(&self, used: &ToolUse) -> Tool {
        let mut tool = Tool::grooving(groove_blade_width(used));
        tool.tip = 7;
        tool.holder = Holder::None;
        if let Insert::Grooving { reach, .. } = &mut tool.insert {
            *reach = reach.max(self.cut_depth(used) + EXTRA_REACH_MM).min(200.0);
        }
        tool
    }

    fn build_groover(&self, used: &ToolUse, pose: ToolPose, slimness: u8) -> Tool {
        let mut tool = Tool::grooving(groove_blade_width(used));
        let deep = if pose.internal {
            used.farthest_cut_mm - used.nearest_mm.unwrap_or(0.0).max(0.0)
        } else {
            self.radius - used.nearest_cut_mm.max(0.0)
        };
        if let Insert::Grooving { reach, .. } = &mut tool.insert {
            *reach = match pose.internal {
                true => (deep.max(DEFAULT_INSIDE_GROOVE_DEPTH_MM) + EXTRA_REACH_MM).min(200.0),
                false => reach.max(deep + EXTRA_REACH_MM).min(200.0),
            };
            if pose.internal {
                tool.holder = self.build_bar(used, *reach, slimness);
            }
        }
        if slimness > 0 {
            tool.holder = Holder::None;
        }
        tool
    }

    fn build_threading_tool(&self, used: &ToolUse, pose: ToolPose, slimness: u8) -> Tool {
        let mut tool = Tool::threading(60.0);
        tool.tip = if pose.internal != used.is_beyond_axis {
            6
        } else {
            8
        };
        if let Insert::Threading { height, .. } = &mut tool.insert {
            // The profile of a coarse thread is higher.
            *height = height.max(used.lead_mm).min(30.0);
            if pose.internal {
                tool.holder = self.build_bar(used, *height, slimness);
            }
        }
        if slimness > 0 {
            tool.holder = Holder::None;
        }
        tool
    }

    fn build_boring_tool(&self, used: &ToolUse, slimness: u8) -> Tool {
        let mut tool = Tool::boring();
        // The hole must also have space for the insert.
        let hole = 2.0 * used.nearest_mm.unwrap_or(f64::INFINITY).max(1.0);
        let scale = (hole / 15.0).min(1.0);
        // A right-angled edge leaves nothing on a shoulder for the rapid away from it, a long
        // one finishes the shoulder in one pass.
        let (new_letter, angle, scale) = match slimness {
            0 => (InsertLetter::D, BORING_ANGLE_DEG, scale),
            1 | 3 => (InsertLetter::D, SHOULDER_ANGLE_DEG, scale),
            SQUARE_BLADE_LEVEL => (InsertLetter::V, SHOULDER_ANGLE_DEG, scale / 4.0),
            4 => (InsertLetter::D, SHOULDER_ANGLE_DEG, LONG_EDGE_RATIO),
            5 => (InsertLetter::V, SHOULDER_ANGLE_DEG, LONG_EDGE_RATIO),
            _ => (InsertLetter::V, BORING_ANGLE_DEG, 0.0),
        };
        if let Insert::Turning {
            size,
            nose,
            letter,
            entering,
        } = &mut tool.insert
        {
            *size = (*size * scale).max(2.0);
            *nose = nose.min(*size / 4.0);
            *letter = new_letter;
            *entering = angle;
            tool.holder = self.build_bar(used, *size / 2.0, slimness);
        }
        tool
    }

    /// Builds a boring bar that fits, with an insert that protrudes by `out`, mm, into the hole
    /// that the tool enters; no holder at a high `slimness`.
    fn build_bar(&self, used: &ToolUse, out: f64, slimness: u8) -> Holder {
        if slimness > 1 {
            return Holder::None;
        }
        let hole = 2.0 * used.nearest_mm.unwrap_or(f64::INFINITY).max(1.0);
        let diameter = ((hole - out) * BAR_TO_HOLE_RATIO).min(12.0) / f64::from(1 + slimness);
        Holder::Bar {
            diameter: diameter.max(2.0),
            length: (self.cut_depth(used) + 20.0).clamp(80.0, 500.0),
        }
    }
}

/// Slimness level of a turning tool with a square blade, if the contour permits it.
const SQUARE_BLADE_LEVEL: u8 = 2;
/// The highest level of slimness: the slimmest tool, which collides least.
pub(super) const MAX_SLIMNESS: u8 = 6;

/// Returns the width of the blade for a groove, mm. A groove wider than the blade is cut in several
/// plunges.
fn groove_blade_width(used: &ToolUse) -> f64 {
    let step = used.plunge_step(DEFAULT_GROOVE_WIDTH_MM);
    step.map_or(DEFAULT_GROOVE_WIDTH_MM, |step| {
        (step + GROOVE_OVERLAP_MM).min(DEFAULT_GROOVE_WIDTH_MM)
    })
}

/// Builds an outside turning tool whose trailing edge clears a contour with the angle `steepest`
/// from Z, degrees.
fn build_turning_tool(steepest: f64, slimness: u8) -> Tool {
    // Angle left between the second edge and the spindle axis.
    let clears = |letter: InsertLetter, entering: f64| 180.0 - entering - letter.corner();
    let (letter, entering, nose) = if steepest <= clears(InsertLetter::C, 95.0) {
        (InsertLetter::C, 95.0, 0.8)
    } else if steepest <= clears(InsertLetter::D, 93.0) {
        (InsertLetter::D, 93.0, 0.4)
    } else {
        (InsertLetter::V, 93.0, 0.4)
    };
    // An edge of 16 mm finishes shoulders in one pass. A right-angled edge leaves nothing on a
    // shoulder for the rapid away from it; a blade leaves nothing on a faced step either.
    let usual = Tool::turning().holder;
    if slimness == SQUARE_BLADE_LEVEL && steepest <= 0.0 {
        let (width, reach) = (12.0, 16.0);
        let insert = Insert::Grooving { width, nose, reach };
        return Tool {
            insert,
            tip: 3,
            holder: usual,
        };
    }
    let (letter, entering, size, holder) = match slimness {
        0 => (letter, entering, 15.875, usual),
        1 => (letter, SHOULDER_ANGLE_DEG, 15.875, usual),
        SQUARE_BLADE_LEVEL | 3 => (letter, SHOULDER_ANGLE_DEG, 15.875, Holder::None),
        4 => (letter, SHOULDER_ANGLE_DEG, 40.0, Holder::None),
        5 => (InsertLetter::D, SHOULDER_ANGLE_DEG, 50.0, Holder::None),
        _ => (InsertLetter::V, SHOULDER_ANGLE_DEG, 50.0, Holder::None),
    };
    Tool {
        insert: Insert::Turning {
            letter,
            entering,
            size,
            nose,
        },
        tip: 3,
        holder,
    }
}
