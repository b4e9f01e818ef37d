//! Tests pictures of solids: their size, what covers what, and robustness against any input.

use gsk_workpiece::grid::{GridContour, GridPoint, grid};
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::Tool;
use proptest::prelude::*;

use super::*;

fn rectangle(z: (f64, f64), x: (f64, f64)) -> Region {
    let corner = |z, x| GridPoint::new(grid(z), grid(x));
    Region::rectangle(corner(z.0, x.0), corner(z.1, x.1))
}

/// Draws bodies on a picture of 400 by 300 pixels, at 4 pixels per millimetre, around Z −40.
fn picture(bodies: &[SolidBody], turn: ViewDirection) -> Vec<SolidPixel> {
    let view = SolidView {
        direction: turn,
        centre: (-40.0, 0.0),
        pixels_per_mm: 4.0,
    };
    let bodies = bodies.iter().map(|body| (body, (0.0, 0.0)));
    SolidCanvas::default().draw(bodies, &view, (400, 300), 1)
}

fn at(picture: &[SolidPixel], column: usize, row: usize) -> SolidPixel {
    picture[row * 400 + column]
}

/// The covered columns and rows: first column, the one after the last, first row, the one
/// after the last.
fn covered_box(picture: &[SolidPixel]) -> [usize; 4] {
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

const FLAT: ViewDirection = ViewDirection::flat(true);

#[test]
fn a_cylinder_is_as_large_as_its_section() {
    let bar = rectangle((-80.0, 0.0), (0.0, 25.0));
    let bodies = part_bodies(&bar, &bar, BodyResolution::for_scale(4.0));
    for turn in [FLAT, ViewDirection::flat(false)] {
        // 80 mm and 50 mm, 4 pixels each, about the middle; a line sticks out by half its
        // width.
        let [left, right, top, bottom] = covered_box(&picture(&bodies, turn));
        for (found, wanted) in [(left, 40), (right, 360), (top, 50), (bottom, 250)] {
            assert!(found.abs_diff(wanted) <= 1, "{found} for {wanted}");
        }
    }
    // Seen at an angle of 30° it is shorter, and its faces are ellipses.
    let turned = FLAT.turn_by(30.0, 0.0);
    let [left, right, top, bottom] = covered_box(&picture(&bodies, turned));
    let long = 4.0 * (80.0 * 0.866_025 + 2.0 * 25.0 * 0.5);
    assert!(
        (right - left).abs_diff(long as usize) <= 2,
        "{left} {right}"
    );
    assert!((bottom - top).abs_diff(200) <= 1, "{top} {bottom}");
}

#[test]
fn a_large_cylinder_hides_a_small_one() {
    let large = rectangle((-60.0, -40.0), (0.0, 30.0));
    let small = rectangle((-80.0, -60.0), (0.0, 10.0));
    let none = Region::default();
    let fineness = BodyResolution::for_scale(4.0);
    // Nearly along the axis, from the end of +Z: the large one hides the small one.
    let turn = FLAT.turn_by(-70.0, 0.0);
    let alone = picture(&part_bodies(&large, &none, fineness), turn);
    for order in [[&large, &small], [&small, &large]] {
        let bodies = order.map(|region| part_bodies(region, &none, fineness));
        let both = picture(&bodies.concat(), turn);
        // Through the cut-out quarter, up and to the viewer, it may be visible.
        let below = 160 * 400;
        assert_eq!(&both[below..], &alone[below..]);
    }
    let turn = FLAT.turn_by(70.0, 0.0);
    let bodies = [&large, &small].map(|region| part_bodies(region, &none, fineness));
    assert_ne!(picture(&bodies.concat(), turn), picture(&bodies[0], turn));
}

#[test]
fn through_the_cut_out_quarter_the_section_is_seen() {
    let tube = rectangle((-80.0, 0.0), (10.0, 25.0));
    let seen = picture(
        &part_bodies(&tube, &Region::default(), BodyResolution::for_scale(4.0)),
        FLAT,
    );
    let warm = |pixel: SolidPixel| pixel[3] == 255 && pixel[0] > pixel[2].saturating_add(40);
    // X 20 above the axis: the section; X 20 below: steel from outside.
    assert!(warm(at(&seen, 203, 150 - 80)), "{:?}", at(&seen, 203, 70));
    let below = at(&seen, 203, 150 + 80);
    assert!(below[3] == 255 && !warm(below), "{below:?}");
    // X 5 above it: the bore on the far side of the plane.
    let bore = at(&seen, 203, 150 - 20);
    assert!(bore[3] == 255 && !warm(bore), "{bore:?}");
}

#[test]
fn cut_surfaces_look_different_from_the_stock() {
    let stock = rectangle((-80.0, 0.0), (0.0, 25.0));
    let turned = stock.difference(rectangle((-40.0, 1.0), (20.0, 26.0)).contours());
    let seen = picture(
        &part_bodies(&turned, &stock, BodyResolution::for_scale(4.0)),
        FLAT,
    );
    let [cut, skin] = [280, 120].map(|column| at(&seen, column, 150 + 40));
    assert!(cut[2] > skin[2] + 10, "{cut:?} {skin:?}");
}

#[test]
fn a_tool_that_stands_in_the_part_is_seen_before_its_section() {
    let bar = rectangle((-80.0, 0.0), (0.0, 25.0));
    let fineness = BodyResolution::for_scale(4.0);
    let part = part_bodies(&bar, &bar, fineness);
    let tool = tool_bodies(&Tool::turning(), fineness);
    for turn in [FLAT, ViewDirection::oblique(true)] {
        let mut seen = [0, 0];
        for (count, with) in seen.iter_mut().zip([false, true]) {
            let view = SolidView {
                direction: turn,
                centre: (-40.0, 10.0),
                pixels_per_mm: 4.0,
            };
            let part = part.iter().filter(|_| with).map(|body| (body, (0.0, 0.0)));
            let tool = tool.iter().map(|body| (body, (-40.0, 10.0)));
            let picture = SolidCanvas::default().draw(part.chain(tool), &view, (40, 40), 1);
            let gold = |pixel: &&SolidPixel| pixel[1] > 150 && pixel[2] < pixel[1] / 2;
            *count = picture.iter().filter(gold).count();
        }
        assert!(seen[0] > 100 && seen[1] >= seen[0] * 9 / 10, "{seen:?}");
    }
}

#[test]
fn the_same_bodies_make_the_same_picture() {
    let stock = Stock::bar(50.0, 0.0, 60.0);
    let draw = || {
        let fineness = BodyResolution::for_scale(4.0);
        let mut bodies = part_bodies(&stock.section(), &Region::default(), fineness).to_vec();
        bodies.extend(clamping_bodies(&stock, false, fineness));
        bodies.extend(tool_bodies(&Tool::turning(), fineness));
        picture(&bodies, ViewDirection::oblique(false))
    };
    assert_eq!(draw(), draw());
}

#[test]
fn a_view_that_fits_shows_everything() {
    let stock = Stock::bar(50.0, 0.0, 60.0);
    let bar = stock.section();
    let bodies = part_bodies(&bar, &bar, BodyResolution::for_scale(4.0));
    for turn in [
        FLAT,
        ViewDirection::flat(false),
        ViewDirection::oblique(true),
        ViewDirection::oblique(false),
    ] {
        let view = SolidView::fit(turn, [&bar], (400, 300), 20.0);
        let bodies = bodies.iter().map(|body| (body, (0.0, 0.0)));
        let seen = SolidCanvas::default().draw(bodies, &view, (400, 300), 2);
        let [left, right, top, bottom] = covered_box(&seen);
        assert!(left >= 18 && right <= 382 && top >= 18 && bottom <= 282);
        assert!(left <= 22 && right >= 378 || top <= 22 && bottom >= 278);
    }
}

#[test]
fn nothing_and_no_size_make_no_trouble() {
    let none = Region::default();
    let fineness = BodyResolution::for_scale(4.0);
    let bodies = part_bodies(&none, &none, fineness);
    assert!(picture(&bodies, FLAT).iter().all(|pixel| *pixel == [0; 4]));
    let fitted = SolidView::fit(FLAT, [&none], (0, 0), 20.0);
    let bar = rectangle((-80.0, 0.0), (0.0, 25.0));
    let bodies = part_bodies(&bar, &none, BodyResolution::for_scale(f32::INFINITY));
    let mut canvas = SolidCanvas::default();
    for size in [(0, 0), (1, 1), (0, 7), (7, 0), (3, 200)] {
        for scale in [
            fitted.pixels_per_mm,
            0.0,
            -1.0,
            1e-30,
            1e30,
            f32::NAN,
            f32::INFINITY,
        ] {
            for samples in [0, 1, 2, 100] {
                let view = SolidView {
                    pixels_per_mm: scale,
                    ..fitted
                };
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
        let bodies = part_bodies(&region, &Region::from_contours(&[contour(&corners)]), BodyResolution::for_scale(scale));
        let view = SolidView {
            direction: ViewDirection::oblique(rear).turn_by(yaw, pitch),
            centre: (0.0, 0.0),
            pixels_per_mm: scale,
        };
        let bodies = bodies.iter().map(|body| (body, (1.0, -1.0)));
        SolidCanvas::default().draw(bodies, &view, (64, 48), 1);
    }
}
