//! Lists the parameters of a ladder: the keep relays, data, timers and counters that it uses, with
//! their meanings.

use std::collections::BTreeSet;

use gsk_core::plc::{Area, Ladder, Mnemonic, PlcAddress};
use gsk_messages::Language;

use super::address_text::{address_comment, signal};

/// A keep relay, a data byte, a timer, a counter or one of their presets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LadderParameter {
    /// The address of the parameter.
    pub address: PlcAddress,
    /// Comment of the ladder, or the meaning in the signal table; may be empty.
    pub meaning: String,
    /// What the parameter does, from the signal table; empty without a row there.
    pub explanation: &'static str,
    /// Value in a blank memory (`.INIT`); `None` for 0, or 2147483647 of DC and DT.
    pub start: Option<i32>,
    /// The preset of a timer or counter as its instruction has it: `DT3`, `500`.
    pub preset: Option<String>,
    /// The data parameter of the control that sets this preset; `None` if none does.
    pub data_parameter: Option<u16>,
    /// Numbers of the rungs that use it, each once.
    pub rows: Vec<u32>,
}

impl LadderParameter {
    /// Returns the preset as a text: that of the instruction, or the data parameter that sets
    /// it; empty without one.
    pub fn preset_text(&self) -> String {
        match (&self.preset, self.data_parameter) {
            (Some(preset), _) => preset.clone(),
            (None, Some(number)) => format!("P{number:03}"),
            (None, None) => String::new(),
        }
    }

    /// Returns the numbers of the rungs that use the parameter, separated by spaces.
    pub fn rows_text(&self) -> String {
        let rows: Vec<String> = self.rows.iter().map(ToString::to_string).collect();
        rows.join(" ")
    }
}

/// Returns the parameters of a ladder in address order: K, D, T, C, DC and DT that the program
/// uses, names or presets, and the presets that the control sets by data parameters.
pub fn list_parameters(ladder: &Ladder, language: Language) -> Vec<LadderParameter> {
    let mut addresses: BTreeSet<PlcAddress> = ladder.addresses();
    let starts = ladder.start_values().iter();
    addresses.extend(starts.map(|start| PlcAddress::Byte(start.address)));
    let comments = ladder.comments().iter();
    addresses.extend(comments.map(|comment| comment.subject));
    addresses.retain(|address| is_parameter_area(area(*address)));
    let describe = |address| describe_parameter(ladder, address, language);
    addresses.into_iter().map(describe).collect()
}

const fn area(address: PlcAddress) -> Area {
    match address {
        PlcAddress::Bit(bit) => bit.area,
        PlcAddress::Byte(byte) => byte.area,
    }
}

const fn is_parameter_area(area: Area) -> bool {
    matches!(
        area,
        Area::K | Area::D | Area::T | Area::C | Area::Dc | Area::Dt
    )
}

fn describe_parameter(ladder: &Ladder, address: PlcAddress, language: Language) -> LadderParameter {
    let signal = signal(address);
    let parameter = signal.and_then(|signal| signal.symbol.strip_prefix('P')?.parse().ok());
    let start = ladder
        .start_values()
        .iter()
        .find(|start| PlcAddress::Byte(start.address) == address);
    let mut rows: Vec<u32> = ladder
        .references(address)
        .iter()
        .map(|it| it.rung)
        .collect();
    rows.dedup();
    LadderParameter {
        address,
        meaning: address_comment(ladder, address, language),
        explanation: signal.map_or("", |signal| signal.help.rule(language)),
        start: start.map(|start| start.value),
        preset: preset(ladder, address),
        data_parameter: parameter,
        rows,
    }
}

/// The preset operand of the TMRB or CTRC that has this timer or counter.
fn preset(ladder: &Ladder, address: PlcAddress) -> Option<String> {
    let uses = ladder.references(address);
    let mut statements = uses.iter().filter_map(|reference| {
        let statement = ladder.statements().get(reference.statement)?;
        let index = match (statement.mnemonic, area(address)) {
            (Mnemonic::Tmrb, Area::T) => 1,
            (Mnemonic::Ctrc, Area::C) => 3,
            _ => return None,
        };
        statement.operands.get(index).map(ToString::to_string)
    });
    statements.next()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::setup::standard_ladder;

    fn find(list: &[LadderParameter], address: &str) -> LadderParameter {
        let mut list = list.iter();
        let found = list.find(|it| match it.address {
            PlcAddress::Bit(bit) => bit.short_name() == address,
            PlcAddress::Byte(byte) => byte.short_name() == address,
        });
        found.expect("a parameter").clone()
    }

    #[test]
    fn the_standard_ladder_has_its_presets_with_their_data_parameters() {
        let list = list_parameters(&standard_ladder(), Language::En);
        let time = find(&list, "DT5");
        assert_eq!(time.data_parameter, Some(80));
        assert_eq!(time.start, Some(500));
        assert!(time.explanation.contains("FIN"), "{}", time.explanation);
        assert_eq!(time.meaning, "M time");
        assert!(!time.rows.is_empty());
        let mode = find(&list, "K9");
        assert_eq!((mode.start, mode.data_parameter), (Some(0), None));
        assert!(mode.explanation.contains("power-off"));
        // 000:13340: 系统占用,通过65#参数修改.
        assert_eq!(find(&list, "DT0").data_parameter, Some(65));
        let all = ["K", "DT", "T", "C"];
        let has = |letter: &str| list.iter().any(|it| area(it.address).letter() == letter);
        assert!(all.into_iter().all(has));
    }

    #[test]
    fn timers_and_counters_show_the_preset_of_their_instruction() {
        let source = "END1\nLD X0.0\nTMRB T1 DT20 R1.0\nLD X0.1\nTMRB T2 500 R1.1\nLD X0.2\n\
                      CTRC 0000 X0.3 C4 DC7 R1.2\nLD K5.1\nMOVN 1 D10 D11\nEND2";
        let ladder = Ladder::compile(source).expect("a ladder");
        let list = list_parameters(&ladder, Language::En);
        let preset = |address| find(&list, address).preset;
        assert_eq!(preset("T1").as_deref(), Some("DT0020"));
        assert_eq!(preset("T2").as_deref(), Some("500"));
        assert_eq!(preset("C4").as_deref(), Some("DC0007"));
        assert_eq!(find(&list, "D11").rows, [5]);
        let order: Vec<String> = list.iter().map(|it| it.address.to_string()).collect();
        assert_eq!(order.len(), 8, "{order:?}");
    }
}
