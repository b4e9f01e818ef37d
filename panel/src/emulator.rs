//! Combines control, lathe and panel into one emulator.

mod serial;

use gsk_core::alarm::Alarm;
use gsk_core::cnc::ControlRequest;
use gsk_core::machine::{MachineInputs, MachineOutputs};
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_messages::Message;
use serde::{Deserialize, Serialize};
use tiny_skia::Pixmap;

use crate::faceplate::{self, FaceState};
use crate::keys::{Bit, Key};
pub use crate::panel::number_of_name;
use crate::panel::{KeyEvent, Panel, ReceiveError, SerialFile, contacts};
use crate::raster;
use crate::screen::Screen;

/// Time that [`Emulator::press`] holds a key, and pause after it, ticks.
pub(crate) const PRESS_TICKS: u64 = 100;

/// Interval between checks of the LCD while waiting for its text, ticks.
const SCREEN_PERIOD: u64 = 20;

/// A control with its panel and its simulated lathe: the save state.
///
/// ```
/// use gsk_core::setup::Setup;
/// use gsk_panel::emulator::{WaitCondition, Emulator, WaitOutcome};
/// use gsk_panel::keys::Key;
///
/// let mut emulator = Emulator::new(Setup::default());
/// emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
/// emulator.press(Key::Auto);
/// assert!(emulator.screen().text().contains("自动方式"));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Emulator {
    /// Control and lathe.
    pub simulation: Simulation,
    /// The panel.
    pub panel: Panel,
}

/// A condition for [`Emulator::run_until`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WaitCondition {
    /// The self-test picture has disappeared.
    SelfTestOver,
    /// No program runs and the axes are stopped.
    Stopped,
    /// A block has ended, or the run has stopped.
    BlockEnd,
    /// An alarm or a message is active.
    Alarm,
    /// The LCD shows this text in one row. Runs of blanks count as one.
    Text(String),
    /// A bit of PLC memory has this value.
    Bit(BitAddress, bool),
}

/// How [`Emulator::run_until`] ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaitOutcome {
    /// The condition became true.
    Reached,
    /// The time limit expired first.
    TimedOut,
}

impl Emulator {
    /// Creates an emulator at power-on.
    pub fn new(setup: Setup) -> Self {
        Self {
            simulation: Simulation::new(setup),
            panel: Panel::new(),
        }
    }

    /// Returns the ticks since the start, including power-off.
    pub const fn ticks(&self) -> u64 {
        self.panel.clock()
    }

    /// Runs one millisecond.
    pub fn tick(&mut self) {
        if self.panel.powered() {
            self.simulation.tick();
        } else {
            // Without power the drives hold and everything else stops. The control does not
            // read its inputs.
            let outputs = MachineOutputs::without_power(self.simulation.cnc.pulses());
            self.simulation
                .lathe
                .tick(&outputs, &mut MachineInputs::default());
        }
        let requests = self.panel.tick(&self.simulation.cnc);
        self.send_requests(requests);
    }

    /// Runs a number of milliseconds.
    pub fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    /// Handles a key event at the start of the next tick. Returns the reason if page, mode or a
    /// switch prevents its effect. Machine keys are checked later, by
    /// [`crate::refusal::KeyPress`].
    pub fn key(&mut self, event: KeyEvent) -> Option<Message> {
        let cnc = &self.simulation.cnc;
        let by_page = match event {
            KeyEvent::Down(key) => self.panel.refuses(key, cnc),
            KeyEvent::Type(character) => self.panel.refuses_character(character, cnc),
            KeyEvent::Up(_) | KeyEvent::ReleaseAll | KeyEvent::Wheel(_) => None,
        };
        let requests = self.panel.key(event, cnc);
        let by_control = |request| cnc.request_refusal(request);
        let refused = by_page.or_else(|| requests.iter().find_map(by_control));
        self.send_requests(requests);
        let lathe = &mut self.simulation.lathe;
        if let KeyEvent::Wheel(graduations) = event {
            lathe.turn_handwheel(graduations);
        }
        lathe.set_emergency_button(self.panel.emergency_stop());
        lathe.set_overtravel_release(self.panel.is_held(Key::OvertravelRelease));
        self.connect_keys();
        refused
    }

