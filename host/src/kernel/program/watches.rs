//! Values that the window watches by their names.

use gsk_debugger::watch::WatchTarget;
use gsk_messages::Message;

use super::super::Kernel;

/// A watched value, as the window shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct WatchReading {
    /// The name of the value as the operator has written it.
    pub name: String,
    /// The value as text, or why it cannot be read.
    pub value: Result<String, Message>,
}

impl Kernel {
    /// Reads the watched values of the machine that the snapshots show.
    pub(in crate::kernel) fn read_watches(&self) -> Vec<WatchReading> {
        let simulation = self.shown_machine().simulation();
        let read = |target: &WatchTarget| WatchReading {
            name: target.name().to_owned(),
            value: (target.read(simulation))
                .map(|value| value.to_string())
                .map_err(|alarm| alarm.reason()),
        };
        self.watches.iter().map(read).collect()
    }
}
