//! Draws the diagnosis page (manual III-2.7): machine contacts and outputs, drives and encoder,
//! mirrored status parameters, the current tool. All but the tool is read-only.

use gsk_core::cnc::Cnc;
use gsk_core::memory;
use gsk_core::operation::Sensors;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_messages::{Message, say};

use super::format;
use super::frame;
use super::lists::{self, HEADING_ROW};
use super::parameters::{self, BITS};
use super::plc_names;
use super::view::PageView;
use crate::face::PageId;
use crate::screen::Screen;

/// Number of diagnosis bytes.
pub(crate) const DIAGNOSES: usize = 128;
const SCREEN: usize = 16;

/// A diagnosis number whose bits show PLC inputs or outputs.
struct Register {
    number: usize,
    group: fn() -> Message,
    area: Area,
    /// X or Y byte and bit that each of the eight bits shows, bit 7 first; `None` where
    /// nothing is wired.
    bits: [Option<(u16, u8)>; 8],
    names: [&'static str; 8],
}

/// A diagnosis number whose bits show signals other than contacts: names, bit 7 first, and
/// meanings.
struct Signals {
    number: usize,
    group: fn() -> Message,
    names: [&'static str; 8],
    meanings: [Option<fn() -> Message>; 8],
}

/// The diagnosis numbers of zero signals, drives and the encoder (manual III-12.7.1).
const SIGNALS: [Signals; 3] = [
    Signals {
        number: 8,
        group: say::lcd_drives_and_encoder,
        names: ["-", "-", "*ALMZ", "*ALMX", "-", "PCS", "PCZ", "PCX"],
        meanings: [
            None,
            None,
            Some(say::lcd_z_drive_well),
            Some(say::lcd_x_drive_well),
            None,
            Some(say::lcd_spindle_one_turn),
            Some(say::lcd_z_zero),
            Some(say::lcd_x_zero),
        ],
    },
    Signals {
        number: 11,
        group: say::lcd_encoder_low,
        names: ["7", "6", "5", "4", "3", "2", "1", "0"],
        meanings: [None; 8],
    },
    Signals {
        number: 12,
        group: say::lcd_encoder_high,
        names: ["15", "14", "13", "12", "11", "10", "9", "8"],
        meanings: [None; 8],
    },
];

/// The diagnosis numbers of the machine interface (manual IV-2).
const REGISTERS: [Register; 5] = [
    Register {
        number: 0,
        group: say::lcd_machine_inputs,
        area: Area::X,
        bits: wired([
            (0, 7),
            (0, 6),
            (0, 3),
            (0, 2),
            (0, 1),
            (0, 0),
            (1, 7),
            (1, 6),
        ]),
        names: ["*TCP", "DIQP", "*DECX", "X14", "T04", "T03", "T02", "T01"],
    },
    Register {
        number: 1,
        group: say::lcd_machine_inputs,
        area: Area::X,
        bits: wired([
            (1, 5),
            (1, 4),
            (1, 3),
            (0, 5),
            (1, 2),
            (1, 1),
            (1, 0),
            (0, 4),
        ]),
        names: ["*SP", "ST", "*DECZ", "*ESP", "T08", "T07", "T06", "T05"],
    },
    Register {
        number: 2,
        group: say::lcd_machine_inputs,
        area: Area::X,
        bits: [
            Some((1, 2)),
            Some((1, 1)),
            Some((1, 0)),
            Some((0, 4)),
            None,
            None,
            None,
            None,
        ],
        names: ["T08", "T07", "T06", "T05", "-", "-", "-", "-"],
    },
    Register {
        number: 4,
        group: say::lcd_machine_outputs,
        area: Area::Y,
        bits: wired([
            (0, 7),
            (0, 6),
            (0, 5),
            (0, 2),
            (1, 1),
            (0, 3),
            (0, 4),
            (1, 2),
        ]),
        names: ["SPZD", "DOQPJ", "M05", "DOTWJ", "M32", "M08", "M04", "M03"],
    },
    Register {
        number: 5,
        group: say::lcd_machine_outputs,
        area: Area::Y,
        bits: wired([
            (1, 7),
            (1, 6),
            (1, 5),
            (1, 4),
            (1, 3),
            (0, 1),
            (0, 0),
            (1, 0),
        ]),
        names: ["TL-", "TL+", "UO5", "UO4", "S4", "S3", "S2", "S1"],
    },
];

const fn wired(bits: [(u16, u8); 8]) -> [Option<(u16, u8)>; 8] {
    let mut wired_bits = [None; 8];
    let mut at = 0;
    while at < wired_bits.len() {
        wired_bits[at] = Some(bits[at]);
        at += 1;
    }
    wired_bits
}

/// Diagnosis number that shows the number of the current tool.
const TOOL: usize = 75;
/// Diagnosis numbers that show the state parameter whose number is 100 greater.
const MIRRORED: [usize; 5] = [64, 68, 72, 73, 74];
/// Diagnosis numbers that show times and limits of gear change, pressure, tool change, M and
/// S. An earlier control set them here. They are now the data parameters of the same numbers
/// (manual I-3.5, IV-2.8), shown in decimal.
const TIMES: [u16; 12] = [65, 66, 67, 69, 76, 78, 80, 81, 82, 83, 84, 85];

/// Returns the data parameter that a diagnosis number shows; `None` if it shows none.
fn time_of(number: usize) -> Option<u16> {
    let number = u16::try_from(number).ok()?;
    TIMES.contains(&number).then_some(number)
}

impl Register {
    fn of(number: usize) -> Option<&'static Self> {
        REGISTERS.iter().find(|register| register.number == number)
    }

