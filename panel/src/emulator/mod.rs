//! Combines control, lathe and panel into one emulator.

mod input;
mod serial;

use gsk_core::alarm::Alarm;
use gsk_core::cnc::{Cnc, ControlRequest};
use gsk_core::machine::{MachineInputs, MachineOutputs, SimulatedLathe};
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::simulation::Simulation;
use gsk_core::units::Point;
use gsk_messages::Message;
use serde::{Deserialize, Serialize};
use tiny_skia::Pixmap;

use crate::faceplate::{self, FaceState, LcdGlass};
use crate::keys::{Bit, Key};
pub use crate::panel::number_of_name;
use crate::panel::{KeyEvent, Panel, ReceiveError, SerialFile, contacts};
use crate::raster;
use crate::screen::Screen;
use input::InputRecord;
pub use input::{EmulatorInput, InputAnswer, StampedInput};
pub use serial::PortRequest;

/// Ticks for which [`Emulator::press`] holds a key, and ticks of the pause after its release.
pub(crate) const PRESS_TICKS: u64 = 100;

/// Interval between checks of the LCD while waiting for its text, ticks.
const SCREEN_PERIOD: u64 = 20;

/// A control with its operator panel and its simulated lathe. Saving a session stores it.
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
    simulation: Simulation,
    panel: Panel,
    #[serde(skip)]
    record: InputRecord,
}

/// A condition for [`Emulator::run_until`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WaitCondition {
    /// Waits until the self-test picture after power-on has disappeared.
    SelfTestOver,
    /// Waits until no program runs and the axes are stopped.
    Stopped,
    /// The block in execution has ended, or the run has stopped.
    BlockEnd,
    /// Waits until an alarm or a message is active.
    Alarm,
    /// A row of the LCD contains this text. Runs of blanks count as one.
    Text(String),
    /// Waits until a bit of PLC memory has this value.
    Bit(BitAddress, bool),
}

/// Whether [`Emulator::run_until`] reached the condition or its time limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WaitOutcome {
    /// The condition became true.
    Reached,
    /// The time limit expired before the condition became true.
    TimedOut,
}

impl Emulator {
    /// Creates an emulator that has just been switched on.
    pub fn new(setup: Setup) -> Self {
        Self {
            simulation: Simulation::new(setup),
            panel: Panel::new(),
            record: InputRecord::default(),
        }
    }

    /// Returns the control and the simulated lathe.
    pub const fn simulation(&self) -> &Simulation {
        &self.simulation
    }

    /// Returns the control.
    pub const fn cnc(&self) -> &Cnc {
        &self.simulation.cnc
    }

    /// Returns the simulated lathe.
    pub const fn lathe(&self) -> &SimulatedLathe {
        &self.simulation.lathe
    }

    /// Returns the operator panel: keys, LCD pages, lamps.
    pub const fn panel(&self) -> &Panel {
        &self.panel
    }

    /// Returns the simulation for the link to a pulse board, which exchanges reports and
    /// orders with it beside the ticks. This exchange is not recorded.
    pub const fn board_simulation(&mut self) -> &mut Simulation {
        &mut self.simulation
    }

    /// Returns the ticks (ms) since the emulator was created, including those with the power
    /// off.
    pub const fn ticks(&self) -> u64 {
        self.panel.clock()
    }

    /// Simulates one tick (1 ms) of panel, control and lathe.
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

