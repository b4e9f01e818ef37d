//! One direction of a serial line: bytes take their time, and may be lost,
//! changed, doubled or held up on the way.

use std::collections::VecDeque;

/// Bits on the wire for a byte: start, eight, stop.
const BITS: u64 = 10;

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
    HeldUp(u64),
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
    under_way: VecDeque<(u64, u8)>,
    /// When the last byte given has left.
    busy_until: u64,
    held_up: u64,
    cut: bool,
    given: u64,
    /// Damage to come, by the count of the byte.
    damage: VecDeque<(u64, Damage)>,
}

impl Wire {
    /// A line of so many bits a second, nothing wrong with it.
    pub const fn new(baud: u32) -> Self {
        let baud = if baud == 0 { 1 } else { baud };
        Self {
            byte_ns: BITS * 1_000_000_000 / baud as u64,
            under_way: VecDeque::new(),
            busy_until: 0,
            held_up: 0,
            cut: false,
            given: 0,
            damage: VecDeque::new(),
        }
    }

    /// Damages the byte with this count (the first byte ever given is 0).
    pub fn damage(&mut self, count: u64, damage: Damage) {
        let place = self.damage.partition_point(|(at, _)| *at <= count);
        self.damage.insert(place, (count, damage));
    }

    /// How many bytes were given so far.
    pub const fn given(&self) -> u64 {
        self.given
    }

    /// Pulls the cable, or puts it back in; what was under way is gone.
    pub fn set_cut(&mut self, cut: bool) {
        self.cut = cut;
        self.under_way.clear();
    }

    /// Puts bytes on the line at a moment, ns.
    pub fn give(&mut self, bytes: &[u8], now: u64) {
        for &byte in bytes {
            self.busy_until = self.busy_until.max(now) + self.byte_ns;
            let mut copies = [Some(byte), None];
            while let Some(&(at, damage)) = self.damage.front() {
                if at > self.given {
                    break;
                }
                self.damage.pop_front();
                if at < self.given {
                    continue;
                }
                match damage {
                    Damage::Lost => copies[0] = None,
                    Damage::Changed(bits) => copies[0] = Some(byte ^ bits),
                    Damage::Doubled => copies[1] = Some(byte),
                    Damage::HeldUp(ns) => self.held_up += ns,
                    Damage::Stalled(ns) => self.busy_until += ns,
                    Damage::Cut => self.cut = true,
                }
            }
            self.given += 1;
            if self.cut {
                continue;
            }
            for copy in copies.into_iter().flatten() {
                let arrival = self.busy_until + self.held_up;
                self.under_way.push_back((arrival, copy));
            }
        }
    }

    /// The next byte that has arrived by now.
    pub fn take(&mut self, now: u64) -> Option<u8> {
        let &(arrival, byte) = self.under_way.front()?;
        if arrival > now {
            return None;
        }
        self.under_way.pop_front();
        Some(byte)
    }

    /// When the next byte arrives.
    pub(crate) fn next_arrival(&self) -> Option<u64> {
        self.under_way.front().map(|(arrival, _)| *arrival)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arrived(wire: &mut Wire, now: u64) -> Vec<u8> {
        core::iter::from_fn(|| wire.take(now)).collect()
    }

    #[test]
    fn bytes_take_their_time() {
        let mut wire = Wire::new(115_200);
        wire.give(b"ab", 1_000_000);
        assert_eq!(arrived(&mut wire, 1_086_000), b"");
        assert_eq!(arrived(&mut wire, 1_087_000), b"a");
        assert_eq!(arrived(&mut wire, 1_174_000), b"b");
        assert!(wire.take(u64::MAX).is_none());
    }

    #[test]
    fn damage_hits_the_byte_it_is_meant_for() {
        let mut wire = Wire::new(1_000_000);
        wire.damage(4, Damage::Cut);
        wire.damage(0, Damage::Lost);
        wire.damage(1, Damage::Changed(0b11));
        wire.damage(2, Damage::Doubled);
        wire.damage(3, Damage::HeldUp(1_000_000));
        wire.give(b"abcdef", 0);
        assert_eq!(arrived(&mut wire, 100_000), [b'b' ^ 3, b'c', b'c']);
        assert_eq!(arrived(&mut wire, 2_000_000), b"d");
        assert_eq!(arrived(&mut wire, u64::MAX), b"");
    }

    #[test]
    fn a_stall_ends() {
        let mut wire = Wire::new(1_000_000);
        wire.damage(1, Damage::Stalled(5_000_000));
        wire.give(b"abc", 0);
        assert_eq!(arrived(&mut wire, 5_019_000), b"a");
        assert_eq!(arrived(&mut wire, 5_020_000), b"b");
        assert_eq!(arrived(&mut wire, 5_030_000), b"c");
        wire.give(b"d", 6_000_000);
        assert_eq!(arrived(&mut wire, 6_010_000), b"d");
    }
}
