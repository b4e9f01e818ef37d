use std::collections::BTreeSet;

use super::*;
use crate::glyphs::text_columns;
use crate::keys::{KEYS, MODEL_KEYS};
use gsk_messages::Language;

/// Width of a soft key label without the space after it, columns.
const LABEL_COLUMNS: usize = 6;

#[test]
fn the_gsk980td_has_the_keys_and_pages_of_its_tables() {
    let face = face_of(ModelId::Gsk980td);
    let keys: Vec<Key> = face.keys().map(|row| row.key).collect();
    assert_eq!(keys, KEYS.map(|row| row.key));
    assert!(MODEL_KEYS.iter().all(|row| face.key(row.key).is_none()));
    for (index, row) in PAGES.iter().enumerate() {
        assert_eq!(row.page as usize, index, "{}", row.name);
        assert_eq!(face.page_named(row.name), Some(row));
    }
}

#[test]
fn page_keys_wrap_inside_one_display() {
    let face = face_of(ModelId::Gsk980td);
    for (page, forward, next) in [
        (PageId::PosRel, true, PageId::PosAbs),
        (PageId::PosRel, false, PageId::PosPrg),
        (PageId::GraphPar, true, PageId::Graph),
        (PageId::Graph, true, PageId::GraphPar),
        (PageId::Password, true, PageId::SetCode),
        (PageId::Version, true, PageId::Version),
    ] {
        assert_eq!(face.neighbour(page, forward), next, "{page:?}");
    }
}

#[test]
fn displays_of_a_key_follow_each_other() {
    let face = face_of(ModelId::Gsk980td);
    for (key, display, page) in [
        (PageKey::Set, 1, PageId::GraphPar),
        (PageKey::Set, 2, PageId::SetCode),
        (PageKey::Dgn, 4, PageId::Version),
        (PageKey::Par, 3, PageId::ParBit),
        (PageKey::Alm, 0, PageId::Msg),
    ] {
        assert_eq!(face.first_of(key, display), page);
    }
    let face = face_of(ModelId::Ncb08);
    assert_eq!(face.first_of(PageKey::Set, 1), PageId::Udisk);
    assert_eq!(face.first_of(PageKey::Dgn, 0), PageId::Inputs);
    assert_eq!(face.first_of(PageKey::Teach, 0), PageId::Teach);
}

#[test]
fn pages_of_a_model_are_unique_and_named_as_everywhere() {
    for model in ModelId::ALL {
        let face = face_of(model);
        let pages: BTreeSet<PageId> = face.pages.iter().map(|row| row.page).collect();
        assert_eq!(pages.len(), face.pages.len(), "{model:?}");
        for row in face.pages {
            assert_eq!(row.page.name(), row.name, "{model:?}");
            // Every page is reached: its key or soft key opens its display.
            let first = face.first_of(row.key, row.display);
            let step = |page: &PageId| Some(face.neighbour(*page, true));
            let mut display = core::iter::successors(Some(first), step);
            assert!(
                display
                    .by_ref()
                    .take(face.pages.len())
                    .any(|page| page == row.page)
            );
        }
    }
}

#[test]
fn soft_keys_open_pages_of_their_main_function() {
    let face = face_of(ModelId::Hx31);
    for key in face.soft_keys {
        if let SoftAction::Open(page) = key.action {
            assert_eq!(
                face.page(page).map(|row| row.key),
                Some(key.group),
                "{page:?}"
            );
        }
        for language in [Language::En, Language::Zh] {
            let label = (key.label)().text(language);
            assert!(text_columns(&label) <= LABEL_COLUMNS, "{label}");
        }
    }
    for group in [PageKey::Program, PageKey::Operate, PageKey::Parameter] {
        for bar in 0..face.soft_bars(group) {
            let positions: Vec<u8> = face.soft_bar(group, bar).map(|key| key.position).collect();
            assert_eq!(positions, [0, 1, 2, 3, 4], "{group:?} {bar}");
        }
        let displays = face.pages.iter().filter(|row| row.key == group);
        for display in displays.map(|row| row.display) {
            let opened = |key: &&SoftKey| match key.action {
                SoftAction::Open(page) => face.page(page).is_some_and(|it| it.display == display),
                _ => false,
            };
            let mut keys = face.soft_keys.iter().filter(|key| key.group == group);
            assert!(keys.any(|key| opened(&key)), "{group:?} {display}");
        }
    }
}

#[test]
fn contacts_of_the_nc_b08_have_one_pin_each() {
    let face = face_of(ModelId::Ncb08);
    assert_eq!((face.inputs.len(), face.outputs.len()), (32, 24));
    for (contacts, wired) in [(face.inputs, 24), (face.outputs, 16)] {
        let pins = contacts.iter().map(|row| row.pin).filter(|pin| *pin != 0);
        let pins: Vec<u8> = pins.collect();
        let unique: BTreeSet<u8> = pins.iter().copied().collect();
        assert_eq!((pins.len(), unique.len()), (wired, wired));
        assert!(unique.iter().all(|pin| (1..=25).contains(pin)));
    }
}
