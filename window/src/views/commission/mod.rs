//! The commissioning view: leads step by step from measurements at the lathe to the parameters
//! of the control (manual III-12). It moves no axis, and writes only what the control allows.

mod graph;
mod inputs;
mod pitch;

use std::sync::Arc;

use egui::{Button, CentralPanel, Grid, Panel, RichText, ScrollArea, TextEdit, Ui};
use gsk_commission::{
    CommissioningStep, DriveKind, DriveTrain, FollowingErrorReading, MeasuredMove, ParameterChange,
    Proposal, SlideTravel, SpindleSpeed, UndoList, ZeroMethod, propose_acceleration,
    propose_backlash, propose_direction, propose_gear_from_drive, propose_gear_from_move,
    propose_rapid_rate, propose_reference, propose_spindle,
};
use gsk_core::units::{Axis, PerAxis};
use gsk_host::files::pitch::axis_letter;
use gsk_host::kernel::monitor::MachineView;
use gsk_host::kernel::{Command, Console};
use gsk_messages::{Language, Message, say};
use gsk_project::refusal_message;

use super::interface::{View, ViewFrame, ViewStart};
use super::undo_panel;
use crate::focus;
use crate::theme;
use inputs::{CommissionInputs, parse_number, parse_optional, parse_readings, show_rows};
use pitch::PitchErrorStep;

/// Width of the list of steps, points.
const STEPS_WIDTH: f32 = 210.0;
/// Height of the list of changes, points.
const CHANGES_HEIGHT: f32 = 160.0;

/// The view for commissioning a machine step by step.
pub struct CommissionView {
    console: Console,
    /// Whether the operator has requested that the scope opens.
    wants_scope: bool,
    step: CommissioningStep,
    axis: Axis,
    fields: CommissionInputs,
    pitch: PitchErrorStep,
    proposal: Option<Result<Proposal, Message>>,
    undo: UndoList<CommissioningStep, ParameterChange>,
    /// The largest following error since the last clearing, mm of slide travel.
    max_following_error: PerAxis<f64>,
}

impl View for CommissionView {
    fn create(start: ViewStart<'_>) -> Self {
        Self::new(start.console.clone())
    }

    fn show(&mut self, ui: &mut Ui, frame: ViewFrame<'_>) {
        self.wants_scope = self.draw(ui, frame.language, frame.machine);
    }
}

impl CommissionView {
    /// Takes the operator's request to see the scope, if any.
    pub const fn take_scope_request(&mut self) -> bool {
        std::mem::replace(&mut self.wants_scope, false)
    }

    /// Creates the view at its first step.
    pub fn new(console: Console) -> Self {
        Self {
            console,
            wants_scope: false,
            step: CommissioningStep::Direction,
            axis: Axis::Z,
            fields: CommissionInputs::default(),
            pitch: PitchErrorStep::default(),
            proposal: None,
            undo: UndoList::default(),
            max_following_error: PerAxis::default(),
        }
    }

    /// Draws the view. Returns true when the operator requests to see the scope.
    fn draw(
        &mut self,
        ui: &mut Ui,
        language: Language,
        machine: Option<&Arc<MachineView>>,
    ) -> bool {
        let Some(machine) = machine else {
            ui.label(say::commission_waits().text(language));
            return false;
        };
        let error = machine.lathe.following_error();
        self.max_following_error.x = self.max_following_error.x.max(error.x.abs());
        self.max_following_error.z = self.max_following_error.z.max(error.z.abs());
        let mut wants_scope = false;
        Panel::left("commission steps")
            .exact_size(STEPS_WIDTH)
            .resizable(false)
            .frame(super::side_frame())
            .show(ui, |ui| {
                wants_scope = self.show_steps(ui, language, machine);
            });
        CentralPanel::default()
            .frame(super::side_frame())
            .show(ui, |ui| {
                ScrollArea::vertical()
                    .id_salt("commission")
                    .auto_shrink([false, false])
                    .show(ui, |ui| {
                        self.show_step(ui, language, machine);
                        focus::scroll_to_focus(ui);
                    });
            });
        wants_scope
    }

