//! Handles the keys and the display of the operator panel: held keys, selected page, typed text
//! (manual III-1.2). It stores no machine state. It reads the control and sends requests to it.

mod entry;
mod graphic;
mod limited_keys;
pub mod limits;
mod navigation;
mod program_text;
mod refusal;
mod search;
mod soft_keys;
mod teach;
mod transfer;
mod udisk;
mod values;

pub(crate) use entry::is_typable;
use gsk_core::cnc::{Cnc, ControlRequest};
use gsk_core::command::{Frame, ProgramId};
use gsk_core::operation::OperatingMode;
use gsk_core::units::Point;
use gsk_messages::Language;
use serde::{Deserialize, Serialize};
use transfer::Transfer;
pub use transfer::{
    DataLineError, FileId, FileRefusal, LADDER_FILE, ReceiveError, SerialCable, SerialFile,
    file_of, number_of_name, read_data,
};

use crate::face::face_of;
use crate::keys::{Key, KeyRole, all_rows};
use crate::pages::{self, GraphicSettings, POWER_ON_TICKS, PageId, PageKey, PageView};
use crate::panel::limits::PanelLimits;
use crate::screen::Screen;

/// Greatest number of characters that the input line accepts.
pub(crate) const INPUT_LENGTH: usize = 20;

/// Time until a held cursor or page key repeats, ticks (ms).
pub(crate) const REPEAT_DELAY: u64 = 500;
/// Interval between repetitions of a held key, ticks (ms).
pub(crate) const REPEAT_PERIOD: u64 = 100;

/// An action of the operator on the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum KeyEvent {
    /// Presses a key. The emergency stop latches, and is released by the next press.
    Down(Key),
    /// Releases a key that was pressed.
    Up(Key),
    /// Releases all keys, because the window has lost the focus.
    ReleaseAll,
    /// Types a character on the PC keyboard, as if it had its own key.
    Type(char),
    /// Turns the handwheel by a number of graduations, clockwise positive.
    Wheel(i32),
}

/// The settings of the panel that survive power-off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PanelRetained {
    /// Brightness of the LCD, 0 (darkest) to 15.
    pub brightness: u8,
    /// Plane, scale, centre and extents of the graphic page.
    pub graphic: GraphicSettings,
}

/// The operator panel: keys, selected page, typed text, serial port.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Panel {
    page: PageId,
    view: PageView,
    /// The last page of the groups POS, PRG, OFT and ALM.
    last_shown: [PageId; 4],
    /// Keys that are held and accepted, in the order of pressing.
    held: Vec<Key>,
    emergency_stop: bool,
    repeat: Option<Repeat>,
    /// The compound key that entered the last character of the input line; `None` if another
    /// key did.
    compound: Option<Key>,
    powered: bool,
    /// Ticks (ms) since the emulator was created, including power-off.
    clock: u64,
    /// Clock tick until which the self-test picture is shown; `None` after the self-test.
    picture_until: Option<u64>,
    /// Whether the self-test picture stays until a page key is pressed (173.2 SWAT).
    picture_waits: bool,
    mode: Option<OperatingMode>,
    /// Numbers of the alarms that were active at the last tick.
    alarms: Vec<u16>,
    /// Numbers of the ladder messages that were active at the last tick.
    messages: Vec<u16>,
    /// Number of the program whose text the editor has changed but not stored; `None` without
    /// changes.
    edited: Option<u16>,
    /// Number of a program whose creation has just been requested, otherwise `None`.
    created: Option<u16>,
    /// Selected program and line (from 1) of the control at the last tick; `None` before the
    /// first.
    followed: Option<(Option<ProgramId>, u32)>,
    traced: Option<(Frame, Point)>,
    /// Number of stops of a pulse board after which the drawn path was corrected.
    stops: u64,
    wheel: i32,
    transfer: Transfer,
    /// The keys and pages that an exercise refuses.
    #[serde(default, skip_serializing_if = "PanelLimits::is_empty")]
    limits: PanelLimits,
}

/// A held key that repeats, and the clock tick of the next repetition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Repeat {
    key: Key,
    at: u64,
}

impl Default for Panel {
    fn default() -> Self {
        Self::new()
    }
}

impl Panel {
    /// Creates a panel that has just been switched on.
    pub fn new() -> Self {
        Self {
            page: PageId::PosRel,
            view: PageView::default(),
            last_shown: [PageId::PosRel, PageId::Prg, PageId::Oft, PageId::Msg],
            held: Vec::new(),
            emergency_stop: false,
            repeat: None,
            compound: None,
            powered: true,
            clock: 0,
            picture_until: Some(POWER_ON_TICKS),
            picture_waits: false,
            mode: None,
            alarms: Vec::new(),
            messages: Vec::new(),
            edited: None,
            created: None,
            followed: None,
            traced: None,
            stops: 0,
            wheel: 0,
            transfer: Transfer::default(),
            limits: PanelLimits::default(),
        }
    }

