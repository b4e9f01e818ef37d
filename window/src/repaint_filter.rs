//! Decides whether a repaint that the kernel requests would change the window. The scan of the
//! PLC moves on all the time, and with it the machine state that the kernel publishes, but most
//! states look like the one before.

use std::sync::Arc;

use crossbeam::channel::Receiver;
use crossbeam::queue::ArrayQueue;
use gsk_host::kernel::monitor::MachineView;
use gsk_host::kernel::part::PartView;
use gsk_host::kernel::{Console, Notice, PanelSnapshot};
use gsk_host::termination::TerminationFlag;

/// Compares published machine states with the last one that was repainted.
pub struct RepaintFilter {
    snapshots: Arc<ArrayQueue<PanelSnapshot>>,
    machine: Arc<ArrayQueue<MachineView>>,
    part: Arc<ArrayQueue<PartView>>,
    notices: Receiver<Notice>,
    termination: TerminationFlag,
    last_machine: Option<MachineView>,
}

impl RepaintFilter {
    /// Creates a filter for the states that `console` receives. Once `termination` is requested,
    /// the filter passes every repaint on.
    pub fn new(console: &Console, termination: TerminationFlag) -> Self {
        Self {
            snapshots: Arc::clone(&console.snapshots),
            machine: Arc::clone(&console.machine),
            part: Arc::clone(&console.part),
            notices: console.notices.clone(),
            termination,
            last_machine: None,
        }
    }

    /// Whether a requested repaint is necessary. Discards a machine state that looks like the
    /// last one, unless the window has taken it already.
    pub fn needs_repaint(&mut self) -> bool {
        let machine = self.machine.pop();
        let is_other_news =
            !(self.snapshots.is_empty() && self.part.is_empty() && self.notices.is_empty());
        let Some(machine) = machine else { return true };
        let last = self.last_machine.as_ref();
        if last.is_some_and(|last| looks_same(last, &machine)) {
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
fn looks_same(one: &MachineView, other: &MachineView) -> bool {
    let (scan, other_scan) = (&one.plc, &other.plc);
    let is_plc_same = match one.halted || other.halted {
        true => scan == other_scan,
        false => {
            Arc::ptr_eq(scan.ladder(), other_scan.ladder())
                && scan.memory() == other_scan.memory()
                && scan.fault() == other_scan.fault()
                && scan.forces() == other_scan.forces()
        }
    };
    is_plc_same
        && one.halted == other.halted
        && one.lathe == other.lathe
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
