//! Options of `class`, and those with which a seat joins one.

use std::path::PathBuf;

use clap::Args;
use gsk_host::network::class::DEFAULT_PAGE_ADDRESS;
use gsk_host::network::class::class_address::{ClassAddress, ClassAddressError, ClassCode};
use gsk_host::network::mqtt::{BrokerUrl, parse_broker};
use gsk_host::network::mtconnect::parse_address;

/// `class`.
#[derive(Args, Debug)]
pub struct ClassArgs {
    /// The MQTT broker of the class, mqtt://USER@HOST:PORT/PREFIX, with TLS mqtts://
    #[arg(long, value_name = "URL", value_parser = parse_broker)]
    pub broker: BrokerUrl,
    /// Code of the class: 3 to 24 letters and digits
    #[arg(long, value_name = "CODE", value_parser = parse_code)]
    pub code: ClassCode,
    /// File with the certificates of the authorities that TLS trusts, for mqtts:// [default: those of the system]
    #[arg(long, value_name = "FILE")]
    pub mqtt_ca: Option<PathBuf>,
    /// File with the password for the broker [default: the environment variable GSK980TD_MQTT_PASSWORD]
    #[arg(long, value_name = "FILE")]
    pub mqtt_password_file: Option<PathBuf>,
    /// Folder for the results that seats hand in [default: class-results]
    #[arg(long, value_name = "DIR")]
    pub results: Option<PathBuf>,
    /// Data folder with a teacher's exercises in its folder `exercises`
    #[arg(long, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Show the seats on a page for browsers at this address of this computer [default: none; without ADDR 127.0.0.1:5001]
    #[arg(long, value_name = "ADDR", num_args = 0..=1, default_missing_value = DEFAULT_PAGE_ADDRESS, value_parser = parse_address)]
    pub page: Option<String>,
    /// Address of the page of the program for browsers: its link joins a seat, also as a QR code [default: none]
    #[arg(long, value_name = "URL")]
    pub seat_page: Option<String>,
    /// The broker as that page reaches it, ws://HOST:PORT/PREFIX or wss:// [default: port 9001 of the broker]
    #[arg(long, value_name = "URL", requires = "seat_page", value_parser = parse_broker)]
    pub seat_broker: Option<BrokerUrl>,
    /// Print the seats as a table in the terminal instead of opening a window
    #[arg(long)]
    pub text: bool,
    /// End after this number of seconds [default: with Ctrl-C]
    #[arg(long, value_name = "N", requires = "text")]
    pub seconds: Option<u64>,
}

/// Whether this window is a seat of a class.
#[derive(Args, Clone, Debug, Default)]
pub struct SeatArgs {
    /// Show this seat to the instructor of a class, CODE@BROKER; the instructor cannot operate it
    /// [default: nothing is sent]
    #[arg(long, value_name = "CODE@BROKER", value_parser = parse_class)]
    pub class: Option<ClassAddress>,
    /// Name of the learner that the instructor sees [default: the name on results of exercises]
    #[arg(long, value_name = "NAME", requires = "class")]
    pub class_name: Option<String>,
}

fn parse_code(word: &str) -> Result<ClassCode, ClassAddressError> {
    ClassCode::parse(word)
}

fn parse_class(word: &str) -> Result<ClassAddress, ClassAddressError> {
    ClassAddress::parse(word)
}
