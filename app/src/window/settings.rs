//! What the window remembers from one start to the next.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::layout::Layouts;
use super::views::project::Projects;
use crate::pc::Remembered;
use gsk_messages::Language;

/// Programs that are remembered.
const MOST: usize = 10;

/// What the window remembers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// Language of menus and messages.
    pub language: Language,
    /// The last programs, the newest first.
    pub recent: Vec<PathBuf>,
    /// Layouts, and where windows are.
    pub layouts: Layouts,
    /// What surrounds panel and pictures is light, else dark.
    pub light: bool,
    /// The machine view shows the part as a solid, else as a half section.
    pub solid: bool,
    /// Lessons that were done to their end, by name.
    pub lessons: BTreeSet<String>,
    /// Port, speed and files of the view that is the PC's side of the serial port.
    pub transfer: Remembered,
    /// Projects of the last time.
    pub projects: Projects,
    /// The questions of the first start wait to be answered.
    pub first_start: bool,
    /// The lathe that was chosen at the first start; none: the simulated one as delivered.
    pub machine: Option<PathBuf>,
    /// How large everything is, per cent; none: as the monitor asks for.
    pub zoom: Option<u16>,
    /// Keys of the panel are at least as large as fingers.
    pub fingers: bool,
    /// Volume of the machine's sound, per cent; none: it is silent.
    pub sound: Option<u8>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            language: Language::Zh,
            recent: Vec::new(),
            layouts: Layouts::default(),
            light: false,
            solid: false,
            lessons: BTreeSet::new(),
            transfer: Remembered::default(),
            projects: Projects::default(),
            first_start: false,
            machine: None,
            zoom: None,
            fingers: false,
            sound: None,
        }
    }
}

impl Settings {
    /// Puts a program in front of the last ones.
    pub fn remember(&mut self, path: &Path) {
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent.retain(|known| *known != path);
        self.recent.insert(0, path);
        self.recent.truncate(MOST);
    }
}