    /// Switches the panel on with the self-test picture. Keeps brightness, graphic settings
    /// and latched buttons.
    pub fn power_on(&mut self, cnc: &Cnc) {
        let mut new = Self::new();
        new.restore(&self.retained());
        new.emergency_stop = self.emergency_stop;
        new.wheel = self.wheel;
        new.transfer = self.transfer.after_power_on();
        new.limits = core::mem::take(&mut self.limits);
        new.clock = self.clock;
        new.picture_until = Some(self.clock + POWER_ON_TICKS);
        new.picture_waits = cnc.parameters().waits_at_power_on();
        *self = new;
    }

    /// Returns the panel's settings that survive power-off.
    pub const fn retained(&self) -> PanelRetained {
        PanelRetained {
            brightness: self.view.brightness,
            graphic: self.view.graphic,
        }
    }

    /// Restores the panel's settings that survive power-off.
    pub fn restore(&mut self, retained: &PanelRetained) {
        self.view.brightness = retained.brightness.min(pages::BRIGHTNESS_STEPS - 1);
        self.view.graphic = retained.graphic;
        self.view.graphic.drawing = false;
    }

    /// Returns the requests that store the program text in the editor. Call it when the window
    /// closes.
    pub(crate) fn requests_to_store(&mut self) -> Vec<ControlRequest> {
        let mut requests = Vec::new();
        self.store_edited(&mut requests);
        requests
    }

    /// Switches the panel off: the LCD is dark and all keys are released.
    pub(crate) fn power_off(&mut self) {
        self.powered = false;
        self.held.clear();
        self.repeat = None;
    }

    /// Returns whether the control's power is on.
    pub const fn powered(&self) -> bool {
        self.powered
    }

    /// Returns the ticks (ms) since the emulator was created, including power-off.
    pub const fn clock(&self) -> u64 {
        self.clock
    }

    /// Returns the selected page, which the LCD shows after the self-test.
    pub const fn page(&self) -> PageId {
        self.page
    }

    /// Returns the state that the LCD pages draw.
    pub const fn view(&self) -> &PageView {
        &self.view
    }

    /// Returns the keys that are held and accepted, in the order of pressing.
    pub fn held(&self) -> &[Key] {
        &self.held
    }

    /// Returns whether this key is held down and was accepted.
    pub fn is_held(&self, key: Key) -> bool {
        self.held.contains(&key)
    }

    /// Returns whether the emergency stop button is latched.
    pub const fn emergency_stop(&self) -> bool {
        self.emergency_stop
    }

    /// Returns the position of the handwheel, graduations, clockwise positive.
    pub const fn wheel(&self) -> i32 {
        self.wheel
    }

    /// Returns whether the self-test picture after power-on is shown.
    pub(crate) const fn in_self_test(&self) -> bool {
        self.picture_until.is_some()
    }

    /// Shows a page immediately without keys, for pictures of single pages. Ends the
    /// self-test.
    pub fn show(&mut self, page: PageId, cnc: &Cnc) {
        self.picture_until = None;
        self.go_to(page, cnc);
    }

    /// Returns the picture of the LCD; empty while the power is off.
    pub fn screen(&self, cnc: &Cnc) -> Screen {
        self.screen_in(pages::language(cnc), cnc)
    }

    /// Returns the LCD in the other language: English if it is set to Chinese, and vice versa.
    pub fn translated(&self, cnc: &Cnc) -> Screen {
        self.screen_in(pages::language(cnc).other(), cnc)
    }

    fn screen_in(&self, language: Language, cnc: &Cnc) -> Screen {
        if !self.powered {
            return Screen::new();
        }
        if self.in_self_test() {
            return pages::power_on(language, cnc.model().id());
        }
        pages::draw_in(language, self.page, &self.view, cnc)
    }

    /// Returns the keys drawn as pressed: the held ones and the latched emergency stop.
    pub fn pressed(&self) -> Vec<Key> {
        let mut pressed = self.held.clone();
        if self.emergency_stop {
            pressed.push(Key::EmergencyStop);
        }
        pressed
    }

