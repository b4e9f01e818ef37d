//! What a cut above the limits of lathe and insert does to them.

use gsk_core::command::SourcePosition;
use gsk_core::machine::{LatheFault, LoadLimits};
use gsk_core::units::Point;
use gsk_messages::{Message, say};
use gsk_workpiece::cutting::ChipSample;

use super::move_load::{CutConditions, CutLoad};

/// Distance by which stock may give way before it bends, mm.
const BENDING_MM: f64 = 0.5;

/// The limit that a cut exceeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CutFaultKind {
    /// A longer edge is in the material than the insert bears, mm.
    InsertEdge {
        /// Length of the edge in the material.
        edge_mm: f64,
        /// Length that the insert bears.
        limit_mm: f64,
    },
    /// The feed per revolution is greater than the insert bears, mm.
    InsertFeed {
        /// Feed per revolution.
        feed_mm: f64,
        /// Feed that the insert bears.
        limit_mm: f64,
    },
    /// The torque is greater than that of the spindle at its speed, N·m.
    SpindleTorque {
        /// Torque of the cut.
        torque_nm: f64,
        /// Speed of the spindle, r/min.
        rpm: f64,
        /// Torque of the spindle.
        limit_nm: f64,
    },
    /// The torque is greater than the chuck holds, N·m.
    ChuckGrip {
        /// Torque of the cut.
        torque_nm: f64,
        /// Torque that the chuck holds.
        limit_nm: f64,
    },
    /// The stock gives way to a force across its axis until it bends.
    StockBends {
        /// The force, N.
        force_n: f64,
        /// The distance by which the stock gives way, mm.
        distance_mm: f64,
    },
}

/// A cut that breaks or loosens something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutFault {
    /// The limit that is exceeded.
    pub kind: CutFaultKind,
    /// Number of the tool that cuts.
    pub tool: u8,
    /// The block that cuts; `None` in manual operation.
    pub source: Option<SourcePosition>,
    /// Position of the tip, part coordinates, mm.
    pub tip: Point,
}

impl CutFault {
    /// The fault of the lathe that it causes.
    pub const fn fault(&self) -> LatheFault {
        match self.kind {
            CutFaultKind::InsertEdge { .. } | CutFaultKind::InsertFeed { .. } => {
                LatheFault::InsertBroken
            }
            CutFaultKind::SpindleTorque { .. } => LatheFault::SpindleBlocked,
            CutFaultKind::ChuckGrip { .. } | CutFaultKind::StockBends { .. } => {
                LatheFault::StockLoose
            }
        }
    }

    /// The sentence about it for the operator.
    pub fn message(&self) -> Message {
        let tool = format_args!("{:02}", self.tool);
        let what = match self.kind {
            CutFaultKind::InsertEdge { edge_mm, limit_mm } => say::cut_fault_insert_edge(
                tool,
                format_args!("{edge_mm:.2}"),
                format_args!("{limit_mm:.2}"),
            ),
            CutFaultKind::InsertFeed { feed_mm, limit_mm } => say::cut_fault_insert_feed(
                tool,
                format_args!("{feed_mm:.3}"),
                format_args!("{limit_mm:.3}"),
            ),
            CutFaultKind::SpindleTorque {
                torque_nm,
                rpm,
                limit_nm,
            } => say::cut_fault_spindle(
                format_args!("{torque_nm:.1}"),
                format_args!("{rpm:.0}"),
                format_args!("{limit_nm:.1}"),
            ),
            CutFaultKind::ChuckGrip {
                torque_nm,
                limit_nm,
            } => say::cut_fault_slip(
                format_args!("{torque_nm:.1}"),
                format_args!("{limit_nm:.1}"),
            ),
            CutFaultKind::StockBends {
                force_n,
                distance_mm,
            } => say::cut_fault_bend(
                format_args!("{force_n:.0}"),
                format_args!("{distance_mm:.2}"),
                format_args!("{BENDING_MM:.2}"),
            ),
        };
        say::window_cut_fault(what, self.tip.diameter().0, self.tip.z)
    }
}

impl CutConditions<'_> {
    /// The first limit that a chip exceeds at a feed per revolution, mm, and a spindle speed,
    /// r/min; `None` within all limits.
    pub(super) fn exceeded_limit(
        &self,
        sample: &ChipSample,
        (feed_mm, is_thread): (f64, bool),
        rpm: f64,
        limits: &LoadLimits,
    ) -> Option<CutFaultKind> {
        let load = self.load(sample, 1.0, rpm);
        self.exceeded_insert_limit(&load, feed_mm, is_thread)
            .or_else(|| self.exceeded_machine_limit(&load, sample.tip_z, limits))
    }

    fn exceeded_insert_limit(
        &self,
        load: &CutLoad,
        feed_mm: f64,
        is_thread: bool,
    ) -> Option<CutFaultKind> {
        let (insert, edge_mm) = (&self.tool.insert, load.chip.width_mm);
        if let Some(limit_mm) = insert.breaking_edge_mm().filter(|limit| edge_mm > *limit) {
            return Some(CutFaultKind::InsertEdge { edge_mm, limit_mm });
        }
        let limit_mm = insert.breaking_feed_mm().filter(|_| !is_thread)?;
        (feed_mm > limit_mm).then_some(CutFaultKind::InsertFeed { feed_mm, limit_mm })
    }

    fn exceeded_machine_limit(
        &self,
        load: &CutLoad,
        tip_z: f64,
        limits: &LoadLimits,
    ) -> Option<CutFaultKind> {
        let (torque_nm, rpm) = (load.torque_nm, load.rpm);
        if let Some(limit_nm) = limits.torque_at(rpm).filter(|limit| torque_nm > *limit) {
            return Some(CutFaultKind::SpindleTorque {
                torque_nm,
                rpm,
                limit_nm,
            });
        }
        if let Some(limit_nm) = limits.grip_nm.filter(|limit| torque_nm > *limit) {
            return Some(CutFaultKind::ChuckGrip {
                torque_nm,
                limit_nm,
            });
        }
        let flexibility = self.scene.stock_flexibility(tip_z) / self.material.modulus();
        let force_n = load.radial_force_n.abs();
        let distance_mm = force_n * flexibility;
        (distance_mm > BENDING_MM).then_some(CutFaultKind::StockBends {
            force_n,
            distance_mm,
        })
    }
}
