//! The scope: position, speed, acceleration, following error, spindle and PLC bits over time,
//! a sample a millisecond; for tuning an axis.

mod csv;
mod plot;
mod pointer;
mod record;
mod scale;
mod side;
mod toolbar;
mod trace;
mod trigger;

use std::time::Duration;

use egui::{Event, Key, Panel, Ui};
use gsk_core::plc::address::BitAddress;

use super::aside;
use crate::kernel::probe::{BITS, Probe};
use crate::kernel::{Command, Console};
use gsk_messages::{Language, say};
use pointer::Drag;
use record::Record;
use scale::Range;
use trace::{Quantity, TRACES};
use trigger::{Mode, Trigger};

/// Time spans of the picture that can be chosen, ms.
const SPANS: [u64; 11] = [
    50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000, 30_000, 60_000,
];
/// Numbers of ticks for the average of speed and acceleration that can be chosen.
const AVERAGES: [u64; 6] = [1, 2, 4, 8, 16, 32];
/// Part of the picture after the trigger's edge, in tenths.
const AFTER_EDGE: u64 = 9;

/// A watched PLC bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BitChannel {
    pub address: BitAddress,
    /// Its position in the bits of a sample.
    pub place: usize,
}

/// The two cursors, ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Cursors {
    at: [u64; 2],
    /// Index of the cursor that keys move.
    active: usize,
}

/// The state of the scope.
pub struct Scope {
    console: Console,
    record: Option<Record>,
    running: bool,
    /// Right edge of a stopped picture, ticks; `None`: the picture rolls.
    stopped_at: Option<u64>,
    /// Tick of the time axis' zero.
    origin: u64,
    span: u64,
    over: u64,
    on: [bool; TRACES.len()],
    bits: Vec<BitChannel>,
    next_place: usize,
    trigger: Trigger,
    cursors: Option<Cursors>,
    autoscale: bool,
    ranges: [Range; Quantity::ALL.len()],
    drag: Drag,
    entry: String,
    complaint: Option<String>,
}

impl Scope {
    /// Creates the scope closed: the kernel takes no samples.
    pub fn new(console: Console) -> Self {
        Self {
            console,
            record: None,
            running: true,
            stopped_at: None,
            origin: 0,
            span: 5000,
            over: 8,
            on: std::array::from_fn(|index| TRACES[index].on),
            bits: Vec::new(),
            next_place: 0,
            trigger: Trigger::new(),
            cursors: None,
            autoscale: true,
            ranges: Quantity::ALL.map(|quantity| Range::around(0.0, quantity)),
            drag: Drag::Nothing,
            entry: String::new(),
            complaint: None,
        }
    }

    /// Starts the sampling in the kernel with an empty record.
    pub fn open(&mut self) {
        self.record = Some(Record::new());
        self.running = true;
        self.stopped_at = None;
        self.origin = 0;
        self.cursors = None;
        self.trigger.arm();
        self.watch();
    }

    /// Stops the sampling in the kernel.
    pub fn close(&mut self) {
        self.record = None;
        self.console.send(Command::Probe(None));
    }

    fn watch(&self) {
        let Some(record) = &self.record else { return };
        let mut bits = vec![None; BITS];
        for channel in &self.bits {
            if let Some(place) = bits.get_mut(channel.place) {
                *place = Some(channel.address);
            }
        }
        let queue = record.queue();
        self.console
            .send(Command::Probe(Some(Probe { queue, bits })));
    }

    /// Draws the scope and handles its input. `own_keys`: the scope is in a separate window
    /// and handles its keys.
    pub fn show(&mut self, ui: &mut Ui, language: Language, own_keys: bool) {
        self.take();
        if own_keys {
            self.keys(ui);
        }
        let bar = Panel::top("scope bar").frame(super::bar_frame());
        bar.show(ui, |ui| self.toolbar(ui, language));
        let side = Panel::right("scope side")
            .exact_size(self.side_width())
            .resizable(false)
            .frame(super::side_frame());
        side.show(ui, |ui| self.side(ui, language));
        egui::CentralPanel::default()
            .frame(super::plain_frame())
            .show(ui, |ui| self.plot(ui, language));
        if self.running {
            // No more often than the picture moves by a pixel.
            let pause = (self.span / 800).clamp(33, 100);
            ui.ctx().request_repaint_after(Duration::from_millis(pause));
        }
    }

    /// Takes new samples and checks them for the trigger.
    fn take(&mut self) {
        let Some(record) = self.record.as_mut().filter(|_| self.running) else {
            return;
        };
        let count = record.take();
        if self.origin == 0 {
            self.origin = record.ticks().map_or(0, |(first, _)| first);
        }
        let after = self.span * AFTER_EDGE / 10;
        for sample in record.last(count) {
            let Some(edge) = self.trigger.look(sample, after) else {
                continue;
            };
            self.origin = edge;
            self.stopped_at = Some(edge + after);
            if self.trigger.mode == Mode::Once {
                self.running = false;
                break;
            }
        }
    }

    /// First and last tick of the picture. The first may be earlier than the record.
    fn shown(&self) -> Option<(u64, u64)> {
        let (_, last) = self.record.as_ref()?.ticks()?;
        let end = self.stopped_at.unwrap_or(last);
        Some((end.saturating_sub(self.span), end))
    }

