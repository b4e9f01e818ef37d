use super::*;
use crate::keys::STRIP;

/// The model whose panel most tests paint.
const MAIN: ModelId = ModelId::Gsk980td;

#[test]
fn every_key_is_on_the_panel_once() {
    for model in ModelId::ALL {
        for row in face_of(model).keys() {
            let keys = parts(model)
                .iter()
                .filter(|part| part.key() == Some(row.key));
            assert_eq!(keys.count(), 1, "{model:?} {}", row.id);
            assert!(part_of(model, row.key).is_some());
        }
        let lamps = parts(model)
            .iter()
            .filter(|part| matches!(part.what, PartKind::Strip(_)))
            .count();
        assert_eq!(lamps, STRIP.len());
    }
}

#[test]
fn a_stop_key_is_at_the_same_position_on_every_panel() {
    for key in [Key::EmergencyStop, Key::FeedHold, Key::Reset] {
        for model in ModelId::ALL {
            assert_eq!(part_of(model, key), part_of(MAIN, key), "{model:?}");
        }
    }
}

#[test]
fn parts_of_one_layer_do_not_overlap_and_are_on_the_layer_below() {
    for model in ModelId::ALL {
        check_layers(parts(model));
    }
}

fn check_layers(parts: &[PanelPart]) {
    for (index, part) in parts.iter().enumerate() {
        for other in &parts[index + 1..] {
            assert!(part.layer <= other.layer, "drawing order");
            if part.layer == other.layer {
                assert!(!part.rect.overlaps(&other.rect), "{part:?}\n{other:?}");
            }
        }
        let supported = part.layer == 0
            || parts
                .iter()
                .any(|below| below.layer + 1 == part.layer && below.rect.encloses(&part.rect));
        assert!(supported, "{part:?}");
    }
}

#[test]
fn a_stretched_section_keeps_its_layers_its_lcd_and_its_circles() {
    for stretch in [(1.4, 1.0), (1.0, 1.4), (1.1, 1.1)] {
        for area in PanelArea::SECTIONS {
            let area = PanelArea { stretch, ..area };
            let stretched: Vec<PanelPart> = area.parts(MAIN).collect();
            // Parts that touch are rounded: the upper layers are a little smaller.
            let smaller = stretched.iter().map(|part| {
                let Rect { x, y, w, h } = part.rect;
                let by = 0.01 * f32::from(part.layer);
                let rect = Rect::new(x + by, y + by, w - 2.0 * by, h - 2.0 * by);
                PanelPart { rect, ..*part }
            });
            check_layers(&smaller.collect::<Vec<PanelPart>>());
            for part in &stretched {
                let (x, y) = part.rect.center();
                let found = area.part_at(MAIN, x, y).unwrap();
                assert!(found.layer > part.layer || found.what == part.what);
                match (part.what, part.outline) {
                    (PartKind::Lcd, _) => assert_eq!((part.rect.w, part.rect.h), (640.0, 480.0)),
                    (_, Outline::Round) => {
                        assert!((part.rect.w - part.rect.h).abs() < 0.01, "{part:?}");
                        let beside = x + part.rect.w / 2.0 + 1.0;
                        assert_ne!(
                            area.part_at(MAIN, beside, y).map(|it| it.what),
                            Some(part.what)
                        );
                    }
                    _ => {}
                }
            }
        }
    }
}

#[test]
fn names_of_lamps_are_readable_at_one_pixel_per_dot() {
    let lamps = parts(MAIN).iter().filter_map(|part| match part.what {
        PartKind::Strip(index) => Some((part, &STRIP[index])),
        _ => None,
    });
    for (part, lamp) in lamps.filter(|(_, lamp)| lamp.fitted) {
        let name = text::width(lamp.label, layout::LAMP_NAME_HEIGHT);
        assert!(layout::LAMP_NAME_LEFT + name <= part.rect.w, "{}", lamp.id);
        assert!(layout::LAMP_NAME_HEIGHT <= part.rect.h);
    }
    // A character is as wide as high; at one pixel per dot a unit is half a pixel.
    assert!(text::width("机", layout::LAMP_NAME_HEIGHT) * 0.5 >= 11.0);
}

