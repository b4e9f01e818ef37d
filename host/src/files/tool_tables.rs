//! Tool tables of other programs as files.

use std::path::{Path, PathBuf};

use gsk_messages::{Message, say};
use gsk_tooling::{
    FreecadInserts, ImportedTools, ToolLibrary, csv_text, freecad_bits, freecad_library_text,
    linuxcnc_text, read_csv, read_freecad_bit, read_freecad_library, read_linuxcnc,
};

use crate::files::{atomic, program_file, tool_library};
use crate::platform;

/// FreeCAD keeps lists of tools in this folder, and the tools in a folder `Bit` beside it.
const FREECAD_LISTS: &str = "Library";
/// FreeCAD's folder of tools.
const FREECAD_TOOLS: &str = "Bit";

/// The format of a tool table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToolTableFormat {
    Csv,
    LinuxCnc,
    FreeCad,
    /// FreeCAD's with the shapes of its add-on for lathes; read like [`Self::FreeCad`].
    FreeCadLathe,
    /// The file of this program's library.
    Ron,
}

impl ToolTableFormat {
    /// Returns the format by the ending of a file name; `None` if it means none.
    pub fn from_path(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_string_lossy().to_lowercase();
        match ending.as_str() {
            "csv" | "txt" => Some(Self::Csv),
            "tbl" => Some(Self::LinuxCnc),
            "fctl" => Some(Self::FreeCad),
            "ron" => Some(Self::Ron),
            _ => None,
        }
    }

    /// Returns the format of a file to read: [`Self::from_path`], or a single tool of FreeCAD.
    pub fn from_input_path(path: &Path) -> Option<Self> {
        Self::from_path(path).or_else(|| is_freecad_bit(path).then_some(Self::FreeCad))
    }
}

/// Whether a file is a single tool of FreeCAD.
fn is_freecad_bit(path: &Path) -> bool {
    path.extension()
        .is_some_and(|it| it.eq_ignore_ascii_case("fctb"))
}

/// Reads a tool table. `unit_mm` is the unit of lengths in a table of LinuxCNC.
///
/// # Errors
/// The file cannot be read or is no table of this format.
pub fn import(
    path: &Path,
    format: ToolTableFormat,
    unit_mm: f64,
) -> Result<ImportedTools, Message> {
    if format == ToolTableFormat::Ron {
        let library = tool_library::read_file(path)?;
        return Ok(ImportedTools {
            tools: library.tools.into_iter().collect(),
            notes: Vec::new(),
        });
    }
    let text = program_file::read(path)
        .map_err(|error| error.message())?
        .text;
    let in_file = |why: Message| say::subject_reason(path.display(), why);
    match format {
        ToolTableFormat::LinuxCnc => Ok(read_linuxcnc(&text, unit_mm)),
        ToolTableFormat::FreeCad | ToolTableFormat::FreeCadLathe if is_freecad_bit(path) => {
            let mut imported = ImportedTools::default();
            let stem = path.file_stem().unwrap_or_default();
            read_freecad_bit(&mut imported, &text, &stem.to_string_lossy(), 0);
            Ok(imported)
        }
        ToolTableFormat::FreeCad | ToolTableFormat::FreeCadLathe => {
            let list = read_freecad_library(&text).map_err(in_file)?;
            Ok(import_freecad(path, &list))
        }
        ToolTableFormat::Csv | ToolTableFormat::Ron => read_csv(&text).map_err(in_file),
    }
}

/// Reads the tools of a FreeCAD list from the folders where FreeCAD keeps them.
fn import_freecad(path: &Path, list: &[(u32, String)]) -> ImportedTools {
    let mut imported = ImportedTools::default();
    let folder = path.parent().unwrap_or(Path::new(""));
    for (number, name) in list {
        let folders = [folder.join("..").join(FREECAD_TOOLS), folder.to_owned()];
        let mut candidates = folders.iter().map(|it| it.join(name));
        let found = candidates.find(|it| platform::is_taken(it));
        let text = found.and_then(|it| program_file::read(&it).ok());
        match text {
            Some(file) => {
                let stem = Path::new(name).file_stem().unwrap_or_default();
                read_freecad_bit(&mut imported, &file.text, &stem.to_string_lossy(), *number);
            }
            None => imported.notes.push(say::tool_freecad_missing(name, number)),
        }
    }
    imported
}

/// Returns the text of a library as a table in one file; `None` for a format of several files.
pub fn table_text(library: &ToolLibrary, format: ToolTableFormat) -> Option<String> {
    match format {
        ToolTableFormat::Csv => Some(csv_text(library)),
        ToolTableFormat::LinuxCnc => Some(linuxcnc_text(library)),
        ToolTableFormat::FreeCad | ToolTableFormat::FreeCadLathe | ToolTableFormat::Ron => None,
    }
}

/// Writes a library as a table.
///
/// # Errors
/// A file cannot be written.
pub fn export(library: &ToolLibrary, path: &Path, format: ToolTableFormat) -> Result<(), Message> {
    if format == ToolTableFormat::Ron {
        return tool_library::write_file(path, library);
    }
    let write = |path: &Path, text: &str| {
        let failed = |error| say::subject_reason(path.display(), say::as_written(error));
        atomic::write(path, text.as_bytes()).map_err(failed)
    };
    if let Some(text) = table_text(library, format) {
        return write(path, &text);
    }
    let label = path.file_stem().unwrap_or_default().to_string_lossy();
    write(path, &freecad_library_text(library, &label))?;
    let folder = freecad_tool_folder(path);
    let failed = |error| say::subject_reason(folder.display(), say::as_written(error));
    platform::make_folder(&folder).map_err(failed)?;
    let inserts = match format {
        ToolTableFormat::FreeCadLathe => FreecadInserts::LatheAddon,
        _ => FreecadInserts::EndMill,
    };
    for bit in freecad_bits(library, inserts) {
        write(&folder.join(&bit.file_name), &bit.text)?;
    }
    Ok(())
}

/// The folder of the tools of a FreeCAD list: FreeCAD's own if the list is in FreeCAD's folder
/// of lists, else that of the list.
fn freecad_tool_folder(list: &Path) -> PathBuf {
    let folder = list.parent().unwrap_or(Path::new(""));
    match folder.file_name().is_some_and(|it| it == FREECAD_LISTS) {
        true => folder.parent().unwrap_or(folder).join(FREECAD_TOOLS),
        false => folder.to_owned(),
    }
}

/// Adds imported tools to a library; tools with a known id replace it only if `replaces`.
///
/// # Errors
/// A tool breaks a rule, or the library is full.
pub fn add_imported(
    library: &mut ToolLibrary,
    imported: ImportedTools,
    replaces: bool,
) -> Result<usize, Message> {
    let count = imported.tools.len();
    for (id, tool) in imported.tools {
        let is_usable = !id.is_empty() && (replaces || !library.tools.contains_key(&id));
        let name = match (id.is_empty(), tool.code.is_empty()) {
            (false, _) => id.clone(),
            (true, false) => tool.code.clone(),
            (true, true) => tool.description(),
        };
        let id = if is_usable {
            id
        } else {
            library.free_id(&name)
        };
        if library.insert(&id, tool.clone()).is_err() {
            // The id of another program may have characters that this one refuses.
            let id = library.free_id(&id);
            library.insert(&id, tool)?;
        }
    }
    Ok(count)
}
