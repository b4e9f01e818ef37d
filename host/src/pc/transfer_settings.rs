//! Remembers the settings of the PC side: port, rate and files to send (manual V-3.3).

use std::path::PathBuf;

use gsk_transfer::{FileName, Partition};
use serde::{Deserialize, Serialize};

use crate::files::{data_dir, models};

/// Rate of a control as delivered, bits a second (parameter 044).
pub const DELIVERED_BAUD: u32 = 115_200;

/// A file in the send list (发送文件).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SendListItem {
    /// Path of the file on the PC (发送文件路径).
    pub path: PathBuf,
    /// Name that the file gets at the control (CNC保存文件名).
    pub name: String,
    /// Index of the partition (存储区) in [`Partition::ALL`].
    pub partition: usize,
}

impl SendListItem {
    /// Returns the partition of the item; the first one if the stored index is out of range.
    pub fn partition(&self) -> Partition {
        Partition::ALL
            .get(self.partition)
            .copied()
            .unwrap_or_default()
    }

    /// Formats the item as a line of a saved list: path, name and partition, separated by
    /// tabs.
    pub fn to_line(&self) -> String {
        let (path, name) = (self.path.display(), &self.name);
        format!("{path}\t{name}\t{}\n", self.partition().name())
    }

    /// Parses a line of a saved list; `None` if the path is empty or the name is invalid.
    pub fn from_line(line: &str) -> Option<Self> {
        let mut words = line.trim_end().split('\t');
        let (path, name) = (words.next()?, words.next()?);
        let partition = words.next().unwrap_or_default();
        let mut all = Partition::ALL.into_iter();
        let partition = all.position(|it| it.name().eq_ignore_ascii_case(partition));
        FileName::new(name).ok()?;
        (!path.is_empty()).then(|| Self {
            path: PathBuf::from(path),
            name: name.to_owned(),
            partition: partition.unwrap_or_default(),
        })
    }
}

/// Settings that the transfer view of the window remembers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct TransferSettings {
    /// The name of the port (端口选择); empty before the first one was selected.
    pub port: String,
    /// Rate of the port, bits a second (波特率).
    pub baud: u32,
    /// The files in the send list (发送文件).
    pub list: Vec<SendListItem>,
}

impl Default for TransferSettings {
    fn default() -> Self {
        Self {
            port: String::new(),
            baud: DELIVERED_BAUD,
            list: Vec::new(),
        }
    }
}

/// Those of the window's settings that the command line reads.
#[derive(Default, Deserialize)]
#[serde(default)]
struct WindowTransferSettings {
    transfer: TransferSettings,
}

/// Reads the transfer settings that the window has saved last; `None` if they name no port. A
/// running window has not saved the changes of its last second yet.
pub fn load_window_settings() -> Option<TransferSettings> {
    let path = data_dir::default_data_path().ok()?;
    let folder = models::memory_folder(&path, models::read_selected_model(&path));
    let text = std::fs::read_to_string(folder.join("window.ron")).ok()?;
    let settings: WindowTransferSettings = ron::from_str(&text).ok()?;
    Some(settings.transfer).filter(|it| !it.port.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_read_as_it_was_written() {
        let item = SendListItem {
            path: PathBuf::from("/parts/轴 1.nc"),
            name: "O0007.CNC".to_owned(),
            partition: 1,
        };
        assert_eq!(item.to_line(), "/parts/轴 1.nc\tO0007.CNC\tUSER1\n");
        assert_eq!(SendListItem::from_line(&item.to_line()), Some(item));
        assert_eq!(SendListItem::from_line("a.nc\t轴.CNC\tUSER"), None);
        assert_eq!(SendListItem::from_line(""), None);
    }

    #[test]
    fn of_the_settings_of_a_window_only_this_is_read() {
        let text = "(language: En, transfer: (port: \"COM3\", baud: 9600), light: true)";
        let read: WindowTransferSettings = ron::from_str(text).expect("settings");
        assert_eq!(
            (read.transfer.port.as_str(), read.transfer.baud),
            ("COM3", 9600)
        );
        let before: WindowTransferSettings = ron::from_str("(language: En)").expect("settings");
        assert_eq!(before.transfer, TransferSettings::default());
    }
}
