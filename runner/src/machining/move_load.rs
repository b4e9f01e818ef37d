//! The load of the moves of a program, from the chip that they cut from the part.

use gsk_core::command::{ExecutedMove, MoveConditions, SourcePosition};
use gsk_core::units::Feed;
use gsk_workpiece::cutting::{
    ChipSample, CuttingChip, CuttingMaterial, chisel_edge_factors, cutting_power_kw,
    cutting_torque_nm, pressing_force_n, roughness_ra_um, surface_speed_m_per_min,
};
use gsk_workpiece::motion::{MotionKind, ToolMotion};
use gsk_workpiece::scene::LatheScene;
use gsk_workpiece::tool::{Insert, Tool};

/// The load of a cut at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CutLoad {
    /// Position on the move: 0 is its start, 1 its end.
    pub share: f64,
    /// The chip of one cutting edge.
    pub chip: CuttingChip,
    /// Cutting force of all edges, N.
    pub force_n: f64,
    /// Power at the cut, kW.
    pub power_kw: f64,
    /// Torque at the spindle, N·m.
    pub torque_nm: f64,
    /// Force against the feed, N.
    pub feed_force_n: f64,
    /// Force across the spindle axis, N, which bends boring bar and stock. The tool is pushed
    /// outwards if it is positive.
    pub radial_force_n: f64,
    /// Force along the spindle axis on the tool, N, positive in Z+.
    pub axial_force_n: f64,
    /// Change of the turned diameter because boring bar and stock give way, mm.
    pub size_error_mm: f64,
    /// Cutting speed at the greatest radius of the cut, m/min.
    pub speed_m_per_min: f64,
    /// Spindle speed, r/min.
    pub rpm: f64,
}

/// The load of a move.
#[derive(Clone, Debug, PartialEq)]
pub struct MoveLoad {
    /// The block that makes the move.
    pub source: SourcePosition,
    /// Number of the tool.
    pub tool: u8,
    /// Machine time at the start of the move, s.
    pub start_s: f64,
    /// Duration of the move, s.
    pub duration_s: f64,
    /// Feed per revolution, mm; for a thread its lead.
    pub feed_mm: f64,
    /// Whether the move cuts a thread.
    pub is_thread: bool,
    /// Theoretical roughness Ra of the turned surface, µm; `None` for threads, and for tools
    /// other than turning inserts.
    pub roughness_um: Option<f64>,
    /// The load along the move, where the tool cuts.
    pub loads: Vec<CutLoad>,
}

impl MoveLoad {
    /// The load of a move with the chips that it cuts: `chips` returns those for a feed per
    /// revolution of each edge, mm. `None` if the spindle stands or nothing is cut.
    pub(super) fn new(
        executed: &ExecutedMove,
        cut: &CutConditions,
        motion: &ToolMotion,
        chips: impl FnOnce(f64) -> Vec<ChipSample>,
    ) -> Option<Self> {
        let tool = cut.tool;
        let conditions = &executed.conditions;
        if conditions.rpm < 1.0 || matches!(motion.kind, MotionKind::Rapid) {
            return None;
        }
        let (feed_mm, is_per_minute) = match executed.feed? {
            Feed::PerRevolution(feed) => (feed, false),
            Feed::PerMinute(feed) => (feed / conditions.rpm, true),
        };
        let edges = f64::from(tool.edge_count());
        let loads: Vec<CutLoad> = chips(feed_mm / edges)
            .into_iter()
            .map(|sample| {
                let x = executed.from.x + (executed.to.x - executed.from.x) * sample.share;
                let rpm = rpm_at(conditions, (executed.from.x, executed.to.x), x);
                let feed_share = if is_per_minute {
                    conditions.rpm / rpm
                } else {
                    1.0
                };
                cut.load(&sample, feed_share, rpm)
            })
            .collect();
        let is_thread = executed.kind.is_thread();
        let turns = matches!(tool.insert, Insert::Turning { .. }) && !is_thread;
        (!loads.is_empty()).then(|| Self {
            source: executed.source,
            tool: conditions.tool,
            start_s: executed.start_s,
            duration_s: executed.duration_s,
            feed_mm,
            is_thread,
            roughness_um: roughness_ra_um(feed_mm, tool.nose()).filter(|_| turns),
            loads,
        })
    }
}

