//! Forms for programmers who have a drawing: each form has fields with the dimensions of a cut,
//! writes blocks of this control for them, and reads its fields from the written text again.
//!
//! ```
//! use gsk_forms::{FormKind, FormValues, find_sections, write_form};
//!
//! let mut values = FormValues::new(FormKind::Turn);
//! values.set_text("STOCK", "50").unwrap();
//! values.set_text("D", "40").unwrap();
//! let section = write_form(&values).unwrap();
//! let found = find_sections(&section);
//! assert_eq!(found[0].values.as_ref().unwrap(), &values.complete());
//! assert!(!found[0].is_edited);
//! ```

mod blocks;
mod common_fields;
mod contour;
mod error;
mod fields;
mod form_table;
mod job;
mod kind;
mod library_tool;
mod proposal;
mod section;
mod shape_fields;
mod thousandths;
mod thread_table;
mod tool_path;
mod values;

pub use blocks::{DrawnOutline, drawn_outline};
pub use contour::{
    CornerShape, OutlineSolution, SolvedPiece, TurnedArc, TurnedOutline, TurnedPoint,
    outline_of_profile,
};
pub use error::FormError;
pub use fields::{FieldInput, FieldOption, FieldRow, FieldUnit};
pub use form_table::form_fields;
pub use job::{NoseOffset, form_job, nose_offset, program_job};
pub use kind::FormKind;
pub use section::{FormSection, find_sections, free_sequence_number, whole_program, write_form};
pub use thousandths::Thousandths;
pub use thread_table::{
    ThreadPitch, ThreadProfile, ThreadRow, ThreadStandard, find_thread, thread_rows,
    thread_table_text,
};
pub use values::{FormField, FormValue, FormValues};
