//! Solids on pictures: their size, what covers what, and what no input may do.

use gsk_workpiece::grid::{GridContour, GridPoint, grid};
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::Tool;
use proptest::prelude::*;

use super::*;

fn rectangle(z: (f64, f64), x: (f64, f64)) -> Region {
    let corner = |z, x| GridPoint::new(grid(z), grid(x));
    Region::rectangle(corner(z.0, x.0), corner(z.1, x.1))
}

/// A picture of 400 by 300 at 4 pixels a millimetre about Z −40.
fn picture(bodies: &[Body], turn: Turn) -> Vec<Pixel> {
    let view = View {
        turn,
        centre: (-40.0, 0.0),
        scale: 4.0,
    };
    let bodies = bodies.iter().map(|body| (body, (0.0, 0.0)));
    Canvas::default().draw(bodies, &view, (400, 300), 1)
}

fn at(picture: &[Pixel], column: usize, row: usize) -> Pixel {
    picture[row * 400 + column]
}

/// Columns and rows that are covered: first and behind the last.
fn box_of(picture: &[Pixel]) -> [usize; 4] {
    let covered = |index: &usize| picture[*index][3] > 0;
    let places: Vec<usize> = (0..picture.len()).filter(covered).collect();
    let columns = places.iter().map(|it| it % 400);
    let rows = places.iter().map(|it| it / 400);
    [
        columns.clone().min().unwrap(),
        columns.max().unwrap() + 1,
        rows.clone().min().unwrap(),
        rows.max().unwrap() + 1,
    ]
}

const FLAT: Turn = Turn::flat(true);

#[test]
fn a_cylinder_is_as_large_as_its_section() {
    let bar = rectangle((-80.0, 0.0), (0.0, 25.0));
    let bodies = part(&bar, &bar, Fineness::of(4.0));
    for turn in [FLAT, Turn::flat(false)] {
        // 80 mm and 50 mm, 4 pixels each, about the middle; a line stands over by half.
        let [left, right, top, bottom] = box_of(&picture(&bodies, turn));
        for (found, wanted) in [(left, 40), (right, 360), (top, 50), (bottom, 250)] {
            assert!(found.abs_diff(wanted) <= 1, "{found} for {wanted}");
        }
    }
    // Seen at an angle of 30° it is shorter, and its faces are ellipses.
    let turned = FLAT.turned(30.0, 0.0);
    let [left, right, top, bottom] = box_of(&picture(&bodies, turned));
    let long = 4.0 * (80.0 * 0.866_025 + 2.0 * 25.0 * 0.5);
    assert!(
        (right - left).abs_diff(long as usize) <= 2,
        "{left} {right}"
    );
    assert!((bottom - top).abs_diff(200) <= 1, "{top} {bottom}");
}

#[test]
fn a_small_cylinder_behind_a_large_one_is_not_seen() {
    let large = rectangle((-60.0, -40.0), (0.0, 30.0));
    let small = rectangle((-80.0, -60.0), (0.0, 10.0));
    let none = Region::default();
    let fineness = Fineness::of(4.0);
    // Nearly along the axis, from the end of +Z: the small one lies behind.
    let turn = FLAT.turned(-70.0, 0.0);
    let alone = picture(&part(&large, &none, fineness), turn);
    for order in [[&large, &small], [&small, &large]] {
        let bodies = order.map(|region| part(region, &none, fineness));
        let both = picture(&bodies.concat(), turn);
        // Through the cut-out quarter, up and to the viewer, it may be seen.
        let below = 160 * 400;
        assert_eq!(&both[below..], &alone[below..]);
    }
    let turn = FLAT.turned(70.0, 0.0);
    let bodies = [&large, &small].map(|region| part(region, &none, fineness));
    assert_ne!(picture(&bodies.concat(), turn), picture(&bodies[0], turn));
}

#[test]
fn through_the_cut_out_quarter_the_section_is_seen() {
    let tube = rectangle((-80.0, 0.0), (10.0, 25.0));
    let seen = picture(&part(&tube, &Region::default(), Fineness::of(4.0)), FLAT);
    let warm = |pixel: Pixel| pixel[3] == 255 && pixel[0] > pixel[2].saturating_add(40);
    // X 20 above the axis: the section; X 20 below: steel from outside.
    assert!(warm(at(&seen, 203, 150 - 80)), "{:?}", at(&seen, 203, 70));
    let below = at(&seen, 203, 150 + 80);
    assert!(below[3] == 255 && !warm(below), "{below:?}");
    // X 5 above it: the bore behind the plane.
    let bore = at(&seen, 203, 150 - 20);
    assert!(bore[3] == 255 && !warm(bore), "{bore:?}");
}