    /// Sets the contacts of the machine keys to the state of the keys.
    fn connect_keys(&mut self) {
        for (bit, down) in contacts(&self.panel) {
            let address = BitAddress::new(Area::X, bit.byte, bit.bit);
            self.simulation.cnc.set_panel_key(address, down);
        }
    }

    fn send_requests(&mut self, requests: Vec<ControlRequest>) {
        for request in requests {
            // A refusal is shown on the alarm page.
            let _ = self.simulation.cnc.request(request);
        }
    }

    /// Presses a key down. Returns the reason if it has no effect, as [`Self::key`] does.
    pub fn key_down(&mut self, key: Key) -> Option<Message> {
        self.key(KeyEvent::Down(key))
    }

    /// Releases a key.
    pub fn key_up(&mut self, key: Key) {
        self.key(KeyEvent::Up(key));
    }

    /// Presses a key for 100 ms, then waits 100 ms.
    pub fn press(&mut self, key: Key) {
        self.key_down(key);
        self.run(PRESS_TICKS);
        self.key_up(key);
        self.run(PRESS_TICKS);
    }

    /// Holds a key for a number of milliseconds.
    pub fn hold(&mut self, key: Key, ticks: u64) {
        self.key_down(key);
        self.run(ticks);
        self.key_up(key);
    }

    /// Types characters, 100 ms each.
    pub fn type_text(&mut self, text: &str) {
        for character in text.chars() {
            self.key(KeyEvent::Type(character));
            self.run(PRESS_TICKS);
        }
    }

    /// Turns the handwheel by a number of graduations at once.
    pub fn turn(&mut self, graduations: i32) {
        self.key(KeyEvent::Wheel(graduations));
    }

    /// Runs until a condition is true, at most `limit_ms` milliseconds. Checks the condition
    /// before the first tick and after each one.
    pub fn run_until(&mut self, condition: &WaitCondition, limit_ms: u64) -> WaitOutcome {
        let mut watch = ConditionWatch::new(condition.clone(), self);
        for _ in 0..limit_ms {
            if watch.reached(self) {
                return WaitOutcome::Reached;
            }
            self.tick();
        }
        watch.last_check = None;
        if watch.reached(self) {
            WaitOutcome::Reached
        } else {
            WaitOutcome::TimedOut
        }
    }

    /// Stores a program in the program memory and selects it. A text without a program number
    /// takes that of its name (`O0001`, `o12.nc`).
    ///
    /// # Errors
    ///
    /// Returns the alarm with which the control refuses it.
    pub fn load_program(&mut self, name: &str, text: &str) -> Result<(), Alarm> {
        let program = Program::new(text);
        let text = match (program.number(), number_of_name(name)) {
            (None, Some(number)) => program.renumbered(number).text().to_owned(),
            _ => text.to_owned(),
        };
        self.simulation
            .cnc
            .request(ControlRequest::StoreProgram(text))
    }

    /// Receives a file through the serial port.
    ///
    /// # Errors
    ///
    /// Returns the reason why the control does not accept it.
    pub fn receive(&mut self, file: SerialFile) -> Result<(), ReceiveError> {
        let mut requests = Vec::new();
        let taken = self
            .panel
            .receive(file, &self.simulation.cnc, &mut requests);
        self.send_requests(requests);
        taken
    }

    /// Opens a read-only program outside the memory and selects it.
    ///
    /// # Errors
    ///
    /// Returns the alarm with which the control refuses it.
    pub fn load_external(&mut self, program: Program) -> Result<(), Alarm> {
        self.simulation
            .cnc
            .request(ControlRequest::OpenExternal(program))
    }

    /// Sets the graphic page to the extents of a program and starts drawing, unless the
    /// operator has entered extents. X is a radius.
    pub fn fit_graphic(&mut self, min: Point, max: Point) {
        self.panel.fit_graphic(min, max, &self.simulation.cnc);
    }

    /// Returns what the LCD shows.
    pub fn screen(&self) -> Screen {
        self.panel.screen(&self.simulation.cnc)
    }

    /// Returns the LCD in the language that it is not set to.
    pub fn translated_screen(&self) -> Screen {
        self.panel.translated(&self.simulation.cnc)
    }

