//! A measurement of an axis from a file to what is to be written: the same for the command
//! line and for the window.

use std::path::Path;

use gsk_commission::{
    Change, Direction, Fit, Imported, Measurement, Plan, PlanWish, Proposal, add_table, fit, plan,
    read,
};
use gsk_core::memory::{Parameters, PitchTable};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};
use gsk_project::{DataSet, ProjectDifference, ProjectKey, ProjectState, ProjectValue};

use crate::files::program_file;

/// The direction of motion in which the control makes up for nothing (006.0, 006.1).
pub fn free_direction(axis: Axis, parameters: &Parameters) -> Direction {
    match parameters.reference_is_negative(axis) {
        true => Direction::Minus,
        false => Direction::Plus,
    }
}

/// What a file gives.
#[derive(Clone, Debug)]
pub enum Found {
    /// Readings, what they say, and the table for it.
    Measured(Measurement, Fit, Plan),
    /// Values of a table.
    Table(Proposal),
}

impl Found {
    /// What is to be written.
    pub const fn proposal(&self) -> &Proposal {
        match self {
            Self::Measured(_, _, plan) => &plan.proposal,
            Self::Table(proposal) => proposal,
        }
    }
}

/// Reads a file of measurements.
///
/// # Errors
/// It cannot be read, or a line of it cannot be: with file and line.
pub fn read_file(path: &Path) -> Result<Imported, Message> {
    let file = program_file::read(path).map_err(|error| error.message())?;
    read(&file.text).map_err(|fault| say::pitch_file(path.display(), fault.message()))
}

/// What a file says of an axis, for a control with these parameters.
///
/// # Errors
/// A file of the other axis, or one that does not fit.
pub fn found(
    imported: Imported,
    axis: Axis,
    wish: PlanWish,
    diameters: bool,
    (parameters, pitch): (&Parameters, &PitchTable),
) -> Result<Found, Message> {
    if let Some(other) = imported.axis().filter(|it| *it != axis) {
        return Err(say::pitch_other_axis(letter(other)));
    }
    match imported {
        Imported::Table(_) if wish.interval.is_some() || diameters => Err(say::pitch_table_form()),
        Imported::Table(table) => {
            let proposal = add_table(axis, &table, parameters, pitch, wish.clear)?;
            Ok(Found::Table(proposal))
        }
        Imported::Measured(measured) => {
            let measured = match diameters {
                true => measured.from_diameters(),
                false => measured,
            };
            let fit = fit(&measured, free_direction(axis, parameters))?;
            let plan = plan(axis, &fit, parameters, pitch, wish)?;
            Ok(Found::Measured(measured, fit, plan))
        }
    }
}

/// The letter of an axis.
pub const fn letter(axis: Axis) -> char {
    match axis {
        Axis::X => 'X',
        Axis::Z => 'Z',
    }
}

/// Changes as differences of what a control holds.
pub fn differences(changes: &[Change], state: &ProjectState) -> Vec<ProjectDifference> {
    let entries = state.entries();
    let row = |key: ProjectKey, new: i64| ProjectDifference {
        key,
        old: entries.get(&key).cloned(),
        new: Some(ProjectValue::Whole(new)),
    };
    let mut rows = Vec::new();
    for change in changes {
        match *change {
            Change::Value { number, value } => {
                rows.push(row(
                    ProjectKey::Parameter(DataSet::Control, number, None),
                    value.into(),
                ));
            }
            Change::Bit { number, bit, on } => {
                let key = ProjectKey::Parameter(DataSet::Control, number, Some(bit));
                rows.push(row(key, on.into()));
            }
            Change::Pitch { axis, point, value } => {
                rows.push(row(
                    ProjectKey::Pitch(DataSet::Control, point, axis),
                    value.into(),
                ));
            }
        }
    }
    rows.retain(|it| it.old != it.new);
    rows
}
