//! The tool library: tools described by ISO codes, the life of their edges, and the tables of
//! other programs.
//!
//! ```
//! use gsk_tooling::parse_description;
//!
//! let tool = parse_description("CNMG 120408 PCLNR 2020K12").unwrap();
//! assert_eq!((tool.nose(), tool.tip), (0.8, 3));
//! ```

mod description;
mod formats;
mod iso;
mod library;
mod life;

pub use description::{parse_description, tool_description};
pub use formats::{
    FreecadBit, FreecadInserts, ImportedTools, csv_text, freecad_bits, freecad_library_text,
    linuxcnc_text, read_csv, read_freecad_bit, read_freecad_library, read_linuxcnc,
};
pub use iso::{HolderCode, InsertCode, IsoCodeError};
pub use library::{LibraryTool, ToolLibrary};
pub use life::ToolLife;
