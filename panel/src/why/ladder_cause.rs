//! Follows a bit through the rungs that write it to the contacts that decide it.

use std::collections::BTreeSet;

use gsk_core::machine::LatheFault;
use gsk_core::plc::address::{Area, BitAddress, ByteAddress};
use gsk_core::plc::{
    CrossReference, Element, Ladder, Mnemonic, Network, Operand, PlcAddress, PowerFlow, RungBody,
};
use gsk_messages::{Language, Message, say};

use super::bit_log::{BitLog, InputChange};
use super::chain::{CauseChain, CauseTarget};
use super::named_places;
use crate::emulator::Emulator;
use crate::keys::{Bit, Key, all_rows};
use crate::pages::plc_names;

/// X0.5: the emergency stop circuit, 0 while it is open.
const EMERGENCY_INPUT: BitAddress = BitAddress::new(Area::X, 0, 5);
/// Greatest depth of a chain of causes.
const MAX_DEPTH: usize = 20;
/// Greatest number of rungs between an input and a bit that it has changed.
const TRIGGER_DEPTH: usize = 5;

/// Finds the causes of a bit's value in the ladder of a control.
pub(super) struct LadderTracer<'a> {
    emulator: &'a Emulator,
    log: &'a BitLog,
    visited: BTreeSet<PlcAddress>,
    /// Whether the chain already contains the faults of the lathe.
    has_faults: bool,
    pub chain: CauseChain,
}

impl<'a> LadderTracer<'a> {
    pub fn new(emulator: &'a Emulator, log: &'a BitLog) -> Self {
        Self {
            emulator,
            log,
            visited: BTreeSet::new(),
            has_faults: false,
            chain: CauseChain::default(),
        }
    }