    fn show_steps(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) -> bool {
        for step in CommissioningStep::ALL {
            let is_chosen = self.step == step;
            if ui
                .selectable_label(is_chosen, step.name().text(language))
                .clicked()
                && !is_chosen
            {
                self.step = step;
                self.proposal = None;
            }
        }
        ui.separator();
        ui.horizontal(|ui| {
            ui.label(say::commission_axis().text(language));
            for axis in [Axis::X, Axis::Z] {
                let is_chosen = self.axis == axis;
                if ui
                    .selectable_label(is_chosen, axis_letter(axis).to_string())
                    .clicked()
                    && !is_chosen
                {
                    self.axis = axis;
                    self.proposal = None;
                }
            }
        });
        ui.separator();
        let hint = say::commission_scope_hint().text(language);
        let wants_scope = ui
            .button(say::commission_scope().text(language))
            .on_hover_text(hint)
            .clicked();
        ui.separator();
        self.show_undo_list(ui, language, machine);
        wants_scope
    }

    /// Draws the list of written values with the undo button.
    fn show_undo_list(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        let undo_changes = undo_panel::show(
            ui,
            language,
            &mut self.undo,
            &undo_panel::UndoTexts {
                label: |step| step.name(),
                change: |change| change.message(),
                blocked_hint: say::commission_write_hint(),
            },
            |_| machine.parameters_refused.is_none(),
        );
        if let Some(previous_values) = undo_changes {
            let requests = previous_values.iter().map(|change| change.to_request());
            self.console.send(Command::Write(requests.collect()));
            self.proposal = None;
        }
    }

    fn show_step(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        ui.heading(self.step.name().text(language));
        ui.label(self.step.explanation().text(language));
        let note = say::commission_nothing_moves().text(language);
        ui.label(RichText::new(note).weak());
        ui.add_space(6.0);
        let mut has_new_file = false;
        match self.step {
            CommissioningStep::Direction => {}
            CommissioningStep::Gear => self.show_gear_fields(ui, language),
            CommissioningStep::Acceleration => self.show_acceleration_fields(ui, language),
            CommissioningStep::Reference => self.show_reference_fields(ui, language),
            CommissioningStep::Spindle => {
                let [gear, rpm, volts] = &mut self.fields.spindle_texts;
                let mut names = [
                    (say::commission_field_gear(), gear),
                    (say::commission_field_rpm(), rpm),
                    (say::commission_field_volts(), volts),
                ];
                show_rows(ui, language, &mut names);
            }
            CommissioningStep::Backlash => {
                ui.label(say::commission_field_readings().text(language));
                let field = TextEdit::multiline(&mut self.fields.backlash_text).desired_rows(4);
                ui.add(field.desired_width(200.0));
            }
            CommissioningStep::Pitch => has_new_file = self.show_pitch_fields(ui, language),
        }
        ui.add_space(4.0);
        let label = match self.step {
            CommissioningStep::Direction => say::commission_turn_over(),
            _ => say::commission_propose(),
        };
        if ui.button(label.text(language)).clicked() || has_new_file {
            self.proposal = self.propose(machine).transpose();
        }
        ui.separator();
        match self.proposal.clone() {
            None => {}
            Some(Err(error)) => {
                ui.label(RichText::new(error.text(language)).color(theme::ERROR_TEXT));
            }
            Some(Ok(proposal)) => self.show_proposal(ui, language, machine, &proposal),
        }
    }

