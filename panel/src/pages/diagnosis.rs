//! The diagnosis page (manual III-2.7): contacts and outputs of the machine, drives
//! and encoder, mirrored status parameters, the tool in place. All but the tool is
//! read-only.

use gsk_core::cnc::Cnc;
use gsk_core::operation::Sensors;
use gsk_core::plc::address::{Area, BitAddress};

use super::format;
use super::frame;
use super::lists::{self, HEADING_ROW};
use super::parameters::BITS;
use super::plc_names;
use super::table::PageId;
use super::view::View;
use crate::screen::Screen;

/// How many numbers there are, and how many on one screen.
pub const DIAGNOSES: usize = 128;
const SCREEN: usize = 16;

/// A register made of contacts or outputs.
struct Register {
    number: usize,
    group: &'static str,
    area: Area,
    /// Byte and bit of each place, bit 7 first; `None` where nothing is wired.
    bits: [Option<(u16, u8)>; 8],
    names: [&'static str; 8],
}

/// A register of signals that are no contacts: names, bit 7 first, and what they
/// are.
struct Signals {
    number: usize,
    group: &'static str,
    names: [&'static str; 8],
    meanings: [&'static str; 8],
}

/// Zero signals, drives and the encoder (manual III-12.7.1).
const SIGNALS: [Signals; 3] = [
    Signals {
        number: 8,
        group: "驱动单元和编码器的信号",
        names: ["-", "-", "*ALMZ", "*ALMX", "-", "PCS", "PCZ", "PCX"],
        meanings: [
            "",
            "",
            "Z轴驱动器无报警",
            "X轴驱动器无报警",
            "",
            "主轴编码器一转信号",
            "Z轴零点信号",
            "X轴零点信号",
        ],
    },
    Signals {
        number: 11,
        group: "主轴编码器计数(低8位)",
        names: ["7", "6", "5", "4", "3", "2", "1", "0"],
        meanings: [""; 8],
    },
    Signals {
        number: 12,
        group: "主轴编码器计数(高8位)",
        names: ["15", "14", "13", "12", "11", "10", "9", "8"],
        meanings: [""; 8],
    },
];

const INPUTS: &str = "机床侧的输入信号(I/O板)";
const OUTPUTS: &str = "输出到机床侧的信号(I/O板)";

/// The registers of the machine interface (manual IV-2).
const REGISTERS: [Register; 5] = [
    Register {
        number: 0,
        group: INPUTS,
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
        group: INPUTS,
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
        group: INPUTS,
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
        group: OUTPUTS,
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
        group: OUTPUTS,
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
    let mut places = [None; 8];
    let mut at = 0;
    while at < places.len() {
        places[at] = Some(bits[at]);
        at += 1;
    }
    places
}

/// Diagnosis number of the tool in place.
const TOOL: usize = 75;
/// Status parameters that are mirrored a hundred lower.
const MIRRORED: [usize; 5] = [64, 68, 72, 73, 74];

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

/// Draws the page.
pub fn draw(screen: &mut Screen, view: &View, cnc: &Cnc) {
    let cursor = view.cursors.get(PageId::Dgn);
    let item = cursor.item.min(DIAGNOSES - 1);
    screen.put(HEADING_ROW, 0, "序号    数据        序号    数据");
    let first = item / SCREEN * SCREEN;
    let shown =
        (first..DIAGNOSES).map(|number| (format!("{number:03}"), format::byte(value(number, cnc))));
    lists::draw(screen, &BITS, shown, item % SCREEN);
    if let Some(register) = Register::of(item) {
        let bit = cursor.bit.min(7);
        let place = usize::from(7 - bit);
        let end = screen.put(10, 0, &format!("Bit{bit}:{}", register.names[place]));
        if let Some(address) = register.address(bit) {
            let meaning = plc_names::meaning(cnc.plc().ladder(), address, screen.is_english());
            screen.put(10, end + 1, &meaning);
        }
        lists::bit_names(screen, 11, |bit| register.names[usize::from(7 - bit)]);
        screen.put(12, 0, register.group);
    }
    if let Some(signals) = SIGNALS.iter().find(|signals| signals.number == item) {
        let bit = cursor.bit.min(7);
        let place = usize::from(7 - bit);
        let end = screen.put(10, 0, &format!("Bit{bit}:{}", signals.names[place]));
        screen.put(10, end + 1, signals.meanings[place]);
        lists::bit_names(screen, 11, |bit| signals.names[usize::from(7 - bit)]);
        screen.put(12, 0, signals.group);
    }
    frame::input_line(screen, &format!("序号 {item:03} "), view);
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

/// DGN.008. The printed picture of an idle machine, 00110011, has both axes on
/// their zero signals and both drives well.
fn sensor_bits(sensors: Sensors) -> u8 {
    u8::from(sensors.zero_signal.x)
        | u8::from(sensors.zero_signal.z) << 1
        | u8::from(sensors.spindle_mark()) << 2
        | u8::from(sensors.drive_well.x) << 4
        | u8::from(sensors.drive_well.z) << 5
}
