//! Proposals for the fields: cutting values of a material, a tool of the tool library.

use egui::{ComboBox, Ui};
use gsk_host::files::tool_library;
use gsk_messages::{Language, say};
use gsk_workpiece::cutting::CuttingMaterial;

use super::FormPane;
use super::fields::FieldDrafts;

/// Width of a choice, points.
const PROPOSAL_WIDTH: f32 = 200.0;

impl FormPane {
    /// Draws the choice of a material, which sets speed, feed and depth.
    pub(super) fn show_proposals(&mut self, ui: &mut Ui, language: Language) {
        let words = say::form_propose().text(language);
        let list = ComboBox::from_id_salt("form material").selected_text(words);
        let list = list.width(PROPOSAL_WIDTH).show_ui(ui, |ui| {
            let mut names = CuttingMaterial::all();
            names.find(|it| ui.selectable_label(false, it.name).clicked())
        });
        let hint = say::form_propose_tip().text(language);
        list.response.on_hover_text(hint);
        let Some(material) = list.inner.flatten() else {
            return;
        };
        let proposed = self.values.propose(&material);
        self.drafts = FieldDrafts::new(&self.values);
        self.asks_to_replace = false;
        self.rewrite();
        self.notice = match proposed {
            Ok(true) => None,
            Ok(false) => Some(say::form_no_proposal(material.name)),
            Err(error) => Some(error.message()),
        };
    }

    /// Draws the choice of a tool of the library that the form can cut with.
    pub(super) fn show_tools(&mut self, ui: &mut Ui, language: Language) {
        let words = say::tool_library_name().text(language);
        let list = ComboBox::from_id_salt("form tool").selected_text(words);
        let list = list.width(PROPOSAL_WIDTH).show_ui(ui, |ui| {
            // The file is small, and read only while the list is open.
            let tools = tool_library::read().unwrap_or_default().tools;
            let mut fitting = tools
                .into_iter()
                .filter(|it| self.values.fits_tool(&it.1.tool));
            let mut chosen = None;
            let mut is_empty = true;
            for (id, tool) in &mut fitting {
                is_empty = false;
                if ui.selectable_label(false, &id).clicked() {
                    chosen = Some((id, tool));
                }
            }
            if is_empty {
                ui.weak(say::tool_library_nothing().text(language));
            }
            chosen
        });
        let Some((id, tool)) = list.inner.flatten() else {
            return;
        };
        let is_taken = self.values.take_tool(&tool.tool, tool.station);
        self.drafts = FieldDrafts::new(&self.values);
        self.asks_to_replace = false;
        self.rewrite();
        self.notice = (!is_taken).then(|| say::tool_unusable_by_form(id));
    }
}