#[test]
fn the_glass_is_inside_the_frame_and_has_the_colour_of_the_picture() {
    let part = lcd_part(MAIN).unwrap();
    let frame = parts(MAIN).iter().find(|part| part.what == PartKind::Bezel);
    let Rect { x, y, w, h } = part.rect;
    let wide = 2.0 * GLASS_MARGIN;
    let glass = Rect::new(x - GLASS_MARGIN, y - GLASS_MARGIN, w + wide, h + wide);
    assert!(frame.unwrap().rect.encloses(&glass));
    let dots = Pixmap::new(320, 240).unwrap();
    let state = FaceState {
        lcd: Some(LcdGlass {
            dots: dots.as_ref(),
            ground: [1, 2, 200],
        }),
        ..FaceState::default()
    };
    let picture = paint(PanelArea::WHOLE, &state, 1.0).unwrap();
    let margin = picture.pixel(x as u32 - 4, y as u32 + 100).unwrap();
    assert_eq!((margin.red(), margin.green(), margin.blue()), (1, 2, 200));
}

#[test]
fn the_frame_is_as_wide_at_each_side_when_it_is_stretched_in_one_direction() {
    let frame = frame_part(MAIN).unwrap();
    let state = FaceState::default();
    for stretch in [(1.0, 1.0), (1.1, 1.0), (1.0, 1.1), (1.3, 1.05)] {
        let area = PanelArea {
            stretch,
            ..PanelArea::SECTIONS[0]
        };
        let picture = paint(area, &state, 1.0).unwrap();
        let frame = area.stretched_rect(frame);
        let (left, top) = (frame.x - area.rect.x, frame.y - area.rect.y);
        let (middle_x, middle_y) = (left + frame.w / 2.0, top + frame.h / 2.0);
        let ground = PanelColour::Lcd.rgb();
        let is_glass = |x: u32, y: u32| {
            let dot = picture.pixel(x, y).unwrap();
            [dot.red(), dot.green(), dot.blue()] == ground
        };
        let row: Vec<u32> = (0..picture.width())
            .filter(|x| is_glass(*x, middle_y as u32))
            .collect();
        let column: Vec<u32> = (0..picture.height())
            .filter(|y| is_glass(middle_x as u32, *y))
            .collect();
        let widths = [
            row[0] as f32 - left,
            left + frame.w - row[row.len() - 1] as f32 - 1.0,
            column[0] as f32 - top,
            top + frame.h - column[column.len() - 1] as f32 - 1.0,
        ];
        let spread = widths
            .iter()
            .fold(0.0, |most, it| f32::max(most, (it - widths[0]).abs()));
        assert!(spread <= 1.0 && widths[0] >= 5.0, "{stretch:?}: {widths:?}");
    }
}

#[test]
fn a_label_too_small_to_read_is_left_out() {
    let part = parts(MAIN)
        .iter()
        .find(|part| part.what == PartKind::Emulator)
        .unwrap();
    let is_printed = |scale: f32| {
        let state = FaceState::default();
        let (picture, _) = paint_part(PanelArea::WHOLE, part, &state, scale).unwrap();
        let reds = picture.pixels().iter().map(|dot| dot.red());
        reds.clone().max().unwrap() - reds.min().unwrap() > 40
    };
    assert!(is_printed(0.45), "9.4 pixels high");
    assert!(!is_printed(0.4), "8.4 pixels high");
}

#[test]
fn legends_and_lamps_stay_inside_their_key() {
    for part in ModelId::ALL.into_iter().flat_map(parts) {
        for (line, rect) in part.legend() {
            assert!(part.rect.encloses(&rect), "{line}");
            let width = text::width(line, rect.h);
            assert!(width + 4.0 <= part.rect.w, "{line} is {width} wide");
            if let Some(lamp) = part.lamp() {
                assert!(!lamp.overlaps(&rect), "{line}");
                assert!(part.rect.encloses(&lamp));
            }
        }
    }
}

