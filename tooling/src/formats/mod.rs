//! Tool tables of other programs: CSV, LinuxCNC, FreeCAD.

mod csv;
mod freecad;
mod freecad_inserts;
mod freecad_quantity;
mod lathe_angles;
mod linuxcnc;

use gsk_messages::Message;

use crate::library::{LibraryTool, ToolLibrary};

pub use csv::{csv_text, read_csv};
pub use freecad::{
    FreecadBit, FreecadInserts, freecad_bits, freecad_library_text, read_freecad_bit,
    read_freecad_library,
};
pub use linuxcnc::{linuxcnc_text, read_linuxcnc};

/// Tools read from a table of another program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportedTools {
    /// The tools with the ids that the table gives them, empty where it gives none.
    pub tools: Vec<(String, LibraryTool)>,
    /// What could not be read, and what is assumed.
    pub notes: Vec<Message>,
}

/// The tools with different T numbers: the station where it is free, else the next free number.
fn numbered_tools(library: &ToolLibrary) -> Vec<(u32, &String, &LibraryTool)> {
    let stations = library
        .tools
        .values()
        .filter_map(|it| it.station.map(u32::from));
    let stations: Vec<u32> = stations.collect();
    let mut free = (1..).filter(|number: &u32| !stations.contains(number));
    let mut taken = Vec::new();
    let numbered = library.tools.iter().map(|(id, tool)| {
        let station = tool.station.map(u32::from).filter(|it| !taken.contains(it));
        let number = station.or_else(|| free.next()).unwrap_or_default();
        taken.push(number);
        (number, id, tool)
    });
    numbered.collect()
}

/// A number as tables write it: no digits that mean nothing.
fn short_number(value: f64) -> String {
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    match text {
        "-0" => "0".to_owned(),
        text => text.to_owned(),
    }
}
