//! Where the groove lies: phase of passes and starts, lead-in and tail.

use gsk_core::operation::RunState;

use crate::run::Run;

/// One pulse of Z, mm.
const PULSE: f64 = 0.001;

/// Distance of two parts of a turn.
fn apart(one: f64, other: f64) -> f64 {
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
        let mut run = Run::started(&text, &gearing);
        let mut phases = Vec::new();
        let mut before = run.z();
        while run.state() == RunState::Run {
            run.tick();
            let slides = run.simulation.lathe.slides();
            if before > -10.0 && slides.z <= -10.0 && run.simulation.cnc.modal().motion == 92 {
                let turns = run.simulation.lathe.spindle_degrees() / 360.0;
                phases.push((turns + slides.z / LEAD).rem_euclid(1.0));
            }
            before = slides.z;
        }
        assert_eq!(run.alarm(), None);
        assert_eq!(phases.len() as u32, 3 * starts);
        for (pass, phase) in phases.iter().enumerate() {
            let share = f64::from(pass as u32 % starts) / f64::from(starts);
            let error = apart(phase - phases[0], share) * LEAD;
            assert!(
                error <= PULSE + 1e-6,
                "{error} mm in pass {pass} at {rpm} r/min, {starts} starts, {gearing:?}"
            );
        }
    }
}