#[test]
fn every_part_is_in_one_of_the_areas() {
    let parts = ModelId::ALL.into_iter().flat_map(parts);
    for part in parts.filter(|part| part.what != PartKind::Housing) {
        let areas = PanelArea::SECTIONS
            .iter()
            .filter(|area| area.contains(part));
        assert_eq!(areas.count(), 1, "{part:?}");
        assert!(PanelArea::WHOLE.contains(part));
    }
}

#[test]
fn keys_of_the_cursor_are_no_smaller_than_letters() {
    let letter = part_of(MAIN, Key::O).unwrap();
    for key in [
        Key::Up,
        Key::Down,
        Key::Left,
        Key::Right,
        Key::PageUp,
        Key::PageDown,
    ] {
        let rect = part_of(MAIN, key).unwrap().rect;
        assert!(
            rect.w >= letter.rect.w && rect.h >= letter.rect.h,
            "{key:?}"
        );
    }
    let height = |key| part_of(MAIN, key).unwrap().legend()[0].1.h;
    assert!(height(Key::Up) >= height(Key::O));
}

#[test]
fn the_lcd_has_whole_dots_at_half_scales() {
    assert_eq!((lcd().w, lcd().h), (640.0, 480.0));
}

#[test]
fn the_pointer_finds_keys_by_their_outline() {
    let stop = part_of(MAIN, Key::EmergencyStop).unwrap().rect;
    let (x, y) = stop.center();
    assert_eq!(
        PanelArea::WHOLE
            .part_at(MAIN, x, y)
            .and_then(PanelPart::key),
        Some(Key::EmergencyStop)
    );
    assert_eq!(
        PanelArea::WHOLE
            .part_at(MAIN, stop.x + 1.0, stop.y + 1.0)
            .and_then(PanelPart::key),
        None
    );
    for row in face_of(MAIN).keys() {
        let (x, y) = part_of(MAIN, row.key).unwrap().rect.center();
        assert_eq!(
            PanelArea::WHOLE
                .part_at(MAIN, x, y)
                .and_then(PanelPart::key),
            Some(row.key)
        );
    }
    assert_eq!(PanelArea::WHOLE.part_at(MAIN, -1.0, 5.0), None);
}

#[test]
fn it_is_painted_at_any_scale() {
    let state = FaceState {
        y: &[0xff; 20],
        pressed: &[Key::EmergencyStop, Key::CycleStart],
        lcd: None,
        wheel: -7,
        real: false,
        model: ModelId::Gsk980td,
    };
    let picture = paint(PanelArea::WHOLE, &state, 1.0).unwrap();
    assert_eq!((picture.width(), picture.height()), (1280, 756));
    assert_ne!(
        picture,
        paint(PanelArea::WHOLE, &FaceState::default(), 1.0).unwrap()
    );
    assert!(paint(PanelArea::WHOLE, &state, 0.33).is_some());
    assert!(paint(PanelArea::WHOLE, &state, f32::NAN).is_none_or(|picture| picture.width() > 0));
}

#[test]
fn a_part_is_painted_as_in_the_whole_picture() {
    let state = FaceState {
        y: &[0xff; 20],
        pressed: &[Key::EmergencyStop, Key::CycleStart, Key::Auto],
        lcd: None,
        wheel: -7,
        real: false,
        model: ModelId::Gsk980td,
    };
    let scale = 1.37;
    for real in [false, true] {
        sections_as_in_the_whole(&FaceState { real, ..state }, scale);
    }
}

fn sections_as_in_the_whole(state: &FaceState<'_>, scale: f32) {
    for area in core::iter::once(PanelArea::WHOLE).chain(PanelArea::SECTIONS) {
        sections_as_in(area, state, scale);
    }
}

fn sections_as_in(area: PanelArea, state: &FaceState<'_>, scale: f32) {
    let whole = paint(area, state, scale).unwrap();
    for part in area.parts(state.model).filter(|part| part.layer > 1) {
        let part = &part;
        let (section, [left, top]) = paint_part(area, part, state, scale).unwrap();
        for (index, dot) in section.pixels().iter().enumerate() {
            let (x, y) = (
                index as u32 % section.width(),
                index as u32 / section.width(),
            );
            let there = whole.pixel(left + x, top + y).unwrap();
            let near = |one: u8, other: u8| one.abs_diff(other) <= 8;
            assert!(
                near(dot.red(), there.red())
                    && near(dot.green(), there.green())
                    && near(dot.blue(), there.blue()),
                "{part:?} at {x}, {y}: {dot:?}, {there:?}"
            );
        }
    }
}

