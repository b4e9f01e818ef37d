//! What a board says, line by line.

use crate::Pins;

/// No board counts farther, mm: its counter has 32 bits.
const MAX_POSITION_MM: f64 = 1e6;

/// One line from the board.
#[derive(Clone, Debug, PartialEq)]
pub enum LineResponse {
    /// The oldest unanswered line was read.
    Ok,
    /// The oldest unanswered line was refused.
    Error(u16),
    /// The board stopped by itself.
    Alarm(u16),
    /// Response to `?`.
    StatusReport(StatusReport),
    /// The board has just started.
    Banner(String),
    /// The chip of an ESP32 board starts; its firmware greets later.
    Starts,
    /// A line of `$$`.
    Setting(u16, f64),
    /// `[VER:…]`
    Version(String),
    /// `[OPT:…]`: places in the queue, receive buffer.
    Options(u16, u16),
    /// `[AXS:…]`: letters of the axes.
    Axes(String),
    /// `[FIRMWARE:…]`
    Firmware(String),
    /// `[NEWOPT:…]`
    NewOptions(String),
    /// `[G54:…]`, `[G92:…]`, `[TLO:…]`: whether any of its figures is not 0.
    Offset(bool),
    /// `[MSG:…]`
    Message(String),
    /// Anything else in brackets, and empty lines.
    Information,
    /// Not a line any board of the family says.
    Garbage,
}

/// What a board is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardState {
    /// Nothing.
    Idle,
    /// Moving.
    Run,
    /// Braking.
    Braking,
    /// Held.
    Held,
    /// Homing.
    Home,
    /// Locked.
    Alarm,
    /// Door, Tool, Sleep, Check, Jog: never asked for by us.
    Other,
}

/// A report.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatusReport {
    /// What the board is doing.
    pub state: BoardState,
    /// Machine position X and Z, mm.
    pub position: Option<[f64; 2]>,
    /// Free places in the motion queue.
    pub free_blocks: Option<u16>,
    /// Speed along the path, mm/min.
    pub feed: Option<f64>,
    /// Speed of the spindle as its encoder counts it, r/min.
    pub spindle: Option<f64>,
    /// Switches operated.
    pub pins: Pins,
}

impl LineResponse {
    /// Reads a line without its end.
    pub fn parse(line: &str) -> Self {
        let line = line.trim();
        if line.is_empty() || line.starts_with('>') {
            return Self::Information;
        }
        if line == "ok" {
            return Self::Ok;
        }
        if let Some(number) = line.strip_prefix("error:") {
            return number.parse().map_or(Self::Garbage, Self::Error);
        }
        if let Some(number) = line.strip_prefix("ALARM:") {
            return number.parse().map_or(Self::Garbage, Self::Alarm);
        }
        if let Some(report) = line
            .strip_prefix('<')
            .and_then(|rest| rest.strip_suffix('>'))
        {
            return status(report).map_or(Self::Garbage, Self::StatusReport);
        }
        if let Some(text) = line
            .strip_prefix('[')
            .and_then(|rest| rest.strip_suffix(']'))
        {
            return information(text);
        }
        if let Some(setting) = line.strip_prefix('$') {
            return setting
                .split_once('=')
                .and_then(|(number, value)| {
                    // Some builds write a remark behind the value.
                    let value = value.split_whitespace().next()?;
                    Some(Self::Setting(number.parse().ok()?, value.parse().ok()?))
                })
                .unwrap_or(Self::Garbage);
        }
        if line.starts_with("rst:0x") {
            return Self::Starts;
        }
        let family = ["Grbl ", "GrblHAL "];
        if family.iter().any(|name| line.starts_with(name)) {
            return Self::Banner(line.to_owned());
        }
        Self::Garbage
    }
}

fn information(text: &str) -> LineResponse {
    let Some((name, value)) = text.split_once(':') else {
        return LineResponse::Information;
    };
    match name {
        "VER" => LineResponse::Version(value.trim_end_matches(':').to_owned()),
        "OPT" => {
            let mut fields = value.split(',').skip(1);
            let mut next = || fields.next().and_then(|field| field.parse().ok());
            match (next(), next()) {
                (Some(blocks), Some(bytes)) => LineResponse::Options(blocks, bytes),
                // FluidNC does not tell them there.
                _ if !value.contains(',') => LineResponse::Information,
                _ => LineResponse::Garbage,
            }
        }
        "AXS" => LineResponse::Axes(value.rsplit(':').next().unwrap_or_default().to_owned()),
        "FIRMWARE" => LineResponse::Firmware(value.to_owned()),
        "G54" | "G92" | "TLO" => {
            let figures: Result<Vec<f64>, _> = value.split(',').map(str::parse).collect();
            figures.map_or(LineResponse::Garbage, |figures| {
                LineResponse::Offset(figures.iter().any(|figure| *figure != 0.0))
            })
        }
        "MSG" => LineResponse::Message(value.to_owned()),
        "NEWOPT" => LineResponse::NewOptions(value.to_owned()),
        _ => LineResponse::Information,
    }
}

