//! PLC memory: all areas in one little-endian byte array.

use std::fmt;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

use crate::address::{Area, BitAddress, ByteAddress};

/// Index of X in the memory array. X and F are the first areas, so that one copy latches both
/// for level 2.
const X: usize = 0;
const F: usize = X + Area::X.count() as usize;
/// Distance in bytes from a byte of X or F to its latched copy for level 2.
pub(crate) const LATCH_OFFSET: usize = F + Area::F.count() as usize;
const Y: usize = 2 * LATCH_OFFSET;
const G: usize = Y + Area::Y.count() as usize;
const R: usize = G + Area::G.count() as usize;
const A: usize = R + Area::R.count() as usize;
const K: usize = A + Area::A.count() as usize;
const D: usize = K + Area::K.count() as usize;
const T: usize = D + Area::D.count() as usize;
const C: usize = T + 4 * Area::T.count() as usize;
const DC: usize = C + 4 * Area::C.count() as usize;
const DT: usize = DC + 4 * Area::Dc.count() as usize;
/// Size of the memory array, bytes.
pub(crate) const SIZE: usize = DT + 4 * Area::Dt.count() as usize;

/// Number of the first retained entry of T.
const FIRST_RETAINED_T: usize = 80;
/// Number of the first retained byte of D.
const FIRST_RETAINED_D: usize = 300;

/// Initial value of counter and timer presets, which is practically unlimited.
const NEW_PRESET: i32 = i32::MAX;

/// Signals to the CNC that are inactive at 1: *IT G8.0, *ESP G8.4, *SP G8.5, the limits *+L
/// G114 and *-L G116. All start at 1, so that a ladder that does not write them does not stop
/// the machine.
const SIGNALS_INACTIVE_AT_1: [(usize, u8); 3] = [(8, 0b0011_0001), (114, 0b1111), (116, 0b1111)];

#[inline]
const fn area_start(area: Area) -> usize {
    match area {
        Area::X => X,
        Area::Y => Y,
        Area::F => F,
        Area::G => G,
        Area::R => R,
        Area::A => A,
        Area::K => K,
        Area::D => D,
        Area::T => T,
        Area::C => C,
        Area::Dc => DC,
        Area::Dt => DT,
    }
}

/// Returns the index of a byte or entry in the memory array, or `None` outside its area.
#[inline]
pub(crate) fn offset(address: ByteAddress) -> Option<usize> {
    if address.byte >= address.area.count() {
        return None;
    }
    let width = if address.area.is_entry() { 4 } else { 1 };
    Some(area_start(address.area) + width * usize::from(address.byte))
}

/// Index of R900, the result flags of every comparison.
pub(crate) const RESULT_FLAGS: usize = R + 900;

/// All memory of the PLC. A read outside an area gives 0; a write outside an area is
/// ignored.
#[derive(Clone, Serialize, Deserialize)]
#[serde(try_from = "Vec<u8>", into = "Vec<u8>")]
pub struct PlcMemory {
    bytes: Box<[u8; SIZE]>,
    /// Whether a write outside X and F has happened since the last
    /// [`PlcMemory::take_changed_length`].
    written: bool,
}

impl PartialEq for PlcMemory {
    fn eq(&self, other: &PlcMemory) -> bool {
        self.bytes == other.bytes
    }
}

impl Eq for PlcMemory {}

macro_rules! byte_area {
    ($get:ident, $set:ident, $area:ident, $doc:literal) => {
        #[doc = concat!("Byte `byte` of ", $doc, ".")]
        #[must_use]
        #[inline]
        pub fn $get(&self, byte: u16) -> u8 {
            self.byte(ByteAddress::new(Area::$area, byte))
        }

        #[doc = concat!("Writes byte `byte` of ", $doc, ".")]
        #[inline]
        pub fn $set(&mut self, byte: u16, value: u8) {
            self.set_byte(ByteAddress::new(Area::$area, byte), value);
        }
    };
}

macro_rules! entry_area {
    ($get:ident, $set:ident, $area:ident, $doc:literal) => {
        #[doc = concat!("Entry `entry` of ", $doc, ".")]
        #[must_use]
        pub fn $get(&self, entry: u16) -> i32 {
            self.long(ByteAddress::new(Area::$area, entry))
        }

        #[doc = concat!("Writes entry `entry` of ", $doc, ".")]
        pub fn $set(&mut self, entry: u16, value: i32) {
            self.set_long(ByteAddress::new(Area::$area, entry), value);
        }
    };
}

