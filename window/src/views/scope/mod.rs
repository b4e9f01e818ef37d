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
use gsk_host::kernel::probe::{MAX_BITS, Probe};
use gsk_host::kernel::{Command, Console};

use super::interface::{View, ViewFrame, ViewStart};
use super::text_files;
use gsk_messages::{Language, say};
use pointer::Drag;
use record::SampleRecord;
use scale::LaneRange;
use trace::{Quantity, TRACES};
use trigger::{Trigger, TriggerMode};

/// Time spans of the picture that the user can choose, ms.
const SPANS_MS: [u64; 11] = [
    50, 100, 200, 500, 1000, 2000, 5000, 10_000, 20_000, 30_000, 60_000,
];
/// Numbers of ticks that the user can choose for the average of speed and acceleration.
const AVERAGES_TICKS: [u64; 6] = [1, 2, 4, 8, 16, 32];
/// Interval between two frames while all traces are level, ms.
const LEVEL_PAUSE_MS: u64 = 4000;
/// Share of the picture after the trigger's event, in tenths.
const TENTHS_AFTER_EDGE: u64 = 9;

/// A PLC bit that the scope records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BitChannel {
    pub address: BitAddress,
    /// Index of the recorded bit in `ScopeSample::bits`, from 0.
    pub bit_index: usize,
}

/// The two time cursors of the scope, by their ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Cursors {
    ticks: [u64; 2],
    /// Index of the cursor that keys move, 0 or 1.
    active: usize,
}

/// The scope: its settings and the recorded samples.
pub struct Scope {
    console: Console,
    record: Option<SampleRecord>,
    is_running: bool,
    /// Tick at the right edge of a stopped picture; `None` if the picture rolls.
    stop_tick: Option<u64>,
    /// Tick that corresponds to the zero of the time axis.
    origin_tick: u64,
    span_ms: u64,
    average_ticks: u64,
    trace_enabled: [bool; TRACES.len()],
    bit_channels: Vec<BitChannel>,
    next_bit_index: usize,
    trigger: Trigger,
    cursors: Option<Cursors>,
    autoscale: bool,
    ranges: [LaneRange; Quantity::ALL.len()],
    drag: Drag,
    entry: String,
    entry_error: Option<String>,
}

impl View for Scope {
    fn create(start: ViewStart<'_>) -> Self {
        Self::new(start.console.clone())
    }

    fn open(&mut self) {
        self.record = Some(SampleRecord::new());
        self.is_running = true;
        self.stop_tick = None;
        self.origin_tick = 0;
        self.cursors = None;
        self.trigger.arm();
        self.start_probe();
    }

    fn close(&mut self) {
        self.record = None;
        self.console.send(Command::Probe(None));
    }

    fn show(&mut self, ui: &mut Ui, frame: ViewFrame<'_>) {
        self.draw(ui, frame.language, frame.owns_keys);
    }
}

impl Scope {
    /// Creates the scope closed, without sampling in the kernel.
    pub fn new(console: Console) -> Self {
        Self {
            console,
            record: None,
            is_running: true,
            stop_tick: None,
            origin_tick: 0,
            span_ms: 5000,
            average_ticks: 8,
            trace_enabled: std::array::from_fn(|index| TRACES[index].on_at_start),
            bit_channels: Vec::new(),
            next_bit_index: 0,
            trigger: Trigger::new(),
            cursors: None,
            autoscale: true,
            ranges: Quantity::ALL.map(|quantity| LaneRange::around_value(0.0, quantity)),
            drag: Drag::Nothing,
            entry: String::new(),
            entry_error: None,
        }
    }

    fn start_probe(&self) {
        let Some(record) = &self.record else { return };
        let mut bits = vec![None; MAX_BITS];
        for channel in &self.bit_channels {
            if let Some(slot) = bits.get_mut(channel.bit_index) {
                *slot = Some(channel.address);
            }
        }
        let queue = record.queue();
        self.console
            .send(Command::Probe(Some(Probe { queue, bits })));
    }

    /// Draws the scope and handles its input. `own_keys`: the scope is in a separate window
    /// and handles its keys.
    fn draw(&mut self, ui: &mut Ui, language: Language, own_keys: bool) {
        self.take_samples();
        if own_keys {
            self.handle_keys(ui);
        }
        let bar = Panel::top("scope bar").frame(super::bar_frame());
        bar.show(ui, |ui| self.show_toolbar(ui, language));
        let side = Panel::right("scope side")
            .exact_size(self.side_width())
            .resizable(false)
            .frame(super::side_frame());
        side.show(ui, |ui| self.show_side(ui, language));
        egui::CentralPanel::default()
            .frame(super::plain_frame())
            .show(ui, |ui| self.show_plot(ui, language));
        if self.is_running {
            // No more often than the picture moves by a pixel, and rarely while all traces are
            // level: the kernel requests a frame when the machine changes.
            let record = self.record.as_ref();
            let span = usize::try_from(self.span_ms).unwrap_or(usize::MAX);
            let pause = match record.is_some_and(|record| record.is_level(span)) {
                true => LEVEL_PAUSE_MS,
                false => (self.span_ms / 800).clamp(33, 100),
            };
            ui.ctx().request_repaint_after(Duration::from_millis(pause));
        }
    }

