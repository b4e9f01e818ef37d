//! Writes the dictionary of the protocol, compressed as the host receives it.

use std::fmt::Write;
use std::path::Path;

#[allow(dead_code, reason = "the firmware uses the rest")]
#[path = "src/messages.rs"]
mod messages;

use messages::{
    CLOCK_HZ, COMMANDS, FIRST_REASON_ID, PINS, PROCESSOR, PWM_MAX, REASONS, RECEIVE_WINDOW,
    RESPONSES, SERIAL_PINS, command_id, response_id,
};

fn join(items: impl Iterator<Item = String>) -> String {
    items.collect::<Vec<_>>().join(",")
}

fn main() {
    let commands = COMMANDS
        .iter()
        .map(|(name, text)| format!("\"{text}\":{}", command_id(*name)));
    let responses = RESPONSES
        .iter()
        .map(|(name, text)| format!("\"{text}\":{}", response_id(*name)));
    let reasons = REASONS
        .iter()
        .zip(FIRST_REASON_ID..)
        .map(|(text, id)| format!("\"{text}\":{id}"));
    let version = std::env::var("CARGO_PKG_VERSION").expect("set by cargo");
    let mut text = String::new();
    write!(
        text,
        "{{\"app\":\"gsk980td-firmware\",\"commands\":{{{}}},\"responses\":{{{}}},\
         \"enumerations\":{{\"pin\":{{\"gpio0\":[0,{PINS}]}},\"static_string_id\":{{{}}}}},\
         \"config\":{{\"CLOCK_FREQ\":{CLOCK_HZ},\"MCU\":\"{PROCESSOR}\",\"PWM_MAX\":{PWM_MAX},\
         \"RECEIVE_WINDOW\":{RECEIVE_WINDOW},\"RESERVE_PINS_serial\":\"{SERIAL_PINS}\"}},\
         \"version\":\"gsk980td-firmware-{version}\"}}",
        join(commands),
        join(responses),
        join(reasons),
    )
    .expect("a string takes all text");
    let packed = miniz_oxide::deflate::compress_to_vec_zlib(text.as_bytes(), 9);
    let folder = std::env::var("OUT_DIR").expect("set by cargo");
    std::fs::write(Path::new(&folder).join("dictionary.bin"), packed).expect("a writable folder");
    println!("cargo:rerun-if-changed=src/messages.rs");
    println!("cargo:rerun-if-changed=build.rs");
}