    /// Handles a key event. Returns the requests to the control that follow. [`Self::is_held`]
    /// gives the contacts of machine keys.
    pub fn key(&mut self, event: KeyEvent, cnc: &Cnc) -> Vec<ControlRequest> {
        let mut requests = Vec::new();
        match event {
            KeyEvent::Down(Key::EmergencyStop) => self.emergency_stop = !self.emergency_stop,
            KeyEvent::Up(Key::EmergencyStop) => {}
            KeyEvent::Down(key) => self.press_key(key, cnc, &mut requests),
            KeyEvent::Up(key) => self.release_key(key, &mut requests),
            KeyEvent::ReleaseAll => {
                for key in self.held.clone() {
                    self.release_key(key, &mut requests);
                }
            }
            KeyEvent::Type(character) => {
                if self.is_awake() && self.limits.character_refusal(character).is_none() {
                    self.type_character(character, cnc, &mut requests);
                }
            }
            KeyEvent::Wheel(graduations) => self.wheel = self.wheel.wrapping_add(graduations),
        }
        requests
    }

    /// Returns whether the display reacts to keys: the power is on and the self-test has
    /// ended.
    const fn is_awake(&self) -> bool {
        self.powered && !self.in_self_test()
    }

    fn press_key(&mut self, key: Key, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        if self.is_held(key) || !(self.powered || key == Key::OvertravelRelease) {
            return;
        }
        let is_on_panel = face_of(cnc.model().id()).key(key).is_some();
        if !is_on_panel || self.limits.key_refusal(key).is_some() {
            return;
        }
        let in_key_matrix = |key: &&Key| **key != Key::OvertravelRelease;
        let most = cnc.parameters().simultaneous_key_limit();
        if in_key_matrix(&&key) && self.held.iter().filter(in_key_matrix).count() >= most {
            return;
        }
        self.held.push(key);
        if self.in_self_test() {
            let shown_long_enough = self.picture_until.is_some_and(|until| self.clock >= until);
            if key.row().role == KeyRole::Page && shown_long_enough {
                self.picture_until = None;
            }
            return;
        }
        self.repeat = key.repeats().then_some(Repeat {
            key,
            at: self.clock + REPEAT_DELAY,
        });
        self.act(key, cnc, requests);
    }

    fn release_key(&mut self, key: Key, requests: &mut Vec<ControlRequest>) {
        self.held.retain(|held| *held != key);
        if self.repeat.is_some_and(|repeat| repeat.key == key) {
            self.repeat = None;
        }
        if key == Key::Output {
            requests.push(ControlRequest::SetOutputKey(false));
        }
    }

    /// Carries out the effect of a key on the display; `requests` receives those to the control.
    fn act(&mut self, key: Key, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        if self.refused_page(key, cnc).is_none() {
            self.act_unlimited(key, cnc, requests);
        }
    }

    fn act_unlimited(&mut self, key: Key, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        self.clear_transfer_error();
        let compound = self.compound.take();
        let flashing = self.view.flashing.take();
        if self.is_teaching(cnc) && self.teaching_key(key, cnc, requests) {
            return;
        }
        if self.page == PageId::Udisk && self.udisk_key(key, cnc, requests) {
            return;
        }
        match (key.row().role, key) {
            (KeyRole::Page, _) => self.page_key(key, cnc),
            (KeyRole::Soft(position), _) => self.soft_key(position, cnc, requests),
            (KeyRole::Character(first, second), _) => {
                self.character_key(key, first, second, compound, cnc, requests);
            }
            (_, Key::Up | Key::Down) if flashing.is_some() && self.page == PageId::PosRel => {
                self.view.flashing = flashing;
                self.change_brightness(key == Key::Down);
            }
            (_, Key::Cancel) if flashing.is_some() => {
                requests.extend(flashing.map(ControlRequest::ZeroRelative));
            }
            (_, Key::Up | Key::Down | Key::Left | Key::Right) => {
                self.cursor_key(key, cnc, requests);
            }
            (_, Key::PageUp) => self.turn_page(false, cnc, requests),
            (_, Key::PageDown) => self.turn_page(true, cnc, requests),
            (_, Key::Input) if cnc.mode().teaches() && self.edits(cnc) => {
                self.teach(cnc, requests);
            }
            (_, Key::Input) => self.commit_input(cnc, requests),
            (_, Key::Output) => self.output(cnc, requests),
            (_, Key::Eob | Key::Insert | Key::Delete | Key::Cancel) if self.edits(cnc) => {
                self.edit_key(key, cnc, requests);
            }
            (_, Key::Change) => self.change_key(cnc, requests),
            (_, Key::Cancel) if self.page == PageId::Password => self.password_cancel(),
            (_, Key::Cancel) => {
                self.view.input.pop();
            }
            (_, Key::Reset) => self.reset(cnc, requests),
            _ => {}
        }
    }

