//! The function instructions at work: compare, move, decode, table, rotate,
//! timer, counter.

use crate::code::{Bit, Function, Value};
use crate::memory::{RESULT_FLAGS, SIZE};
use crate::timer::Timers;

/// R900: result bits of CMP for the whole program.
const RESULT_ZERO: u8 = 1 << 0;
const RESULT_NEGATIVE: u8 = 1 << 1;
pub(crate) const RESULT_OVERFLOW: u8 = 1 << 5;
pub(crate) const RESULT_BITS: u8 = RESULT_ZERO | RESULT_NEGATIVE | RESULT_OVERFLOW;

/// Digits of the ROTB format, `RN0 DIR POS INC`.
const ROTATE_FROM_1: u8 = 1 << 3;
const ROTATE_SHORT_WAY: u8 = 1 << 2;
const ROTATE_TO_POSITION_BEFORE: u8 = 1 << 1;
const ROTATE_STEP_COUNT: u8 = 1 << 0;

type Bytes = [u8; SIZE];

/// What function instructions remember from scan to scan, beside memory.
pub(crate) struct Remembered<'a> {
    pub timers: &'a mut Timers,
    /// Last ACT of each CTRC.
    pub edges: &'a mut [bool],
}

/// Carries out one function instruction with the rung's result `act`.
pub(crate) fn execute(
    function: &Function,
    act: bool,
    bytes: &mut Bytes,
    remembered: &mut Remembered<'_>,
) {
    match function {
        Function::Compare {
            length,
            a,
            b,
            at,
            bit,
        } => {
            if act {
                let a = read(bytes, *a, *length);
                let b = read(bytes, *b, *length);
                compare(bytes, a, b, usize::from(*at), *bit);
            }
        }
        Function::Timer {
            timer,
            at,
            preset,
            output,
        } => {
            let preset = read(bytes, *preset, 4).max(0);
            let elapsed = read(bytes, Value::At(*at), 4);
            let elapsed = if act { elapsed.clamp(0, preset) } else { 0 };
            let done = act && elapsed == preset;
            remembered.timers.executed(*timer, act && !done);
            write(bytes, *at, 4, elapsed);
            write_bit(bytes, *output, done);
        }
        Function::Counter {
            down,
            initial,
            reset,
            at,
            preset,
            output,
            edge,
        } => {
            let Some(last) = remembered.edges.get_mut(usize::from(*edge)) else {
                return;
            };
            let rising = act && !*last;
            *last = act;
            let preset = read(bytes, *preset, 4);
            if read_bit(bytes, *reset) {
                let start = if *down { preset } else { *initial };
                write(bytes, *at, 4, start);
                write_bit(bytes, *output, false);
            } else if rising {
                let value = read(bytes, Value::At(*at), 4);
                let (value, end) = count(value, *down, *initial, preset);
                write(bytes, *at, 4, value);
                write_bit(bytes, *output, value == end);
            }
        }
        Function::Move { length, from, to } => {
            if act {
                let value = read(bytes, *from, *length);
                write(bytes, *to, *length, value);
            }
        }
        Function::Decode {
            length,
            from,
            base,
            to,
        } => {
            let step = i64::from(read(bytes, *from, *length)) - i64::from(*base);
            let bits = match step {
                0..8 if act => 1 << step,
                _ => 0,
            };
            bytes[usize::from(*to)] = bits;
        }
        Function::Table {
            length,
            first,
            index,
            to,
            entries,
        } => {
            let index = bytes[usize::from(*index)].checked_sub(*first);
            let entry = index.and_then(|index| entries.get(usize::from(index)));
            if let (true, Some(entry)) = (act, entry) {
                write(bytes, *to, *length, *entry);
            }
        }
        Function::Rotate {
            format,
            stations,
            length,
            current,
            target,
            result,
            output,
        } => {
            if act {
                let current = read(bytes, *current, *length);
                let target = read(bytes, *target, *length);
                let (value, reverse) = rotate(*format, *stations, current, target);
                write(bytes, *result, *length, value);
                write_bit(bytes, *output, reverse);
            }
        }
    }
}

/// One- and two-byte values are unsigned, four-byte ones signed.
fn read(bytes: &Bytes, value: Value, length: u8) -> i32 {
    let at = match value {
        Value::Number(number) => return number,
        Value::At(at) => usize::from(at),
    };
    match length {
        1 => i32::from(bytes[at]),
        2 => i32::from(u16::from_le_bytes([bytes[at], bytes[at + 1]])),
        _ => i32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]),
    }
}

