//! The operating example of the manual (chapter III-11) in the window, with the mouse. The
//! window shows everything that the script of the case `operate-acceptance` expects.

use std::path::Path;

use crate::common::mouse_operator::MouseOperator;
use gsk_core::setup::Setup;
use gsk_core::units::Point;

#[test]
fn the_operating_example_with_the_mouse() {
    let setup = Setup {
        start: Some(Point::new(0.0, 0.0)),
        referenced: true,
        ..Setup::delivered()
    };
    let mut hand = MouseOperator::new(setup);
    let path = "../tests/cases/program-text/examples/operate-acceptance/operate.txt";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let text = std::fs::read_to_string(path).expect("the script of the operating example");
    hand.run_script(&text);
}
