//! Values of a stopped control as scopes and variables of the client.

use gsk_core::plc::address::{Area, ByteAddress};
use gsk_core::simulation::Simulation;
use gsk_debugger::watch::{WatchTarget, WatchedValue};
use gsk_messages::{Language, say};
use serde_json::{Value, json};

const MODAL: i64 = 1;
const POSITIONS: i64 = 2;
const OFFSETS: i64 = 3;
const VARIABLES: i64 = 4;
const PLC: i64 = 5;
/// Variable reference of the values of offset 0; the next offsets follow.
const FIRST_OFFSET: i64 = 100;
/// Number of the last tool offset.
const LAST_OFFSET: i64 = 32;
/// Variable reference of the first PLC area; the next areas follow.
const FIRST_AREA: i64 = 200;
/// Variable reference of byte 0 of the first PLC area.
const FIRST_BYTE: i64 = 10_000;
/// Difference between the variable references of two PLC areas.
const AREA_STEP: i64 = 1000;
/// The areas of the PLC that have bits.
const AREAS: [Area; 7] = [
    Area::X,
    Area::Y,
    Area::F,
    Area::G,
    Area::R,
    Area::A,
    Area::K,
];
const MODAL_NAMES: [&str; 8] = ["G", "M", "F", "S", "T", "feed", "spindle", "angle"];
const POSITION_NAMES: [&str; 6] = ["X", "Z", "U", "W", "XM", "ZM"];
/// Greatest number of a local macro variable.
const LAST_LOCAL: u16 = 33;

/// Returns the scopes that the client shows for a stopped control.
pub fn scopes(language: Language) -> Value {
    let scope = |name: gsk_messages::Message, reference: i64, is_costly: bool| {
        json!({
            "name": name.text(language),
            "variablesReference": reference,
            "expensive": is_costly,
        })
    };
    json!({"scopes": [
        scope(say::dap_scope_modal(), MODAL, false),
        scope(say::dap_scope_positions(), POSITIONS, false),
        scope(say::dap_scope_variables(), VARIABLES, false),
        scope(say::dap_scope_offsets(), OFFSETS, true),
        scope(say::dap_scope_plc(), PLC, true),
    ]})
}

/// Returns the variables with this reference; empty for an unknown one.
pub fn variables(reference: i64, simulation: &Simulation) -> Value {
    let list = match reference {
        MODAL => named(MODAL_NAMES.map(str::to_owned), simulation),
        POSITIONS => named(POSITION_NAMES.map(str::to_owned), simulation),
        VARIABLES => named(variable_names(simulation), simulation),
        OFFSETS => (0..=LAST_OFFSET)
            .map(|number| offset(number, simulation))
            .collect(),
        PLC => (AREAS.iter().zip(FIRST_AREA..))
            .map(|(area, reference)| group(area.letter(), "", reference))
            .collect(),
        FIRST_OFFSET.. if reference <= FIRST_OFFSET + LAST_OFFSET => {
            let number = reference - FIRST_OFFSET;
            let columns = ["X", "Z", "R", "T"];
            named(
                columns.map(|column| format!("T{number}.{column}")),
                simulation,
            )
        }
        FIRST_AREA.. if reference < FIRST_AREA + AREAS.len() as i64 => {
            bytes((reference - FIRST_AREA) as usize, simulation)
        }
        FIRST_BYTE.. => bits(reference - FIRST_BYTE, simulation),
        _ => Vec::new(),
    };
    json!({"variables": list})
}

/// Returns the numbers of the macro variables that have a value.
fn variable_names(simulation: &Simulation) -> Vec<String> {
    let cnc = &simulation.cnc;
    let locals = cnc.are_variables_real().then_some(1..=LAST_LOCAL);
    let numbers = locals.into_iter().flatten().chain(cnc.variable_numbers());
    let mut names: Vec<u16> = numbers
        .filter(|number| cnc.real_variable(*number).is_some())
        .collect();
    names.sort_unstable();
    names.dedup();
    names.iter().map(|number| format!("#{number}")).collect()
}

fn named(names: impl IntoIterator<Item = String>, simulation: &Simulation) -> Vec<Value> {
    let values = names.into_iter().map(|name| {
        let value = WatchTarget::parse(&name).ok();
        let value = value.and_then(|target| target.read(simulation).ok());
        let value = match value.unwrap_or(WatchedValue::Null) {
            // As the LCD writes it: T0101.
            WatchedValue::Number(number) if name == "T" => format!("{number:04}"),
            value => value.to_string(),
        };
        json!({
            "name": name,
            "value": value,
            "evaluateName": name,
            "variablesReference": 0,
        })
    });
    values.collect()
}

fn group(name: &str, value: &str, reference: i64) -> Value {
    json!({"name": name, "value": value, "variablesReference": reference})
}

fn offset(number: i64, simulation: &Simulation) -> Value {
    let row = simulation.cnc.offsets().get(number as u8);
    let value = format!("X{} Z{} R{} T{}", row.x, row.z, row.r, row.t);
    group(&format!("T{number}"), &value, FIRST_OFFSET + number)
}

fn bytes(area_index: usize, simulation: &Simulation) -> Vec<Value> {
    let Some(area) = AREAS.get(area_index).copied() else {
        return Vec::new();
    };
    let memory = simulation.cnc.plc().memory();
    let first = FIRST_BYTE + area_index as i64 * AREA_STEP;
    let byte = |number: u16| {
        let value = memory.byte(ByteAddress::new(area, number));
        let name = format!("{}{number}", area.letter());
        group(&name, &format!("{value:08b}"), first + i64::from(number))
    };
    (0..area.count()).map(byte).collect()
}

fn bits(reference: i64, simulation: &Simulation) -> Vec<Value> {
    let area = usize::try_from(reference / AREA_STEP).unwrap_or(usize::MAX);
    let Some(area) = AREAS.get(area) else {
        return Vec::new();
    };
    let byte = reference % AREA_STEP;
    let names = (0..8).map(|bit| format!("{}{byte}.{bit}", area.letter()));
    named(names, simulation)
}