impl PlcMemory {
    /// Creates memory with an empty retained part: presets DC and DT are 2147483647, the
    /// interlock signals to the CNC are inactive, and everything else is 0.
    #[must_use]
    pub fn new() -> PlcMemory {
        let mut memory = PlcMemory {
            bytes: Box::new([0; SIZE]),
            written: true,
        };
        for entry in 0..Area::Dc.count() {
            memory.set_dc(entry, NEW_PRESET);
        }
        for entry in 0..Area::Dt.count() {
            memory.set_dt(entry, NEW_PRESET);
        }
        memory.clear_volatile();
        memory
    }

    byte_area!(x, set_x, X, "the machine and panel inputs X0 to X29");
    byte_area!(y, set_y, Y, "the machine outputs and lamps Y0 to Y19");
    byte_area!(f, set_f, F, "the signals from the CNC F0 to F255");
    byte_area!(g, set_g, G, "the signals to the CNC G0 to G255");
    byte_area!(r, set_r, R, "the internal relays R0 to R999");
    byte_area!(a, set_a, A, "the message requests A0 to A24");
    byte_area!(k, set_k, K, "the keep relays K0 to K39");
    byte_area!(d, set_d, D, "the data table D0 to D999");
    entry_area!(t, set_t, T, "the timer values T0 to T99, in ms");
    entry_area!(c, set_c, C, "the counter values C0 to C99");
    entry_area!(dc, set_dc, Dc, "the counter presets DC0 to DC99");
    entry_area!(dt, set_dt, Dt, "the timer presets DT0 to DT99, in ms");

    /// Writes the inputs X0 to X29.
    #[inline]
    pub fn set_inputs(&mut self, x: &[u8; F - X]) {
        self.bytes[X..F].copy_from_slice(x);
    }

    /// Returns the outputs Y0 to Y19.
    #[must_use]
    #[inline]
    pub fn outputs(&self) -> &[u8] {
        &self.bytes[Y..G]
    }

    /// Returns all bytes of an area; an entry is four bytes, the lowest first.
    #[must_use]
    pub fn area(&self, area: Area) -> &[u8] {
        &self.bytes[area_start(area)..area_end(area)]
    }

    /// Returns the value of a bit.
    #[must_use]
    #[inline]
    pub fn bit(&self, address: BitAddress) -> bool {
        address.area.has_bits()
            && address.bit < 8
            && self.byte(address.byte_address()) >> address.bit & 1 == 1
    }

    /// Writes the value of a bit.
    #[inline]
    pub fn set_bit(&mut self, address: BitAddress, value: bool) {
        if !address.area.has_bits() || address.bit > 7 {
            return;
        }
        let mask = 1 << address.bit;
        let byte = self.byte(address.byte_address());
        let byte = if value { byte | mask } else { byte & !mask };
        self.set_byte(address.byte_address(), byte);
    }

    /// Returns a byte; of an entry of T, C, DC or DT the lowest byte.
    #[must_use]
    #[inline]
    pub fn byte(&self, address: ByteAddress) -> u8 {
        offset(address).map_or(0, |at| self.bytes[at])
    }

    /// Writes a byte; of an entry of T, C, DC or DT the lowest byte.
    #[inline]
    pub fn set_byte(&mut self, address: ByteAddress, value: u8) {
        if let Some(at) = offset(address) {
            self.bytes[at] = value;
            self.written |= at >= LATCH_OFFSET;
        }
    }

    /// Returns a value of two bytes. The address is that of the lowest byte.
    #[must_use]
    pub fn word(&self, address: ByteAddress) -> u16 {
        u16::from_le_bytes(self.read_bytes(address))
    }

    /// Writes a value of two bytes. The address is that of the lowest byte.
    pub fn set_word(&mut self, address: ByteAddress, value: u16) {
        self.write_bytes(address, value.to_le_bytes());
    }

    /// Returns a value of four bytes or an entry of T, C, DC or DT. The address is that of
    /// the lowest byte.
    #[must_use]
    pub fn long(&self, address: ByteAddress) -> i32 {
        i32::from_le_bytes(self.read_bytes(address))
    }

    /// Writes a value of four bytes or an entry of T, C, DC or DT. The address is that of
    /// the lowest byte.
    pub fn set_long(&mut self, address: ByteAddress, value: i32) {
        self.write_bytes(address, value.to_le_bytes());
    }

    /// Returns whether any message request bit of A0 to A24 is 1.
    #[must_use]
    pub fn has_message_request(&self) -> bool {
        self.bytes[A..K].iter().any(|byte| *byte != 0)
    }