    fn reset(&mut self, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        self.clear_input();
        self.abort_transfer(requests);
        if self.is_held(Key::Cancel) {
            requests.push(ControlRequest::CancelSwitchAlarm);
        }
        if cnc.mode() == OperatingMode::Edit
            && let Some(editing) = &mut self.view.editor.editing
        {
            editing.move_to_head();
        }
    }

    fn clear_input(&mut self) {
        self.view.input.clear();
        self.view.password.clear();
        self.view.editor.searching = false;
        self.compound = None;
    }

    fn change_brightness(&mut self, brighter: bool) {
        let last = pages::BRIGHTNESS_STEPS - 1;
        self.view.brightness = if brighter {
            (self.view.brightness + 1).min(last)
        } else {
            self.view.brightness.saturating_sub(1)
        };
    }

    /// Advances the panel by one millisecond, after the control. Returns the requests to the
    /// control.
    pub fn tick(&mut self, cnc: &Cnc) -> Vec<ControlRequest> {
        self.clock += 1;
        if !self.powered {
            return Vec::new();
        }
        self.view.ticks += 1;
        let over = self.picture_until.is_some_and(|until| self.clock >= until);
        if over && !self.picture_waits {
            self.picture_until = None;
        }
        let mut requests = Vec::new();
        self.follow_mode(cnc, &mut requests);
        if self.picture_until.is_none() {
            // A message during the self-test leaves no empty alarm page.
            self.follow_alarms(cnc);
        }
        self.trace(cnc);
        self.follow_program(cnc, &mut requests);
        self.follow_transfer(cnc, &mut requests);
        self.repeat_key(cnc, &mut requests);
        requests
    }

    fn repeat_key(&mut self, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        let Some(repeat) = self.repeat.filter(|repeat| self.clock >= repeat.at) else {
            return;
        };
        self.act(repeat.key, cnc, requests);
        self.repeat = Some(Repeat {
            at: self.clock + REPEAT_PERIOD,
            ..repeat
        });
    }

    /// Clears the input line and stores the text in the editor when the mode has changed. EDIT
    /// has no MDI page and no directory.
    fn follow_mode(&mut self, cnc: &Cnc, requests: &mut Vec<ControlRequest>) {
        let mode = cnc.mode();
        if self.mode.replace(mode).is_none_or(|before| before == mode) {
            return;
        }
        self.clear_input();
        self.store_edited(requests);
        self.view.editor.editing = None;
        self.view.editor.alter = false;
        if mode.edits() && matches!(self.page, PageId::Mdi | PageId::Dir) {
            self.go_to(PageId::Prg, cnc);
        }
    }

    /// Switches the display to the page of a new alarm or message.
    fn follow_alarms(&mut self, cnc: &Cnc) {
        let active = cnc.alarms();
        let known = |number| self.alarms.contains(number);
        let new = active.iter().any(|alarm| !known(&alarm.number));
        if new || active.len() != self.alarms.len() {
            self.alarms = active.iter().map(|alarm| alarm.number).collect();
        }
        if new {
            self.go_to(PageId::Alm, cnc);
        }
        if !cnc.is_in_alarm() {
            self.messages.clear();
            return;
        }
        if !cnc.plc().memory().has_message_request() && self.messages.is_empty() {
            return;
        }
        let messages: Vec<u16> = cnc.plc_messages().map(|(number, _)| number).collect();
        if messages
            .iter()
            .any(|number| !self.messages.contains(number))
        {
            self.go_to(PageId::Msg, cnc);
        }
        self.messages = messages;
    }
}

/// Returns the page group that a key opens; `None` if it is not a page key.
const fn page_group(key: Key) -> Option<PageKey> {
    Some(match key {
        Key::Position => PageKey::Pos,
        Key::Program => PageKey::Prg,
        Key::Offset => PageKey::Oft,
        Key::Alarm => PageKey::Alm,
        Key::Setting => PageKey::Set,
        Key::Parameter => PageKey::Par,
        Key::Diagnosis => PageKey::Dgn,
        Key::Teach => PageKey::Teach,
        Key::MainProgram => PageKey::Program,
        Key::MainOperate => PageKey::Operate,
        Key::MainParameter => PageKey::Parameter,
        _ => return None,
    })
}

/// Returns the X contact of each machine key, and whether the key closes it.
pub(crate) fn contacts(panel: &Panel) -> impl Iterator<Item = (crate::keys::Bit, bool)> {
    all_rows().filter_map(|row| {
        let contact = row.key.contact()?;
        Some((contact, panel.is_held(row.key)))
    })
}

#[cfg(test)]
mod tests;
