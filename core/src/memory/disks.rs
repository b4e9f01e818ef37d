//! The electronic disks N0 to N4: sets of parameters, pitch errors and offsets that can be
//! restored (manual III-2.5.1).

use serde::{Deserialize, Serialize};

use super::offsets::Offsets;
use super::parameter_table::ElectronicDisk;
use super::parameters::ControlParameters;
use super::pitch::PitchTable;
use crate::model::ModelRecord;

/// The data stored on an electronic disk: parameters, offsets and pitch errors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DiskContent {
    /// Values of the state and data parameters.
    pub parameters: ControlParameters,
    /// Table of the tool offsets.
    pub offsets: Offsets,
    /// Pitch error tables of both axes.
    pub pitch: PitchTable,
}

impl DiskContent {
    /// The factory data of a disk for a control model.
    fn factory(disk: ElectronicDisk, record: &ModelRecord) -> Self {
        let mut parameters = ControlParameters::factory(disk);
        parameters.apply_delivered_values(record);
        Self {
            parameters,
            offsets: Offsets::default(),
            pitch: PitchTable::default(),
        }
    }
}

/// The data saved on the electronic disks; a disk without saved data has the factory data.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Disks {
    saved: [Option<DiskContent>; 4],
}

const fn save_index(disk: ElectronicDisk) -> Option<usize> {
    match disk {
        ElectronicDisk::N0 => None,
        ElectronicDisk::N1 => Some(0),
        ElectronicDisk::N2 => Some(1),
        ElectronicDisk::N3 => Some(2),
        ElectronicDisk::N4 => Some(3),
    }
}

impl Disks {
    /// The data on a disk: the saved data, otherwise the factory data of the control model.
    pub fn load(&self, disk: ElectronicDisk, record: &ModelRecord) -> DiskContent {
        save_index(disk)
            .and_then(|place| self.saved[place].clone())
            .unwrap_or_else(|| DiskContent::factory(disk, record))
    }

    /// The saved data of a disk; `None` if nothing was saved, and always for N0, which is
    /// read-only.
    pub fn saved(&self, disk: ElectronicDisk) -> Option<&DiskContent> {
        self.saved.get(save_index(disk)?)?.as_ref()
    }

    /// Saves data on a disk. N0 is read-only: the call has no effect.
    pub fn save(&mut self, disk: ElectronicDisk, content: DiskContent) {
        if let Some(place) = save_index(disk) {
            self.saved[place] = Some(content);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::ModelId;

    #[test]
    fn disks_keep_what_is_saved() {
        let mut disks = Disks::default();
        let td = ModelId::default().record();
        let hx31 = ModelId::Hx31.record();
        assert_eq!(
            disks.load(ElectronicDisk::N0, hx31).parameters.value(22),
            60_000
        );
        assert_eq!(disks.load(ElectronicDisk::N3, td).parameters.value(24), 400);
        let mut content = disks.load(ElectronicDisk::N0, td);
        content.parameters.set(24, 123).unwrap();
        for disk in [ElectronicDisk::N0, ElectronicDisk::N1, ElectronicDisk::N4] {
            disks.save(disk, content.clone());
        }
        let rapid_time = |disk| disks.load(disk, td).parameters.value(24);
        let all = [
            ElectronicDisk::N0,
            ElectronicDisk::N1,
            ElectronicDisk::N2,
            ElectronicDisk::N3,
            ElectronicDisk::N4,
        ]
        .map(rapid_time);
        assert_eq!(all, [300, 123, 50, 400, 123]);
    }
}
