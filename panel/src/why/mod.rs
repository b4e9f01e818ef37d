//! Explains why a bit, a lamp, a key, an axis or an alarm is in its present state: the chain of
//! rungs, contacts, parameters and key presses that decides it.
//!
//! ```text
//! G8.5 = 0 <- rung 2 does not conduct <- X24.7 = 1: contact of the key [暂停]
//! ```

mod bit_log;
mod chain;
mod ladder_cause;
mod named_places;
mod subject;

pub use bit_log::BitLog;
pub use chain::{CauseChain, CauseLink, CauseTarget};
pub use subject::{CauseSubject, explain};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emulator::{Emulator, WaitCondition};
    use crate::keys::all_rows;
    use gsk_core::plc::PlcAddress;
    use gsk_core::setup::Setup;
    use gsk_messages::Language;

    #[test]
    fn every_bit_and_key_has_a_chain_with_an_end() {
        let mut emulator = Emulator::new(Setup::default());
        emulator.run_until(&WaitCondition::SelfTestOver, 10_000);
        let log = BitLog::default();
        let addresses = emulator.cnc().plc().ladder().addresses();
        let bits = addresses.into_iter().filter_map(|address| match address {
            PlcAddress::Bit(bit) => Some(CauseSubject::Bit(bit)),
            PlcAddress::Byte(_) => None,
        });
        let keys = all_rows().map(|row| CauseSubject::Key(row.key));
        for subject in bits.chain(keys) {
            let chain = explain(&emulator, subject, &log);
            assert!(!chain.links().is_empty(), "{subject}");
            assert!(!chain.text(Language::Zh).contains('{'), "{subject}");
            let text = subject.to_string();
            let (kind, name) = text.split_once(' ').unwrap_or_default();
            assert_eq!(CauseSubject::parse(kind, name), Some(subject));
        }
    }

    #[test]
    fn the_log_begins_anew_when_time_goes_back() {
        let mut emulator = Emulator::new(Setup::default());
        let mut log = BitLog::default();
        for _ in 0..5_000 {
            emulator.tick();
            log.follow_tick(emulator.cnc(), emulator.ticks());
        }
        assert_ne!(log, BitLog::default());
        let mut fresh = BitLog::default();
        fresh.follow_tick(emulator.cnc(), 10);
        log.follow_tick(emulator.cnc(), 10);
        assert_eq!(log, fresh);
    }
}
