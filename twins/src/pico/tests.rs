use super::*;

const MS: u64 = 1_000_000;

#[test]
fn the_board_starts_and_answers_with_its_dictionary() {
    let mut twin = PicoTwin::new();
    twin.advance(19 * MS);
    assert_eq!(twin.state(), PicoState::Booting);
    twin.advance(2 * MS);
    assert_eq!((twin.state(), twin.starts()), (PicoState::Running, 1));
    twin.read();
    // identify offset=0 count=40.
    let block = gsk_motion::encode_block(0, &[1, 0, 40]);
    twin.write(&block);
    twin.advance(10 * MS);
    let answer = twin.read();
    assert_eq!(answer[2..4], [0, 0], "{answer:02X?}");
    assert_eq!(answer[5..7], DICTIONARY[..2]);
    twin.press_reset();
    twin.advance(21 * MS);
    assert_eq!(twin.starts(), 2);
}

#[test]
fn a_load_slows_the_spindle_down_for_its_turns() {
    let mut twin = PicoTwin::new();
    twin.attach_spindle(SpindleEncoderWiring {
        index_pin: 18,
        direction_pins: None,
        speed_pin: None,
        counts_per_turn: 4096,
        full_speed_rpm: 0.0,
        time_constant_s: 0.0,
    });
    twin.run_spindle(600.0);
    twin.set_load(Some(SpindleLoad {
        stepper: 0,
        interval: [1, 100],
        lost_share: 0.4,
        turns: 0.5,
    }));
    twin.advance(100 * MS);
    assert!((twin.spindle_turns() - 1.3).abs() < 1e-3);
    twin.place_slides([5, 0]);
    twin.advance(50 * MS);
    assert!((twin.spindle_turns() - 1.6).abs() < 1e-3);
    twin.advance(100 * MS);
    // Half a turn at 6 turns/s takes 83 ms.
    assert!((twin.spindle_turns() - 2.467).abs() < 2e-3);
}