    /// Simulates `ticks` milliseconds.
    pub fn run(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    /// Handles a key event, which acts in the next tick. Returns the reason if page, mode
    /// or a switch prevents its effect, otherwise `None`. Machine keys are checked later, by
    /// [`crate::refusal::KeyPress`].
    pub fn key(&mut self, event: KeyEvent) -> Option<Message> {
        match self.apply(EmulatorInput::Key(event)) {
            InputAnswer::KeyRefused(why) => Some(why),
            _ => None,
        }
    }

    fn apply_key(&mut self, event: KeyEvent) -> Option<Message> {
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

    /// Sets the X contact of each machine key: closed while the key is held.
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

    /// Presses a key and keeps it down. Returns the reason if the key has no effect now,
    /// otherwise `None`.
    pub fn key_down(&mut self, key: Key) -> Option<Message> {
        self.key(KeyEvent::Down(key))
    }

    /// Releases a key that is held down.
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

    /// Holds a key for `ticks` milliseconds, then releases it.
    pub fn hold(&mut self, key: Key, ticks: u64) {
        self.key_down(key);
        self.run(ticks);
        self.key_up(key);
    }

    /// Types the characters of a text, one each 100 ms.
    pub fn type_text(&mut self, text: &str) {
        for character in text.chars() {
            self.key(KeyEvent::Type(character));
            self.run(PRESS_TICKS);
        }
    }

    /// Turns the handwheel at once by a number of graduations, clockwise positive.
    pub fn turn(&mut self, graduations: i32) {
        self.key(KeyEvent::Wheel(graduations));
    }

    /// Simulates until a condition is true, at most `limit_ms` milliseconds. Checks the
    /// condition before the first tick and after each one.
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
    /// takes the number in `name` (`O0001`, `o12.nc`).
    ///
    /// # Errors
    ///
    /// Returns the alarm with which the control refuses the program.
    pub fn load_program(&mut self, name: &str, text: &str) -> Result<(), Alarm> {
        let program = Program::new(text);
        let text = match (program.number(), number_of_name(name)) {
            (None, Some(number)) => program.renumbered(number).text().to_owned(),
            _ => text.to_owned(),
        };
        self.request(ControlRequest::StoreProgram(text))
    }

    /// Starts receiving a file through the serial port, as if its partner sent it.
    ///
    /// # Errors
    ///
    /// Returns the reason why the control does not receive the file.
    pub fn receive(&mut self, file: SerialFile) -> Result<(), ReceiveError> {
        match self.apply(EmulatorInput::Receive(file)) {
            InputAnswer::NotReceived(refused) => Err(refused),
            _ => Ok(()),
        }
    }

    fn begin_reception(&mut self, file: SerialFile) -> Result<(), ReceiveError> {
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
    /// Returns the alarm with which the control refuses to open the program.
    pub fn load_external(&mut self, program: Program) -> Result<(), Alarm> {
        self.request(ControlRequest::OpenExternal(program))
    }

    /// Sets the graphic page to the extents `min` to `max` of a program, mm with X as a
    /// radius, and starts drawing. Does nothing if the operator has entered extents.
    pub fn fit_graphic(&mut self, min: Point, max: Point) {
        self.apply(EmulatorInput::FitGraphic { min, max });
    }

    /// Returns the current picture of the LCD.
    pub fn screen(&self) -> Screen {
        self.panel.screen(&self.simulation.cnc)
    }

    /// Returns the LCD in the other language: English if it is set to Chinese, and vice versa.
    pub fn translated_screen(&self) -> Screen {
        self.panel.translated(&self.simulation.cnc)
    }

    /// Draws the whole panel at `scale` pixels a panel unit (half an LCD dot). Returns `None`
    /// if the picture does not fit into memory.
    pub fn panel_picture(&self, scale: f32) -> Option<Pixmap> {
        let (screen, brightness) = (self.screen(), self.panel.view().brightness);
        let lcd = if self.panel.powered() {
            raster::render(&screen, 1, brightness)
        } else {
            None
        };
        let lcd = lcd.as_ref().map(|picture| LcdGlass {
            dots: picture.as_ref(),
            ground: raster::palette(screen.colours(), brightness).background,
        });
        let state = FaceState {
            y: &self.lamps(),
            pressed: &self.panel.pressed(),
            lcd,
            wheel: self.panel.wheel(),
            real: false,
            model: self.simulation.cnc.model().id(),
        };
        faceplate::paint(faceplate::PanelArea::WHOLE, &state, scale)
    }

    /// Returns whether the lamp at this Y bit is lit; `false` while the power is off.
    pub fn lamp(&self, lamp: Bit) -> bool {
        let memory = self.simulation.cnc.plc().memory();
        self.panel.powered() && memory.bit(BitAddress::new(Area::Y, lamp.byte, lamp.bit))
    }

    /// Returns bytes 0 to 19 of the Y memory, which light the lamps; zeros while the power is
    /// off.
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

    /// Stores the program text that is open in the editor. Call it when a session ends with
    /// the power on.
    pub fn store_edited(&mut self) {
        self.apply(EmulatorInput::StoreEdited);
    }

    fn store_edited_text(&mut self) {
        let requests = self.panel.requests_to_store();
        self.send_requests(requests);
    }

    /// Switches the power off: the LCD goes dark, keys are released, the lathe stops.
    pub(crate) fn power_off(&mut self) {
        self.apply(EmulatorInput::PowerOff);
    }

    fn switch_off(&mut self) -> InputAnswer {
        self.panel.power_off();
        self.connect_keys();
        InputAnswer::Applied
    }

    /// Switches the power on, if it is off.
    pub fn power_on(&mut self) {
        self.apply(EmulatorInput::PowerOn);
    }

    fn switch_on(&mut self) -> InputAnswer {
        if !self.panel.powered() {
            self.simulation.power_cycle();
            self.panel.power_on(&self.simulation.cnc);
            self.connect_keys();
        }
        InputAnswer::Applied
    }

    /// Switches the power off and on again. Retained memory is kept.
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

/// Watches a [`WaitCondition`]; stores the block at the start and the time of the last LCD
/// check.
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

/// Whether a row of the LCD contains `text`, with every run of blanks as one.
fn has_row_with(screen: &Screen, text: &str) -> bool {
    (0..crate::screen::ROWS).any(|row| fold_blanks(&screen.row(row)).contains(text))
}

/// Returns a text with every run of blanks replaced by one.
pub(crate) fn fold_blanks(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests;