#[test]
fn a_change_of_the_picture_changes_the_state() {
    let dark = FaceState::default();
    let lit = FaceState {
        y: &[0xff; 20],
        ..dark
    };
    let turned = FaceState { wheel: 1, ..dark };
    for part in parts(MAIN) {
        let key = part.key().filter(|key| *key != Key::EmergencyStop);
        let pressed: Vec<Key> = part.key().into_iter().collect();
        let down = FaceState {
            pressed: &pressed,
            ..dark
        };
        assert_eq!(
            part_state(part, &dark) != part_state(part, &down),
            part.key().is_some()
        );
        let lamp = match part.what {
            PartKind::Strip(index) => STRIP[index].fitted,
            _ => key.is_some_and(|key| key.row().lamp.is_some()),
        };
        assert_eq!(
            part_state(part, &dark) != part_state(part, &lit),
            lamp,
            "{part:?}"
        );
        let wheel = part.what == PartKind::Handwheel;
        assert_eq!(part_state(part, &dark) != part_state(part, &turned), wheel);
        let linked = FaceState { real: true, ..dark };
        let says = matches!(part.what, PartKind::Emulator | PartKind::RealMotion);
        assert_eq!(part_state(part, &dark) != part_state(part, &linked), says);
        let other = FaceState {
            model: ModelId::Ncb08,
            ..dark
        };
        assert_eq!(
            part_state(part, &dark) != part_state(part, &other),
            part.what == PartKind::Model
        );
    }
}

#[test]
fn the_name_is_that_of_the_model() {
    let part = parts(MAIN)
        .iter()
        .find(|part| part.what == PartKind::Model)
        .unwrap();
    let mut pictures = Vec::new();
    for model in ModelId::ALL {
        let state = FaceState {
            model,
            ..FaceState::default()
        };
        let (picture, _) = paint_part(PanelArea::WHOLE, part, &state, 1.0).unwrap();
        let edge = |x: u32| (0..picture.height()).map(move |y| (x, y));
        let ground = picture.pixel(0, picture.height() / 2).unwrap();
        let of_edges = edge(1).chain(edge(picture.width() - 2));
        let far = |(x, y): (u32, u32)| {
            let dot = picture.pixel(x, y).unwrap();
            dot.red().abs_diff(ground.red()) > 60
        };
        assert!(!of_edges.into_iter().any(far), "{model:?} leaves its room");
        assert!(!pictures.contains(&picture), "{model:?}");
        pictures.push(picture);
    }
}

#[test]
fn a_panel_with_a_real_machine_is_no_emulator() {
    let dots = |real: bool, what: PartKind| {
        let part = parts(MAIN).iter().find(|part| part.what == what).unwrap();
        let state = FaceState {
            real,
            ..FaceState::default()
        };
        paint_part(PanelArea::WHOLE, part, &state, 1.0).unwrap().0
    };
    let plain = |section: &Pixmap| {
        let row = |y: u32| (8..section.width() - 8).map(move |x| section.pixel(x, y).unwrap());
        (8..section.height() - 8).all(|y| row(y).all(|dot| dot == row(y).next().unwrap()))
    };
    assert!(!plain(&dots(false, PartKind::Emulator)));
    assert!(plain(&dots(true, PartKind::Emulator)), "the word is gone");
    assert!(plain(&dots(false, PartKind::RealMotion)));
    let badge = dots(true, PartKind::RealMotion);
    let red = |dot: &tiny_skia::PremultipliedColorU8| dot.red() > 150 && dot.green() < 90;
    let share = badge.pixels().iter().filter(|dot| red(dot)).count();
    assert!(share * 2 > badge.pixels().len(), "{share} red dots");
}
