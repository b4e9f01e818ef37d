//! Tools for what a program does with them, the most usual one first.

use std::collections::BTreeMap;

use gsk_core::memory::{Offsets, ToolOffset};
use gsk_workpiece::tool::{Holder, Insert, InsertLetter, Tool};

use super::uses::{Use, Work};

/// Width of a grooving tool whose width nothing shows, mm.
const GROOVE: f64 = 3.0;
/// How far the steps of a wide groove overlap, mm.
const OVERLAP: f64 = 0.5;
/// A drill whose diameter nothing shows, mm.
const DRILL: f64 = 10.0;
/// A drill that goes no deeper while another one does drills a centre, mm.
const CENTER_DEPTH: f64 = 8.0;
/// Its diameter, mm.
const CENTER: f64 = 4.0;
/// A blade or a drill reaches so much farther than it goes, mm.
const SPARE: f64 = 2.0;
/// Part of a hole that a boring bar in it fills.
const FILLS: f64 = 0.7;
/// Entering angle of an edge that finishes a shoulder, degrees.
const RIGHT_ANGLE: f64 = 90.0;
/// Depth of a groove inside whose depth nothing shows, mm.
const INSIDE_GROOVE: f64 = 3.0;

/// How a tool stands to the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pose {
    /// It cuts the inside.
    pub(super) internal: bool,
    /// It cuts away from the chuck.
    pub(super) left_hand: bool,
}

impl Pose {
    /// The number of the imaginary tip; beyond the axis everything is upside down.
    const fn tip(self, beyond: bool) -> u8 {
        match (self.internal != beyond, self.left_hand) {
            (false, false) => 3,
            (false, true) => 4,
            (true, false) => 2,
            (true, true) => 1,
        }
    }

    /// How slim the tools are with which a pose is judged, the first one first: a square
    /// insert leaves nothing on shoulders and steps that a rapid would meet.
    pub(super) const fn levels(self) -> [u8; 3] {
        if self.internal {
            [0, SQUARE, SLIMMEST]
        } else {
            [SQUARE, 0, SLIMMEST]
        }
    }

    /// All of them, from the one that seems to be right on.
    fn all(used: &Use) -> [Self; 4] {
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

/// What is known of the tools beside what each of them does.
pub(super) struct Known<'a> {
    pub(super) uses: &'a BTreeMap<u8, Use>,
    pub(super) offsets: &'a Offsets,
    /// Greatest radius and front of the stock, mm.
    pub(super) radius: f64,
    pub(super) front: f64,
}

impl Known<'_> {
    /// The poses that a tool may have; the offset table decides where it names one.
    pub(super) fn poses(&self, used: &Use) -> Vec<Pose> {
        let all = Pose::all(used);
        match (used.work, self.row(used).t) {
            (Some(Work::Drill | Work::FaceGroove), _) => vec![all[0]],
            (Some(Work::Thread), 6 | 1 | 2) => vec![Pose {
                internal: !used.beyond,
                ..all[0]
            }],
            (Some(Work::Thread), 8 | 3 | 4) => vec![Pose {
                internal: used.beyond,
                ..all[0]
            }],
            (_, tip @ 1..=4) => all
                .into_iter()
                .filter(|pose| pose.tip(used.beyond) == tip)
                .collect(),
            (Some(Work::Thread | Work::Groove), _) => vec![all[0], all[2]],
            _ => all.to_vec(),
        }
    }

    fn row(&self, used: &Use) -> ToolOffset {
        self.offsets.get(used.offset)
    }

