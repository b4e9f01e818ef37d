//! The commissioning view: leads step by step from measurements at the lathe to the parameters
//! of the control (manual III-12). It moves no axis, and writes only what the control allows.

mod fields;
mod graph;
mod pitch;

use std::sync::Arc;

use egui::{Button, CentralPanel, Color32, Grid, Panel, RichText, ScrollArea, TextEdit, Ui};
use gsk_commission::{
    CommissioningStep, DriveKind, DriveTrain, FollowingErrorReading, MeasuredMove, ParameterChange,
    Proposal, SlideTravel, SpindleSpeed, UndoList, ZeroMethod, propose_acceleration,
    propose_backlash, propose_direction, propose_gear_from_drive, propose_gear_from_move,
    propose_rapid_rate, propose_reference, propose_spindle,
};
use gsk_core::units::{Axis, PerAxis};
use gsk_messages::{Language, Message, say};
use gsk_project::refusal_message;

use super::written;
use crate::kernel::monitor::MachineView;
use crate::kernel::{Command, Console};
use crate::pitch::letter;
use crate::window::focus;
use fields::{Fields, number, optional, readings, rows};
use pitch::PitchStep;

/// Width of the list of steps, points.
const STEPS: f32 = 210.0;
/// Height of the list of changes, points.
const CHANGES: f32 = 160.0;

const WRONG: Color32 = Color32::from_rgb(255, 150, 110);
/// Colour of the reason why the control refuses values now.
const NOT_NOW: Color32 = Color32::from_rgb(255, 214, 110);
const FINE: Color32 = Color32::from_rgb(110, 230, 120);

/// The commissioning view.
pub struct CommissionView {
    console: Console,
    step: CommissioningStep,
    axis: Axis,
    fields: Fields,
    pitch: PitchStep,
    proposal: Option<Result<Proposal, Message>>,
    undo: UndoList<CommissioningStep, ParameterChange>,
    /// The largest following error since the last clearing, mm of slide travel.
    lag: PerAxis<f64>,
}

impl CommissionView {
    /// Creates the view with its first step.
    pub fn new(console: Console) -> Self {
        Self {
            console,
            step: CommissioningStep::Direction,
            axis: Axis::Z,
            fields: Fields::default(),
            pitch: PitchStep::default(),
            proposal: None,
            undo: UndoList::default(),
            lag: PerAxis::default(),
        }
    }

    /// Draws the view. Returns whether the operator wants to see the scope.
    pub fn show(
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
        self.lag.x = self.lag.x.max(error.x.abs());
        self.lag.z = self.lag.z.max(error.z.abs());
        let mut scope = false;
        Panel::left("commission steps")
            .exact_size(STEPS)
            .resizable(false)
            .frame(super::side_frame())
            .show(ui, |ui| scope = self.steps(ui, language, machine));
        CentralPanel::default()
            .frame(super::side_frame())
            .show(ui, |ui| {
                ScrollArea::vertical()
                    .id_salt("commission")
                    .auto_shrink([false, false])
                    .show(ui, |ui| {
                        self.work(ui, language, machine);
                        focus::follow(ui);
                    });
            });
        scope
    }

    fn steps(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) -> bool {
        for step in CommissioningStep::ALL {
            let chosen = self.step == step;
            if ui
                .selectable_label(chosen, step.name().text(language))
                .clicked()
                && !chosen
            {
                self.step = step;
                self.proposal = None;
            }
        }
        ui.separator();
        ui.horizontal(|ui| {
            ui.label(say::commission_axis().text(language));
            for axis in [Axis::X, Axis::Z] {
                let chosen = self.axis == axis;
                if ui
                    .selectable_label(chosen, letter(axis).to_string())
                    .clicked()
                    && !chosen
                {
                    self.axis = axis;
                    self.proposal = None;
                }
            }
        });
        ui.separator();
        let hint = say::commission_scope_hint().text(language);
        let scope = ui
            .button(say::commission_scope().text(language))
            .on_hover_text(hint)
            .clicked();
        ui.separator();
        self.written(ui, language, machine);
        scope
    }

    /// Draws the list of written values with the undo button.
    fn written(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        let taken = written::show(
            ui,
            language,
            &mut self.undo,
            &written::Words {
                label: |step| step.name(),
                change: |change| change.message(),
                hint: say::commission_write_hint(),
            },
            |_| machine.parameters_refused.is_none(),
        );
        if let Some(before) = taken {
            let requests = before.iter().map(|change| change.to_request());
            self.console.send(Command::Write(requests.collect()));
            self.proposal = None;
        }
    }