fn status(report: &str) -> Option<StatusReport> {
    let mut fields = report.split('|');
    let state = match fields.next()? {
        "Idle" => BoardState::Idle,
        // A hold that waits for the end of a thread.
        "Run" | "Run:1" => BoardState::Run,
        "Hold:0" => BoardState::Held,
        "Hold:1" => BoardState::Braking,
        "Home" => BoardState::Home,
        state if state == "Alarm" || state.starts_with("Alarm:") => BoardState::Alarm,
        state if state.starts_with(|letter: char| letter.is_ascii_uppercase()) => BoardState::Other,
        _ => return None,
    };
    let mut status = StatusReport {
        state,
        position: None,
        free_blocks: None,
        feed: None,
        spindle: None,
        pins: Pins::default(),
    };
    for field in fields {
        let (name, value) = field.split_once(':')?;
        match name {
            "MPos" => {
                let mut numbers = value.split(',').map(|number| number.parse::<f64>().ok());
                let (x, z) = (numbers.next()??, numbers.nth(1)??);
                let countable = |place: &f64| place.abs() <= MAX_POSITION_MM;
                if ![x, z].iter().all(countable) {
                    return None;
                }
                status.position = Some([x, z]);
            }
            "Bf" => status.free_blocks = Some(value.split(',').next()?.parse().ok()?),
            "FS" => {
                // Feed, commanded speed, measured speed.
                let mut figures = value.split(',').map(|figure| {
                    let figure = figure.parse::<f64>().ok();
                    figure.filter(|figure| figure.is_finite())
                });
                status.feed = Some(figures.next()??);
                status.spindle = match figures.nth(1) {
                    Some(rpm) => Some(rpm?),
                    None => None,
                };
            }
            "Pn" => {
                for letter in value.chars() {
                    match letter {
                        'X' => status.pins.x = true,
                        'Z' => status.pins.z = true,
                        'E' | 'R' => status.pins.emergency = true,
                        'D' => status.pins.door = true,
                        'P' => status.pins.probe = true,
                        'H' => status.pins.hold = true,
                        'S' => status.pins.start = true,
                        _ => {}
                    }
                }
            }
            _ => {}
        }
    }
    Some(status)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_no_board_can_count_is_garbage() {
        for place in ["99999999999999999999", "-1000001", "inf", "nan"] {
            let line = format!("<Idle|MPos:0.000,0.000,{place}|Bf:15,128|FS:0,0>");
            assert_eq!(LineResponse::parse(&line), LineResponse::Garbage, "{line}");
        }
    }

    #[test]
    fn reports_are_read() {
        let line =
            "<Run|MPos:-1.005,0.000,12.340|Bf:3,101|FS:600,0|Pn:XZPHS|WCO:0.000,0.000,0.000>";
        let LineResponse::StatusReport(status) = LineResponse::parse(line) else {
            panic!("{line}")
        };
        assert_eq!(status.state, BoardState::Run);
        assert_eq!(status.position, Some([-1.005, 12.34]));
        assert_eq!(status.free_blocks, Some(3));
        let pins = status.pins;
        assert!(pins.x && pins.z && pins.probe && pins.hold && pins.start);
        assert!(!pins.door && !pins.emergency);
        assert_eq!((status.feed, status.spindle), (Some(600.0), None));
        let line = "<Run:1|MPos:0.000,0.000,0.000|FS:600,500,498>";
        let LineResponse::StatusReport(status) = LineResponse::parse(line) else {
            panic!("{line}")
        };
        assert_eq!(
            (status.state, status.spindle),
            (BoardState::Run, Some(498.0))
        );
    }

    #[test]
    fn identity_of_either_firmware_is_read() {
        assert_eq!(
            LineResponse::parse("[VER:1.1h.20190825:]"),
            LineResponse::Version("1.1h.20190825".into())
        );
        assert_eq!(
            LineResponse::parse("[OPT:V,15,128]"),
            LineResponse::Options(15, 128)
        );
        assert_eq!(
            LineResponse::parse("[OPT:VNMSL,100,1024,3,0]"),
            LineResponse::Options(100, 1024)
        );
        assert_eq!(
            LineResponse::parse("[AXS:3:XYZ]"),
            LineResponse::Axes("XYZ".into())
        );
        assert_eq!(
            LineResponse::parse("$110=500.000"),
            LineResponse::Setting(110, 500.0)
        );
    }

    #[test]
    fn broken_lines_are_garbage_not_a_guess() {
        for line in [
            "o",
            "okok",
            "error:",
            "error:x",
            "<Run|MPos:1,2",
            "<run>",
            "<Run|MPos:1>",
            "<Idle|MPos:1,0,NaN>",
            "<Idle|MPos:1,0,0|FS:1,2,x>",
            "$1=",
            "\u{fffd}",
        ] {
            assert_eq!(LineResponse::parse(line), LineResponse::Garbage, "{line}");
        }
    }
}