    /// Clears the memory that power-off loses: X Y F G R A, T0 to T79 and D0 to D299 become 0. The
    /// signals to the CNC that interlock at 0 become 1.
    pub(crate) fn clear_volatile(&mut self) {
        self.written = true;
        self.bytes[..K].fill(0);
        self.bytes[D..D + FIRST_RETAINED_D].fill(0);
        self.bytes[T..T + 4 * FIRST_RETAINED_T].fill(0);
        for (byte, bits) in SIGNALS_INACTIVE_AT_1 {
            self.bytes[G + byte] = bits;
        }
    }

    /// Returns the retained part of memory, which the battery keeps.
    #[must_use]
    pub fn retained(&self) -> RetainedMemory {
        let entries = |area, first: u16| -> Vec<i32> {
            (first..Area::count(area))
                .map(|entry| self.long(ByteAddress::new(area, entry)))
                .collect()
        };
        RetainedMemory {
            k: self.bytes[K..D].to_vec(),
            d300: self.bytes[D + FIRST_RETAINED_D..T].to_vec(),
            t80: entries(Area::T, FIRST_RETAINED_T as u16),
            c: entries(Area::C, 0),
            dc: entries(Area::Dc, 0),
            dt: entries(Area::Dt, 0),
        }
    }

    /// Restores the retained part of memory. Entries that `retained` lacks do not change.
    pub fn restore_retained(&mut self, retained: &RetainedMemory) {
        self.written = true;
        copy_bytes(&mut self.bytes[K..D], &retained.k);
        copy_bytes(&mut self.bytes[D + FIRST_RETAINED_D..T], &retained.d300);
        self.restore_entries(Area::T, FIRST_RETAINED_T as u16, &retained.t80);
        self.restore_entries(Area::C, 0, &retained.c);
        self.restore_entries(Area::Dc, 0, &retained.dc);
        self.restore_entries(Area::Dt, 0, &retained.dt);
    }

    /// Returns the memory array, which contains all areas.
    pub(crate) fn bytes(&self) -> &[u8; SIZE] {
        &self.bytes
    }

    /// Returns the length, from the start of the array, in which bytes may have changed
    /// since the last call, apart from writes of the scan: X, F and their copies, or the
    /// whole array.
    pub(crate) fn take_changed_length(&mut self) -> usize {
        if core::mem::take(&mut self.written) {
            SIZE
        } else {
            2 * LATCH_OFFSET
        }
    }

    /// Returns the mutable memory array for the scan, which tracks its own changes.
    pub(crate) fn bytes_mut(&mut self) -> &mut [u8; SIZE] {
        &mut self.bytes
    }

    /// Returns the value of a bit in level 2, where X and F are latched at the start of the
    /// cycle.
    pub(crate) fn bit_in_level2(&self, address: BitAddress) -> bool {
        match offset(address.byte_address()) {
            Some(at) if at < LATCH_OFFSET => {
                self.bytes[at + LATCH_OFFSET] >> (address.bit & 7) & 1 == 1
            }
            _ => self.bit(address),
        }
    }

    /// Copies X and F to the latched copies that level 2 reads.
    pub(crate) fn latch_inputs(&mut self) {
        self.bytes.copy_within(..LATCH_OFFSET, LATCH_OFFSET);
    }

    fn restore_entries(&mut self, area: Area, first: u16, values: &[i32]) {
        for (entry, value) in (first..area.count()).zip(values) {
            self.set_long(ByteAddress::new(area, entry), *value);
        }
    }

    fn read_bytes<const N: usize>(&self, address: ByteAddress) -> [u8; N] {
        let mut value = [0; N];
        if let Some(at) = offset(address) {
            let end = (at + N).min(area_end(address.area));
            value[..end - at].copy_from_slice(&self.bytes[at..end]);
        }
        value
    }

    fn write_bytes<const N: usize>(&mut self, address: ByteAddress, value: [u8; N]) {
        if let Some(at) = offset(address) {
            let end = (at + N).min(area_end(address.area));
            self.bytes[at..end].copy_from_slice(&value[..end - at]);
            self.written |= end > LATCH_OFFSET;
        }
    }
}

fn area_end(area: Area) -> usize {
    let width = if area.is_entry() { 4 } else { 1 };
    area_start(area) + width * usize::from(area.count())
}

fn copy_bytes(target: &mut [u8], values: &[u8]) {
    for (byte, value) in target.iter_mut().zip(values) {
        *byte = *value;
    }
}

