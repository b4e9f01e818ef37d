//! The figures of the link page.

use std::time::Duration;

use egui::{Align, Layout, ProgressBar, RichText, Ui};
use gsk_core::machine::link::{Input, Protocol, SpindleWay, Traffic};
use gsk_core::units::{Axis, Pulses};

use super::{BAD, GOOD, words};
use crate::cli::Language;
use crate::kernel::link_view::LinkView;
use crate::window::texts::say;

/// Between two looks at the counters, s.
const INTERVAL: f64 = 1.0;

/// Counters of the wire, a second.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rates {
    since: f64,
    last: Traffic,
    /// Bytes to the board, from the board, pieces of motion.
    rates: Option<[f64; 3]>,
}

impl Rates {
    /// The counters at a time of the window, s.
    pub fn take(&mut self, traffic: &Traffic, now: f64) {
        let passed = now - self.since;
        if passed < INTERVAL {
            return;
        }
        let begun = self.since > 0.0 && traffic.sent >= self.last.sent;
        let rate = |now: u64, last: u64| now.saturating_sub(last) as f64 / passed;
        self.rates = begun.then(|| {
            [
                rate(traffic.sent, self.last.sent),
                rate(traffic.received, self.last.received),
                rate(traffic.segments, self.last.segments),
            ]
        });
        self.since = now;
        self.last = *traffic;
    }
}

/// A block of figures.
pub struct Section {
    /// Heading.
    pub title: &'static str,
    /// Names and values.
    pub rows: Vec<(&'static str, String)>,
}

/// Draws them.
pub fn show(ui: &mut Ui, language: Language, view: &LinkView, rates: &Rates) {
    let agrees = view.counted.map(|counted| counted == view.commanded);
    for (index, section) in sections(language, view, rates).into_iter().enumerate() {
        if index > 0 {
            ui.add_space(8.0);
        }
        ui.heading(section.title);
        for (name, value) in section.rows {
            ui.horizontal(|ui| {
                ui.label(RichText::new(name).weak());
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                    ui.monospace(value);
                });
            });
        }
        match index {
            0 if view.state.takes_motion() => {
                if let Some(agrees) = agrees {
                    // While slides move the report is always a little behind.
                    let (zh, en, ink) = match (agrees, view.outstanding.is_zero()) {
                        (true, _) => ("两边计数一致", "The counts agree", GOOD),
                        (false, false) => ("运动中", "On the way", ui.visuals().text_color()),
                        (false, true) => ("两边计数不一致", "The counts differ", BAD),
                    };
                    ui.label(RichText::new(say(language, zh, en)).color(ink));
                }
            }
            1 => {
                let full = view.lookahead.as_secs_f32().max(0.001);
                let share = view.outstanding.as_secs_f32() / full;
                ui.add(ProgressBar::new(share.clamp(0.0, 1.0)).desired_height(8.0));
            }
            _ => {}
        }
    }
    ui.add_space(8.0);
    let words = say(
        language,
        "未接线的信号 (刀架、卡盘、尾座等) 由仿真机床回答。",
        "What is not wired (tool post, chuck, tailstock …) is answered by the simulated lathe.",
    );
    ui.label(RichText::new(words).weak());
}

/// The figures in blocks: position, queue, wire, inputs and outputs.
pub fn sections(language: Language, view: &LinkView, rates: &Rates) -> [Section; 4] {
    [
        position(language, view),
        queue(language, view),
        wire(language, view, rates),
        contacts(language, view),
    ]
}

