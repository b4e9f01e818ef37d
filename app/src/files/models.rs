//! Which control model a data directory is for, and where each model keeps its memory.
//!
//! ```text
//! DIR/              the memory of the GSK980TD
//! DIR/models/ncb08/ that of the NC-B08: programs, parameters and all else of its own
//! DIR/control       the model that the window opens with
//! ```

use std::io;
use std::path::{Path, PathBuf};

use gsk_core::model::ModelId;

use super::atomic;
use crate::platform;

/// The file that names it.
pub const CHOICE: &str = "control";
/// The folder of the memories of other models.
pub const FOLDER: &str = "models";
/// No word of a model is longer.
const LONGEST: u64 = 64;

/// The model that was chosen for a directory: the GSK980TD where none was.
pub fn chosen(directory: &Path) -> ModelId {
    let read = platform::read(&directory.join(CHOICE), LONGEST);
    let text = read.map(|bytes| String::from_utf8_lossy(&bytes).trim().to_owned());
    let id = text.ok().and_then(|word| ModelId::from_word(&word));
    id.filter(|id| !id.is_mill()).unwrap_or_default()
}

/// Chooses the model that the window opens with.
///
/// # Errors
/// It cannot be written down.
pub fn choose(directory: &Path, model: ModelId) -> io::Result<()> {
    if chosen(directory) == model {
        return Ok(());
    }
    atomic::write(
        &directory.join(CHOICE),
        format!("{}\n", model.word()).as_bytes(),
    )
}

/// Where a model keeps its memory.
pub fn folder(directory: &Path, model: ModelId) -> PathBuf {
    match model {
        ModelId::Gsk980td => directory.to_owned(),
        other => directory.join(FOLDER).join(other.word()),
    }
}

/// The data directory that a model keeps its memory in.
pub fn directory(folder: &Path, model: ModelId) -> PathBuf {
    match model {
        ModelId::Gsk980td => folder.to_owned(),
        _ => folder.ancestors().nth(2).unwrap_or(folder).to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::test_folder;

    #[test]
    fn a_directory_keeps_its_model() {
        let directory = test_folder("model");
        assert_eq!(chosen(&directory), ModelId::Gsk980td);
        choose(&directory, ModelId::Ncb08).expect("write");
        assert_eq!(chosen(&directory), ModelId::Ncb08);
        for strange in ["", "gsk980mdi\n", "no such model\n", "\u{fffd}\u{0}"] {
            std::fs::write(directory.join(CHOICE), strange).expect("write");
            assert_eq!(chosen(&directory), ModelId::Gsk980td, "{strange:?}");
        }
        assert_eq!(folder(&directory, ModelId::Gsk980td), *directory);
        assert!(folder(&directory, ModelId::Ncb08).ends_with("models/ncb08"));
        for model in ModelId::ALL {
            assert_eq!(
                super::directory(&folder(&directory, model), model),
                *directory
            );
        }
    }
}