    /// Draws the whole panel at `scale` pixels a panel unit. The LCD has two units a dot.
    /// `None` if the picture does not fit into memory.
    pub fn panel_picture(&self, scale: f32) -> Option<Pixmap> {
        let lcd = if self.panel.powered() {
            raster::render(&self.screen(), 1, self.panel.view().brightness)
        } else {
            None
        };
        let state = FaceState {
            y: &self.lamps(),
            pressed: &self.panel.pressed(),
            lcd: lcd.as_ref().map(Pixmap::as_ref),
            wheel: self.panel.wheel(),
            real: false,
            model: self.simulation.cnc.model().id(),
        };
        faceplate::paint(faceplate::PanelArea::WHOLE, &state, scale)
    }

    /// Returns whether a lamp is lit.
    pub fn lamp(&self, lamp: Bit) -> bool {
        let memory = self.simulation.cnc.plc().memory();
        self.panel.powered() && memory.bit(BitAddress::new(Area::Y, lamp.byte, lamp.bit))
    }

    /// Returns the Y memory for the lamps of the faceplate.
    pub fn lamps(&self) -> [u8; 20] {
        let memory = self.simulation.cnc.plc().memory();
        core::array::from_fn(|byte| {
            if self.panel.powered() {
                memory.y(byte as u16)
            } else {
                0
            }
        })
    }

    /// Stores the text in the editor, as leaving its page does, when a session ends with the
    /// power on.
    pub fn store_edited(&mut self) {
        let requests = self.panel.requests_to_store();
        self.send_requests(requests);
    }

    /// Switches the power off. The lathe stops.
    pub(crate) fn power_off(&mut self) {
        self.panel.power_off();
        self.connect_keys();
    }

    /// Switches the power on, if it is off.
    pub fn power_on(&mut self) {
        if self.panel.powered() {
            return;
        }
        self.simulation.power_cycle();
        self.panel.power_on(&self.simulation.cnc);
        self.connect_keys();
    }

    /// Switches the power off and on. Retained memory is kept.
    pub fn power_cycle(&mut self) {
        self.power_off();
        self.power_on();
    }

    /// Returns whether no program runs and the axes are stopped.
    pub fn is_stopped(&self) -> bool {
        let cnc = &self.simulation.cnc;
        cnc.run_state() != RunState::Run && !cnc.is_moving()
    }
}

/// A condition to wait for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ConditionWatch {
    condition: WaitCondition,
    block: gsk_core::cnc::ProgramCursor,
    last_check: Option<u64>,
}

impl ConditionWatch {
    pub(crate) fn new(condition: WaitCondition, emulator: &Emulator) -> Self {
        let condition = match condition {
            WaitCondition::Text(text) => WaitCondition::Text(fold_blanks(&text)),
            other => other,
        };
        Self {
            condition,
            block: emulator.simulation.cnc.cursor(),
            last_check: None,
        }
    }

    pub(crate) fn reached(&mut self, emulator: &Emulator) -> bool {
        let cnc = &emulator.simulation.cnc;
        match &self.condition {
            WaitCondition::SelfTestOver => !emulator.panel.in_self_test(),
            WaitCondition::Stopped => emulator.is_stopped(),
            WaitCondition::BlockEnd => emulator.is_stopped() || cnc.cursor() != self.block,
            WaitCondition::Alarm => cnc.is_in_alarm(),
            WaitCondition::Bit(bit, value) => cnc.plc().memory().bit(*bit) == *value,
            WaitCondition::Text(text) => {
                let now = emulator.ticks();
                if self
                    .last_check
                    .is_some_and(|last| now < last + SCREEN_PERIOD)
                {
                    return false;
                }
                self.last_check = Some(now);
                has_row_with(&emulator.screen(), text)
            }
        }
    }
}

/// Whether a row of the screen contains a text with single blanks.
fn has_row_with(screen: &Screen, text: &str) -> bool {
    (0..crate::screen::ROWS).any(|row| fold_blanks(&screen.row(row)).contains(text))
}

/// Returns a text with every run of blanks replaced by one.
pub(crate) fn fold_blanks(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests;