    fn pause(&mut self) {
        self.stopped_at = self.shown().map(|(_, end)| end);
        self.running = false;
    }

    fn go_on(&mut self) {
        self.running = true;
        self.stopped_at = None;
        self.trigger.arm();
    }

    fn toggle(&mut self) {
        if self.running {
            self.pause();
        } else {
            self.go_on();
        }
    }

    /// Changes the span by steps of `SPANS`. In a stopped picture the tick at `at`, 0 to 1 of
    /// the width, keeps its position.
    fn zoom(&mut self, steps: i32, at: f64) {
        let now = SPANS.iter().position(|span| *span >= self.span);
        let now = now.unwrap_or(SPANS.len() - 1) as i32;
        let next = (now + steps).clamp(0, SPANS.len() as i32 - 1);
        let span = SPANS[next as usize];
        if let Some(end) = self.stopped_at {
            let fixed = end as f64 - (1.0 - at) * self.span as f64;
            self.stopped_at = Some((fixed + (1.0 - at) * span as f64).max(0.0).round() as u64);
        }
        self.span = span;
    }

    /// Stops the picture and moves it by `ticks`, positive to the right.
    fn pan(&mut self, ticks: i64) {
        if self.running {
            self.pause();
        }
        let Some((first, last)) = self.record.as_ref().and_then(Record::ticks) else {
            return;
        };
        let end = self.stopped_at.unwrap_or(last);
        self.stopped_at = Some(end.saturating_add_signed(-ticks).clamp(first, last));
    }

    fn toggle_cursors(&mut self) {
        self.cursors = match (self.cursors, self.shown()) {
            (None, Some((first, end))) => {
                let quarter = (end - first) / 4;
                Some(Cursors {
                    at: [first + quarter, end - quarter],
                    active: 0,
                })
            }
            _ => None,
        };
    }

    fn move_cursor(&mut self, ticks: i64) {
        if let Some(cursors) = &mut self.cursors
            && let Some(at) = cursors.at.get_mut(cursors.active)
        {
            *at = at.saturating_add_signed(ticks);
        }
    }

    /// Handles the keys of the scope. Keys with Ctrl or Alt belong to the panel.
    fn keys(&mut self, ui: &Ui) {
        if ui.ctx().egui_wants_keyboard_input() {
            return;
        }
        let pressed: Vec<(Key, bool)> = ui.input(|input| {
            let key = |event: &Event| match event {
                Event::Key {
                    key,
                    pressed: true,
                    modifiers,
                    ..
                } if !modifiers.ctrl && !modifiers.alt => Some((*key, modifiers.shift)),
                _ => None,
            };
            input.events.iter().filter_map(key).collect()
        });
        for (key, fine) in pressed {
            let step = if fine {
                1
            } else {
                (self.span / 200).max(1) as i64
            };
            match key {
                Key::Space => self.toggle(),
                Key::C => self.toggle_cursors(),
                Key::A => self.autoscale = !self.autoscale,
                Key::Plus | Key::Equals => self.zoom(-1, 0.5),
                Key::Minus => self.zoom(1, 0.5),
                Key::PageUp => self.pan(self.span as i64 / 2),
                Key::PageDown => self.pan(-(self.span as i64 / 2)),
                Key::ArrowLeft => self.move_cursor(-step),
                Key::ArrowRight => self.move_cursor(step),
                Key::ArrowUp | Key::ArrowDown => {
                    if let Some(cursors) = &mut self.cursors {
                        cursors.active = 1 - cursors.active;
                    }
                }
                _ => {}
            }
        }
    }

    /// Watches the PLC bit that the user has typed.
    fn add_bit(&mut self, language: Language) {
        let entry = self.entry.trim().to_ascii_uppercase();
        match entry.parse::<BitAddress>() {
            Err(error) => {
                self.complaint = Some(say::scope_not_an_address(error).text(language));
            }
            Ok(address) => {
                self.complaint = None;
                self.entry.clear();
                let known = self.bits.iter().any(|channel| channel.address == address);
                if !known && self.bits.len() < BITS {
                    let place = self.free_place();
                    self.bits.push(BitChannel { address, place });
                    self.watch();
                }
            }
        }
    }

    /// The position in the samples that has been unused for the longest time: old samples of
    /// another bit must not appear under the new name.
    fn free_place(&mut self) -> usize {
        while self
            .bits
            .iter()
            .any(|channel| channel.place == self.next_place)
        {
            self.next_place = (self.next_place + 1) % BITS;
        }
        let place = self.next_place;
        self.next_place = (place + 1) % BITS;
        place
    }

    /// Writes the visible part of the record to a file that the user chooses.
    fn export(&self, language: Language, context: &egui::Context) {
        let (Some(record), Some((first, last))) = (&self.record, self.shown()) else {
            return;
        };
        let excerpt = record.excerpt(first.saturating_sub(2 * self.over), last);
        let (bits, over) = (self.bits.clone(), self.over);
        aside::save(
            &self.console,
            context,
            language,
            ("scope.csv", "CSV"),
            move || csv::table(&excerpt, &bits, (first, last), over),
        );
    }
}
