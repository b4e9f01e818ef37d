//! Edits values of the open project on the sheets of the data view (manual V-3).

use std::sync::Arc;

use egui::Ui;
use gsk_commission::ParameterChange;
use gsk_core::memory::ParameterGroup;
use gsk_messages::Language;
use gsk_project::{
    DataSet, OffsetColumn, ProjectDifference, ProjectKey, ProjectState, ProjectValue,
};

use super::super::data::{Asked, Edit, Into, Page, Part, Sheets, Tables, Values, is_state};
use super::tree::Node;

/// The sheets, and the tables of the project that they show.
pub struct Editing {
    sheets: Sheets,
    tables: Option<(Arc<ProjectState>, Tables)>,
}

impl Default for Editing {
    fn default() -> Self {
        Self {
            sheets: Sheets::new(Into::Project),
            tables: None,
        }
    }
}

impl Editing {
    /// The sheet of a node; `None` for a node without fields.
    pub const fn page(node: Node) -> Option<Page> {
        match node {
            Node::Parameters => Some(Page::Group(ParameterGroup::ALL[0])),
            Node::Offsets => Some(Page::Offsets),
            Node::Pitch => Some(Page::Pitch),
            Node::Variables => Some(Page::Variables),
            _ => None,
        }
    }

    /// Whether typed values are not in the project yet.
    pub fn has_drafts(&self) -> bool {
        self.sheets.has_drafts()
    }

    /// Shows why the last request was refused.
    pub fn refuse(&mut self, why: gsk_messages::Message, asked: &Asked) {
        self.sheets.refuse(why, asked);
    }

    /// Draws a sheet and returns the values to put into the project.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        language: Language,
        page: Page,
        state: &Arc<ProjectState>,
    ) -> Option<Asked> {
        let is_known = |known: &&(Arc<ProjectState>, Tables)| Arc::ptr_eq(&known.0, state);
        if self.tables.as_ref().filter(is_known).is_none() {
            self.tables = Some((Arc::clone(state), Tables::of(state.memory())));
        }
        let (_, tables) = self.tables.as_ref()?;
        let values = Values::of_memory(state.memory(), tables);
        self.sheets.turn_to(page);
        self.sheets.show(ui, language, &values)
    }
}

/// The differences that edits make in a project.
pub fn differences(edits: &[Edit], state: &ProjectState) -> Vec<ProjectDifference> {
    let entries = state.entries();
    let wanted = edits.iter().flat_map(|edit| values(*edit));
    let other = wanted.map(|(key, new)| ProjectDifference {
        key,
        old: entries.get(&key).cloned(),
        new,
    });
    other.filter(|it| it.old != it.new).collect()
}

/// The values that an edit sets: each bit of a state parameter is a value.
fn values(edit: Edit) -> Vec<(ProjectKey, Option<ProjectValue>)> {
    let set = DataSet::Control;
    let whole = |value: i32| Some(ProjectValue::Whole(value.into()));
    match edit {
        Edit::Parameter(ParameterChange::Value { number, value }) if is_state(number) => {
            let bit = |bit: u8| {
                let on = value >> bit & 1;
                (ProjectKey::Parameter(set, number, Some(bit)), whole(on))
            };
            (0..8).map(bit).collect()
        }
        Edit::Parameter(ParameterChange::Value { number, value }) => {
            vec![(ProjectKey::Parameter(set, number, None), whole(value))]
        }
        Edit::Parameter(ParameterChange::Bit { number, bit, on }) => {
            vec![(
                ProjectKey::Parameter(set, number, Some(bit)),
                whole(on.into()),
            )]
        }
        Edit::Parameter(ParameterChange::Pitch { axis, point, value }) => {
            vec![(ProjectKey::Pitch(set, point, axis), whole(value.into()))]
        }
        Edit::Offset {
            number,
            part,
            value,
        } => {
            let (word, value) = match part {
                Part::X => (OffsetColumn::X, ProjectValue::Real(value)),
                Part::Z => (OffsetColumn::Z, ProjectValue::Real(value)),
                Part::R => (OffsetColumn::R, ProjectValue::Real(value)),
                // 0 to 9: checked when it was parsed.
                Part::T => (OffsetColumn::T, ProjectValue::Whole(value as i64)),
            };
            vec![(ProjectKey::Offset(set, number, word), Some(value))]
        }
        Edit::Variable { number, value, .. } => {
            vec![(ProjectKey::Variable(number), value.map(ProjectValue::Real))]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::data::Spot;
    use super::*;
    use gsk_core::setup::Setup;
    use gsk_core::units::Axis;
    use gsk_project::{apply, export};

    fn typed(state: &ProjectState, spot: Spot, text: &str) -> Result<Edit, gsk_messages::Message> {
        let tables = Tables::of(state.memory());
        spot.read(text, &Values::of_memory(state.memory(), &tables))
    }

    #[test]
    fn what_is_typed_is_a_line_of_the_folder_each() {
        let state = ProjectState::from_setup(&Setup::delivered());
        let edits: Vec<Edit> = [
            (Spot::Parameter(22), "7600"),
            (Spot::Parameter(4), "01000001"),
            (Spot::Offset(3, Part::X), "-1.5"),
            (Spot::Offset(3, Part::T), "8"),
            (Spot::pitch(Axis::Z, 12), "-5"),
            (Spot::Variable(500), "17"),
        ]
        .into_iter()
        .map(|(spot, text)| typed(&state, spot, text).unwrap())
        .collect();
        let tables = Tables::of(state.memory());
        let values = Values::of_memory(state.memory(), &tables);
        let before: Vec<Edit> = edits.iter().map(|edit| edit.now(&values)).collect();
        let found = differences(&edits, &state);
        let changed = apply(&state, &found).unwrap();
        assert_eq!(gsk_project::diff(&state, &changed).len(), found.len());
        let [old, new] = [&state, &changed].map(|it| export(it, Language::En));
        let lines = |files: &gsk_project::ProjectFiles| -> Vec<String> {
            let all = files.values().flat_map(|text| text.lines());
            all.map(str::to_owned).collect()
        };
        let (old, new) = (lines(&old), lines(&new));
        assert_eq!(old.len(), new.len());
        let changed_lines = old.iter().zip(&new).filter(|(old, new)| old != new);
        assert!(
            (5..=found.len()).contains(&changed_lines.count()),
            "{found:?}"
        );
        // Undoing the edits restores the project.
        let back = apply(&changed, &differences(&before, &changed)).unwrap();
        assert_eq!(back, state);
    }

    #[test]
    fn a_project_takes_what_a_control_takes() {
        let state = ProjectState::from_setup(&Setup::delivered());
        for (spot, text) in [
            (Spot::Parameter(22), "1"),
            (Spot::Parameter(22), "quick"),
            (Spot::Parameter(4), "0102"),
            (Spot::Offset(3, Part::X), "99999"),
            (Spot::pitch(Axis::Z, 12), "400"),
        ] {
            assert!(typed(&state, spot, text).is_err(), "{spot:?} {text}");
        }
    }

    #[test]
    fn what_is_wrong_with_an_offset_names_its_place() {
        let state = ProjectState::from_setup(&Setup::delivered());
        for (part, text) in [(Part::X, "99999"), (Part::X, "x"), (Part::T, "12")] {
            let said = typed(&state, Spot::Offset(5, part), text).unwrap_err();
            let said = said.text(Language::En);
            let place = format!("offset 005 {}: ", part.letter());
            assert!(said.starts_with(&place), "{said}");
        }
    }
}