    /// Takes new samples into the record and checks them for the trigger.
    fn take_samples(&mut self) {
        let Some(record) = self.record.as_mut().filter(|_| self.is_running) else {
            return;
        };
        let count = record.take_samples();
        if self.origin_tick == 0 {
            self.origin_tick = record.tick_range().map_or(0, |(first, _)| first);
        }
        let after = self.span_ms * TENTHS_AFTER_EDGE / 10;
        for sample in record.last_samples(count) {
            let Some(edge) = self.trigger.check_sample(sample, after) else {
                continue;
            };
            self.origin_tick = edge;
            self.stop_tick = Some(edge + after);
            if self.trigger.mode == TriggerMode::Once {
                self.is_running = false;
                break;
            }
        }
    }

    /// First and last tick of the picture; `None` without samples. The first may be earlier
    /// than the record.
    fn visible_ticks(&self) -> Option<(u64, u64)> {
        let (_, last) = self.record.as_ref()?.tick_range()?;
        let end = self.stop_tick.unwrap_or(last);
        Some((end.saturating_sub(self.span_ms), end))
    }

    fn pause(&mut self) {
        self.stop_tick = self.visible_ticks().map(|(_, end)| end);
        self.is_running = false;
    }

    fn resume(&mut self) {
        self.is_running = true;
        self.stop_tick = None;
        self.trigger.arm();
    }

    fn toggle_running(&mut self) {
        if self.is_running {
            self.pause();
        } else {
            self.resume();
        }
    }

    /// Changes the span of the picture by steps of `SPANS_MS`. In a stopped picture the tick
    /// at `at`, 0 to 1 of the width, keeps its position.
    fn zoom_time(&mut self, steps: i32, at: f64) {
        let now = SPANS_MS.iter().position(|span| *span >= self.span_ms);
        let now = now.unwrap_or(SPANS_MS.len() - 1) as i32;
        let next = (now + steps).clamp(0, SPANS_MS.len() as i32 - 1);
        let span = SPANS_MS[next as usize];
        if let Some(end) = self.stop_tick {
            let fixed = end as f64 - (1.0 - at) * self.span_ms as f64;
            self.stop_tick = Some((fixed + (1.0 - at) * span as f64).max(0.0).round() as u64);
        }
        self.span_ms = span;
    }

    /// Stops the picture and moves it by `ticks`, positive to the right.
    fn pan_time(&mut self, ticks: i64) {
        if self.is_running {
            self.pause();
        }
        let Some((first, last)) = self.record.as_ref().and_then(SampleRecord::tick_range) else {
            return;
        };
        let end = self.stop_tick.unwrap_or(last);
        self.stop_tick = Some(end.saturating_add_signed(-ticks).clamp(first, last));
    }

    fn toggle_cursors(&mut self) {
        self.cursors = match (self.cursors, self.visible_ticks()) {
            (None, Some((first, end))) => {
                let quarter = (end - first) / 4;
                Some(Cursors {
                    ticks: [first + quarter, end - quarter],
                    active: 0,
                })
            }
            _ => None,
        };
    }

    fn move_cursor(&mut self, ticks: i64) {
        if let Some(cursors) = &mut self.cursors
            && let Some(at) = cursors.ticks.get_mut(cursors.active)
        {
            *at = at.saturating_add_signed(ticks);
        }
    }

    /// Handles the keys of the scope. Keys with Ctrl or Alt are left to the panel.
    fn handle_keys(&mut self, ui: &Ui) {
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
                (self.span_ms / 200).max(1) as i64
            };
            match key {
                Key::Space => self.toggle_running(),
                Key::C => self.toggle_cursors(),
                Key::A => self.autoscale = !self.autoscale,
                Key::Plus | Key::Equals => self.zoom_time(-1, 0.5),
                Key::Minus => self.zoom_time(1, 0.5),
                Key::PageUp => self.pan_time(self.span_ms as i64 / 2),
                Key::PageDown => self.pan_time(-(self.span_ms as i64 / 2)),
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

    /// Adds the PLC bit that the user has typed to the watched ones. Shows the error of an
    /// invalid address.
    fn add_bit(&mut self, language: Language) {
        let entry = self.entry.trim().to_ascii_uppercase();
        match entry.parse::<BitAddress>() {
            Err(error) => {
                self.entry_error = Some(say::scope_not_an_address(error).text(language));
            }
            Ok(address) => {
                self.entry_error = None;
                self.entry.clear();
                let known = self
                    .bit_channels
                    .iter()
                    .any(|channel| channel.address == address);
                if !known && self.bit_channels.len() < MAX_BITS {
                    let bit_index = self.free_bit_index();
                    self.bit_channels.push(BitChannel { address, bit_index });
                    self.start_probe();
                }
            }
        }
    }

    /// Reserves the position in the samples for a new bit channel: the one that has been unused
    /// for the longest time, because old samples of another bit must not appear in the new
    /// channel.
    fn free_bit_index(&mut self) -> usize {
        while self
            .bit_channels
            .iter()
            .any(|channel| channel.bit_index == self.next_bit_index)
        {
            self.next_bit_index = (self.next_bit_index + 1) % MAX_BITS;
        }
        let bit_index = self.next_bit_index;
        self.next_bit_index = (bit_index + 1) % MAX_BITS;
        bit_index
    }

    /// Writes the visible part of the record to a file that the user chooses.
    fn export(&self, language: Language, context: &egui::Context) {
        let (Some(record), Some((first, last))) = (&self.record, self.visible_ticks()) else {
            return;
        };
        let excerpt = record.excerpt(first.saturating_sub(2 * self.average_ticks), last);
        let (bits, average_ticks) = (self.bit_channels.clone(), self.average_ticks);
        text_files::save(
            &self.console,
            context,
            language,
            ("scope.csv", "CSV"),
            move || csv::format_table(&excerpt, &bits, (first, last), average_ticks),
        );
    }
}