    fn show_gear_fields(&mut self, ui: &mut Ui, language: Language) {
        ui.horizontal(|ui| {
            for (is_measured, name) in [
                (true, say::commission_by_measurement()),
                (false, say::commission_from_plates()),
            ] {
                let chosen = &mut self.fields.is_gear_measured;
                ui.radio_value(chosen, is_measured, name.text(language));
            }
        });
        if self.fields.is_gear_measured {
            let [commanded, measured] = &mut self.fields.move_texts;
            let mut names = [
                (say::commission_field_commanded(), commanded),
                (say::commission_field_measured(), measured),
            ];
            show_rows(ui, language, &mut names);
        } else {
            let [pulses, lead, screw, motor] = &mut self.fields.plate_texts;
            let mut names = [
                (say::commission_field_pulses(), pulses),
                (say::commission_field_lead(), lead),
                (say::commission_field_screw_teeth(), screw),
                (say::commission_field_motor_teeth(), motor),
            ];
            show_rows(ui, language, &mut names);
        }
    }

    fn show_acceleration_fields(&mut self, ui: &mut Ui, language: Language) {
        ui.horizontal(|ui| {
            for (kind, name) in [
                (DriveKind::Stepper, say::commission_stepper()),
                (DriveKind::Servo, say::commission_servo()),
            ] {
                ui.radio_value(&mut self.fields.drive_kind, kind, name.text(language));
            }
        });
        let largest = *self.max_following_error.get(self.axis);
        ui.horizontal(|ui| {
            let label = say::commission_lag_now(axis_letter(self.axis), largest);
            ui.label(label.text(language));
            if ui.button(say::commission_clear().text(language)).clicked() {
                self.max_following_error = PerAxis::default();
            }
        });
        let [measured, allowed] = &mut self.fields.following_error_texts;
        let mut names = [
            (say::commission_field_seen(), measured),
            (say::commission_field_allowed(), allowed),
        ];
        show_rows(ui, language, &mut names);
    }

    fn show_reference_fields(&mut self, ui: &mut Ui, language: Language) {
        for (method, name) in [
            (ZeroMethod::NoSwitch, say::commission_method_a()),
            (ZeroMethod::SwitchAndSignal, say::commission_method_b()),
            (ZeroMethod::OneSwitch, say::commission_method_c()),
        ] {
            ui.radio_value(&mut self.fields.zero_method, method, name.text(language));
        }
    }

    /// Draws the fields of the pitch error step. Returns true when a file has been read.
    fn show_pitch_fields(&mut self, ui: &mut Ui, language: Language) -> bool {
        let has_new_file = self.pitch.show(ui, language, &self.console);
        let interval = &mut self.fields.pitch_interval_text;
        let mut names = [(say::commission_field_interval(), interval)];
        show_rows(ui, language, &mut names);
        let label = say::commission_without_table().text(language);
        ui.checkbox(&mut self.fields.is_table_empty, label);
        let label = say::commission_diameters().text(language);
        ui.checkbox(&mut self.fields.are_targets_diameters, label);
        has_new_file
    }