    fn ladder(&self) -> &'a Ladder {
        self.emulator.cnc().plc().ladder()
    }

    pub fn bit(&self, bit: BitAddress) -> bool {
        self.emulator.cnc().plc().memory().bit(bit)
    }

    /// Adds a bit and the causes of its value, unless the chain already contains the bit.
    pub fn trace_bit_once(&mut self, bit: BitAddress, depth: usize) {
        if !self.visited.contains(&PlcAddress::Bit(bit)) {
            self.trace_bit(bit, None, depth);
        }
    }

    /// Adds a bit and the causes of its value. `reader` is the index of the statement that reads
    /// it.
    fn trace_bit(&mut self, bit: BitAddress, reader: Option<usize>, depth: usize) {
        let value = self.bit(bit);
        let since = self.log.since(PlcAddress::Bit(bit));
        let key = key_of_contact(bit);
        let target = key.map_or(CauseTarget::Bit(bit), CauseTarget::Key);
        let ladder = self.ladder();
        self.chain.push(depth, Some(target), |language| {
            let meaning = contact_meaning(ladder, bit, language);
            match since {
                Some(tick) => say::why_bit_since(
                    bit.short_name(),
                    u8::from(value),
                    tick as f64 / 1000.0,
                    meaning,
                ),
                None => say::why_bit(bit.short_name(), u8::from(value), meaning),
            }
        });
        if !self.enters(PlcAddress::Bit(bit), depth) {
            return;
        }
        let forces = self.emulator.cnc().plc().forces();
        if let Some(force) = forces.iter().find(|force| force.bit == bit) {
            let value = u8::from(force.value);
            let target = Some(CauseTarget::Bit(bit));
            let forced = |_| say::why_forced(bit.short_name(), value);
            return self.chain.push(depth + 1, target, forced);
        }
        if bit.area == Area::F {
            let signal = plc_names::signal_meaning(bit, Language::En);
            return self.add_named_parameters(signal, depth + 1);
        }
        if bit.area == Area::X {
            self.add_sensor_causes(bit, depth + 1);
        } else {
            self.trace_writers(PlcAddress::Bit(bit), Some(value), reader, depth + 1);
        }
    }

    /// Adds the sensor or switch that operates an input of the machine.
    fn add_sensor_causes(&mut self, bit: BitAddress, depth: usize) {
        let emulator = self.emulator;
        let lathe = emulator.lathe();
        let target = Some(CauseTarget::Bit(bit));
        if let Some(value) = lathe.forced_input(bit) {
            let value = u8::from(value);
            self.chain.push(depth, target, |_| {
                say::why_input_set(bit.short_name(), value)
            });
        } else if bit == EMERGENCY_INPUT && !lathe.is_emergency_loop_closed() {
            if emulator.panel().emergency_stop() {
                let key = Some(CauseTarget::Key(Key::EmergencyStop));
                self.chain
                    .push(depth, key, |_| say::window_hint_emergency_stop());
            }
            if lathe.is_over_limit() {
                self.chain.push(depth, target, |_| say::why_limit_switch());
            }
        }
        if key_of_contact(bit).is_none() {
            self.add_faults(depth);
        }
    }

    /// Adds the faults of the lathe once. Which inputs a fault changes depends on the lathe, so
    /// every fault that is set is named.
    pub fn add_faults(&mut self, depth: usize) {
        if core::mem::replace(&mut self.has_faults, true) {
            return;
        }
        let lathe = self.emulator.lathe();
        let set = LatheFault::ALL.iter().map(|(_, fault)| *fault);
        for fault in set.filter(|fault| lathe.has_fault(*fault)) {
            let label = fault.row().label();
            self.chain
                .push(depth, None, |_| say::why_fault(label.clone()));
        }
    }

    /// Adds a byte or counter and the causes of its value.
    fn trace_byte(&mut self, byte: ByteAddress, reader: Option<usize>, depth: usize) {
        let address = PlcAddress::Byte(byte);
        let memory = self.emulator.cnc().plc().memory();
        let value = match byte.area.is_entry() {
            true => memory.long(byte),
            false => memory.byte(byte).into(),
        };
        let since = self.log.since(address).filter(|_| byte.area.is_entry());
        let ladder = self.ladder();
        self.chain.push(depth, None, |language| {
            let comment = ladder.comment(address);
            let meaning = comment.map_or("", |comment| match language {
                Language::Zh => &comment.chinese,
                Language::En => &comment.english,
            });
            match since {
                Some(tick) => {
                    say::why_bit_since(byte.short_name(), value, tick as f64 / 1000.0, meaning)
                }
                None => say::why_bit(byte.short_name(), value, meaning),
            }
        });
        if self.enters(address, depth) && !matches!(byte.area, Area::X | Area::F) {
            self.trace_writers(address, None, reader, depth + 1);
        }
    }

    /// Whether an address is new in the chain and the chain has space for its causes.
    fn enters(&mut self, address: PlcAddress, depth: usize) -> bool {
        self.visited.insert(address) && depth < MAX_DEPTH && !self.chain.is_full()
    }

    /// Adds the rung that has given an address its value: the last one before the reader that
    /// writes it now, or else the one whose inputs changed when it changed.
    fn trace_writers(
        &mut self,
        address: PlcAddress,
        value: Option<bool>,
        reader: Option<usize>,
        depth: usize,
    ) {
        let ladder = self.ladder();
        let writers = ladder.references(address);
        let mut writers: Vec<CrossReference> = (writers.into_iter())
            .filter(|it| it.access.is_write())
            .collect();
        // The newest write comes first.
        writers.reverse();
        let reader = reader.unwrap_or(usize::MAX);
        writers.sort_by_key(|it| it.statement >= reader);
        let mut idle = Vec::new();
        for writer in &writers {
            let Some(network) = ladder.network(writer.rung) else {
                continue;
            };
            if always_writes(writer.mnemonic) || self.is_live(&network) {
                self.trace_rung(&network, writer, false, depth);
                let is_held = self.holds_itself(&network, address);
                if is_held {
                    self.add_triggers(address, &[network], depth + 1);
                }
                return;
            }
            idle.push((network, *writer));
        }
        let networks: Vec<Network> = idle.iter().map(|(network, _)| network.clone()).collect();
        if self.add_triggers(address, &networks, depth) {
            return self.add_conducting_contacts(address, &idle, depth);
        }
        // Nothing has written the value: the rungs that would write the other one are open.
        let other = |mnemonic| match mnemonic {
            Mnemonic::Set => value == Some(false),
            Mnemonic::Rst => value == Some(true),
            _ => true,
        };
        for (network, writer) in idle.iter().filter(|(_, it)| other(it.mnemonic)).take(3) {
            self.trace_rung(network, writer, true, depth);
        }
    }

    /// Adds the contacts that conducted when an input made a rung set or reset a bit, and that
    /// conduct since.
    fn add_conducting_contacts(
        &mut self,
        address: PlcAddress,
        writers: &[(Network, CrossReference)],
        depth: usize,
    ) {
        let Some(changed_at) = self.log.since(address) else {
            return;
        };
        for (network, _) in (writers.iter()).filter(|(_, it)| it.mnemonic == Mnemonic::Set) {
            let RungBody::Rung { contacts, .. } = &network.body else {
                continue;
            };
            let flow = self.emulator.cnc().plc().power_flow(network);
            let mut found = Vec::new();
            for element in contacts {
                let is_closed = |it: &Element| match it {
                    Element::Contact(_) => conducts(it, &flow),
                    _ => true,
                };
                collect_contacts(element, &is_closed, &mut found);
            }
            for (bit, at) in found {
                let since = self.log.since(PlcAddress::Bit(bit));
                if since.is_none_or(|since| since < changed_at) {
                    self.trace_bit(bit, Some(network.first + at), depth);
                }
            }
        }
    }

    fn is_live(&self, network: &Network) -> bool {
        let flow = self.emulator.cnc().plc().power_flow(network);
        flow.last().is_some_and(|state| state.live)
    }

    fn holds_itself(&self, network: &Network, address: PlcAddress) -> bool {
        let RungBody::Rung { contacts, .. } = &network.body else {
            return false;
        };
        let mut bits = Vec::new();
        for element in contacts {
            collect_contacts(element, &|_| true, &mut bits);
        }
        bits.iter().any(|(bit, _)| PlcAddress::Bit(*bit) == address)
    }

    fn trace_rung(
        &mut self,
        network: &Network,
        writer: &CrossReference,
        is_latched: bool,
        depth: usize,
    ) {
        let is_live = self.is_live(network);
        let (number, line) = (network.number, writer.line);
        let target = Some(CauseTarget::Rung(number));
        self.chain.push(depth, target, |_| match is_live {
            true => say::why_rung_live(number, line),
            false if is_latched => say::why_rung_latched(number, line),
            false => say::why_rung_dead(number, line),
        });
        let RungBody::Rung { contacts, .. } = &network.body else {
            return;
        };
        let flow = self.emulator.cnc().plc().power_flow(network);
        let mut deciding = Vec::new();
        for element in contacts {
            collect_contacts(element, &|it| conducts(it, &flow) == is_live, &mut deciding);
        }
        for (bit, at) in deciding {
            self.trace_bit(bit, Some(network.first + at), depth + 1);
        }
        if !is_live {
            return;
        }
        // What a function copies, compares or looks up.
        let statement = self.ladder().statements().get(writer.statement);
        let operands = statement.map_or(&[][..], |it| &it.operands);
        let written = self.written_byte(writer);
        for operand in operands {
            if let Operand::Byte(byte) = operand
                && Some(*byte) != written
            {
                self.trace_byte(*byte, Some(writer.statement), depth + 1);
            }
        }
    }

    /// Returns the byte that a function writes: its last operand; `None` if that is not a byte.
    fn written_byte(&self, writer: &CrossReference) -> Option<ByteAddress> {
        let statement = self.ladder().statements().get(writer.statement)?;
        match statement.operands.last() {
            Some(Operand::Byte(byte)) => Some(*byte),
            _ => None,
        }
    }

    /// Adds the inputs that changed when an address changed, and on which one of the rungs
    /// depends; returns false if there are none.
    fn add_triggers(&mut self, address: PlcAddress, networks: &[Network], depth: usize) -> bool {
        let triggers = self.log.triggers(address);
        let mut has_trigger = false;
        for network in networks {
            let mut inputs = BTreeSet::new();
            self.collect_inputs(network, TRIGGER_DEPTH, &mut BTreeSet::new(), &mut inputs);
            let matching: Vec<InputChange> = (triggers.iter().copied())
                .filter(|change| inputs.contains(&change.bit))
                .collect();
            for change in matching {
                has_trigger = true;
                self.add_trigger(change, network.number, depth);
            }
        }
        has_trigger
    }

    fn add_trigger(&mut self, change: InputChange, rung: u32, depth: usize) {
        let InputChange { bit, value, tick } = change;
        let ladder = self.ladder();
        let key = key_of_contact(bit);
        let target = key.map_or(CauseTarget::Rung(rung), CauseTarget::Key);
        self.chain.push(depth, Some(target), |language| {
            let meaning = contact_meaning(ladder, bit, language);
            say::why_changed(
                bit.short_name(),
                u8::from(value),
                tick as f64 / 1000.0,
                rung,
                meaning,
            )
        });
    }

    /// Collects the inputs X and F on which a rung depends, through at most `depth` rungs.
    fn collect_inputs(
        &self,
        network: &Network,
        depth: usize,
        visited: &mut BTreeSet<u32>,
        inputs: &mut BTreeSet<BitAddress>,
    ) {
        let RungBody::Rung { contacts, .. } = &network.body else {
            return;
        };
        if depth == 0 || !visited.insert(network.number) {
            return;
        }
        let mut bits = Vec::new();
        for element in contacts {
            collect_contacts(element, &|_| true, &mut bits);
        }
        for (bit, _) in bits {
            if matches!(bit.area, Area::X | Area::F) {
                inputs.insert(bit);
                continue;
            }
            let writers = self.ladder().references(PlcAddress::Bit(bit));
            for writer in writers.iter().filter(|it| it.access.is_write()) {
                if let Some(network) = self.ladder().network(writer.rung) {
                    self.collect_inputs(&network, depth - 1, visited, inputs);
                }
            }
        }
    }

    /// Adds the parameters to which a text refers, with their values.
    pub fn add_named_parameters(&mut self, text: &str, depth: usize) {
        let parameters = self.emulator.cnc().parameters();
        for (number, bit) in named_places::find_parameters(text) {
            let (name, value) = match bit {
                Some(bit) => (
                    format!("{number:03}.{bit}"),
                    i32::from(parameters.bit(number, bit)),
                ),
                None => (format!("{number:03}"), parameters.value(number)),
            };
            let target = Some(CauseTarget::Parameter(number));
            self.chain
                .push(depth, target, |_| say::why_parameter(&name, value));
        }
    }

    /// Adds a state of the control, then the bits and parameters that its message names.
    pub fn add_condition(&mut self, message: &Message, depth: usize) {
        let english = message.text(Language::En);
        let key = named_places::find_key(&english).map(CauseTarget::Key);
        self.chain.push(depth, key, |_| message.clone());
        let bits = named_places::find_bits(&english);
        // The ladder leads from a signal to the pins that the message names beside it.
        let has_signal = bits.iter().any(|bit| bit.area == Area::G);
        for bit in bits
            .into_iter()
            .filter(|bit| !has_signal || bit.area == Area::G)
        {
            self.trace_bit_once(bit, depth + 1);
        }
        self.add_named_parameters(&english, depth + 1);
    }
}

