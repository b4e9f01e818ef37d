//! The data view, after GSKCC (manual V-3): parameters by number and by function, tool
//! offsets, pitch errors, macro variables. All drafts are written together, if the control
//! allows it. An undo list restores the previous values (decision DATA-2).

mod data_values;
mod edit;
mod parameters;
mod sheets;
mod tables;
mod value_field;

use std::sync::Arc;

use egui::Ui;
use gsk_core::memory::ParameterGroup;
use gsk_messages::{Language, Message, say};

use super::interface::{View, ViewFrame, ViewStart};
pub use data_values::{DataValues, MemoryTables};
#[cfg(test)]
pub use edit::DataField;
pub use edit::{DataEdit, ToolOffsetField, is_state_parameter};
use gsk_host::kernel::monitor::MachineView;
use gsk_host::kernel::{Command, Console};
pub use sheets::{DataSheets, WriteRequest, WriteTarget};

/// A page of the data view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DataPage {
    Numbers(ParameterKind),
    Group(ParameterGroup),
    Offsets,
    Pitch,
    Variables,
}

/// The kinds of parameters that a page lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterKind {
    /// State parameters and data parameters.
    All,
    /// State parameters, which consist of eight bits.
    State,
    /// Data parameters, whose value is a number.
    Data,
}

impl DataPage {
    fn name(self) -> Message {
        match self {
            Self::Numbers(kind) => kind.name(),
            Self::Group(group) => group.name(),
            Self::Offsets => say::data_offsets(),
            Self::Pitch => say::data_pitch(),
            Self::Variables => say::data_variables(),
        }
    }
}

impl ParameterKind {
    const ALL: [Self; 3] = [Self::All, Self::State, Self::Data];

    fn name(self) -> Message {
        match self {
            Self::All => say::data_all_parameters(),
            Self::State => say::data_state_parameters(),
            Self::Data => say::data_data_parameters(),
        }
    }
}

pub struct DataView {
    console: Console,
    sheets: DataSheets,
}

impl View for DataView {
    fn create(start: ViewStart<'_>) -> Self {
        Self::new(start.console.clone())
    }

    fn show(&mut self, ui: &mut Ui, frame: ViewFrame<'_>) {
        self.draw(ui, frame.language, frame.machine);
    }
}

impl DataView {
    /// Creates the data view at the page of all parameters.
    pub fn new(console: Console) -> Self {
        Self {
            console,
            sheets: DataSheets::new(WriteTarget::Control),
        }
    }

    fn draw(&mut self, ui: &mut Ui, language: Language, machine: Option<&Arc<MachineView>>) {
        let Some(machine) = machine else {
            ui.label(say::commission_waits().text(language));
            return;
        };
        let values = DataValues::of_control(machine, self.console.model.record());
        if let Some(request) = self.sheets.show(ui, language, &values) {
            let requests = request.edits.iter().map(|edit| edit.request());
            self.console.send(Command::Write(requests.collect()));
        }
    }
}
