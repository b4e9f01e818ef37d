//! Decides whether a repaint that the kernel requests would change the window. The scan of the
//! PLC moves on all the time, and with it the machine state that the kernel publishes, but most
//! states look like the one before.

use std::sync::Arc;

use crossbeam::channel::Receiver;
use crossbeam::queue::ArrayQueue;
use gsk_core::machine::{LatheFault, SimulatedLathe};
use gsk_core::plc::PlcMemory;
use gsk_core::plc::address::Area;
use gsk_core::units::Point;
use gsk_host::kernel::monitor::MachineView;
use gsk_host::kernel::part::PartView;
use gsk_host::kernel::timeline::TimelineView;
use gsk_host::kernel::{Console, Notice, PanelSnapshot};
use gsk_host::termination::TerminationFlag;

use crate::shown_content::ShownContent;

/// Differences of positions below this one are not shown, mm.
const SHOWN_MM: f64 = 0.000_1;
/// Differences of the spindle speed below this one are not shown, r/min.
const SHOWN_RPM: f64 = 0.1;

/// Compares published machine states with the last one that was repainted.
pub struct RepaintFilter {
    snapshots: Arc<ArrayQueue<PanelSnapshot>>,
    machine: Arc<ArrayQueue<MachineView>>,
    part: Arc<ArrayQueue<Arc<PartView>>>,
    timeline: Arc<ArrayQueue<Arc<TimelineView>>>,
    notices: Receiver<Notice>,
    termination: TerminationFlag,
    shown: Arc<ShownContent>,
    last_machine: Option<MachineView>,
}

impl RepaintFilter {
    /// Creates a filter for the states that `console` receives. Once `termination` is requested,
    /// the filter passes every repaint on. `shown`: what the window shows.
    pub fn new(console: &Console, termination: TerminationFlag, shown: Arc<ShownContent>) -> Self {
        Self {
            snapshots: Arc::clone(&console.snapshots),
            machine: Arc::clone(&console.machine),
            part: Arc::clone(&console.part),
            timeline: Arc::clone(&console.timeline),
            notices: console.notices.clone(),
            termination,
            shown,
            last_machine: None,
        }
    }

    /// Whether a requested repaint is necessary. Discards a machine state that looks like the
    /// last one, unless the window has taken it already.
    pub fn needs_repaint(&mut self) -> bool {
        let machine = self.machine.pop();
        let is_other_news = !(self.snapshots.is_empty()
            && self.part.is_empty()
            && self.timeline.is_empty()
            && self.notices.is_empty());
        let Some(machine) = machine else { return true };
        let last = self.last_machine.as_ref();
        let with_memory = self.shown.has_plc_memory();
        if last.is_some_and(|last| looks_same(last, &machine, with_memory)) {
            return is_other_news || self.termination.is_requested();
        }
        // A newer state may have arrived since: it stays.
        if self.machine.push(machine.clone()).is_ok() {
            self.last_machine = Some(machine);
        }
        true
    }
}

/// Whether no view shows a difference between two machine states. Both have all that views
/// read; the part of the ladder that the scan runs next shows only while the scan is halted.
/// `with_memory`: a view shows more of the PLC memory than the inputs.
fn looks_same(one: &MachineView, other: &MachineView, with_memory: bool) -> bool {
    let (scan, other_scan) = (&one.plc, &other.plc);
    let is_plc_same = match one.halted || other.halted {
        true => scan == other_scan,
        false => {
            Arc::ptr_eq(scan.ladder(), other_scan.ladder())
                && has_same_memory(scan.memory(), other_scan.memory(), with_memory)
                && scan.fault() == other_scan.fault()
                && scan.forces() == other_scan.forces()
        }
    };
    is_plc_same
        && one.halted == other.halted
        && looks_same_lathe(&one.lathe, &other.lathe)
        && one.inputs == other.inputs
        && one.next_ladder == other.next_ladder
        && one.ladder_refused == other.ladder_refused
        && one.parameters == other.parameters
        && one.pitch == other.pitch
        && one.parameters_refused == other.parameters_refused
        && one.offsets == other.offsets
        && one.variables == other.variables
        && one.alarms == other.alarms
}

/// Whether two PLC memories are equal, or only their inputs if no view shows the rest.
fn has_same_memory(one: &PlcMemory, other: &PlcMemory, whole: bool) -> bool {
    if whole {
        return one == other;
    }
    one.area(Area::X) == other.area(Area::X)
}

/// Whether no view shows a difference between two states of the lathe. Following error and
/// spindle speed fade out for a minute after a motion, far below the last digit.
fn looks_same_lathe(one: &SimulatedLathe, other: &SimulatedLathe) -> bool {
    let is_near = |one: Point, other: Point| {
        (one.x - other.x).abs() < SHOWN_MM && (one.z - other.z).abs() < SHOWN_MM
    };
    let signals = |it: &SimulatedLathe| {
        (
            it.is_tool_post_clamped(),
            it.is_chuck_clamped(),
            it.is_tailstock_forward(),
            it.is_coolant_on(),
            it.is_lubrication_on(),
            it.is_over_limit(),
            it.is_emergency_loop_closed(),
            it.station(),
            it.forced_input_count(),
        )
    };
    let mut faults = LatheFault::ALL.into_iter();
    is_near(one.slide_position(), other.slide_position())
        && is_near(one.following_error(), other.following_error())
        && (one.spindle_rpm() - other.spindle_rpm()).abs() < SHOWN_RPM
        && signals(one) == signals(other)
        && faults.all(|(_, fault)| one.has_fault(fault) == other.has_fault(fault))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::plc::address::ByteAddress;

    #[test]
    fn a_running_timer_is_news_only_where_the_memory_is_shown() {
        let still = PlcMemory::default();
        let mut timed = still.clone();
        timed.set_byte(ByteAddress::new(Area::R, 100), 1);
        assert!(has_same_memory(&still, &timed, false));
        assert!(!has_same_memory(&still, &timed, true));
        let mut pressed = still.clone();
        pressed.set_byte(ByteAddress::new(Area::X, 24), 1);
        assert!(!has_same_memory(&still, &pressed, false));
    }
}
