//! What the 3D view shows of the lathe in addition to the part.

use gsk_core::machine::{LatheConstruction, LatheFault};
use gsk_panel::emulator::Emulator;

use super::active_tool;

/// Construction, steady rest, signal lamps, handwheel and broken insert of the lathe, which the 3D
/// view shows in addition to the part.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LatheFittings {
    /// The construction by the machine file; `None`: it follows from tool post and chuck.
    pub construction: Option<LatheConstruction>,
    /// Distance of the steady rest from the front of the chuck's body, mm; `None`: no steady
    /// rest.
    pub steady_rest: Option<f64>,
    /// Whether the green, yellow and red lamp of the tower are lit.
    pub lit_lamps: [bool; 3],
    /// Position of the handwheel since the start, detents, clockwise positive.
    pub wheel_detents: i32,
    /// Number of the tool whose insert is broken by a fault; `None`: all cut.
    pub broken_tool: Option<u8>,
}

impl LatheFittings {
    pub(super) fn from_emulator(emulator: &Emulator) -> Self {
        let lathe = emulator.lathe();
        let picture = &lathe.config().picture;
        let memory = emulator.simulation().cnc.plc().memory();
        let is_lit = |address| emulator.panel().powered() && memory.bit(address);
        let lamps = picture.tower.addresses().unwrap_or_default();
        Self {
            construction: picture.construction,
            steady_rest: picture.steady_rest,
            lit_lamps: lamps.map(|address| address.is_some_and(is_lit)),
            wheel_detents: lathe.handwheel_detents(),
            broken_tool: (lathe.has_fault(LatheFault::InsertBroken)).then(|| active_tool(emulator)),
        }
    }
}

#[cfg(test)]
mod tests {
    use gsk_core::command::ProgramId;
    use gsk_core::setup::Setup;
    use gsk_panel::keys::Key;

    use super::*;

    fn run(emulator: &mut Emulator, ticks: u32) -> [bool; 3] {
        (0..ticks).for_each(|_| emulator.tick());
        LatheFittings::from_emulator(emulator).lit_lamps
    }

    #[test]
    fn the_lamps_of_the_tower_follow_run_hold_alarm_and_power() {
        let mut setup = Setup::default();
        let programs = &mut setup.memory.programs;
        let number = programs.store("O0001\nG04 X9\nM30\n").unwrap();
        programs.select(ProgramId::Stored(number));
        let mut emulator = Emulator::new(setup);
        assert_eq!(run(&mut emulator, 5000), [false; 3]);
        emulator.press(Key::Auto);
        run(&mut emulator, 100);
        emulator.press(Key::CycleStart);
        assert_eq!(run(&mut emulator, 300), [true, false, false]);
        emulator.press(Key::FeedHold);
        assert_eq!(run(&mut emulator, 300), [false, true, false]);
        emulator.set_fault(LatheFault::DriveX, true);
        assert!(run(&mut emulator, 500)[2]);
    }

    #[test]
    fn fittings_come_from_the_machine_file_and_the_handwheel() {
        let mut setup = Setup::default();
        setup.lathe.picture.steady_rest = Some(120.0);
        setup.lathe.picture.construction = Some(LatheConstruction::Bench);
        setup.lathe.picture.tower.red = String::new();
        let mut emulator = Emulator::new(setup);
        emulator.set_fault(LatheFault::DriveX, true);
        assert_eq!(run(&mut emulator, 5000), [false; 3]);
        emulator.turn(-7);
        let fittings = LatheFittings::from_emulator(&emulator);
        assert_eq!(fittings.steady_rest, Some(120.0));
        assert_eq!(fittings.construction, Some(LatheConstruction::Bench));
        assert_eq!(fittings.wheel_detents, -7);
        assert_eq!(fittings.broken_tool, None);
        emulator.set_fault(LatheFault::InsertBroken, true);
        let fittings = LatheFittings::from_emulator(&emulator);
        assert_eq!(fittings.broken_tool, Some(active_tool(&emulator)));
    }
}