    /// A tool in a pose; `slim` counts up to [`SLIMMEST`] from the usual one to one that
    /// touches least.
    pub(super) fn tool(&self, used: &Use, pose: Pose, slim: u8) -> Tool {
        let mut tool = match used.work {
            Some(Work::Drill) => return self.drill(used),
            Some(Work::FaceGroove) => self.face_groove(used),
            Some(Work::Groove) => self.groove(used, pose, slim),
            Some(Work::Thread) => self.thread(used, pose, slim),
            Some(Work::Turn) | None if pose.internal => self.boring(used, slim),
            Some(Work::Turn) | None => turning(used.steepest, slim),
        };
        let row = self.row(used);
        let upright = matches!(used.work, Some(Work::Thread | Work::FaceGroove));
        tool.tip = match (row.t, upright) {
            (_, true) => tool.tip,
            (tip @ 1..=8, false) => tip,
            (_, false) => pose.tip(used.beyond),
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

    /// How deep a tool goes behind the front, mm.
    fn depth(&self, used: &Use) -> f64 {
        (self.front - used.deepest).max(0.0)
    }

    fn drill(&self, used: &Use) -> Tool {
        let depth = self.depth(used);
        let deepest = |other: &Use| other.is_drill() && self.depth(other) > depth;
        let bored = self.uses.values().filter(|other| {
            other.is_internal() && !other.is_drill() && other.work != Some(Work::FaceGroove)
        });
        let nearest = bored.filter_map(|other| other.nearest).reduce(f64::min);
        let diameter = match nearest {
            _ if depth <= CENTER_DEPTH && self.uses.values().any(deepest) => CENTER,
            Some(radius) if radius > 0.5 => 2.0 * radius,
            _ => DRILL,
        };
        let mut tool = Tool::drill(diameter.max(1.0));
        if let Insert::Drill { reach, .. } = &mut tool.insert {
            *reach = reach.max(depth + diameter + SPARE).min(1000.0);
        }
        tool
    }

    /// A blade along the spindle axis; the middle of its edge is programmed.
    fn face_groove(&self, used: &Use) -> Tool {
        let mut tool = Tool::grooving(width(used));
        tool.tip = 7;
        tool.holder = Holder::None;
        if let Insert::Grooving { reach, .. } = &mut tool.insert {
            *reach = reach.max(self.depth(used) + SPARE).min(200.0);
        }
        tool
    }

    fn groove(&self, used: &Use, pose: Pose, slim: u8) -> Tool {
        let mut tool = Tool::grooving(width(used));
        let deep = if pose.internal {
            used.farthest_cut - used.nearest.unwrap_or(0.0).max(0.0)
        } else {
            self.radius - used.nearest_cut.max(0.0)
        };
        if let Insert::Grooving { reach, .. } = &mut tool.insert {
            *reach = match pose.internal {
                true => (deep.max(INSIDE_GROOVE) + SPARE).min(200.0),
                false => reach.max(deep + SPARE).min(200.0),
            };
            if pose.internal {
                tool.holder = self.bar(used, *reach, slim);
            }
        }
        if slim > 0 {
            tool.holder = Holder::None;
        }
        tool
    }

    fn thread(&self, used: &Use, pose: Pose, slim: u8) -> Tool {
        let mut tool = Tool::threading(60.0);
        tool.tip = if pose.internal != used.beyond { 6 } else { 8 };
        if let Insert::Threading { height, .. } = &mut tool.insert {
            // The profile of a coarse thread is higher.
            *height = height.max(used.lead).min(30.0);
            if slim > 0 {
                *height = (*height * 2.0).min(30.0);
            }
            if pose.internal {
                tool.holder = self.bar(used, *height, slim);
            }
        }
        if slim > 0 {
            tool.holder = Holder::None;
        }
        tool
    }

    fn boring(&self, used: &Use, slim: u8) -> Tool {
        let mut tool = Tool::boring();
        // The hole into which it goes must have room for the insert, too.
        let hole = 2.0 * used.nearest.unwrap_or(f64::INFINITY).max(1.0);
        let scale = match slim {
            0 => (hole / 15.0).min(1.0),
            slim => (hole / 15.0).min(1.0) / f64::from(1_u32 << slim.min(8)),
        };
        if let Insert::Turning {
            size, nose, letter, ..
        } = &mut tool.insert
        {
            *size = (*size * scale).max(2.0);
            *nose = nose.min(*size / 4.0);
            if slim > 1 {
                *letter = InsertLetter::V;
            }
            tool.holder = self.bar(used, *size / 2.0, slim);
        }
        tool
    }

    /// A bar that fits into the hole that a tool finds, its insert standing out.
    fn bar(&self, used: &Use, out: f64, slim: u8) -> Holder {
        if slim > 1 {
            return Holder::None;
        }
        let hole = 2.0 * used.nearest.unwrap_or(f64::INFINITY).max(1.0);
        let diameter = ((hole - out) * FILLS).min(12.0) / f64::from(1 + slim);
        Holder::Bar {
            diameter: diameter.max(2.0),
            length: (self.depth(used) + 20.0).clamp(80.0, 500.0),
        }
    }
}

/// The step with a square blade, where a contour lets it.
const SQUARE: u8 = 2;
/// The last step from a usual tool to one that touches least.
pub(super) const SLIMMEST: u8 = 6;

/// Width of a blade: a groove that is wider than its tool is cut in steps of less.
fn width(used: &Use) -> f64 {
    let step = used.step().filter(|step| *step < GROOVE);
    step.map_or(GROOVE, |step| (step + OVERLAP).min(GROOVE))
}

/// An outside tool whose back clears a contour that goes in so steeply, degrees.
fn turning(steepest: f64, slim: u8) -> Tool {
    // What is left between the second edge and the spindle axis.
    let clears = |letter: InsertLetter, entering: f64| 180.0 - entering - letter.corner();
    let (letter, entering, nose) = if steepest <= clears(InsertLetter::C, 95.0) {
        (InsertLetter::C, 95.0, 0.8)
    } else if steepest <= clears(InsertLetter::D, 93.0) {
        (InsertLetter::D, 93.0, 0.4)
    } else {
        (InsertLetter::V, 93.0, 0.4)
    };
    // An edge of 16 mm: shoulders are finished in one go. One at right angles leaves nothing
    // on a shoulder for the rapid away from it, a blade nothing on a step that is faced, either.
    let usual = Tool::turning().holder;
    if slim == SQUARE && steepest <= 0.0 {
        let (width, reach) = (12.0, 16.0);
        let insert = Insert::Grooving { width, nose, reach };
        return Tool {
            insert,
            tip: 3,
            holder: usual,
        };
    }
    let (letter, entering, size, holder) = match slim {
        0 => (letter, entering, 15.875, usual),
        1 => (letter, RIGHT_ANGLE, 15.875, usual),
        SQUARE | 3 => (letter, RIGHT_ANGLE, 15.875, Holder::None),
        4 => (letter, RIGHT_ANGLE, 40.0, Holder::None),
        5 => (InsertLetter::D, RIGHT_ANGLE, 50.0, Holder::None),
        _ => (InsertLetter::V, RIGHT_ANGLE, 50.0, Holder::None),
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