/// What the load of a chip depends on besides the chip.
pub(super) struct CutConditions<'a> {
    /// The tool that cuts.
    pub tool: &'a Tool,
    /// The material, with the constants for the rake of the tool.
    pub material: CuttingMaterial,
    /// The part and its clamping.
    pub scene: &'a LatheScene,
}

impl CutConditions<'_> {
    /// The load of a chip, whose area is multiplied by `feed_share`.
    pub(super) fn load(&self, sample: &ChipSample, feed_share: f64, rpm: f64) -> CutLoad {
        let edges = f64::from(self.tool.edge_count());
        let chip = CuttingChip {
            area_mm2: sample.chip.area_mm2 * feed_share,
            ..sample.chip
        };
        let factor = edges * self.tool.insert.force_factor();
        let force_n = factor * self.material.cutting_force_n(&chip);
        let pressing = sample.into_material * pressing_force_n(force_n);
        let mut load = CutLoad {
            share: sample.share,
            chip,
            force_n,
            speed_m_per_min: surface_speed_m_per_min(sample.outer_radius_mm, rpm),
            feed_force_n: pressing.dot(sample.feed).max(0.0),
            rpm,
            ..CutLoad::default()
        };
        // A drill cuts from the axis to its radius, so its force acts at the mean radius, and its
        // lips hold each other in the middle.
        let lever_mm = if edges > 1.0 {
            let (torque, thrust) =
                chisel_edge_factors(sample.inner_radius_mm, sample.outer_radius_mm);
            load.feed_force_n *= thrust;
            load.axial_force_n = -pressing.z * thrust;
            sample.mean_radius_mm * torque
        } else {
            load.radial_force_n = -pressing.x;
            load.axial_force_n = -pressing.z;
            load.size_error_mm = 2.0 * load.radial_force_n * self.flexibility(sample.tip_z);
            sample.outer_radius_mm
        };
        load.torque_nm = cutting_torque_nm(force_n, lever_mm);
        load.power_kw = cutting_power_kw(force_n, surface_speed_m_per_min(lever_mm, rpm));
        load
    }

    /// The distance by which tool and part separate for each newton across the axis, mm.
    fn flexibility(&self, tip_z: f64) -> f64 {
        let stock = self.scene.stock_flexibility(tip_z) / self.material.modulus();
        stock + self.tool.holder.flexibility_mm_per_n()
    }
}

/// The spindle speed at the radius `x`, r/min, of a move between two radii, mm. Under G96 the
/// speed is inverse to the radius within the speeds of both ends.
fn rpm_at(conditions: &MoveConditions, (from, to): (f64, f64), x: f64) -> f64 {
    let (start, end) = (conditions.rpm, conditions.end_rpm);
    if start == end || end < 1.0 {
        return start;
    }
    let surface = (start * from.abs()).max(end * to.abs());
    (surface / x.abs().max(1e-6)).clamp(start.min(end), start.max(end))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn under_g96_the_speed_is_inverse_to_the_radius_up_to_the_limit() {
        let conditions = MoveConditions {
            rpm: 500.0,
            end_rpm: 2000.0,
            ..MoveConditions::default()
        };
        let at = |x| rpm_at(&conditions, (40.0, 0.0), x);
        assert_eq!((at(40.0), at(20.0), at(10.0)), (500.0, 1000.0, 2000.0));
        assert_eq!(at(2.0), 2000.0, "the limit of the spindle");
        let fixed = MoveConditions {
            rpm: 800.0,
            end_rpm: 800.0,
            ..MoveConditions::default()
        };
        assert_eq!(rpm_at(&fixed, (40.0, 0.0), 10.0), 800.0);
    }
}
