//! A session at the panel with a hash over every tick, the same on every system.

use gsk_core::setup::Setup;
use gsk_panel::emulator::Emulator;
use gsk_panel::script::{Effect, Runner, Script, ScriptProgress};

/// Expected hash of the positions in the session. A change of motion, ladder or script changes
/// it. Only then replace it with the value that the test prints.
pub const GOLDEN: u64 = 0x2b0d_c502_6b99_8055;

const PART: &str = "O0001;
G50 X100 Z100;
M03 S800;
T0202;
G00 X60 Z2;
G90 X50 Z-30 F900;
X45 R-3;
G01 X40 Z0 F700;
G02 X50 Z-5 R5;
G03 X60 Z-10 I0 K-5;
G03 I-10 F1200;
G99 G01 X64 Z-20 F0.8;
G98 G04 P300;
G94 X30 Z-22 F1000;
G00 X100 Z100;
M30;
";

const SCRIPT: &str = "load part.nc
press POS
press JOG
hold ZM 1500ms
press RT
hold XP 700ms
wait idle 2s
press AUTO
press CS
wait 3s
expect lamp CS on
press FD-
press FD-
wait 3500ms
press FH
wait 700ms
expect lamp FH on
press CS
press RP-
wait 2s
expect lamp CS on
press PRG
press SBK
wait idle 20s
press CS
wait idle 20s
press SBK
press CS
wait 10s
press POS
press PGDN
expect lamp CS on
press ESTOP
wait 500ms
expect alarm 207
press ESTOP
wait 500ms
expect alarm none
";

/// Hashes of a session over all its ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SessionTrace {
    /// Hash of the machine positions at every tick.
    pub positions: u64,
    /// Hash of the LCD's text, four times a second.
    pub screens: u64,
    /// Hash of the PLC memory, four times a second.
    pub plc: u64,
    /// Number of ticks (ms) of the session up to now.
    pub ticks: u64,
}

/// Adds bytes to a hash (FNV-1a), which is stored in `state`.
fn add_to_hash(state: &mut u64, bytes: impl IntoIterator<Item = u8>) {
    for byte in bytes {
        *state = (*state ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
}

/// Runs the session and returns its hashes. At the ticks of `saves` the emulator is saved, and
/// the session continues with the restored copy.
///
/// # Errors
/// Returns a message if a line of the session fails, or a restored state differs.
pub fn trace_session(saves: &[u64]) -> Result<SessionTrace, String> {
    const BASIS: u64 = 0xcbf2_9ce4_8422_2325;
    let mut trace = SessionTrace {
        positions: BASIS,
        screens: BASIS,
        plc: BASIS,
        ticks: 0,
    };
    let mut emulator = Emulator::new(Setup::default());
    let mut runner = Runner::new(Script::parse(SCRIPT).map_err(|errors| format!("{errors:?}"))?);
    loop {
        let before = emulator.ticks();
        match runner.advance(&mut emulator, 1) {
            ScriptProgress::Effect(Effect::Load(name)) => {
                let loaded = emulator.load_program(&name, PART);
                loaded.map_err(|alarm| alarm.to_string())?;
            }
            ScriptProgress::Running | ScriptProgress::Effect(_) => {}
            ScriptProgress::Failed(failure) => return Err(failure.to_string()),
            ScriptProgress::Finished => return Ok(trace),
        }
        if emulator.ticks() == before {
            continue;
        }
        trace.ticks += 1;
        let cnc = emulator.cnc();
        let machine = cnc.position_machine();
        for axis in [machine.x, machine.z] {
            add_to_hash(&mut trace.positions, axis.to_bits().to_le_bytes());
        }
        if trace.ticks.is_multiple_of(250) {
            add_to_hash(&mut trace.screens, emulator.screen().text().bytes());
            add_to_hash(&mut trace.plc, format!("{:?}", cnc.plc().memory()).bytes());
        }
        if saves.contains(&trace.ticks) {
            let restored = crate::saved_state::restore(&emulator)?;
            if restored != emulator {
                return Err(format!("the state at tick {} differs", trace.ticks));
            }
            emulator = restored;
        }
    }
}
