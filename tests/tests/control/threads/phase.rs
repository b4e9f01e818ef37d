//! Position of the groove: phase of passes and starts, lead-in and tail.

use gsk_core::command::MotionCode;
use gsk_core::machine::LatheFault;
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};

use super::run::ThreadRun;

/// One pulse of Z, mm.
const PULSE_MM: f64 = 0.001;

/// Feed override down and up.
const OVERRIDES: [BitAddress; 2] = [
    BitAddress::new(Area::X, 24, 6),
    BitAddress::new(Area::X, 24, 3),
];

/// Distance of two angles, turns.
fn turn_distance(one: f64, other: f64) -> f64 {
    let apart = (one - other).abs().fract();
    apart.min(1.0 - apart)
}

#[test]
fn passes_meet_the_same_groove_at_every_speed_and_start() {
    const LEAD: f64 = 2.0;
    let direct = [(110, 1), (111, 1)];
    for (rpm, starts, gearing) in [
        (200, 1u32, direct),
        (200, 2, direct),
        (200, 5, direct),
        (600, 1, direct),
        (600, 2, direct),
        (600, 5, direct),
        (1500, 1, direct),
        (1500, 2, direct),
        (1500, 5, direct),
        (500, 3, [(110, 2), (111, 1)]),
        (500, 3, [(110, 3), (111, 2)]),
        (500, 3, [(110, 1), (111, 2)]),
    ] {
        let text = format!(
            "O0001\nM03 S{rpm}\nG04 X2\nG00 X40 Z5\n\
                 G92 X39 Z-30 F{LEAD} J0 L{starts}\nX38.5\nX38.2\nM30\n"
        );
        let mut run = ThreadRun::started(&text, &gearing);
        let mut phases = Vec::new();
        let mut before = run.z();
        let mut overrides = Vec::new();
        for tick in 0u32.. {
            if run.state() != RunState::Run {
                break;
            }
            // The operator changes the feed override all the time.
            let key = OVERRIDES[tick as usize / 1600 % 2];
            let down = tick % 200 < 100;
            run.simulation.cnc.set_panel_key(key, down);
            overrides.push(run.simulation.cnc.feed_override());
            run.tick();
            let slides = run.simulation.lathe.slide_position();
            if before > -10.0
                && slides.z <= -10.0
                && run.simulation.cnc.modal().motion == MotionCode::ThreadCycle
            {
                let turns = run.simulation.lathe.spindle_degrees() / 360.0;
                phases.push((turns + slides.z / LEAD).rem_euclid(1.0));
            }
            before = slides.z;
        }
        assert_eq!(run.alarm(), None);
        overrides.sort_unstable();
        overrides.dedup();
        assert!(overrides.len() > 5, "{overrides:?}");
        assert_eq!(phases.len() as u32, 3 * starts);
        for (pass, phase) in phases.iter().enumerate() {
            let share = f64::from(pass as u32 % starts) / f64::from(starts);
            let error = turn_distance(phase - phases[0], share) * LEAD;
            assert!(
                error <= PULSE_MM + 1e-6,
                "{error} mm in pass {pass} at {rpm} r/min, {starts} starts, {gearing:?}"
            );
        }
    }
}

/// The greatest distance of the tool from its groove between two Z, mm. It refers to the angle
/// that the control has sampled, a tick before it moves the tool.
fn groove_error(run: &mut ThreadRun, lead: f64, from: f64, to: f64) -> f64 {
    run.run_until_z(from);
    let first = run.simulation.lathe.spindle_degrees();
    run.tick();
    // The angle that the control sampled in this tick is the zero of the turns.
    let begun = run.z();
    let mut before = run.simulation.lathe.spindle_degrees();
    let mut turns = (before - first).rem_euclid(360.0) / 360.0;
    let mut worst = 0.0f64;
    while run.z() > to {
        let sampled = turns;
        run.tick();
        let degrees = run.simulation.lathe.spindle_degrees();
        turns += (degrees - before + 180.0).rem_euclid(360.0) / 360.0 - 0.5;
        before = degrees;
        worst = worst.max((sampled * lead - (begun - run.z())).abs());
    }
    worst
}

#[test]
fn a_thread_keeps_its_groove_while_the_spindle_changes_its_speed() {
    // G96 acts in threads: along the taper the spindle slows down from 800 to 400 r/min.
    let text = "O0001\nM03 S800\nG50 S800\nG96 S100\nG00 X40 Z5\nG04 X1\n\
                G32 X80 Z-95 F2\nG97 S400\nG00 X100\nM30\n";
    let mut run = ThreadRun::started(text, &[]);
    run.run_until_z(4.0);
    let fast = run.simulation.lathe.spindle_rpm();
    let off = groove_error(&mut run, 2.0, 0.0, -90.0);
    let slow = run.simulation.lathe.spindle_rpm();
    assert!(fast > 780.0 && slow < 420.0, "{fast} {slow} r/min");
    assert!(off <= 2.0 * PULSE_MM, "{off} mm");
    run.finish();
    assert_eq!(run.alarm(), None);
}

#[test]
fn a_thread_follows_a_spindle_that_runs_out_and_starts_again() {
    let text = "O0001\nM03 S600\nG04 X1\nG00 X40 Z5\nG32 Z-95 F2\nG00 X100\nM30\n";
    let mut run = ThreadRun::started(text, &[]);
    run.run_until_z(-10.0);
    run.simulation
        .lathe
        .set_fault(LatheFault::SpindleBlocked, true);
    run.run_ticks(500);
    assert!(run.simulation.lathe.spindle_rpm() < 1.0 && run.z() > -20.0);
    run.simulation
        .lathe
        .set_fault(LatheFault::SpindleBlocked, false);
    // Braked and accelerated, measured over the whole thread.
    let off = groove_error(&mut run, 2.0, -10.0, -90.0);
    assert!(off <= 2.0 * PULSE_MM, "{off} mm");
}
