//! Edits values of the open project on the sheets of the data view (manual V-3).

use std::sync::Arc;

use egui::Ui;
use gsk_commission::ParameterChange;
use gsk_core::memory::ParameterGroup;
use gsk_messages::Language;
use gsk_project::{
    DataSet, OffsetColumn, ProjectDifference, ProjectKey, ProjectState, ProjectValue,
};

use super::super::data::{
    DataEdit, DataPage, DataSheets, DataValues, MemoryTables, ToolOffsetField, WriteRequest,
    WriteTarget, is_state_parameter,
};
use super::tree::ProjectNode;

/// The pages with fields, and the tables of the project that they show.
pub struct ProjectSheets {
    sheets: DataSheets,
    tables: Option<(Arc<ProjectState>, MemoryTables)>,
}

impl Default for ProjectSheets {
    fn default() -> Self {
        Self {
            sheets: DataSheets::new(WriteTarget::Project),
            tables: None,
        }
    }
}

impl ProjectSheets {
    /// The data page for a node of the tree; `None` for a node without fields.
    pub const fn page_of(node: ProjectNode) -> Option<DataPage> {
        match node {
            ProjectNode::Parameters => Some(DataPage::Group(ParameterGroup::ALL[0])),
            ProjectNode::Offsets => Some(DataPage::Offsets),
            ProjectNode::Pitch => Some(DataPage::Pitch),
            ProjectNode::Variables => Some(DataPage::Variables),
            _ => None,
        }
    }

    /// Whether typed values were not written into the project yet.
    pub fn has_drafts(&self) -> bool {
        self.sheets.has_drafts()
    }

    /// Shows the reason why the last request to write was refused.
    pub fn show_refusal(&mut self, reason: gsk_messages::Message, request: &WriteRequest) {
        self.sheets.show_refusal(reason, request);
    }

    /// Draws a page and returns the values to write into the project; `None` without any.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        language: Language,
        page: DataPage,
        state: &Arc<ProjectState>,
    ) -> Option<WriteRequest> {
        let is_current = |known: &&(Arc<ProjectState>, MemoryTables)| Arc::ptr_eq(&known.0, state);
        if self.tables.as_ref().filter(is_current).is_none() {
            self.tables = Some((Arc::clone(state), MemoryTables::from_memory(state.memory())));
        }
        let (_, tables) = self.tables.as_ref()?;
        let values = DataValues::of_memory(state.memory(), tables);
        self.sheets.show_page(page);
        self.sheets.show(ui, language, &values)
    }
}

/// Returns the differences that edits would make to the project `state`.
pub fn differences_of_edits(edits: &[DataEdit], state: &ProjectState) -> Vec<ProjectDifference> {
    let entries = state.entries();
    let values = edits.iter().flat_map(|edit| values_of_edit(*edit));
    let differences = values.map(|(key, new)| ProjectDifference {
        key,
        old: entries.get(&key).cloned(),
        new,
    });
    differences.filter(|it| it.old != it.new).collect()
}

