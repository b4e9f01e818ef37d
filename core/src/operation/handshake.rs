//! The M/S/T handshake with the PLC (manual PLC-I, M function and FIN).
//!
//! ```text
//! code    ____/‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾‾
//! strobe  ________/‾‾‾‾‾‾‾‾‾‾‾‾\________   16 ms after the code
//! FIN     _________________/‾‾‾‾‾‾‾\____   seen for 16 ms
//!              Code  Strobe     Release
//! ```
//!
//! One FIN answers all strobes that are up together.

use serde::{Deserialize, Serialize};

/// Delay from code to strobe, and time for which FIN must be on, ms.
const STROBE_MS: u32 = 16;

/// The function that a strobe signal belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Strobe {
    /// M function, with the strobe MF (F7.0).
    M,
    /// S function, with the strobe SF (F7.2).
    S,
    /// T function, with the strobe TF (F7.3).
    T,
}

/// Phase of the handshake of one function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum HandshakePhase {
    /// The function has no handshake in progress.
    Idle,
    /// The code is output; the strobe is switched on after this many ms.
    Code(u32),
    /// The strobe is on; FIN has been on for this many ms.
    Strobe(u32),
    /// The strobe is off; the handshake ends when FIN goes off.
    Release,
}

/// The handshakes of M, S and T functions with the ladder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Handshake {
    phases: [HandshakePhase; 3],
    /// M code output on F10; 0 = none.
    pub m: u8,
    /// S code output on F22–F25; it stays until the next one.
    pub s: u32,
    /// T code (tool number) that is output on F26.
    pub t: u8,
}

impl Default for Handshake {
    fn default() -> Self {
        Self {
            phases: [HandshakePhase::Idle; 3],
            m: 0,
            s: 0,
            t: 0,
        }
    }
}

impl Handshake {
    /// Outputs the code of a function and starts its handshake.
    pub fn start(&mut self, strobe: Strobe, code: u8) {
        match strobe {
            Strobe::M => self.m = code,
            Strobe::S => self.s = u32::from(code),
            Strobe::T => self.t = code,
        }
        self.phases[strobe as usize] = HandshakePhase::Code(STROBE_MS);
    }

    /// Whether the strobe signal of a function is on.
    pub fn is_strobe_up(&self, strobe: Strobe) -> bool {
        matches!(self.phases[strobe as usize], HandshakePhase::Strobe(_))
    }

    /// The M code that the ladder has not answered with FIN; `None` without one.
    pub(crate) const fn waiting_m(&self) -> Option<u8> {
        match self.phases[Strobe::M as usize] {
            HandshakePhase::Code(_) | HandshakePhase::Strobe(_) => Some(self.m),
            HandshakePhase::Idle | HandshakePhase::Release => None,
        }
    }

    /// Whether a handshake of any function is in progress.
    pub fn is_busy(&self) -> bool {
        self.phases
            .iter()
            .any(|phase| *phase != HandshakePhase::Idle)
    }

    /// The first function whose strobe is on, with its code; `None` if all strobes are off.
    pub(crate) fn unanswered_strobe(&self) -> Option<(Strobe, u32)> {
        let codes = [
            (Strobe::M, u32::from(self.m)),
            (Strobe::S, self.s),
            (Strobe::T, u32::from(self.t)),
        ];
        codes
            .into_iter()
            .find(|(strobe, _)| self.is_strobe_up(*strobe))
    }

    /// Advances by one tick (1 ms) with the FIN signal of the ladder.
    pub fn tick(&mut self, fin: bool) {
        if !self.is_busy() {
            return;
        }
        for (index, phase) in self.phases.iter_mut().enumerate() {
            *phase = match *phase {
                HandshakePhase::Idle => continue,
                HandshakePhase::Code(0 | 1) => HandshakePhase::Strobe(0),
                HandshakePhase::Code(left) => HandshakePhase::Code(left - 1),
                HandshakePhase::Strobe(stood) if fin && stood + 1 >= STROBE_MS => {
                    HandshakePhase::Release
                }
                HandshakePhase::Strobe(stood) if fin => HandshakePhase::Strobe(stood + 1),
                HandshakePhase::Strobe(_) => HandshakePhase::Strobe(0),
                HandshakePhase::Release if fin => HandshakePhase::Release,
                HandshakePhase::Release => HandshakePhase::Idle,
            };
            // S and T codes stay until the next code, the M code does not.
            if *phase == HandshakePhase::Idle && index == Strobe::M as usize {
                self.m = 0;
            }
        }
    }

    /// Switches all strobes off and ends the handshakes (RESET); FIN is no longer awaited.
    pub fn reset(&mut self) {
        self.phases = [HandshakePhase::Idle; 3];
        self.m = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs ticks with `fin` until the M strobe is on or off as `up` demands. Returns their
    /// number.
    fn ticks_until(handshake: &mut Handshake, up: bool, fin: bool) -> u32 {
        let mut count = 0;
        while handshake.is_strobe_up(Strobe::M) != up {
            handshake.tick(fin);
            count += 1;
            assert!(count < 1000, "the strobe never changes");
        }
        count
    }

    #[test]
    fn the_strobe_follows_the_code_after_16_ms_and_waits_for_fin() {
        let mut handshake = Handshake::default();
        handshake.start(Strobe::M, 8);
        assert_eq!(handshake.m, 8);
        assert_eq!(ticks_until(&mut handshake, true, false), 16);
        for _ in 0..500 {
            handshake.tick(false);
        }
        assert!(
            handshake.is_strobe_up(Strobe::M),
            "without FIN nothing goes on"
        );
        assert_eq!(ticks_until(&mut handshake, false, true), 16);
        assert!(handshake.is_busy(), "FIN must fall");
        handshake.tick(true);
        assert!(handshake.is_busy());
        handshake.tick(false);
        assert!(!handshake.is_busy());
        assert_eq!(handshake.m, 0, "the M code goes");
    }

    #[test]
    fn a_short_fin_does_not_count() {
        let mut handshake = Handshake::default();
        handshake.start(Strobe::M, 8);
        ticks_until(&mut handshake, true, false);
        for _ in 0..15 {
            handshake.tick(true);
        }
        handshake.tick(false);
        for _ in 0..15 {
            handshake.tick(true);
        }
        assert!(handshake.is_strobe_up(Strobe::M));
    }

    #[test]
    fn s_and_t_codes_stay_until_the_next() {
        let mut handshake = Handshake::default();
        handshake.start(Strobe::T, 3);
        for _ in 0..40 {
            handshake.tick(true);
        }
        handshake.tick(false);
        assert!(!handshake.is_busy());
        assert_eq!(handshake.t, 3);
    }

    #[test]
    fn reset_drops_the_strobes_at_once() {
        let mut handshake = Handshake::default();
        handshake.start(Strobe::S, 2);
        for _ in 0..20 {
            handshake.tick(false);
        }
        assert!(handshake.is_strobe_up(Strobe::S));
        handshake.reset();
        assert!(!handshake.is_strobe_up(Strobe::S) && !handshake.is_busy());
    }
}
