//! Runs the function instructions: compare, move, decode, table, rotate, timer and counter.

use crate::code::{Function, MemoryBit, OperandValue};
use crate::memory::{RESULT_FLAGS, SIZE};
use crate::timer::Timers;

/// Result flag of CMP in R900: both numbers are equal. The whole program shares the flags.
const RESULT_ZERO: u8 = 1 << 0;
const RESULT_NEGATIVE: u8 = 1 << 1;
pub(crate) const RESULT_OVERFLOW: u8 = 1 << 5;
pub(crate) const RESULT_BITS: u8 = RESULT_ZERO | RESULT_NEGATIVE | RESULT_OVERFLOW;

/// Digit RN0 of the ROTB format `RN0 DIR POS INC`: stations are numbered from 1.
const ROTATE_FROM_1: u8 = 1 << 3;
const ROTATE_SHORTEST_DIRECTION: u8 = 1 << 2;
const ROTATE_TO_STATION_BEFORE_TARGET: u8 = 1 << 1;
const ROTATE_STEP_COUNT: u8 = 1 << 0;

type MemoryBytes = [u8; SIZE];

/// State of function instructions that is kept from scan to scan, besides PLC memory.
pub(crate) struct FunctionState<'a> {
    pub timers: &'a mut Timers,
    /// Previous input state (ACT) of each CTRC.
    pub counter_inputs: &'a mut [bool],
}

/// Runs one function instruction. `act` is the result of the rung, the input ACT.
pub(crate) fn execute(
    function: &Function,
    act: bool,
    bytes: &mut MemoryBytes,
    state: &mut FunctionState<'_>,
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
                write_comparison(bytes, a, b, usize::from(*at), *bit);
            }
        }
        Function::Timer {
            timer,
            at,
            preset,
            output,
        } => {
            let preset = read(bytes, *preset, 4).max(0);
            let elapsed = read(bytes, OperandValue::Address(*at), 4);
            let elapsed = if act { elapsed.clamp(0, preset) } else { 0 };
            let done = act && elapsed == preset;
            state.timers.record_execution(*timer, act && !done);
            write(bytes, *at, 4, elapsed);
            write_bit(bytes, *output, done);
        }
        counter @ Function::Counter { .. } => count(counter, act, bytes, state.counter_inputs),
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
                let (value, reverse) = compute_rotation(*format, *stations, current, target);
                write(bytes, *result, *length, value);
                write_bit(bytes, *output, reverse);
            }
        }
    }
}

/// Runs a CTRC: counts when ACT changes to 1, and restores the start value while the reset bit
/// is 1.
#[inline]
fn count(counter: &Function, act: bool, bytes: &mut MemoryBytes, inputs: &mut [bool]) {
    let Function::Counter {
        down,
        initial,
        reset,
        at,
        preset,
        output,
        edge,
    } = counter
    else {
        return;
    };
    let Some(last) = inputs.get_mut(usize::from(*edge)) else {
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
        let value = read(bytes, OperandValue::Address(*at), 4);
        let (value, end) = next_counter_value(value, *down, *initial, preset);
        write(bytes, *at, 4, value);
        write_bit(bytes, *output, value == end);
    }
}

/// Reads an operand of 1, 2 or 4 bytes. Values of 1 and 2 bytes are unsigned, values of 4
/// bytes are signed.
fn read(bytes: &MemoryBytes, value: OperandValue, length: u8) -> i32 {
    let at = match value {
        OperandValue::Number(number) => return number,
        OperandValue::Address(at) => usize::from(at),
    };
    match length {
        1 => i32::from(bytes[at]),
        2 => i32::from(u16::from_le_bytes([bytes[at], bytes[at + 1]])),
        _ => i32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]),
    }
}

/// Writes the lowest `length` bytes of `value` to the memory array at index `at`.
fn write(bytes: &mut MemoryBytes, at: u16, length: u8, value: i32) {
    let value = value.to_le_bytes();
    let width = usize::from(length).min(value.len());
    let at = usize::from(at);
    bytes[at..at + width].copy_from_slice(&value[..width]);
}

fn read_bit(bytes: &MemoryBytes, bit: MemoryBit) -> bool {
    bytes[usize::from(bit.at)] & bit.mask != 0
}

fn write_bit(bytes: &mut MemoryBytes, bit: MemoryBit, value: bool) {
    let byte = &mut bytes[usize::from(bit.at)];
    if value {
        *byte |= bit.mask;
    } else {
        *byte &= !bit.mask;
    }
}

fn write_comparison(bytes: &mut MemoryBytes, a: i32, b: i32, at: usize, bit: u8) {
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

/// Returns the next value of a counter and the value at which its output is 1.
fn next_counter_value(value: i32, down: bool, initial: i32, preset: i32) -> (i32, i32) {
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

/// Returns the result of ROTB (a station or a number of steps) and whether the rotation is
/// backwards.
fn compute_rotation(format: u8, stations: i32, current: i32, target: i32) -> (i32, bool) {
    let set = |digit: u8| format & digit != 0;
    let base = i64::from(set(ROTATE_FROM_1));
    let stations = i64::from(stations.max(1));
    let current = i64::from(current) - base;
    let target = i64::from(target) - base;
    let forward = (target - current).rem_euclid(stations);
    let backward = (current - target).rem_euclid(stations);
    let reverse = set(ROTATE_SHORTEST_DIRECTION) && backward < forward;
    let steps = if reverse { backward } else { forward };
    let before = set(ROTATE_TO_STATION_BEFORE_TARGET) && steps > 0;
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
        // Example of the manual: shortest direction, station before the target.
        let before = |target| compute_rotation(0b1110, 12, 1, target);
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
                compute_rotation(format, stations, current, target),
                (result, backwards),
                "format {format:04b}, {stations} stations, {current} to {target}"
            );
        }
    }

    #[test]
    fn counting_wraps_at_both_ends() {
        assert_eq!(next_counter_value(9, false, 0, 10), (10, 10));
        assert_eq!(next_counter_value(10, false, 0, 10), (0, 10));
        assert_eq!(next_counter_value(10, false, 1, 10), (1, 10));
        assert_eq!(
            next_counter_value(i32::MAX, false, 0, i32::MAX),
            (0, i32::MAX)
        );
        assert_eq!(next_counter_value(1, true, 0, 10), (0, 0));
        assert_eq!(next_counter_value(0, true, 0, 10), (10, 0));
        assert_eq!(next_counter_value(1, true, 1, 10), (10, 1));
        assert_eq!(next_counter_value(i32::MIN, true, 0, 10), (10, 0));
    }
}