/// Writes the lowest `length` bytes of `value`.
fn write(bytes: &mut Bytes, at: u16, length: u8, value: i32) {
    let value = value.to_le_bytes();
    let width = usize::from(length).min(value.len());
    let at = usize::from(at);
    bytes[at..at + width].copy_from_slice(&value[..width]);
}

fn read_bit(bytes: &Bytes, bit: Bit) -> bool {
    bytes[usize::from(bit.at)] & bit.mask != 0
}

fn write_bit(bytes: &mut Bytes, bit: Bit, value: bool) {
    let byte = &mut bytes[usize::from(bit.at)];
    if value {
        *byte |= bit.mask;
    } else {
        *byte &= !bit.mask;
    }
}

fn compare(bytes: &mut Bytes, a: i32, b: i32, at: usize, bit: u8) {
    let three = u8::from(a > b) | u8::from(a == b) << 1 | u8::from(a < b) << 2;
    bytes[at] = bytes[at] & !(0b111 << bit) | three << bit;
    let mut flags = bytes[RESULT_FLAGS] & !RESULT_BITS;
    if a == b {
        flags |= RESULT_ZERO;
    }
    if a < b {
        flags |= RESULT_NEGATIVE;
    }
    bytes[RESULT_FLAGS] = flags;
}

/// The counter's next value, and the value at which its output is 1.
fn count(value: i32, down: bool, initial: i32, preset: i32) -> (i32, i32) {
    if down {
        let next = value.saturating_sub(1);
        let next = if next < initial { preset } else { next };
        return (next, initial);
    }
    let next = value.saturating_add(1);
    let next = if value == i32::MAX || next > preset {
        initial
    } else {
        next
    };
    (next, preset)
}

/// Result of ROTB and whether the way leads backwards.
fn rotate(format: u8, stations: i32, current: i32, target: i32) -> (i32, bool) {
    let set = |digit: u8| format & digit != 0;
    let base = i64::from(set(ROTATE_FROM_1));
    let stations = i64::from(stations.max(1));
    let current = i64::from(current) - base;
    let target = i64::from(target) - base;
    let forward = (target - current).rem_euclid(stations);
    let backward = (current - target).rem_euclid(stations);
    let reverse = set(ROTATE_SHORT_WAY) && backward < forward;
    let steps = if reverse { backward } else { forward };
    let before = set(ROTATE_TO_POSITION_BEFORE) && steps > 0;
    let result = if set(ROTATE_STEP_COUNT) {
        steps - i64::from(before)
    } else {
        let back = match (before, reverse) {
            (false, _) => 0,
            (true, true) => 1,
            (true, false) => -1,
        };
        (target + back).rem_euclid(stations) + base
    };
    (i32::try_from(result).unwrap_or(i32::MAX), reverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotation_of_twelve_stations_from_1() {
        // Short way, position before the target: the manual's example.
        let before = |target| rotate(0b1110, 12, 1, target);
        assert_eq!(before(10), (11, true));
        assert_eq!(before(8), (9, true));
        assert_eq!(before(5), (4, false));
        assert_eq!(before(3), (2, false));
        assert_eq!(before(1), (1, false));
    }

    #[test]
    fn rotation_formats() {
        // format, stations, current, target, result, backwards
        let table = [
            (0b1100, 12, 1, 10, 10, true),
            (0b1101, 12, 1, 10, 3, true),
            (0b1111, 12, 1, 10, 2, true),
            (0b1111, 12, 1, 1, 0, false),
            (0b1001, 12, 1, 10, 9, false),
            (0b0001, 8, 7, 0, 1, false),
            (0b0101, 8, 0, 4, 4, false),
            (0b0110, 8, 0, 7, 0, true),
            (0b0110, 8, 7, 0, 7, false),
            (0b1000, 4, 2, 9, 9 - 8, false),
            (0b0001, 1, 200, 7, 0, false),
        ];
        for (format, stations, current, target, result, backwards) in table {
            assert_eq!(
                rotate(format, stations, current, target),
                (result, backwards),
                "format {format:04b}, {stations} stations, {current} to {target}"
            );
        }
    }

    #[test]
    fn counting_wraps_at_both_ends() {
        assert_eq!(count(9, false, 0, 10), (10, 10));
        assert_eq!(count(10, false, 0, 10), (0, 10));
        assert_eq!(count(10, false, 1, 10), (1, 10));
        assert_eq!(count(i32::MAX, false, 0, i32::MAX), (0, i32::MAX));
        assert_eq!(count(1, true, 0, 10), (0, 0));
        assert_eq!(count(0, true, 0, 10), (10, 0));
        assert_eq!(count(1, true, 1, 10), (10, 1));
        assert_eq!(count(i32::MIN, true, 0, 10), (10, 0));
    }
}