fn position(language: Language, view: &LinkView) -> Section {
    let axis = |axis: Axis| {
        let commanded = view.commanded.get(axis).0;
        match view.counted.as_ref().map(|counted| counted.get(axis)) {
            Some(Pulses(counted)) => format!("{commanded} / {counted}"),
            None => format!("{commanded} / -"),
        }
    };
    let known = match view.position_known {
        true => say(language, "已知", "known"),
        false => say(language, "未知", "not known"),
    };
    Section {
        title: say(language, "位置 (脉冲)", "Position (pulses)"),
        rows: vec![
            (
                say(language, "X 指令 / 驱动板", "X commanded / board"),
                axis(Axis::X),
            ),
            (
                say(language, "Z 指令 / 驱动板", "Z commanded / board"),
                axis(Axis::Z),
            ),
            (
                say(language, "滑板位置", "place of the slides"),
                known.to_owned(),
            ),
        ],
    }
}

fn queue(language: Language, view: &LinkView) -> Section {
    Section {
        title: say(language, "未完成的运动", "Motion not made yet"),
        rows: vec![
            (
                say(language, "未完成 / 提前量", "outstanding / lookahead"),
                format!("{} / {} ms", whole(view.outstanding), whole(view.lookahead)),
            ),
            (
                say(language, "驱动板队列", "places in the board's queue"),
                view.board.blocks.to_string(),
            ),
        ],
    }
}

fn wire(language: Language, view: &LinkView, rates: &Rates) -> Section {
    let traffic = &view.traffic;
    let trip = view.round_trip.map_or_else(
        || "-".to_owned(),
        |(median, worst)| format!("{} / {} ms", tenths(median), tenths(worst)),
    );
    let rate = |index: usize| rates.rates.map_or(0.0, |rates| rates[index]);
    let (sent, segments) = match view.protocol {
        Protocol::Line => (
            say(language, "发送行数", "lines sent"),
            say(language, "线段", "segments"),
        ),
        Protocol::StepQueue => (
            say(language, "发送数据块", "blocks sent"),
            say(language, "步进指令", "step commands"),
        ),
    };
    Section {
        title: say(language, "通信", "Wire"),
        rows: vec![
            (
                say(language, "往返时间 中值/最大", "round trip, median / worst"),
                trip,
            ),
            (
                say(
                    language,
                    "电脑未查看端口 近来/最长",
                    "computer away, of late / longest",
                ),
                match view.connected {
                    true => format!("{} / {} ms", tenths(view.away.0), tenths(view.away.1)),
                    false => "-".to_owned(),
                },
            ),
            (
                say(language, "字节/秒 发送/接收", "bytes/s out / in"),
                format!("{:.0} / {:.0}", rate(0), rate(1)),
            ),
            (sent, traffic.lines.to_string()),
            (segments, format!("{} ({:.0}/s)", traffic.segments, rate(2))),
            (
                say(language, "重发", "sent again"),
                traffic.resent.to_string(),
            ),
            (
                say(language, "无法识别", "made no sense"),
                traffic.garbage.to_string(),
            ),
        ],
    }
}

