//! Parses the lines that a line board sends.

use crate::Pins;

/// Greatest absolute value of a valid position, mm: the counters of the boards have 32 bits.
const MAX_POSITION_MM: f64 = 1e6;

/// A line that the board has sent, parsed.
#[derive(Clone, Debug, PartialEq)]
pub enum LineResponse {
    /// `ok`: the board has read the oldest unanswered line.
    Ok,
    /// `error:N`: the board has refused the oldest unanswered line.
    Error(u16),
    /// `ALARM:N`: the board has stopped without a command; the value is the alarm number.
    Alarm(u16),
    /// `<…>`: the answer to `?`.
    StatusReport(StatusReport),
    /// The banner that a board sends when it has started; the value is its text.
    Banner(String),
    /// The boot message of an ESP32; the banner follows.
    Starts,
    /// `$N=V`: number and value of a setting, a line of the answer to `$$`.
    Setting(u16, f64),
    /// `[VER:…]`: the version of the firmware, as text.
    Version(String),
    /// `[OPT:…]`: size of the motion queue in entries, and of the receive buffer in bytes.
    Options(u16, u16),
    /// `[AXS:…]`: the letters of the axes.
    Axes(String),
    /// `[FIRMWARE:…]`: the name of the firmware.
    Firmware(String),
    /// `[NEWOPT:…]`: the names of compiled options.
    NewOptions(String),
    /// `[G54:…]`, `[G92:…]`, `[TLO:…]`: an offset; `true` if one of its values is not 0.
    Offset(bool),
    /// `[MSG:…]`: a message, as text.
    Message(String),
    /// Another line in brackets, or an empty line; the link ignores it.
    Information,
    /// An invalid line: noise on the wire, or an unknown format.
    Garbage,
}

/// The state of the board in a status report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoardState {
    /// `Idle`: the axes are at standstill.
    Idle,
    /// `Run`: the axes move.
    Run,
    /// `Hold:1`: the axes decelerate after a feed hold.
    Braking,
    /// `Hold:0`: the axes are at standstill after a feed hold.
    Held,
    /// `Home`: the board is homing.
    Home,
    /// `Alarm`: the board is locked.
    Alarm,
    /// Door, Tool, Sleep, Check or Jog: states that the link never requests.
    Other,
}

/// A status report. A field that the report lacks is `None`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StatusReport {
    /// The state of the board, such as idle or alarm.
    pub state: BoardState,
    /// Machine position of X and Z, mm; `None` if the report lacks it.
    pub position: Option<[f64; 2]>,
    /// Number of free entries of the motion queue; `None` if the report lacks it.
    pub free_blocks: Option<u16>,
    /// Speed along the path, mm/min; `None` if the report lacks it.
    pub feed: Option<f64>,
    /// Measured spindle speed, r/min; `None` if the report lacks it.
    pub spindle: Option<f64>,
    /// The switches that the report names as operated.
    pub pins: Pins,
}

impl LineResponse {
    /// Parses a line that the board has sent, given without its line end.
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
                    // Some builds write a comment after the value.
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
                // FluidNC does not report the sizes here.
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
        // Run:1 is a feed hold that waits for the end of a thread pass.
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
                let countable = |position: &f64| position.abs() <= MAX_POSITION_MM;
                if ![x, z].iter().all(countable) {
                    return None;
                }
                status.position = Some([x, z]);
            }
            "Bf" => status.free_blocks = Some(value.split(',').next()?.parse().ok()?),
            "FS" => {
                // Feed, commanded spindle speed, measured spindle speed.
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
    fn an_impossible_position_is_garbage() {
        for position in ["99999999999999999999", "-1000001", "inf", "nan"] {
            let line = format!("<Idle|MPos:0.000,0.000,{position}|Bf:15,128|FS:0,0>");
            assert_eq!(LineResponse::parse(&line), LineResponse::Garbage, "{line}");
        }
    }

    #[test]
    fn status_reports_are_parsed() {
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
    fn identification_of_both_firmwares_is_parsed() {
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
    fn damaged_lines_are_garbage() {
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
