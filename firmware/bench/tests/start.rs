//! The firmware starts, answers, and reports a reset.

use gsk_motion::messages::{Command, Response};
use pico_bench::{Bench, CRC};

#[test]
fn the_board_reports_its_start_and_answers() {
    let mut bench = Bench::start();
    println!("started after {:.2} ms", bench.cycle() as f64 / 125e3);
    bench.configure();
    let config = bench.query(Command::GetConfig, &[], Response::Config);
    assert_eq!(config.values[..3], [1, CRC as u32, 0]);
    assert_eq!(bench.shutdown_text(), None);
}

#[test]
fn a_reset_is_reported_and_the_configuration_is_forgotten() {
    let mut bench = Bench::start();
    bench.configure();
    bench.replies.clear();
    bench.press_reset();
    let is_reported = bench.run_until(40_000_000, |bench| bench.find(Response::Starting).is_some());
    assert!(is_reported);
    let config = bench.query(Command::GetConfig, &[], Response::Config);
    assert_eq!(config.values[..3], [0, 0, 0]);
}

#[test]
fn no_step_comes_before_the_lease_with_the_hash_of_the_configuration() {
    for crc in [None, Some(CRC + 1)] {
        let mut bench = Bench::start();
        bench.configure();
        let clock = bench.clock() as u32;
        if let Some(crc) = crc {
            bench.send(Command::RenewLease, &[crc, i64::from(clock) + 1_562_500]);
        }
        bench.send(Command::ResetStepClock, &[0, i64::from(clock) + 100_000]);
        bench.send(Command::QueueStep, &[0, 1000, 100, 0]);
        bench.run(5_000_000);
        assert_eq!(bench.edges, []);
        let text = bench.shutdown_text();
        let expected = if crc.is_some() {
            "Lease for another configuration"
        } else {
            "Motion without lease or armed trsync"
        };
        assert_eq!(text, Some(expected));
    }
}
