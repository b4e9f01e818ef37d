//! Random values of every form: the text is read again exactly, the check of its program finds
//! nothing, and the part has the dimensions of the form.

#![allow(clippy::panic, clippy::unwrap_used, reason = "tests fail by panicking")]

mod contours;
mod cut;
mod random;
mod shapes;

use cut::CutPart;
use gsk_forms::{FormKind, FormValues, find_sections, write_form};
use random::Random;

/// Programs for each form; 9 forms.
const PROGRAMS: usize = 40;
/// Greatest difference between the part and the form, mm.
const TOLERANCE_MM: f64 = 0.002;

/// Writes random forms of a kind, and checks each text and its part.
fn check_form(form: FormKind, fill_in: fn(&mut Random, &mut FormValues), measure: fn(&CutPart)) {
    let mut random = Random::new(form as u64 + 1);
    for number in 0..PROGRAMS {
        let mut values = FormValues::new(form);
        random::fill_in_machine(&mut random, &mut values);
        fill_in(&mut random, &mut values);
        let section = write_form(&values);
        let section = section.unwrap_or_else(|error| panic!("{number} {values:?}: {error:?}"));
        let found = find_sections(&section);
        assert_eq!(found.len(), 1, "{section}");
        assert!(!found[0].is_edited, "{section}");
        let again = found[0].values.as_ref().unwrap();
        assert_eq!(*again, values.complete(), "{section}");
        assert_eq!(write_form(again).unwrap(), section);
        measure(&CutPart::cut(values, section));
    }
}

#[test]
fn faces_end_at_zero() {
    check_form(FormKind::Face, random::face, shapes::face);
}

#[test]
fn turned_parts_have_diameter_edge_and_shoulder() {
    check_form(FormKind::Turn, random::turn, shapes::turned);
}

#[test]
fn bores_have_diameter_edge_and_shoulder() {
    check_form(FormKind::Bore, random::bore, shapes::turned);
}

#[test]
fn contours_follow_their_points() {
    check_form(FormKind::Contour, random::contour, shapes::contour);
}

#[test]
fn grooves_have_walls_and_bottom() {
    check_form(FormKind::Groove, random::groove, shapes::groove);
}

#[test]
fn parts_are_cut_off_at_their_length() {
    check_form(FormKind::PartOff, random::part_off, shapes::part_off);
}

#[test]
fn threads_have_pitch_crest_and_root() {
    check_form(FormKind::Thread, random::thread, shapes::thread);
}

#[test]
fn holes_have_diameter_and_depth() {
    check_form(FormKind::Drill, random::drill, shapes::drill);
}

#[test]
fn centre_holes_have_their_diameter_at_the_face() {
    check_form(FormKind::Center, random::center, shapes::center);
}
