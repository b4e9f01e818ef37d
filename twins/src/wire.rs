//! One direction of a serial line: bytes take their time, and may be lost,
//! changed, doubled or held up on the way.

use std::collections::VecDeque;

/// Bits on the wire for a byte: start, eight, stop.
const BITS_PER_BYTE: u64 = 10;

/// What happens to a byte on its way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Damage {
    /// It never arrives.
    Lost,
    /// It arrives with these bits turned over.
    Changed(u8),
    /// It arrives twice.
    Doubled,
    /// It and everything behind it arrives so much later, ns.
    Delayed(u64),
    /// It waits so much longer, ns, and so does what is behind it; then the line is as
    /// before.
    Stalled(u64),
    /// It and everything behind it never arrives: the cable is out.
    Cut,
}

/// One direction of a serial line.
#[derive(Clone, Debug)]
pub struct Wire {
    byte_ns: u64,
    /// Bytes under way, with the moment of their arrival.
    in_transit: VecDeque<(u64, u8)>,
    /// When the last byte given has left.
    busy_until_ns: u64,
    delay_ns: u64,
    cut: bool,
    sent: u64,
    /// Damage to come, by the count of the byte.
    damage: VecDeque<(u64, Damage)>,
}

impl Wire {
    /// A line of so many bits a second, nothing wrong with it.
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

    /// Damages the byte with this count (the first byte ever given is 0).
    pub fn damage(&mut self, count: u64, damage: Damage) {
        let position = self.damage.partition_point(|(at, _)| *at <= count);
        self.damage.insert(position, (count, damage));
    }

    /// How many bytes were given so far.
    pub const fn sent_count(&self) -> u64 {
        self.sent
    }

    /// Pulls the cable, or puts it back in; what was under way is gone.
    pub fn set_cut(&mut self, cut: bool) {
        self.cut = cut;
        self.in_transit.clear();
    }

    /// Puts bytes on the line at a moment, ns.
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

    /// The next byte that has arrived by now.
    pub fn receive(&mut self, now: u64) -> Option<u8> {
        let &(arrival, byte) = self.in_transit.front()?;
        if arrival > now {
            return None;
        }
        self.in_transit.pop_front();
        Some(byte)
    }

    /// When the next byte arrives.
    pub(crate) fn next_arrival(&self) -> Option<u64> {
        self.in_transit.front().map(|(arrival, _)| *arrival)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrived(wire: &mut Wire, now: u64) -> Vec<u8> {
        core::iter::from_fn(|| wire.receive(now)).collect()
    }

    #[test]
    fn bytes_take_their_time() {
        let mut wire = Wire::new(115_200);
        wire.send(b"ab", 1_000_000);
        assert_eq!(arrived(&mut wire, 1_086_000), b"");
        assert_eq!(arrived(&mut wire, 1_087_000), b"a");
        assert_eq!(arrived(&mut wire, 1_174_000), b"b");
        assert!(wire.receive(u64::MAX).is_none());
    }

    #[test]
    fn damage_hits_the_byte_it_is_meant_for() {
        let mut wire = Wire::new(1_000_000);
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
    fn a_stall_ends() {
        let mut wire = Wire::new(1_000_000);
        wire.damage(1, Damage::Stalled(5_000_000));
        wire.send(b"abc", 0);
        assert_eq!(arrived(&mut wire, 5_019_000), b"a");
        assert_eq!(arrived(&mut wire, 5_020_000), b"b");
        assert_eq!(arrived(&mut wire, 5_030_000), b"c");
        wire.send(b"d", 6_000_000);
        assert_eq!(arrived(&mut wire, 6_010_000), b"d");
    }
}
