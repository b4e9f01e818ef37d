//! One direction of a serial line in virtual time. Bytes take their transmission time and
//! can be lost, changed, doubled or delayed.

use std::collections::VecDeque;

/// Bits per byte on the line: start bit, eight data bits, stop bit.
const BITS_PER_BYTE: u64 = 10;

/// A fault that hits one byte on the line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damage {
    /// The faulty byte is lost.
    Lost,
    /// The faulty byte arrives with these bits inverted.
    Changed(u8),
    /// The faulty byte arrives twice.
    Doubled,
    /// The faulty byte and all later bytes arrive this much later, ns.
    Delayed(u64),
    /// The line stops for this duration, ns, before it transmits the byte.
    Stalled(u64),
    /// The faulty byte and all later bytes are lost, as with an unplugged cable.
    Cut,
}

/// One direction of a serial line: transmits bytes with their duration and faults.
#[derive(Clone, Debug)]
pub struct TwinWire {
    byte_ns: u64,
    /// Bytes in transit, each with the time of its arrival, ns.
    in_transit: VecDeque<(u64, u8)>,
    /// Time at which the line finishes the last byte sent, ns.
    busy_until_ns: u64,
    delay_ns: u64,
    cut: bool,
    sent: u64,
    /// Damage that is due, each with the index of the byte that it hits, from 0.
    damage: VecDeque<(u64, Damage)>,
}

impl TwinWire {
    /// Creates a line without faults. `baud` is its rate in bits/s.
    pub const fn new(baud: u32) -> Self {
        let baud = if baud == 0 { 1 } else { baud };
        Self {
            byte_ns: BITS_PER_BYTE * 1_000_000_000 / baud as u64,
            in_transit: VecDeque::new(),
            busy_until_ns: 0,
            delay_ns: 0,
            cut: false,
            sent: 0,
            damage: VecDeque::new(),
        }
    }

    /// Schedules damage for the byte with index `count`; the first byte ever sent has index
    /// 0.
    pub fn damage(&mut self, count: u64, damage: Damage) {
        let position = self.damage.partition_point(|(at, _)| *at <= count);
        self.damage.insert(position, (count, damage));
    }

    /// Returns the number of bytes that were sent on the line.
    pub const fn sent_count(&self) -> u64 {
        self.sent
    }

    /// Unplugs the cable (true) or plugs it in. Bytes in transit are lost.
    pub fn set_cut(&mut self, cut: bool) {
        self.cut = cut;
        self.in_transit.clear();
    }

    /// Starts to transmit bytes at time `now`, ns.
    pub fn send(&mut self, bytes: &[u8], now: u64) {
        for &byte in bytes {
            self.busy_until_ns = self.busy_until_ns.max(now) + self.byte_ns;
            let mut copies = [Some(byte), None];
            while let Some(&(at, damage)) = self.damage.front() {
                if at > self.sent {
                    break;
                }
                self.damage.pop_front();
                if at < self.sent {
                    continue;
                }
                match damage {
                    Damage::Lost => copies[0] = None,
                    Damage::Changed(bits) => copies[0] = Some(byte ^ bits),
                    Damage::Doubled => copies[1] = Some(byte),
                    Damage::Delayed(ns) => self.delay_ns += ns,
                    Damage::Stalled(ns) => self.busy_until_ns += ns,
                    Damage::Cut => self.cut = true,
                }
            }
            self.sent += 1;
            if self.cut {
                continue;
            }
            for copy in copies.into_iter().flatten() {
                let arrival = self.busy_until_ns + self.delay_ns;
                self.in_transit.push_back((arrival, copy));
            }
        }
    }

    /// Returns the next byte if it has arrived by time `now`, ns; `None` otherwise.
    pub fn receive(&mut self, now: u64) -> Option<u8> {
        let &(arrival, byte) = self.in_transit.front()?;
        if arrival > now {
            return None;
        }
        self.in_transit.pop_front();
        Some(byte)
    }

    /// Returns the time at which the next byte arrives, ns; `None` if no byte is in transit.
    pub(crate) fn next_arrival(&self) -> Option<u64> {
        self.in_transit.front().map(|(arrival, _)| *arrival)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrived(wire: &mut TwinWire, now: u64) -> Vec<u8> {
        core::iter::from_fn(|| wire.receive(now)).collect()
    }

    #[test]
    fn bytes_arrive_after_their_transmission_time() {
        let mut wire = TwinWire::new(115_200);
        wire.send(b"ab", 1_000_000);
        assert_eq!(arrived(&mut wire, 1_086_000), b"");
        assert_eq!(arrived(&mut wire, 1_087_000), b"a");
        assert_eq!(arrived(&mut wire, 1_174_000), b"b");
        assert!(wire.receive(u64::MAX).is_none());
    }

    #[test]
    fn damage_hits_only_its_byte() {
        let mut wire = TwinWire::new(1_000_000);
        wire.damage(4, Damage::Cut);
        wire.damage(0, Damage::Lost);
        wire.damage(1, Damage::Changed(0b11));
        wire.damage(2, Damage::Doubled);
        wire.damage(3, Damage::Delayed(1_000_000));
        wire.send(b"abcdef", 0);
        assert_eq!(arrived(&mut wire, 100_000), [b'b' ^ 3, b'c', b'c']);
        assert_eq!(arrived(&mut wire, 2_000_000), b"d");
        assert_eq!(arrived(&mut wire, u64::MAX), b"");
    }

    #[test]
    fn stall_delays_only_until_the_line_is_idle() {
        let mut wire = TwinWire::new(1_000_000);
        wire.damage(1, Damage::Stalled(5_000_000));
        wire.send(b"abc", 0);
        assert_eq!(arrived(&mut wire, 5_019_000), b"a");
        assert_eq!(arrived(&mut wire, 5_020_000), b"b");
        assert_eq!(arrived(&mut wire, 5_030_000), b"c");
        wire.send(b"d", 6_000_000);
        assert_eq!(arrived(&mut wire, 6_010_000), b"d");
    }
}