    fn work(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        ui.heading(self.step.name().text(language));
        ui.label(self.step.explanation().text(language));
        let words = say::commission_nothing_moves().text(language);
        ui.label(RichText::new(words).weak());
        ui.add_space(6.0);
        let mut again = false;
        match self.step {
            CommissioningStep::Direction => {}
            CommissioningStep::Gear => self.gear_fields(ui, language),
            CommissioningStep::Acceleration => self.acceleration_fields(ui, language),
            CommissioningStep::Reference => self.reference_fields(ui, language),
            CommissioningStep::Spindle => {
                let [gear, rpm, volts] = &mut self.fields.spindle;
                let mut names = [
                    (say::commission_field_gear(), gear),
                    (say::commission_field_rpm(), rpm),
                    (say::commission_field_volts(), volts),
                ];
                rows(ui, language, &mut names);
            }
            CommissioningStep::Backlash => {
                ui.label(say::commission_field_readings().text(language));
                let field = TextEdit::multiline(&mut self.fields.readings).desired_rows(4);
                ui.add(field.desired_width(200.0));
            }
            CommissioningStep::Pitch => again = self.pitch_fields(ui, language),
        }
        ui.add_space(4.0);
        let words = match self.step {
            CommissioningStep::Direction => say::commission_turn_over(),
            _ => say::commission_propose(),
        };
        if ui.button(words.text(language)).clicked() || again {
            self.proposal = self.propose(machine).transpose();
        }
        ui.separator();
        match self.proposal.clone() {
            None => {}
            Some(Err(said)) => {
                ui.label(RichText::new(said.text(language)).color(WRONG));
            }
            Some(Ok(proposal)) => self.proposed(ui, language, machine, &proposal),
        }
    }

    fn gear_fields(&mut self, ui: &mut Ui, language: Language) {
        ui.horizontal(|ui| {
            for (measured, name) in [
                (true, say::commission_by_measurement()),
                (false, say::commission_from_plates()),
            ] {
                let chosen = &mut self.fields.measured_gear;
                ui.radio_value(chosen, measured, name.text(language));
            }
        });
        if self.fields.measured_gear {
            let [commanded, measured] = &mut self.fields.moved;
            let mut names = [
                (say::commission_field_commanded(), commanded),
                (say::commission_field_measured(), measured),
            ];
            rows(ui, language, &mut names);
        } else {
            let [pulses, lead, screw, motor] = &mut self.fields.plates;
            let mut names = [
                (say::commission_field_pulses(), pulses),
                (say::commission_field_lead(), lead),
                (say::commission_field_screw_teeth(), screw),
                (say::commission_field_motor_teeth(), motor),
            ];
            rows(ui, language, &mut names);
        }
    }

    fn acceleration_fields(&mut self, ui: &mut Ui, language: Language) {
        ui.horizontal(|ui| {
            for (kind, name) in [
                (DriveKind::Stepper, say::commission_stepper()),
                (DriveKind::Servo, say::commission_servo()),
            ] {
                ui.radio_value(&mut self.fields.kind, kind, name.text(language));
            }
        });
        let largest = *self.lag.get(self.axis);
        ui.horizontal(|ui| {
            let words = say::commission_lag_now(letter(self.axis), largest);
            ui.label(words.text(language));
            if ui.button(say::commission_clear().text(language)).clicked() {
                self.lag = PerAxis::default();
            }
        });
        let [seen, allowed] = &mut self.fields.lag;
        let mut names = [
            (say::commission_field_seen(), seen),
            (say::commission_field_allowed(), allowed),
        ];
        rows(ui, language, &mut names);
    }

    fn reference_fields(&mut self, ui: &mut Ui, language: Language) {
        for (method, name) in [
            (ZeroMethod::NoSwitch, say::commission_method_a()),
            (ZeroMethod::SwitchAndSignal, say::commission_method_b()),
            (ZeroMethod::OneSwitch, say::commission_method_c()),
        ] {
            ui.radio_value(&mut self.fields.method, method, name.text(language));
        }
    }

    /// Draws the fields of the pitch errors. Returns whether a file has been read.
    fn pitch_fields(&mut self, ui: &mut Ui, language: Language) -> bool {
        let come = self.pitch.show(ui, language, &self.console);
        let interval = &mut self.fields.interval;
        let mut names = [(say::commission_field_interval(), interval)];
        rows(ui, language, &mut names);
        let words = say::commission_without_table().text(language);
        ui.checkbox(&mut self.fields.clear, words);
        let words = say::commission_diameters().text(language);
        ui.checkbox(&mut self.fields.diameters, words);
        come
    }

