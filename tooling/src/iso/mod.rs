//! The designations of ISO 1832 (inserts), ISO 5608 (square shanks) and ISO 6261 (boring bars).

mod code_reader;
mod holder_code;
mod insert_code;

pub use code_reader::IsoCodeError;
pub use holder_code::HolderCode;
pub use insert_code::InsertCode;
