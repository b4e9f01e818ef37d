//! What a ported program needs of the lathe besides the equipment as delivered.

use crate::block::split_block;
use crate::number::Number;
use crate::porter::PortedProgram;

/// Equipment that a ported program needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MachineNeeds {
    /// The highest tool number that T calls: the tool post needs as many stations (parameter 084).
    pub tool_stations: i64,
    /// Whether G41 or G42 occurs: the option nose radius compensation (parameter 002.1).
    pub nose_compensation: bool,
}

impl PortedProgram {
    /// Returns what the ported text needs of the lathe.
    pub fn machine_needs(&self) -> MachineNeeds {
        let mut needs = MachineNeeds::default();
        for (line, text) in (1..).zip(self.text.lines()) {
            let block = split_block(line, text);
            for word in block.words() {
                let number = word.number.and_then(Number::whole);
                match (word.letter, number) {
                    (b'T', Some(number)) => {
                        needs.tool_stations = needs.tool_stations.max(number / 100);
                    }
                    (b'G', Some(41 | 42)) => needs.nose_compensation = true,
                    _ => {}
                }
            }
        }
        needs
    }
}
