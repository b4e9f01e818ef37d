//! What the programming software GSKCC does with a ladder besides editing it: search, printed
//! diagram, table of parameters (manual PLC-III 3).

mod address_text;
mod operand_role;
mod parameters;
mod print;
mod rung_drawing;
mod search;

pub use address_text::address_comment;
pub use operand_role::{operand_line_count, operand_role};
pub use parameters::{LadderParameter, list_parameters};
pub use print::print_ladder;
pub use search::{LadderMatch, LadderMatches, SearchDirection, search_ladder};
