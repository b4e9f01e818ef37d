//! Draws the PLC pages: signals, values, soft machine panel, and the version page, which names
//! the ladder (manual III-2.7).

use gsk_core::cnc::Cnc;
use gsk_core::operation::SoftSwitch;
use gsk_core::plc::address::{Area, BitAddress, ByteAddress};
use gsk_core::units::Axis;
use gsk_messages::say;

use super::format::{self, CoordinateFormat};
use super::frame;
use super::lists::{self, HEADING_ROW, LIST_ROWS};
use super::plc_names;
use super::view::PageView;
use crate::face::{PageId, face_of};
use crate::screen::Screen;

/// PLC memory areas of the signal page and of the value page, in the order of display.
const BIT_AREAS: [Area; 7] = [
    Area::X,
    Area::Y,
    Area::F,
    Area::G,
    Area::A,
    Area::K,
    Area::R,
];
const VALUE_AREAS: [Area; 3] = [Area::D, Area::T, Area::C];

/// Number of bytes that one screen of the signal page shows.
const BIT_SCREEN: usize = 2 * LIST_ROWS;

/// Returns the PLC address that an item of the signal page shows. Items are counted from 0
/// through all areas.
pub(crate) fn bit_item(item: usize) -> ByteAddress {
    address(&BIT_AREAS, item)
}

/// Returns the item of the signal page (from 0) that shows a PLC address; `None` if none does.
pub(crate) fn bit_item_of(address: ByteAddress) -> Option<usize> {
    item(&BIT_AREAS, address)
}

/// Returns the number of items on the signal page, over all areas.
pub(crate) fn bit_items() -> usize {
    count(&BIT_AREAS)
}

/// Returns the PLC address that an item of the value page shows. Items are counted from 0
/// through all areas.
pub(crate) fn value_item(item: usize) -> ByteAddress {
    address(&VALUE_AREAS, item)
}

/// Returns the item of the value page (from 0) that shows a PLC address; `None` if none does.
pub(crate) fn value_item_of(address: ByteAddress) -> Option<usize> {
    item(&VALUE_AREAS, address)
}

/// Returns the number of items on the value page, over all areas.
pub(crate) fn value_items() -> usize {
    count(&VALUE_AREAS)
}

fn count(areas: &[Area]) -> usize {
    areas.iter().map(|area| usize::from(area.count())).sum()
}

/// Returns the address of an item of these areas; beyond the end the last address.
fn address(areas: &[Area], item: usize) -> ByteAddress {
    let mut rest = item;
    for area in areas {
        let count = usize::from(area.count());
        if rest < count {
            return ByteAddress::new(*area, rest as u16);
        }
        rest -= count;
    }
    let last = areas.last().copied().unwrap_or(Area::R);
    ByteAddress::new(last, last.count() - 1)
}

fn item(areas: &[Area], address: ByteAddress) -> Option<usize> {
    let at = areas.iter().position(|area| *area == address.area)?;
    let inside = address.byte < address.area.count();
    inside.then(|| count(&areas[..at]) + usize::from(address.byte))
}

/// Returns the addresses on the screen of `size` addresses that shows `address`. Each area
/// starts a new screen.
fn screen_of(address: ByteAddress, size: usize) -> impl Iterator<Item = ByteAddress> {
    let size = size as u16;
    let first = address.byte / size * size;
    (first..address.area.count().min(first + size))
        .map(move |byte| ByteAddress::new(address.area, byte))
}

/// Draws the page of PLC signals (PLC信号状态): bytes of memory as bits.
pub fn signals(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let cursor = view.cursors.get(PageId::PlcBits);
    let at = bit_item(cursor.item);
    screen.put_message(HEADING_ROW, 0, &say::lcd_diagnosis_heading());
    let memory = cnc.plc().memory();
    let shown = screen_of(at, BIT_SCREEN)
        .map(|address| (address.to_string(), format::byte(memory.byte(address))));
    lists::draw(
        screen,
        &lists::NUMBERED,
        shown,
        usize::from(at.byte) % BIT_SCREEN,
    );
    let bit = cursor.bit.min(7);
    let ladder = cnc.plc().ladder();
    let name = |bit| plc_names::short(BitAddress::new(at.area, at.byte, bit));
    let meaning = plc_names::meaning(
        ladder,
        BitAddress::new(at.area, at.byte, bit),
        screen.language(),
    );
    let end = screen.put(10, 0, &format!("BIT{bit}: {}", name(bit)));
    screen.put(10, end + 1, &meaning);
    lists::bit_names(screen, 11, name);
    frame::input_line(screen, &say::lcd_number_prompt(at), view);
}

