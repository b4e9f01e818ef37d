use super::*;

#[test]
fn the_table_has_the_order_of_the_enum() {
    for (index, row) in all_rows().enumerate() {
        assert_eq!(row.key as usize, index, "{}", row.id);
        assert_eq!(row.key.row(), row);
    }
}

#[test]
fn every_key_is_labelled_and_named() {
    for row in all_rows() {
        assert!(!row.legend.is_empty(), "{}", row.id);
        assert!(row.legend.iter().all(|line| !line.trim().is_empty()));
        assert!(!row.name_zh.is_empty() && !row.name_en.is_empty());
        assert!(row.name_en.is_ascii());
        assert!(!row.pc.is_empty());
    }
}

#[test]
fn ids_names_bindings_contacts_and_lamps_are_unique() {
    let mut ids: Vec<String> = all_rows().map(|row| row.id.to_ascii_uppercase()).collect();
    ids.extend(STRIP.iter().map(|lamp| lamp.id.to_owned()));
    assert_unique(ids);
    assert_unique(all_rows().map(|row| row.pc).collect());
    assert_unique(all_rows().map(|row| row.name_zh).collect());
    assert_unique(all_rows().map(|row| row.name_en).collect());
    assert_unique(all_rows().filter_map(|row| row.key.contact()).collect());
    let mut lamps: Vec<Bit> = all_rows().filter_map(|row| row.lamp).collect();
    lamps.extend(STRIP.iter().map(|lamp| lamp.lamp));
    assert_unique(lamps);
}

fn assert_unique<T: Ord + core::fmt::Debug + Clone>(mut all: Vec<T>) {
    all.sort();
    for pair in all.windows(2) {
        assert_ne!(pair[0], pair[1]);
    }
}

#[test]
fn every_contact_of_the_key_matrix_has_its_key() {
    // PLC-I 3.1.2: X20.0 to X26.0 without the cells that have no key.
    let mut contacts: Vec<Bit> = (20..25)
        .flat_map(|byte| (0..8).map(move |bit| Bit::new(byte, bit)))
        .filter(|bit| ![Bit::new(22, 2), Bit::new(23, 0)].contains(bit))
        .collect();
    contacts.extend([Bit::new(25, 0), Bit::new(26, 0)]);
    let mut found: Vec<Bit> = KEYS.iter().filter_map(|row| row.key.contact()).collect();
    found.sort();
    assert_eq!(found, contacts);
}

#[test]
fn every_lamp_of_the_keys_is_in_a_key() {
    // Y5.0 to Y9.1. Y9.1 is on the strip.
    let expected: Vec<Bit> = (5..9)
        .flat_map(|byte| (0..8).map(move |bit| Bit::new(byte, bit)))
        .chain([Bit::new(9, 0)])
        .collect();
    let mut found: Vec<Bit> = KEYS.iter().filter_map(|row| row.lamp).collect();
    found.sort();
    assert_eq!(found, expected);
}

#[test]
fn the_keys_of_the_manual_are_all_there() {
    for id in "EDIT AUTO MDI ZRN HND JOG PZRN SBK BDT MLK AFL DRN I1 I10 I100 HX HZ HY XM XP ZM \
               ZP YM YP RT M3 M5 M4 M8 M32 TC SP+ SP- RP+ RP- FD+ FD- FH CS RESET IN OUT CHG CAN \
               INS DEL EOB UP DOWN LEFT RIGHT PGUP PGDN POS PRG OFT ALM SET PAR DGN ESTOP OTREL \
               O N G X Z U W S T M P R I K J F L H / 7 8 9 4 5 6 1 2 3 - 0 . D/U P/Q J/C H/Y"
        .split_whitespace()
    {
        assert!(Key::from_id(id).is_some(), "{id}");
    }
    assert_eq!(Key::from_id("d/u"), Some(Key::U));
    assert_eq!(Key::from_id("cs"), Some(Key::CycleStart));
    assert_eq!(
        Key::from_id("XM").and_then(Key::contact),
        Some(Bit::new(22, 3))
    );
}

#[test]
fn every_character_is_entered_by_one_key() {
    for character in "ONGXZUWSTMPRIKJFLH/0123456789-.".chars() {
        let enters =
            |row: &&KeyRow| matches!(row.role, KeyRole::Character(first, _) if first == character);
        assert_eq!(KEYS.iter().filter(enters).count(), 1, "{character}");
    }
}

#[test]
fn an_unknown_id_has_neighbours() {
    assert!(near_ids("AUT").contains(&"AUTO"));
    assert!(near_ids("CYCLE").contains(&"CS"));
    assert!(near_ids("XQWERTY").is_empty());
    assert_eq!(distance("kitten", "sitting"), 3);
}

#[test]
fn lamps_are_found_by_their_key_or_strip_name() {
    assert_eq!(lamp_of("SBK"), Some(Bit::new(6, 7)));
    assert_eq!(lamp_of("s-sbk"), Some(Bit::new(4, 3)));
    assert_eq!(lamp_of("POS"), None);
    assert!(Bit::new(1, 3).is_set_in(&[0, 8]));
    assert!(!Bit::new(2, 3).is_set_in(&[0, 8]));
}