#[test]
fn what_was_cut_looks_other_than_the_stock() {
    let stock = rectangle((-80.0, 0.0), (0.0, 25.0));
    let turned = stock.difference(rectangle((-40.0, 1.0), (20.0, 26.0)).contours());
    let seen = picture(&part(&turned, &stock, Fineness::of(4.0)), FLAT);
    let [cut, skin] = [280, 120].map(|column| at(&seen, column, 150 + 40));
    assert!(cut[2] > skin[2] + 10, "{cut:?} {skin:?}");
}

#[test]
fn a_tool_that_stands_in_the_part_is_seen_before_its_section() {
    let bar = rectangle((-80.0, 0.0), (0.0, 25.0));
    let fineness = Fineness::of(4.0);
    let part = part(&bar, &bar, fineness);
    let tool = tool(&Tool::turning(), fineness);
    for turn in [FLAT, Turn::oblique(true)] {
        let mut seen = [0, 0];
        for (count, with) in seen.iter_mut().zip([false, true]) {
            let view = View {
                turn,
                centre: (-40.0, 10.0),
                scale: 4.0,
            };
            let part = part.iter().filter(|_| with).map(|body| (body, (0.0, 0.0)));
            let tool = tool.iter().map(|body| (body, (-40.0, 10.0)));
            let picture = Canvas::default().draw(part.chain(tool), &view, (40, 40), 1);
            let gold = |pixel: &&Pixel| pixel[1] > 150 && pixel[2] < pixel[1] / 2;
            *count = picture.iter().filter(gold).count();
        }
        assert!(seen[0] > 100 && seen[1] >= seen[0] * 9 / 10, "{seen:?}");
    }
}

#[test]
fn the_same_bodies_make_the_same_picture() {
    let stock = Stock::bar(50.0, 0.0, 60.0);
    let draw = || {
        let fineness = Fineness::of(4.0);
        let mut bodies = part(&stock.section(), &Region::default(), fineness).to_vec();
        bodies.extend(clamping(&stock, false, fineness));
        bodies.extend(tool(&Tool::turning(), fineness));
        picture(&bodies, Turn::oblique(false))
    };
    assert_eq!(draw(), draw());
}

#[test]
fn a_view_that_fits_shows_everything() {
    let stock = Stock::bar(50.0, 0.0, 60.0);
    let bar = stock.section();
    let bodies = part(&bar, &bar, Fineness::of(4.0));
    for turn in [
        FLAT,
        Turn::flat(false),
        Turn::oblique(true),
        Turn::oblique(false),
    ] {
        let view = View::fit(turn, [&bar], (400, 300), 20.0);
        let bodies = bodies.iter().map(|body| (body, (0.0, 0.0)));
        let seen = Canvas::default().draw(bodies, &view, (400, 300), 2);
        let [left, right, top, bottom] = box_of(&seen);
        assert!(left >= 18 && right <= 382 && top >= 18 && bottom <= 282);
        assert!(left <= 22 && right >= 378 || top <= 22 && bottom >= 278);
    }
}

#[test]
fn nothing_and_no_size_make_no_trouble() {
    let none = Region::default();
    let fineness = Fineness::of(4.0);
    let bodies = part(&none, &none, fineness);
    assert!(picture(&bodies, FLAT).iter().all(|pixel| *pixel == [0; 4]));
    let fitted = View::fit(FLAT, [&none], (0, 0), 20.0);
    let bar = rectangle((-80.0, 0.0), (0.0, 25.0));
    let bodies = part(&bar, &none, Fineness::of(f32::INFINITY));
    let mut canvas = Canvas::default();
    for size in [(0, 0), (1, 1), (0, 7), (7, 0), (3, 200)] {
        for scale in [
            fitted.scale,
            0.0,
            -1.0,
            1e-30,
            1e30,
            f32::NAN,
            f32::INFINITY,
        ] {
            for samples in [0, 1, 2, 100] {
                let view = View { scale, ..fitted };
                let bodies = bodies.iter().map(|body| (body, (0.0, 0.0)));
                let seen = canvas.draw(bodies, &view, size, samples);
                assert_eq!(seen.len(), size.0 * size.1);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn no_region_makes_a_panic(
        corners in prop::collection::vec((-900_000..900_000_i32, -20_000..600_000_i32), 0..24),
        more in prop::collection::vec((-90..90_i32, 0..60_i32), 0..8),
        yaw in -90.0..90.0_f32,
        pitch in -90.0..90.0_f32,
        rear: bool,
        scale in 0.01..4000.0_f32,
    ) {
        let contour = |points: &[(i32, i32)]| -> GridContour {
            points.iter().map(|(z, x)| GridPoint::new(*z, *x)).collect()
        };
        let region = Region::from_contours(&[contour(&corners), contour(&more)]);
        let bodies = part(&region, &Region::from_contours(&[contour(&corners)]), Fineness::of(scale));
        let view = View {
            turn: Turn::oblique(rear).turned(yaw, pitch),
            centre: (0.0, 0.0),
            scale,
        };
        let bodies = bodies.iter().map(|body| (body, (1.0, -1.0)));
        Canvas::default().draw(bodies, &view, (64, 48), 1);
    }
}