/// Draws the page of PLC values (PLC数值诊断): counters, timers and data of memory.
pub fn values(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let at = value_item(view.cursors.get(PageId::PlcValues).item);
    screen.put_message(HEADING_ROW, 0, &say::lcd_plc_values_heading());
    let memory = cnc.plc().memory();
    let rows = screen_of(at, LIST_ROWS);
    for (row, address) in (lists::FIRST_ROW..).zip(rows) {
        if address == at {
            screen.put(row, 0, "_");
        }
        screen.put(row, 1, &address.to_string());
        let (current, preset) = match address.area {
            Area::T => (Some(memory.t(address.byte)), memory.dt(address.byte)),
            Area::C => (Some(memory.c(address.byte)), memory.dc(address.byte)),
            _ => (None, i32::from(memory.byte(address))),
        };
        if let Some(current) = current {
            screen.put_right(row, 20, &format!("{current:08}"));
        }
        screen.put_right(row, 34, &format!("{preset:08}"));
    }
    frame::input_line(screen, &say::lcd_number_prompt(at), view);
}

/// Draws the soft machine panel (机床面板): switches with the states that the ladder has set.
pub fn soft_panel(screen: &mut Screen, cnc: &Cnc) {
    let texts = [
        say::lcd_machine_lock(),
        say::lcd_auxiliary_lock(),
        say::lcd_single_block(),
        say::lcd_dry_run(),
        say::lcd_block_skip(),
    ];
    for ((row, text), switch) in (2..).zip(texts).zip(SoftSwitch::ALL) {
        let on = cnc.is_soft_switch_active(switch);
        screen.put_message(row, 0, &text);
        screen.put_message(row, 18, &say::lcd_off_on());
        screen.put(row, if on { 23 } else { 17 }, "*");
    }
    let display = CoordinateFormat::of(cnc);
    let at = cnc.position_relative();
    screen.put_message(9, 0, &say::lcd_position());
    for (row, (letter, axis)) in (10..).zip([("U", Axis::X), ("W", Axis::Z)]) {
        screen.put(row, 2, letter);
        screen.put_right(row, 17, &display.coordinate(axis, at.get(axis)));
    }
}

/// Draws the version page (系统版本信息): model, software, hardware and ladder.
pub fn version(screen: &mut Screen, cnc: &Cnc) {
    let header = cnc.plc().ladder().header();
    let face = face_of(cnc.model().id());
    let (software, hardware) = face.versions.unwrap_or(("-", "-"));
    // Row, label, blanks after it, value.
    let rows = [
        (2, say::lcd_model(), 3, face.product),
        (3, say::lcd_software_version(), 1, software),
        (4, say::lcd_hardware_version(), 1, hardware),
        (6, say::lcd_ladder_unit(), 1, &header.unit),
        (7, say::lcd_ladder_version(), 1, &header.version),
        (8, say::lcd_ladder_author(), 1, &header.author),
        (9, say::lcd_ladder_note(), 1, &header.remark),
    ];
    for (row, label, gap, value) in rows {
        let end = screen.put_message(row, 0, &label);
        screen.put(row, end + gap, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_and_addresses_belong_together() {
        for (item, name) in [(0, "X0000"), (29, "X0029"), (30, "Y0000"), (1626, "R0999")] {
            assert_eq!(bit_item(item).to_string(), name);
            assert_eq!(bit_item_of(bit_item(item)), Some(item));
        }
        assert_eq!(bit_items(), 1627);
        assert_eq!(bit_item(99_999).to_string(), "R0999");
        assert_eq!(value_item(1000).to_string(), "T0000");
        assert_eq!(value_item(value_items() - 1).to_string(), "C0099");
        assert_eq!(value_item_of(ByteAddress::new(Area::X, 0)), None);
    }

    #[test]
    fn every_area_begins_a_screen() {
        let names = |item| {
            let shown: Vec<String> = screen_of(bit_item(item), BIT_SCREEN)
                .map(|address| address.to_string())
                .collect();
            (shown[0].clone(), shown.len())
        };
        assert_eq!(names(17), ("X0016".to_owned(), 14));
        assert_eq!(names(30), ("Y0000".to_owned(), 16));
        assert_eq!(names(1626), ("R0992".to_owned(), 8));
    }
}
