//! Reads the table of PLC signals, `assets/tables/plc-signals.tsv` (manual PLC-I, III and the
//! tables of chapter IV).

use std::sync::LazyLock;

static TABLE: &str = include_str!("../../assets/tables/plc-signals.tsv");

static SIGNALS: LazyLock<Vec<Signal>> =
    LazyLock::new(|| TABLE.lines().skip(1).filter_map(Signal::read).collect());

/// A signal between machine, PLC and control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signal {
    /// Its address: a bit (`X0.5`) or a range of bytes.
    pub address: &'static str,
    /// Its abbreviation, or empty.
    pub symbol: &'static str,
    /// Its sender and receiver: `machine>PLC`.
    pub direction: &'static str,
    /// Its meaning in Chinese.
    pub text_zh: &'static str,
    /// Its meaning in English.
    pub text_en: &'static str,
    /// The sections of the manual.
    pub manual: &'static str,
    /// Where it acts: in the control, in the ladder, nowhere.
    pub acts: &'static str,
}

impl Signal {
    fn read(line: &'static str) -> Option<Self> {
        let fields: Vec<&str> = line.split('\t').collect();
        let [address, symbol, direction, text_zh, text_en, manual, acts] = fields[..] else {
            return None;
        };
        Some(Self {
            address,
            symbol: if symbol == "-" { "" } else { symbol },
            direction,
            text_zh,
            text_en,
            manual,
            acts,
        })
    }
}

/// Returns all signals in the order of the table.
pub fn rows() -> &'static [Signal] {
    &SIGNALS
}

/// Returns the signal with an address.
pub fn find(address: &str) -> Option<&'static Signal> {
    SIGNALS.iter().find(|row| row.address == address)
}