fn contacts(language: Language, view: &LinkView) -> Section {
    let missing = say(language, "未接线", "not wired");
    let told = |input: &Input| {
        let mut inputs = view.inputs.iter();
        match inputs.find(|(other, _)| other == input)?.1 {
            _ if !view.connected => Some("-"),
            None => Some(missing),
            Some(true) => Some(say(language, "动作", "operated")),
            Some(false) => Some(say(language, "正常", "free")),
        }
    };
    let mut rows: Vec<(&'static str, String)> = words::INPUTS
        .iter()
        .map(|(inputs, zh, en)| {
            let states: Vec<_> = inputs.iter().filter_map(told).collect();
            (say(language, zh, en), states.join(" / "))
        })
        .collect();
    let contacts: Vec<String> = view
        .inputs
        .iter()
        .filter_map(|(input, state)| match input {
            Input::Contact { byte, bit } => {
                let state = state.map_or('-', |closed| if closed { '1' } else { '0' });
                Some(format!("X{byte}.{bit}={state}"))
            }
            _ => None,
        })
        .collect();
    rows.push((
        say(language, "其他触点", "other contacts"),
        if !view.connected {
            "-".to_owned()
        } else if contacts.is_empty() {
            missing.to_owned()
        } else {
            contacts.join("  ")
        },
    ));
    let outputs = view.outputs.filter(|_| view.connected).map_or_else(
        || {
            if !view.connected {
                "-".to_owned()
            } else {
                say(language, "切换中", "being switched").to_owned()
            }
        },
        |outputs| {
            let spindle = match outputs.spindle {
                SpindleWay::Stop => "M05",
                SpindleWay::Forward => "M03",
                SpindleWay::Reverse => "M04",
            };
            let coolant = if outputs.coolant { "M08" } else { "M09" };
            let volts = f64::from(outputs.millivolts) / 1000.0;
            format!("{spindle} {volts:.2} V  {coolant}")
        },
    );
    rows.push((say(language, "主轴、冷却", "spindle, coolant"), outputs));
    let name = say(language, "主轴一转信号", "index of the spindle");
    rows.push((name, index(language, view)));
    if !view.missing_outputs.is_empty() {
        let names: Vec<_> = view
            .missing_outputs
            .iter()
            .map(|output| words::output(*output))
            .collect();
        let name = say(language, "未接线的输出", "outputs not wired");
        rows.push((name, names.join(" ")));
    }
    Section {
        title: say(language, "输入和输出", "Inputs and outputs"),
        rows,
    }
}

/// What the index tells of the spindle.
fn index(language: Language, view: &LinkView) -> String {
    if !view.connected {
        return "-".to_owned();
    }
    let Some(spindle) = view.spindle else {
        return say(language, "未接线", "not wired").to_owned();
    };
    if spindle.rpm <= 0.0 {
        return say(language, "主轴停止", "it stands").to_owned();
    }
    let varies = spindle.variation.map_or_else(
        || "-".to_owned(),
        |variation| format!("{:.2} %", variation * 100.0),
    );
    let word = say(language, "波动", "varies by");
    format!("{:.1} r/min, {word} {varies}", spindle.rpm)
}

fn whole(time: Duration) -> u128 {
    time.as_millis()
}

fn tenths(time: Duration) -> String {
    format!("{:.1}", time.as_secs_f64() * 1000.0)
}

#[cfg(test)]
mod tests {
    use gsk_core::machine::link::{BoardInfo, LinkState};
    use gsk_core::units::PerAxis;

    use super::*;

    fn view() -> LinkView {
        LinkView {
            state: LinkState::Ready,
            connected: true,
            protocol: Protocol::Line,
            port: "COM3".to_owned(),
            board: BoardInfo::default(),
            position_known: true,
            round_trip: None,
            away: (Duration::from_micros(2_300), Duration::from_millis(87)),
            outstanding: Duration::ZERO,
            lookahead: Duration::from_millis(150),
            traffic: Traffic::default(),
            inputs: Vec::new(),
            missing_outputs: Vec::new(),
            outputs: None,
            spindle: None,
            commanded: PerAxis::default(),
            counted: None,
            differences: Vec::new(),
            exchanges: Vec::new(),
            log: Vec::new(),
        }
    }

    #[test]
    fn the_absence_of_the_computer_is_shown_while_a_board_is_connected() {
        let shown = |view: &LinkView, name: &str, language| {
            let sections = sections(language, view, &Rates::default());
            let mut rows = sections.into_iter().flat_map(|section| section.rows);
            rows.find(|row| row.0.contains(name)).map(|row| row.1)
        };
        let mut view = view();
        let of = |view: &LinkView| shown(view, "computer away", Language::En);
        assert_eq!(of(&view).as_deref(), Some("2.3 / 87.0 ms"));
        let chinese = shown(&view, "电脑未查看端口", Language::Zh);
        assert_eq!(chinese.as_deref(), Some("2.3 / 87.0 ms"));
        view.connected = false;
        assert_eq!(of(&view).as_deref(), Some("-"));
    }
}