/// The values that an edit sets; for a state parameter, one value per bit.
fn values_of_edit(edit: DataEdit) -> Vec<(ProjectKey, Option<ProjectValue>)> {
    let set = DataSet::Control;
    let to_value = |value: i32| Some(ProjectValue::Whole(value.into()));
    match edit {
        DataEdit::Parameter(ParameterChange::Value { number, value })
            if is_state_parameter(number) =>
        {
            let bit = |bit: u8| {
                let is_on = value >> bit & 1;
                (
                    ProjectKey::Parameter(set, number, Some(bit)),
                    to_value(is_on),
                )
            };
            (0..8).map(bit).collect()
        }
        DataEdit::Parameter(ParameterChange::Value { number, value }) => {
            vec![(ProjectKey::Parameter(set, number, None), to_value(value))]
        }
        DataEdit::Parameter(ParameterChange::Bit { number, bit, on }) => {
            vec![(
                ProjectKey::Parameter(set, number, Some(bit)),
                to_value(on.into()),
            )]
        }
        DataEdit::Parameter(ParameterChange::Pitch { axis, point, value }) => {
            vec![(ProjectKey::Pitch(set, point, axis), to_value(value.into()))]
        }
        DataEdit::Offset {
            number,
            part,
            value,
        } => {
            let (column, value) = match part {
                ToolOffsetField::X => (OffsetColumn::X, ProjectValue::Real(value)),
                ToolOffsetField::Z => (OffsetColumn::Z, ProjectValue::Real(value)),
                ToolOffsetField::R => (OffsetColumn::R, ProjectValue::Real(value)),
                // 0 to 9: checked when it was parsed.
                ToolOffsetField::T => (OffsetColumn::T, ProjectValue::Whole(value as i64)),
            };
            vec![(ProjectKey::Offset(set, number, column), Some(value))]
        }
        DataEdit::Variable { number, value, .. } => {
            vec![(ProjectKey::Variable(number), value.map(ProjectValue::Real))]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::data::DataField;
    use super::*;
    use gsk_core::setup::Setup;
    use gsk_core::units::Axis;
    use gsk_project::{apply, export};

    fn parse(
        state: &ProjectState,
        field: DataField,
        text: &str,
    ) -> Result<DataEdit, gsk_messages::Message> {
        let tables = MemoryTables::from_memory(state.memory());
        field.parse(text, &DataValues::of_memory(state.memory(), &tables))
    }

    #[test]
    fn every_typed_value_is_a_line_of_the_folder() {
        let state = ProjectState::from_setup(&Setup::delivered());
        let edits: Vec<DataEdit> = [
            (DataField::Parameter(22), "7600"),
            (DataField::Parameter(4), "01000001"),
            (DataField::Offset(3, ToolOffsetField::X), "-1.5"),
            (DataField::Offset(3, ToolOffsetField::T), "8"),
            (DataField::pitch(Axis::Z, 12), "-5"),
            (DataField::Variable(500), "17"),
        ]
        .into_iter()
        .map(|(field, text)| parse(&state, field, text).unwrap())
        .collect();
        let tables = MemoryTables::from_memory(state.memory());
        let values = DataValues::of_memory(state.memory(), &tables);
        let previous_values: Vec<DataEdit> = edits
            .iter()
            .map(|edit| edit.with_current_value(&values))
            .collect();
        let found_differences = differences_of_edits(&edits, &state);
        let changed = apply(&state, &found_differences).unwrap();
        assert_eq!(
            gsk_project::diff(&state, &changed).len(),
            found_differences.len()
        );
        let [old, new] = [&state, &changed].map(|it| export(it, Language::En));
        let lines = |files: &gsk_project::ProjectFiles| -> Vec<String> {
            let all = files.values().flat_map(|text| text.lines());
            all.map(str::to_owned).collect()
        };
        let (old, new) = (lines(&old), lines(&new));
        assert_eq!(old.len(), new.len());
        let changed_lines = old.iter().zip(&new).filter(|(old, new)| old != new);
        assert!(
            (5..=found_differences.len()).contains(&changed_lines.count()),
            "{found_differences:?}"
        );
        // Undoing the edits restores the project.
        let restored = apply(&changed, &differences_of_edits(&previous_values, &changed)).unwrap();
        assert_eq!(restored, state);
    }

    #[test]
    fn a_project_takes_what_a_control_takes() {
        let state = ProjectState::from_setup(&Setup::delivered());
        for (field, text) in [
            (DataField::Parameter(22), "1"),
            (DataField::Parameter(22), "quick"),
            (DataField::Parameter(4), "0102"),
            (DataField::Offset(3, ToolOffsetField::X), "99999"),
            (DataField::pitch(Axis::Z, 12), "400"),
        ] {
            assert!(parse(&state, field, text).is_err(), "{field:?} {text}");
        }
    }

    #[test]
    fn an_error_in_an_offset_names_its_number_and_column() {
        let state = ProjectState::from_setup(&Setup::delivered());
        for (part, text) in [
            (ToolOffsetField::X, "99999"),
            (ToolOffsetField::X, "x"),
            (ToolOffsetField::T, "12"),
        ] {
            let error = parse(&state, DataField::Offset(5, part), text).unwrap_err();
            let error = error.text(Language::En);
            let prefix = format!("offset 005 {}: ", part.letter());
            assert!(error.starts_with(&prefix), "{error}");
        }
    }
}