    fn address(&self, bit: u8) -> Option<BitAddress> {
        let (byte, bit) = self.bits[usize::from(7 - bit.min(7))]?;
        Some(BitAddress::new(self.area, byte, bit))
    }

    fn value(&self, cnc: &Cnc) -> u8 {
        let memory = cnc.plc().memory();
        let is_set = |bit: u8| self.address(bit).is_some_and(|bit| memory.bit(bit));
        (0..8).fold(0, |byte, bit| byte | u8::from(is_set(bit)) << bit)
    }
}

/// Draws the diagnosis page: the values of the screen, and the names and meaning of the bits
/// at the cursor.
pub fn draw(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let cursor = view.cursors.get(PageId::Dgn);
    let item = cursor.item.min(DIAGNOSES - 1);
    screen.put_message(HEADING_ROW, 0, &say::lcd_diagnosis_heading());
    let first = item / SCREEN * SCREEN;
    let shown = (first..DIAGNOSES).map(|number| {
        let value = match time_of(number) {
            Some(parameter) => cnc.parameters().value(parameter).to_string(),
            None => format::byte(value(number, cnc)),
        };
        (format!("{number:03}"), value)
    });
    lists::draw(screen, &BITS, shown, item % SCREEN);
    if let Some(register) = Register::of(item) {
        let bit = cursor.bit.min(7);
        let index = usize::from(7 - bit);
        let end = screen.put(10, 0, &format!("Bit{bit}:{}", register.names[index]));
        if let Some(address) = register.address(bit) {
            let meaning = plc_names::meaning(cnc.plc().ladder(), address, screen.language());
            screen.put(10, end + 1, &meaning);
        }
        lists::bit_names(screen, 11, |bit| register.names[usize::from(7 - bit)]);
        screen.put_message(12, 0, &(register.group)());
    }
    if let Some(signals) = SIGNALS.iter().find(|signals| signals.number == item) {
        let bit = cursor.bit.min(7);
        let index = usize::from(7 - bit);
        let end = screen.put(10, 0, &format!("Bit{bit}:{}", signals.names[index]));
        if let Some(meaning) = signals.meanings[index] {
            screen.put_message(10, end + 1, &meaning());
        }
        lists::bit_names(screen, 11, |bit| signals.names[usize::from(7 - bit)]);
        screen.put_message(12, 0, &(signals.group)());
    }
    if let Some(row) = time_of(item).and_then(|parameter| memory::parameter_row(parameter, None)) {
        screen.put(10, 0, parameters::meaning(screen, row));
        screen.put_message(12, 0, &say::lcd_data_parameter(item));
    }
    let prompt = say::lcd_number_prompt(format!("{item:03}"));
    frame::input_line(screen, &prompt, view);
}

fn value(number: usize, cnc: &Cnc) -> u8 {
    if let Some(register) = Register::of(number) {
        return register.value(cnc);
    }
    let sensors = cnc.sensors();
    match number {
        8 => sensor_bits(sensors),
        11 => sensors.encoder as u8,
        12 => (sensors.encoder >> 8) as u8,
        TOOL => cnc.tool().0,
        _ if MIRRORED.contains(&number) => cnc.parameters().byte(number as u16 + 100),
        _ => 0,
    }
}

/// Returns DGN.008: zero signals, index and drives. The manual's picture of an idle machine,
/// 00110011, has both axes on their zero signals and both drives ready.
fn sensor_bits(sensors: Sensors) -> u8 {
    u8::from(sensors.zero_signal.x)
        | u8::from(sensors.zero_signal.z) << 1
        | u8::from(sensors.is_index_shown()) << 2
        | u8::from(sensors.drive_ok.x) << 4
        | u8::from(sensors.drive_ok.z) << 5
}
