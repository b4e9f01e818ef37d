//! Reads the table of PLC signals, `assets/tables/plc-signals.tsv` (manual PLC-I, III and the
//! tables of chapter IV).

use std::sync::LazyLock;

use gsk_messages::HelpColumns;

static TABLE: &str = include_str!("../../assets/tables/plc-signals.tsv");

static SIGNALS: LazyLock<Vec<Signal>> =
    LazyLock::new(|| TABLE.lines().skip(1).filter_map(Signal::read).collect());

/// A row of the PLC signal table: a signal between machine, PLC and control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Signal {
    /// The signal's address: a bit (`X0.5`) or a range of bytes.
    pub address: &'static str,
    /// The signal's abbreviation; empty if it has none.
    pub symbol: &'static str,
    /// The signal's sender and receiver, for example `machine>PLC`.
    pub direction: &'static str,
    /// The signal's meaning in Chinese.
    pub text_zh: &'static str,
    /// The signal's meaning in English.
    pub text_en: &'static str,
    /// The sections of the manual that describe the signal.
    pub manual: &'static str,
    /// The part that reacts to the signal: `control`, `ladder` or both; otherwise `free`, or why
    /// none reacts.
    pub acts: &'static str,
    /// The help texts about the signal in both languages.
    pub help: HelpColumns,
}

impl Signal {
    fn read(line: &'static str) -> Option<Self> {
        let fields: Vec<&'static str> = line.split('\t').collect();
        let [
            address,
            symbol,
            direction,
            text_zh,
            text_en,
            manual,
            acts,
            ref help @ ..,
        ] = fields[..]
        else {
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
            help: HelpColumns::read(&mut help.iter().copied())?,
        })
    }
}

/// Returns all rows of the PLC signal table, in its order.
pub fn rows() -> &'static [Signal] {
    &SIGNALS
}

/// Returns the signal with an address as written in the table; `None` if the table has none.
pub fn find(address: &str) -> Option<&'static Signal> {
    SIGNALS.iter().find(|row| row.address == address)
}