impl Default for PlcMemory {
    fn default() -> PlcMemory {
        PlcMemory::new()
    }
}

impl fmt::Debug for PlcMemory {
    /// Formats only the bytes and entries that are not 0.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut map = f.debug_map();
        for area in Area::ALL {
            for byte in 0..area.count() {
                let address = ByteAddress::new(area, byte);
                let value = if area.is_entry() {
                    self.long(address)
                } else {
                    i32::from(self.byte(address))
                };
                if value != 0 {
                    map.entry(&format_args!("{address}"), &value);
                }
            }
        }
        map.finish()
    }
}

impl From<PlcMemory> for Vec<u8> {
    fn from(memory: PlcMemory) -> Vec<u8> {
        memory.bytes.to_vec()
    }
}

impl TryFrom<Vec<u8>> for PlcMemory {
    type Error = Message;

    fn try_from(bytes: Vec<u8>) -> Result<PlcMemory, Message> {
        let length = bytes.len();
        let bytes = bytes
            .try_into()
            .map_err(|_| say::ladder_memory_size(SIZE, length))?;
        Ok(PlcMemory {
            bytes,
            written: true,
        })
    }
}

/// The retained part of PLC memory, as files store it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RetainedMemory {
    /// Bytes of the keep relays K0 to K39.
    pub k: Vec<u8>,
    /// Bytes of the data table D300 to D999.
    pub d300: Vec<u8>,
    /// Timer values T80 to T99, ms.
    pub t80: Vec<i32>,
    /// Counter values C0 to C99.
    pub c: Vec<i32>,
    /// Counter presets DC0 to DC99.
    pub dc: Vec<i32>,
    /// Timer presets DT0 to DT99, ms.
    pub dt: Vec<i32>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_do_not_overlap() {
        for area in Area::ALL {
            let mut memory = PlcMemory::new();
            let before = memory.clone();
            for byte in 0..area.count() {
                memory.set_byte(ByteAddress::new(area, byte), 0x5A);
            }
            for other in Area::ALL.into_iter().filter(|other| *other != area) {
                for byte in 0..other.count() {
                    let address = ByteAddress::new(other, byte);
                    assert_eq!(
                        memory.long(address),
                        before.long(address),
                        "{area} {address}"
                    );
                }
            }
        }
    }

    #[test]
    fn wide_values_are_little_endian_and_end_with_the_area() {
        let mut memory = PlcMemory::new();
        memory.set_long(ByteAddress::new(Area::R, 10), 0x0403_0201);
        assert_eq!((memory.r(10), memory.r(13)), (1, 4));
        memory.set_long(ByteAddress::new(Area::R, 998), -1);
        assert_eq!(memory.word(ByteAddress::new(Area::R, 999)), 0x00FF);
        assert_eq!(memory.a(0), 0);
    }

    #[test]
    fn power_off_keeps_the_retained_areas() {
        let mut memory = PlcMemory::new();
        for area in Area::ALL {
            for byte in 0..area.count() {
                memory.set_byte(ByteAddress::new(area, byte), 1);
            }
        }
        memory.clear_volatile();
        let kept = |text: &str| memory.byte(text.parse().unwrap()) == 1;
        for text in [
            "K0", "K39", "C0", "DC0", "DT99", "T80", "T99", "D300", "D999",
        ] {
            assert!(kept(text), "{text}");
        }
        for text in [
            "X0", "Y19", "F255", "R999", "A24", "T79", "D0", "D299", "G0",
        ] {
            assert!(!kept(text), "{text}");
        }
        assert_eq!((memory.g(8), memory.g(114), memory.g(116)), (0x31, 15, 15));

        let mut fresh = PlcMemory::new();
        fresh.restore_retained(&memory.retained());
        assert_eq!(fresh, memory);
    }

    #[test]
    fn new_presets_are_the_largest_number() {
        let memory = PlcMemory::new();
        assert_eq!(
            (memory.dt(0), memory.dc(99), memory.c(0)),
            (i32::MAX, i32::MAX, 0)
        );
    }

    #[test]
    fn addresses_outside_an_area_read_0() {
        let mut memory = PlcMemory::new();
        memory.set_x(30, 255);
        memory.set_bit(BitAddress::new(Area::X, 0, 9), true);
        memory.set_bit(BitAddress::new(Area::D, 0, 0), true);
        assert_eq!(
            (memory.x(30), memory.x(0), memory.f(0), memory.d(0)),
            (0, 0, 0, 0)
        );
    }
}
