//! Turns a measurement file of an axis into parameter changes. Shared by command line and
//! window.

use std::path::Path;

use gsk_commission::{
    ApproachDirection, ImportedFile, Measurement, ParameterChange, PitchPlan, PitchPlanOptions,
    Proposal, ScrewFit, fit_screw, plan_pitch_table, propose_table_values, read_measurement_file,
};
use gsk_core::memory::{ControlParameters, PitchTable};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};
use gsk_project::{DataSet, ProjectDifference, ProjectKey, ProjectState, ProjectValue};

use crate::files::program_file;

/// The direction of motion in which the control adds no backlash compensation: that of the
/// reference return (bit parameters 006.0, 006.1).
pub fn uncompensated_direction(axis: Axis, parameters: &ControlParameters) -> ApproachDirection {
    match parameters.is_reference_negative(axis) {
        true => ApproachDirection::Minus,
        false => ApproachDirection::Plus,
    }
}

/// The result of evaluating a measurement file of pitch errors.
#[derive(Clone, Debug)]
pub enum EvaluatedMeasurement {
    /// Readings, the fitted errors of the screw, and the planned pitch error table.
    Measured(Measurement, ScrewFit, PitchPlan),
    /// The file contains a finished pitch error table, with these proposed values.
    Table(Proposal),
}

impl EvaluatedMeasurement {
    /// Returns the proposed changes of pitch error parameters.
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
/// Unreadable file, or a malformed line: the message names file and line.
pub fn read_file(path: &Path) -> Result<ImportedFile, Message> {
    let file = program_file::read(path).map_err(|error| error.message())?;
    read_measurement_file(&file.text)
        .map_err(|fault| say::pitch_file(path.display(), fault.message()))
}

/// Evaluates a measurement file for an axis, with the control's current parameters and pitch
/// error table. `in_diameters`: the positions of the file are diameters of X.
///
/// # Errors
/// The file is of the other axis, an option does not suit its kind, or its values give no
/// table.
pub fn evaluate_measurement(
    imported: ImportedFile,
    axis: Axis,
    options: PitchPlanOptions,
    in_diameters: bool,
    (parameters, pitch): (&ControlParameters, &PitchTable),
) -> Result<EvaluatedMeasurement, Message> {
    if let Some(other) = imported.axis().filter(|it| *it != axis) {
        return Err(say::pitch_other_axis(axis_letter(other)));
    }
    match imported {
        ImportedFile::Table(_) if options.interval.is_some() || in_diameters => {
            Err(say::pitch_table_form())
        }
        ImportedFile::Table(table) => {
            let proposal = propose_table_values(axis, &table, parameters, pitch, options.clear)?;
            Ok(EvaluatedMeasurement::Table(proposal))
        }
        ImportedFile::Measured(measured) => {
            let measured = match in_diameters {
                true => measured.from_diameters(),
                false => measured,
            };
            let fit = fit_screw(&measured, uncompensated_direction(axis, parameters))?;
            let plan = plan_pitch_table(axis, &fit, parameters, pitch, options)?;
            Ok(EvaluatedMeasurement::Measured(measured, fit, plan))
        }
    }
}

pub const fn axis_letter(axis: Axis) -> char {
    match axis {
        Axis::X => 'X',
        Axis::Z => 'Z',
    }
}

/// Lists parameter changes as project differences to `state`; changes to an equal value are
/// left out.
pub fn list_differences(
    changes: &[ParameterChange],
    state: &ProjectState,
) -> Vec<ProjectDifference> {
    let entries = state.entries();
    let row = |key: ProjectKey, new: i64| ProjectDifference {
        key,
        old: entries.get(&key).cloned(),
        new: Some(ProjectValue::Whole(new)),
    };
    let mut rows = Vec::new();
    for change in changes {
        match *change {
            ParameterChange::Value { number, value } => {
                rows.push(row(
                    ProjectKey::Parameter(DataSet::Control, number, None),
                    value.into(),
                ));
            }
            ParameterChange::Bit { number, bit, on } => {
                let key = ProjectKey::Parameter(DataSet::Control, number, Some(bit));
                rows.push(row(key, on.into()));
            }
            ParameterChange::Pitch { axis, point, value } => {
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
