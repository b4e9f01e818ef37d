//! The settings of the window that are stored from one start to the next.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use gsk_host::network::NetworkSettings;
use gsk_host::pc::TransferSettings;
use serde::{Deserialize, Serialize};

use super::layout::Layouts;
use gsk_messages::Language;

/// Maximum number of recent programs that are stored.
const MAX_RECENT: usize = 10;

/// The projects that the settings store for the next start.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ProjectSettings {
    /// The folder of the open project; `None` if none is open.
    pub open: Option<PathBuf>,
    /// The folders of the last projects, the newest first.
    pub recent: Vec<PathBuf>,
}

/// The camera of the lathe view in the form in which it is stored for the next start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct StoredSceneCamera {
    /// Index of the chosen preset, from 0; `None` if the operator has moved the camera.
    pub preset: Option<u8>,
    /// Target x, y, z, µm; yaw, pitch, thousandths of a radian; distance, µm. `None`: as the
    /// preset has them.
    pub position: Option<[i32; 6]>,
    /// Whether the projection of the camera is parallel.
    pub is_parallel: bool,
}

/// The stored settings of the window.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct WindowSettings {
    /// Language of menus and messages.
    pub language: Language,
    /// The recently opened programs, the newest first.
    pub recent: Vec<PathBuf>,
    /// Layouts of the main window, and positions of separate windows.
    pub layouts: Layouts,
    /// True for the light theme, false for the dark one.
    pub light: bool,
    /// True if the machine view shows the part as a solid, false for a half section.
    pub solid: bool,
    /// Camera of the lathe view; `None` for the operator's view.
    pub scene_camera: Option<StoredSceneCamera>,
    /// Names of the finished lessons.
    pub lessons: BTreeSet<String>,
    /// The learner's best points by the name of the exercise.
    pub exercises: BTreeMap<String, u32>,
    /// Name of the learner that results of exercises contain.
    pub learner: String,
    /// Port, baud rate and files of the transfer view.
    pub transfer: TransferSettings,
    /// The open project and the recent ones.
    pub projects: ProjectSettings,
    /// What is switched on in the network.
    pub network: NetworkSettings,
    /// Whether the questions of the first start are still unanswered.
    pub first_start: bool,
    /// The machine file that was chosen at the first start; `None`: the simulated lathe as
    /// delivered.
    pub machine: Option<PathBuf>,
    /// Zoom of the whole window, per cent; `None`: chosen by the size of the monitor.
    pub zoom: Option<u16>,
    /// Whether the keys of the panel must be at least as large as a finger.
    pub fingers: bool,
    /// Whether the time line of the session is shown.
    pub timeline: bool,
    /// Volume of the machine's sound, per cent; `None`: the sound is off.
    pub sound: Option<u8>,
    /// Names of the values that the program view watches.
    pub watches: Vec<String>,
}

impl Default for WindowSettings {
    fn default() -> Self {
        Self {
            language: Language::Zh,
            recent: Vec::new(),
            layouts: Layouts::default(),
            light: false,
            solid: false,
            scene_camera: None,
            lessons: BTreeSet::new(),
            exercises: BTreeMap::new(),
            learner: String::new(),
            transfer: TransferSettings::default(),
            projects: ProjectSettings::default(),
            network: NetworkSettings::default(),
            first_start: false,
            machine: None,
            zoom: None,
            fingers: false,
            timeline: false,
            sound: None,
            watches: Vec::new(),
        }
    }
}

impl WindowSettings {
    /// Adds a program at the front of the recent programs; removes the oldest above the limit.
    pub fn add_recent(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent.retain(|known| *known != path);
        self.recent.insert(0, path);
        self.recent.truncate(MAX_RECENT);
    }
}
