//! The ladder of a machine, built-in or loaded.

use std::sync::{Arc, LazyLock};

use gsk_plc::{Area, ByteAddress, Ladder, LadderDeclarations, MCode};

/// Source of the standard ladder, an instruction list.
pub const STANDARD_LADDER: &str = include_str!("../../../assets/ladder/standard.il");

/// Source of the standard ladder with keys for DNC and teach-in, an instruction list.
const DNC_TEACH_LADDER: &str = include_str!("../../../assets/ladder/dnc-teach.il");

/// The ladder of a machine. The standard one is compiled only when its steps are needed: to
/// check a program, its declarations are enough.
#[derive(Clone, Debug, Default)]
pub enum MachineLadder {
    /// The machine has the built-in standard ladder.
    #[default]
    Standard,
    /// The machine has another ladder, already compiled.
    Own(Arc<Ladder>),
}

impl MachineLadder {
    /// The compiled ladder; the standard one is compiled at the first call.
    pub fn compiled(&self) -> Arc<Ladder> {
        match self {
            Self::Standard => standard_ladder(),
            Self::Own(ladder) => Arc::clone(ladder),
        }
    }

    /// Whether this is the built-in standard ladder.
    pub const fn is_standard(&self) -> bool {
        matches!(self, Self::Standard)
    }

    /// The M codes that the ladder executes in addition to those of the control.
    pub(crate) fn m_codes(&self) -> &[MCode] {
        match self {
            Self::Standard => &standard_declarations().m_codes,
            Self::Own(ladder) => ladder.m_codes(),
        }
    }

    /// The initial value of a byte of the K area, used if no retained memory exists.
    pub(crate) fn initial_k(&self, byte: u16) -> u8 {
        let values = match self {
            Self::Standard => &standard_declarations().start_values,
            Self::Own(ladder) => ladder.start_values(),
        };
        let of_byte = |at: ByteAddress| at.area == Area::K && at.byte == byte;
        let last = values.iter().rfind(|value| of_byte(value.address));
        last.map_or(0, |last| u8::try_from(last.value).unwrap_or(u8::MAX))
    }
}

impl From<Arc<Ladder>> for MachineLadder {
    fn from(ladder: Arc<Ladder>) -> Self {
        if Arc::ptr_eq(&ladder, &standard_ladder()) {
            Self::Standard
        } else {
            Self::Own(ladder)
        }
    }
}

/// The declarations (M codes, initial values) of the standard ladder, parsed once. They are
/// before the names of its addresses, so the rest is not read: every start needs them.
fn standard_declarations() -> &'static LadderDeclarations {
    static DECLARED: LazyLock<LadderDeclarations> = LazyLock::new(|| {
        let head = STANDARD_LADDER.split_once("\n.CMT ");
        LadderDeclarations::read(head.map_or(STANDARD_LADDER, |(head, _)| head))
    });
    &DECLARED
}

/// The compiled standard ladder; compiled at the first call.
pub fn standard_ladder() -> Arc<Ladder> {
    static LADDER: LazyLock<Arc<Ladder>> = LazyLock::new(|| compile_builtin(STANDARD_LADDER));
    Arc::clone(&LADDER)
}

/// The compiled ladder with keys for DNC and teach-in; compiled at the first call.
pub fn dnc_teach_ladder() -> Arc<Ladder> {
    static LADDER: LazyLock<Arc<Ladder>> = LazyLock::new(|| compile_builtin(DNC_TEACH_LADDER));
    Arc::clone(&LADDER)
}

fn compile_builtin(source: &str) -> Arc<Ladder> {
    match Ladder::compile(source) {
        Ok(ladder) => Arc::new(ladder),
        Err(errors) => unreachable!("this ladder is part of the program: {errors}"),
    }
}

#[cfg(test)]
mod tests {
    use gsk_plc::Plc;

    use super::*;

    #[test]
    fn declarations_match_the_compiled_ladder() {
        let own = MachineLadder::Own(standard_ladder());
        let plc = Plc::new(standard_ladder());
        for byte in 0..60 {
            let value = MachineLadder::Standard.initial_k(byte);
            assert_eq!(value, plc.memory().k(byte), "K{byte}");
            assert_eq!(value, own.initial_k(byte), "K{byte}");
        }
        assert_eq!(MachineLadder::Standard.m_codes(), own.m_codes());
    }
}
