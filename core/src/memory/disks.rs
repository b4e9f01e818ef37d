//! The electronic disks N0 to N4: sets of parameters, pitch errors and offsets that can be
//! restored (manual III-2.5.1).

use serde::{Deserialize, Serialize};

use super::offsets::Offsets;
use super::parameters::Parameters;
use super::pitch::PitchTable;
use super::table::Disk;
use crate::model::Record;

/// The data on a disk.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DiskContent {
    /// State and data parameters.
    pub parameters: Parameters,
    /// Tool offsets.
    pub offsets: Offsets,
    /// Pitch error table.
    pub pitch: PitchTable,
}

impl DiskContent {
    /// The factory data of a disk for a control model.
    fn factory(disk: Disk, record: &Record) -> Self {
        let mut parameters = Parameters::factory(disk);
        parameters.take_delivered(record);
        Self {
            parameters,
            offsets: Offsets::default(),
            pitch: PitchTable::default(),
        }
    }
}

/// The disks. A disk without saved data has the factory data.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Disks {
    saved: [Option<DiskContent>; 4],
}

const fn place(disk: Disk) -> Option<usize> {
    match disk {
        Disk::N0 => None,
        Disk::N1 => Some(0),
        Disk::N2 => Some(1),
        Disk::N3 => Some(2),
        Disk::N4 => Some(3),
    }
}

impl Disks {
    /// The data on a disk; without saved data, the factory data for the control model.
    pub fn load(&self, disk: Disk, record: &Record) -> DiskContent {
        place(disk)
            .and_then(|place| self.saved[place].clone())
            .unwrap_or_else(|| DiskContent::factory(disk, record))
    }

    /// The saved data of a disk; `None` if it has the factory data. N0 always has the
    /// factory data.
    pub fn saved(&self, disk: Disk) -> Option<&DiskContent> {
        self.saved.get(place(disk)?)?.as_ref()
    }

    /// Saves data on a disk. N0 is read-only: nothing is saved.
    pub fn save(&mut self, disk: Disk, content: DiskContent) {
        if let Some(place) = place(disk) {
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
        assert_eq!(disks.load(Disk::N0, hx31).parameters.value(22), 60_000);
        assert_eq!(disks.load(Disk::N3, td).parameters.value(24), 400);
        let mut content = disks.load(Disk::N0, td);
        content.parameters.set(24, 123).unwrap();
        for disk in [Disk::N0, Disk::N1, Disk::N4] {
            disks.save(disk, content.clone());
        }
        let rapid_time = |disk| disks.load(disk, td).parameters.value(24);
        let all = [Disk::N0, Disk::N1, Disk::N2, Disk::N3, Disk::N4].map(rapid_time);
        assert_eq!(all, [300, 123, 50, 400, 123]);
    }
}
