//! Handles `P`, a number and 输入: the cursor of a list page moves to that item.

use gsk_core::cnc::Cnc;
use gsk_core::plc::address::{Area, ByteAddress};

use super::Panel;
use super::navigation::item_count;
use crate::pages::{self, PageId};

impl Panel {
    /// Moves the cursor of a list page to the item in the input line (`P` and a number), if it
    /// exists.
    pub(super) fn search_item(&mut self, cnc: &Cnc) {
        let Some(wanted) = self.view.input.strip_prefix('P') else {
            return;
        };
        if let Some(item) = found(self.page, wanted.trim(), cnc) {
            self.view.cursors.get_mut(self.page).item = item;
        }
    }
}

fn found(page: PageId, wanted: &str, cnc: &Cnc) -> Option<usize> {
    if matches!(page, PageId::PlcBits | PageId::PlcValues) {
        return plc_item(page, wanted);
    }
    let number: usize = wanted.parse().ok()?;
    match page {
        PageId::Oft | PageId::Pitch | PageId::Dgn => {
            (number < item_count(page, cnc)).then_some(number)
        }
        PageId::Inputs | PageId::Outputs => (number < item_count(page, cnc)).then_some(number),
        PageId::ParModel => {
            let listed = pages::model_parameter_numbers(cnc);
            listed.iter().position(|it| usize::from(*it) == number)
        }
        PageId::Macro => {
            let mut listed = cnc.variable_numbers().into_iter();
            listed.position(|listed| usize::from(listed) == number)
        }
        PageId::ParBit => pages::state_numbers().position(|listed| usize::from(listed) == number),
        PageId::ParData => pages::data_numbers().position(|listed| usize::from(listed) == number),
        _ => None,
    }
}

/// Returns the item of a PLC address on the page, from 0; `None` if the address is not shown.
/// Letters without a key have substitutes: H is Y, I is A, J is C. U, the first character of
/// its key, is D.
fn plc_item(page: PageId, wanted: &str) -> Option<usize> {
    let letter = wanted.chars().next()?;
    let byte: u16 = wanted.get(1..)?.parse().ok()?;
    if page == PageId::PlcBits {
        let area = match letter {
            'X' => Area::X,
            'H' | 'Y' => Area::Y,
            'F' => Area::F,
            'G' => Area::G,
            'I' | 'A' => Area::A,
            'K' => Area::K,
            'R' => Area::R,
            _ => return None,
        };
        return (byte < area.count())
            .then(|| pages::bit_item_of(ByteAddress::new(area, byte)))
            .flatten();
    }
    let area = match letter {
        'D' | 'U' => Area::D,
        'T' => Area::T,
        'J' | 'C' => Area::C,
        _ => return None,
    };
    (byte < area.count())
        .then(|| pages::value_item_of(ByteAddress::new(area, byte)))
        .flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::setup::Setup;

    fn found_in(page: PageId, wanted: &str) -> Option<usize> {
        found(page, wanted, &Cnc::new(Setup::default()))
    }

    #[test]
    fn variables_of_macro_b_are_found() {
        let mut setup = Setup::default();
        setup.memory.settings.macro_b = true;
        let cnc = Cnc::new(setup);
        let found = |wanted| found(PageId::Macro, wanted, &cnc);
        assert_eq!(
            (found("1"), found("33"), found("34")),
            (Some(0), Some(32), None)
        );
        assert_eq!((found("100"), found("231")), (Some(33), Some(164)));
        assert_eq!(
            (found("500"), found("999"), found("1000")),
            (Some(165), Some(664), None)
        );
    }

    #[test]
    fn items_are_found_by_number() {
        assert_eq!(found_in(PageId::Oft, "07"), Some(7));
        assert_eq!(found_in(PageId::Oft, "33"), None);
        assert_eq!(found_in(PageId::Macro, "231"), Some(31));
        assert_eq!(found_in(PageId::Macro, "500"), Some(32));
        assert_eq!(found_in(PageId::Macro, "232"), None);
        assert_eq!(found_in(PageId::ParBit, "164"), Some(14));
        assert_eq!(found_in(PageId::ParData, "15"), Some(0));
        assert_eq!(found_in(PageId::ParData, "X"), None);
    }

    #[test]
    fn plc_addresses_are_found_in_any_length() {
        let seven = Some(7);
        for text in ["X7", "X07", "X007", "X0007"] {
            assert_eq!(found_in(PageId::PlcBits, text), seven, "{text}");
        }
        assert_eq!(found_in(PageId::PlcBits, "H0"), Some(30));
        assert_eq!(found_in(PageId::PlcBits, "X30"), None);
        assert_eq!(found_in(PageId::PlcBits, "\u{4f4d}1"), None);
        assert_eq!(found_in(PageId::PlcValues, "U1"), Some(1));
        assert_eq!(found_in(PageId::PlcValues, "T0"), Some(1000));
        assert_eq!(found_in(PageId::PlcValues, "J2"), Some(1102));
    }
}