    /// Computes the changes that the current step proposes; `None` if input is missing. Returns a
    /// message as error for wrong input.
    fn propose(&mut self, machine: &MachineView) -> Result<Option<Proposal>, Message> {
        let (axis, parameters) = (self.axis, &machine.parameters);
        let fields = &self.fields;
        let proposal = match self.step {
            CommissioningStep::Direction => propose_direction(axis, parameters),
            CommissioningStep::Gear if fields.is_gear_measured => {
                let [commanded, measured] = &fields.move_texts;
                let measured_move = MeasuredMove {
                    commanded: SlideTravel(parse_number(commanded)?),
                    measured: SlideTravel(parse_number(measured)?),
                };
                propose_gear_from_move(axis, measured_move, parameters)
            }
            CommissioningStep::Gear => {
                let [pulses, lead, screw, motor] = &fields.plate_texts;
                // Teeth are whole numbers. Any other text becomes 0, which is refused.
                let parse_teeth = |text: &str| text.trim().parse().unwrap_or(0);
                let drive = DriveTrain {
                    pulses_per_turn: parse_number(pulses)?,
                    lead: SlideTravel(parse_number(lead)?),
                    screw_teeth: parse_teeth(screw),
                    motor_teeth: parse_teeth(motor),
                };
                propose_gear_from_drive(axis, &drive, parameters)
            }
            CommissioningStep::Acceleration => {
                let [measured, allowed] = &fields.following_error_texts;
                match (parse_optional(measured)?, parse_optional(allowed)?) {
                    (None, None) => propose_acceleration(fields.drive_kind, parameters),
                    (measured, allowed) => {
                        let reading = FollowingErrorReading {
                            measured: SlideTravel(measured.unwrap_or(0.0)),
                            allowed: SlideTravel(allowed.unwrap_or(0.0)),
                        };
                        propose_rapid_rate(axis, reading, parameters)
                    }
                }
            }
            CommissioningStep::Reference => propose_reference(axis, fields.zero_method, parameters),
            CommissioningStep::Spindle => {
                let [gear, rpm, volts] = &fields.spindle_texts;
                let measured = SpindleSpeed {
                    gear: gear.trim().parse().unwrap_or(0),
                    rpm: parse_number(rpm)?,
                    volts: parse_optional(volts)?,
                };
                propose_spindle(measured, parameters)
            }
            CommissioningStep::Backlash => {
                propose_backlash(axis, &parse_readings(&fields.backlash_text)?, parameters)
            }
            CommissioningStep::Pitch => {
                let result = self
                    .pitch
                    .propose(axis, fields, (parameters, &machine.pitch))?;
                return Ok(result.map(|found| found.proposal().clone()));
            }
        };
        proposal.map(Some)
    }

    /// Draws the proposed values beside the current ones, and the write button.
    fn show_proposal(
        &mut self,
        ui: &mut Ui,
        language: Language,
        machine: &MachineView,
        proposal: &Proposal,
    ) {
        if self.step == CommissioningStep::Pitch {
            self.pitch.show_result(ui, language);
        }
        for note in &proposal.notes {
            ui.label(note.text(language));
        }
        if proposal.changes.is_empty() {
            ui.label(say::commission_no_changes().text(language));
            return;
        }
        ScrollArea::vertical()
            .id_salt("commission changes")
            .max_height(CHANGES_HEIGHT)
            .show(ui, |ui| {
                Grid::new("commission changes")
                    .striped(true)
                    .show(ui, |ui| {
                        ui.strong(say::commission_new_value().text(language));
                        ui.strong(say::commission_stands().text(language));
                        ui.end_row();
                        for change in &proposal.changes {
                            let current = change.current(&machine.parameters, &machine.pitch);
                            ui.label(change.message().text(language));
                            ui.label(RichText::new(current.message().text(language)).weak());
                            ui.end_row();
                        }
                    });
                focus::scroll_to_focus(ui);
            });
        let refusal = machine.parameters_refused;
        let (text, colour) = match refusal {
            Some(refusal) => (
                say::data_cannot_write(refusal_message(refusal)),
                theme::UNSAVED_TEXT,
            ),
            None => (say::commission_can_write(), theme::SUCCESS),
        };
        ui.label(RichText::new(text.text(language)).color(colour));
        let label = say::commission_write(proposal.changes.len()).text(language);
        let hint = say::commission_write_hint().text(language);
        let button = ui.add_enabled(refusal.is_none(), Button::new(label));
        if button
            .on_hover_text(hint.as_str())
            .on_disabled_hover_text(hint.as_str())
            .clicked()
        {
            let changes = &proposal.changes;
            let current_value =
                |change: &ParameterChange| change.current(&machine.parameters, &machine.pitch);
            let previous_values = changes.iter().map(current_value).collect();
            self.undo.record(self.step, previous_values, changes);
            let requests = changes.iter().map(|change| change.to_request());
            self.console.send(Command::Write(requests.collect()));
            self.proposal = None;
        }
    }
}