/// Whether an instruction writes its bit in every scan, with or without power.
const fn always_writes(mnemonic: Mnemonic) -> bool {
    matches!(mnemonic, Mnemonic::Out | Mnemonic::Tmrb)
}

/// Collects the contacts of an element that `decides` selects, with their indexes in the rung. A
/// connection that it does not select is skipped.
fn collect_contacts(
    element: &Element,
    decides: &impl Fn(&Element) -> bool,
    found: &mut Vec<(BitAddress, usize)>,
) {
    if !decides(element) {
        return;
    }
    match element {
        Element::Contact(contact) => {
            if !found.iter().any(|(bit, _)| *bit == contact.bit) {
                found.push((contact.bit, contact.at));
            }
        }
        Element::Series(members) | Element::Parallel(members) => {
            for member in members {
                collect_contacts(&member.element, decides, found);
            }
        }
    }
}

fn conducts(element: &Element, flow: &[PowerFlow]) -> bool {
    match element {
        Element::Contact(contact) => flow.get(contact.at).is_some_and(|state| state.closed),
        Element::Series(members) => members.iter().all(|it| conducts(&it.element, flow)),
        Element::Parallel(members) => members.iter().any(|it| conducts(&it.element, flow)),
    }
}

fn contact_meaning(ladder: &Ladder, bit: BitAddress, language: Language) -> String {
    match key_of_contact(bit) {
        Some(key) => {
            let row = key.row();
            let name = match language {
                Language::Zh => row.name_zh,
                Language::En => row.name_en,
            };
            say::why_key(name).text(language)
        }
        None => plc_names::meaning(ladder, bit, language),
    }
}

/// The key of the panel that closes a contact; `None` for another contact.
fn key_of_contact(bit: BitAddress) -> Option<Key> {
    if bit.area != Area::X {
        return None;
    }
    let contact = Some(Bit::new(bit.byte, bit.bit));
    all_rows()
        .map(|row| row.key)
        .find(|key| key.contact() == contact)
}
