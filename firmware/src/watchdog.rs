//! The watchdog: it restarts the board if one of the two processors hangs.

use core::sync::atomic::{AtomicU32, Ordering};

use embassy_rp::pac;

/// Time without a sign of life of the first processor after which the board restarts, calls of
/// [`Watchdog::feed`].
const MAX_SILENT_CALLS: u32 = 50_000;
/// Time after which the watchdog restarts the board, µs. The RP2040 counts it down by two.
const LOAD: u32 = 2 * 100_000;

/// Sign of life of the processor with the serial lines.
static LINE_CALLS: AtomicU32 = AtomicU32::new(0);

/// Records that the serial lines are served.
pub fn note_line_call() {
    LINE_CALLS.store(
        LINE_CALLS.load(Ordering::Relaxed).wrapping_add(1),
        Ordering::Relaxed,
    );
}

/// The watchdog as the processor with the engine feeds it.
#[derive(Clone, Copy, Debug)]
pub struct Watchdog {
    seen: u32,
    silent_calls: u32,
}

impl Watchdog {
    /// Starts the watchdog.
    pub fn start() -> Self {
        select_resets();
        pac::WATCHDOG
            .load()
            .write_value(pac::watchdog::regs::Load(LOAD));
        pac::WATCHDOG.ctrl().write(|ctrl| ctrl.set_enable(true));
        Self {
            seen: 0,
            silent_calls: 0,
        }
    }

    /// Restarts the time of the watchdog, unless the serial lines are not served.
    #[inline]
    pub fn feed(&mut self) {
        let calls = LINE_CALLS.load(Ordering::Relaxed);
        self.silent_calls = if calls == self.seen {
            self.silent_calls + 1
        } else {
            0
        };
        self.seen = calls;
        if self.silent_calls < MAX_SILENT_CALLS {
            pac::WATCHDOG
                .load()
                .write_value(pac::watchdog::regs::Load(LOAD));
        }
    }
}

/// Selects all circuits but the oscillators for the reset by the watchdog.
fn select_resets() {
    pac::PSM
        .wdsel()
        .write_value(pac::psm::regs::Wdsel(0x0001_FFFC));
}

/// Restarts the board.
pub fn restart() -> ! {
    select_resets();
    pac::WATCHDOG.ctrl().write(|ctrl| ctrl.set_trigger(true));
    loop {
        cortex_m::asm::nop();
    }
}