    /// Computes the proposal of the step. `None` while input is missing.
    fn propose(&mut self, machine: &MachineView) -> Result<Option<Proposal>, Message> {
        let (axis, own) = (self.axis, &machine.parameters);
        let fields = &self.fields;
        let proposal = match self.step {
            CommissioningStep::Direction => propose_direction(axis, own),
            CommissioningStep::Gear if fields.measured_gear => {
                let [commanded, measured] = &fields.moved;
                let made = MeasuredMove {
                    commanded: SlideTravel(number(commanded)?),
                    measured: SlideTravel(number(measured)?),
                };
                propose_gear_from_move(axis, made, own)
            }
            CommissioningStep::Gear => {
                let [pulses, lead, screw, motor] = &fields.plates;
                // Teeth are whole numbers. Any other text becomes 0, which is refused.
                let teeth = |text: &str| text.trim().parse().unwrap_or(0);
                let drive = DriveTrain {
                    pulses_per_turn: number(pulses)?,
                    lead: SlideTravel(number(lead)?),
                    screw_teeth: teeth(screw),
                    motor_teeth: teeth(motor),
                };
                propose_gear_from_drive(axis, &drive, own)
            }
            CommissioningStep::Acceleration => {
                let [seen, allowed] = &fields.lag;
                match (optional(seen)?, optional(allowed)?) {
                    (None, None) => propose_acceleration(fields.kind, own),
                    (seen, allowed) => {
                        let lag = FollowingErrorReading {
                            measured: SlideTravel(seen.unwrap_or(0.0)),
                            allowed: SlideTravel(allowed.unwrap_or(0.0)),
                        };
                        propose_rapid_rate(axis, lag, own)
                    }
                }
            }
            CommissioningStep::Reference => propose_reference(axis, fields.method, own),
            CommissioningStep::Spindle => {
                let [gear, rpm, volts] = &fields.spindle;
                let read = SpindleSpeed {
                    gear: gear.trim().parse().unwrap_or(0),
                    rpm: number(rpm)?,
                    volts: optional(volts)?,
                };
                propose_spindle(read, own)
            }
            CommissioningStep::Backlash => {
                propose_backlash(axis, &readings(&fields.readings)?, own)
            }
            CommissioningStep::Pitch => {
                let found = self.pitch.propose(axis, fields, (own, &machine.pitch))?;
                return Ok(found.map(|found| found.proposal().clone()));
            }
        };
        proposal.map(Some)
    }

    /// Draws the proposed values beside the current ones, and the write button.
    fn proposed(
        &mut self,
        ui: &mut Ui,
        language: Language,
        machine: &MachineView,
        proposal: &Proposal,
    ) {
        if self.step == CommissioningStep::Pitch {
            self.pitch.result(ui, language);
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
            .max_height(CHANGES)
            .show(ui, |ui| {
                Grid::new("commission changes")
                    .striped(true)
                    .show(ui, |ui| {
                        ui.strong(say::commission_new_value().text(language));
                        ui.strong(say::commission_stands().text(language));
                        ui.end_row();
                        for change in &proposal.changes {
                            let now = change.current(&machine.parameters, &machine.pitch);
                            ui.label(change.message().text(language));
                            ui.label(RichText::new(now.message().text(language)).weak());
                            ui.end_row();
                        }
                    });
                focus::follow(ui);
            });
        let refusal = machine.parameters_refused;
        let (words, colour) = match refusal {
            Some(refusal) => (say::data_cannot_write(refusal_message(refusal)), NOT_NOW),
            None => (say::commission_can_write(), FINE),
        };
        ui.label(RichText::new(words.text(language)).color(colour));
        let words = say::commission_write(proposal.changes.len()).text(language);
        let hint = say::commission_write_hint().text(language);
        let button = ui.add_enabled(refusal.is_none(), Button::new(words));
        if button
            .on_hover_text(hint.as_str())
            .on_disabled_hover_text(hint.as_str())
            .clicked()
        {
            let changes = &proposal.changes;
            let stands =
                |change: &ParameterChange| change.current(&machine.parameters, &machine.pitch);
            let before = changes.iter().map(stands).collect();
            self.undo.record(self.step, before, changes);
            let requests = changes.iter().map(|change| change.to_request());
            self.console.send(Command::Write(requests.collect()));
            self.proposal = None;
        }
    }
}
