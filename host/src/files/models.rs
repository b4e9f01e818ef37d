//! Selects the control model of a data directory and the folder of its memory.
//!
//! ```text
//! DIR/              the memory of the GSK980TD
//! DIR/models/ncb08/ that of the NC-B08: its programs, parameters and all other data
//! DIR/control       the model that the window opens with
//! ```

use std::io;
use std::path::{Path, PathBuf};

use gsk_core::model::ModelId;

use super::atomic;
use crate::platform;

/// Name of the file in the data directory that holds the selected model.
pub const MODEL_FILE: &str = "control";
/// Name of the folder in the data directory with the memories of the models other than the
/// GSK980TD.
pub const MODELS_FOLDER: &str = "models";
/// Size limit of [`MODEL_FILE`], bytes; every model name is shorter.
const MAX_BYTES: u64 = 64;

/// Reads the selected model of a data directory; the GSK980TD if none is stored.
pub fn read_selected_model(directory: &Path) -> ModelId {
    let read = platform::read(&directory.join(MODEL_FILE), MAX_BYTES);
    let text = read.map(|bytes| String::from_utf8_lossy(&bytes).trim().to_owned());
    let id = text.ok().and_then(|word| ModelId::from_command_word(&word));
    id.filter(|id| !id.is_mill()).unwrap_or_default()
}

/// Stores the model that the window opens with.
///
/// # Errors
/// The file cannot be written.
pub fn store_selected_model(directory: &Path, model: ModelId) -> io::Result<()> {
    if read_selected_model(directory) == model {
        return Ok(());
    }
    atomic::write(
        &directory.join(MODEL_FILE),
        format!("{}\n", model.command_word()).as_bytes(),
    )
}

/// Returns the folder that holds the memory of a model in the data directory `directory`.
pub fn memory_folder(directory: &Path, model: ModelId) -> PathBuf {
    match model {
        ModelId::Gsk980td => directory.to_owned(),
        other => directory.join(MODELS_FOLDER).join(other.command_word()),
    }
}

/// Returns the data directory to which a model's memory folder belongs: the inverse of
/// [`memory_folder`].
pub fn data_directory(folder: &Path, model: ModelId) -> PathBuf {
    match model {
        ModelId::Gsk980td => folder.to_owned(),
        _ => folder.ancestors().nth(2).unwrap_or(folder).to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_tests::test_folder;

    #[test]
    fn a_directory_keeps_its_model() {
        let directory = test_folder("model");
        assert_eq!(read_selected_model(&directory), ModelId::Gsk980td);
        store_selected_model(&directory, ModelId::Ncb08).expect("write");
        assert_eq!(read_selected_model(&directory), ModelId::Ncb08);
        for strange in ["", "gsk980mdi\n", "no such model\n", "\u{fffd}\u{0}"] {
            std::fs::write(directory.join(MODEL_FILE), strange).expect("write");
            assert_eq!(
                read_selected_model(&directory),
                ModelId::Gsk980td,
                "{strange:?}"
            );
        }
        assert_eq!(memory_folder(&directory, ModelId::Gsk980td), *directory);
        assert!(memory_folder(&directory, ModelId::Ncb08).ends_with("models/ncb08"));
        for model in ModelId::ALL {
            assert_eq!(
                data_directory(&memory_folder(&directory, model), model),
                *directory
            );
        }
    }
}
