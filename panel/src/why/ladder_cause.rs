//! Follows a bit through the rungs that write it to the contacts that decide it.

use std::collections::BTreeSet;

use gsk_core::cnc::Cnc;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::plc::network::{Branch, Contact, Element, Network, RungBody};
use gsk_core::plc::{Mnemonic, PlcAddress, PowerFlow};

use super::bit_log::BitLog;
use super::chain::{CauseChain, CauseFact};
use crate::keys::{Bit, Key};

/// Greatest depth of a chain.
const MAX_DEPTH: usize = 16;
/// Greatest number of facts of a chain.
const MAX_LINKS: usize = 60;

/// Follows bits of one control.
pub(super) struct LadderTracer<'a> {
    cnc: &'a Cnc,
    log: &'a BitLog,
    visited: BTreeSet<BitAddress>,
}

impl<'a> LadderTracer<'a> {
    pub fn new(cnc: &'a Cnc, log: &'a BitLog) -> Self {
        Self {
            cnc,
            log,
            visited: BTreeSet::new(),
        }
    }

    /// Adds a bit and what decides it.
    pub fn trace_bit(&mut self, bit: BitAddress, depth: usize, chain: &mut CauseChain) {
        let plc = self.cnc.plc();
        let value = plc.memory().bit(bit);
        chain.push(
            depth,
            CauseFact::Bit {
                bit,
                value,
                since: self.log.since(bit),
                key: key_of_contact(bit),
            },
        );
        let is_first = self.visited.insert(bit);
        if !is_first || depth >= MAX_DEPTH || chain.links.len() >= MAX_LINKS {
            return;
        }
        if let Some(force) = plc.forces().iter().find(|force| force.bit == bit) {
            let value = u8::from(force.value);
            let message = gsk_messages::say::why_forced(bit, value);
            return chain.push(depth + 1, CauseFact::Condition(message));
        }
        if matches!(bit.area, Area::X | Area::F) {
            return;
        }
        let ladder = plc.ladder();
        let writers = ladder.references(PlcAddress::Bit(bit));
        let writers = writers.into_iter().filter(|it| it.access.is_write());
        let mut rungs: Vec<(Network, u32, Mnemonic)> = writers
            .filter_map(|it| Some((ladder.network(it.rung)?, it.line, it.mnemonic)))
            .collect();
        // The rung that gives the bit its value comes first.
        rungs.sort_by_key(|(network, _, mnemonic)| {
            let gives = match mnemonic {
                Mnemonic::Set => true,
                Mnemonic::Rst => false,
                _ => self.is_live(network),
            };
            gives != value
        });
        for (network, line, mnemonic) in rungs {
            self.trace_rung(&network, line, mnemonic, depth + 1, chain);
        }
    }

    fn is_live(&self, network: &Network) -> bool {
        let flow = self.cnc.plc().power_flow(network);
        flow.last().is_some_and(|state| state.live)
    }

    fn trace_rung(
        &mut self,
        network: &Network,
        line: u32,
        mnemonic: Mnemonic,
        depth: usize,
        chain: &mut CauseChain,
    ) {
        let is_live = self.is_live(network);
        chain.push(
            depth,
            CauseFact::Rung {
                number: network.number,
                line,
                is_live,
                is_latched: matches!(mnemonic, Mnemonic::Set | Mnemonic::Rst),
            },
        );
        let RungBody::Rung { contacts, .. } = &network.body else {
            return;
        };
        let flow = self.cnc.plc().power_flow(network);
        let mut deciding = Vec::new();
        for element in contacts {
            collect_deciding(element, is_live, &flow, &mut deciding);
        }
        deciding.dedup();
        for bit in deciding {
            self.trace_bit(bit, depth + 1, chain);
        }
    }
}

/// Collects the contacts that make an element conduct (`is_live`) or block.
fn collect_deciding(
    element: &Element,
    is_live: bool,
    flow: &[PowerFlow],
    deciding: &mut Vec<BitAddress>,
) {
    match element {
        Element::Contact(contact) => {
            if is_closed(contact, flow) == is_live && !deciding.contains(&contact.bit) {
                deciding.push(contact.bit);
            }
        }
        Element::Series(members) if is_live => {
            for member in members {
                collect_deciding(&member.element, true, flow, deciding);
            }
        }
        Element::Parallel(members) if !is_live => {
            for member in members {
                collect_deciding(&member.element, false, flow, deciding);
            }
        }
        // One blocking member is enough in series, one conducting member in parallel.
        Element::Series(members) | Element::Parallel(members) => {
            let decides = |member: &&Branch| conducts(&member.element, flow) == is_live;
            if let Some(member) = members.iter().find(decides) {
                collect_deciding(&member.element, is_live, flow, deciding);
            }
        }
    }
}

fn conducts(element: &Element, flow: &[PowerFlow]) -> bool {
    match element {
        Element::Contact(contact) => is_closed(contact, flow),
        Element::Series(members) => members.iter().all(|it| conducts(&it.element, flow)),
        Element::Parallel(members) => members.iter().any(|it| conducts(&it.element, flow)),
    }
}

fn is_closed(contact: &Contact, flow: &[PowerFlow]) -> bool {
    flow.get(contact.at).is_some_and(|state| state.closed)
}

/// The key of the panel that closes a contact; `None` for another contact.
fn key_of_contact(bit: BitAddress) -> Option<Key> {
    if bit.area != Area::X {
        return None;
    }
    let contact = Some(Bit::new(bit.byte, bit.bit));
    let mut keys = crate::keys::KEYS.iter().map(|row| row.key);
    keys.find(|key| key.contact() == contact)
}
