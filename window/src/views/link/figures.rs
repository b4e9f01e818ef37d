//! Formats and draws the figures of the link page.

use std::time::Duration;

use egui::{Align, Layout, ProgressBar, RichText, Ui};
use gsk_core::units::{Axis, Pulses};
use gsk_host::kernel::link_view::LinkView;
use gsk_link::{EncoderReading, Input, Protocol, SpindleDirection, Traffic};

use super::words;
use crate::theme;
use gsk_messages::{Language, say};

/// Interval between two readings of the traffic counters, s.
const INTERVAL: f64 = 1.0;

/// Computes the traffic rates (per second) from the counters.
#[derive(Clone, Copy, Debug, Default)]
pub struct TrafficRates {
    last_time_s: f64,
    last_traffic: Traffic,
    /// Bytes to the board, bytes from the board and motion commands, each per second; `None`
    /// until they are known.
    rates: Option<[f64; 3]>,
}

impl TrafficRates {
    /// Reads the counters at the window's time `now_s`, s, once per `INTERVAL`.
    pub fn update(&mut self, traffic: &Traffic, now_s: f64) {
        let elapsed_s = now_s - self.last_time_s;
        if elapsed_s < INTERVAL {
            return;
        }
        let is_valid = self.last_time_s > 0.0 && traffic.sent >= self.last_traffic.sent;
        let rate = |now: u64, last: u64| now.saturating_sub(last) as f64 / elapsed_s;
        self.rates = is_valid.then(|| {
            [
                rate(traffic.sent, self.last_traffic.sent),
                rate(traffic.received, self.last_traffic.received),
                rate(traffic.segments, self.last_traffic.segments),
            ]
        });
        self.last_time_s = now_s;
        self.last_traffic = *traffic;
    }
}

/// A titled section of the link page with rows of values.
pub struct FigureSection {
    pub title: String,
    /// The rows of the section: each has a name and a value.
    pub rows: Vec<(String, String)>,
}

/// Draws all sections of the link page.
pub fn show(ui: &mut Ui, language: Language, view: &LinkView, rates: &TrafficRates) {
    let counts_agree = view.counted.map(|counted| counted == view.commanded);
    for (index, section) in build_sections(language, view, rates)
        .into_iter()
        .enumerate()
    {
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
                if let Some(agrees) = counts_agree {
                    // While the slides move, the report of the board always lags a little.
                    let (text, ink) = match (agrees, view.outstanding.is_zero()) {
                        (true, _) => (say::link_page_counts_agree(), theme::SUCCESS),
                        (false, false) => (say::link_page_on_the_way(), ui.visuals().text_color()),
                        (false, true) => (say::link_page_counts_differ(), theme::ALARM_TEXT),
                    };
                    ui.label(RichText::new(text.text(language)).color(ink));
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
    let note = say::link_page_not_wired_is_simulated().text(language);
    ui.label(RichText::new(note).weak());
}

/// Formats the sections of figures: position, queue, wire, inputs and outputs.
pub fn build_sections(
    language: Language,
    view: &LinkView,
    rates: &TrafficRates,
) -> [FigureSection; 4] {
    [
        position_section(language, view),
        queue_section(language, view),
        wire_section(language, view, rates),
        contacts_section(language, view),
    ]
}

fn position_section(language: Language, view: &LinkView) -> FigureSection {
    let axis = |axis: Axis| {
        let commanded = view.commanded.get(axis).0;
        match view.counted.as_ref().map(|counted| counted.get(axis)) {
            Some(Pulses(counted)) => format!("{commanded} / {counted}"),
            None => format!("{commanded} / -"),
        }
    };
    let position_text = match view.position_known {
        true => say::link_page_place_known().text(language),
        false => say::link_page_place_not_known().text(language),
    };
    FigureSection {
        title: say::link_page_position().text(language),
        rows: vec![
            (
                say::link_page_x_commanded_board().text(language),
                axis(Axis::X),
            ),
            (
                say::link_page_z_commanded_board().text(language),
                axis(Axis::Z),
            ),
            (
                say::link_page_place_of_slides().text(language),
                position_text,
            ),
        ],
    }
}

fn queue_section(language: Language, view: &LinkView) -> FigureSection {
    FigureSection {
        title: say::link_page_motion_not_made().text(language),
        rows: vec![
            (
                say::link_page_outstanding_lookahead().text(language),
                format!(
                    "{} / {} ms",
                    whole_ms(view.outstanding),
                    whole_ms(view.lookahead)
                ),
            ),
            (
                say::link_page_queue_places().text(language),
                view.board.blocks.to_string(),
            ),
        ],
    }
}

fn wire_section(language: Language, view: &LinkView, rates: &TrafficRates) -> FigureSection {
    let traffic = &view.traffic;
    let trip = view.round_trip.map_or_else(
        || "-".to_owned(),
        |(median, worst)| format!("{} / {} ms", tenths_ms(median), tenths_ms(worst)),
    );
    let rate = |index: usize| rates.rates.map_or(0.0, |rates| rates[index]);
    let (sent, segments) = match view.protocol {
        Protocol::Line => (
            say::link_page_lines_sent().text(language),
            say::link_page_segments().text(language),
        ),
        Protocol::StepQueue => (
            say::link_page_blocks_sent().text(language),
            say::link_page_step_commands().text(language),
        ),
    };
    FigureSection {
        title: say::link_page_wire().text(language),
        rows: vec![
            (say::link_page_round_trip().text(language), trip),
            (
                say::link_page_computer_away().text(language),
                match view.is_connected {
                    true => format!(
                        "{} / {} ms",
                        tenths_ms(view.absence.0),
                        tenths_ms(view.absence.1)
                    ),
                    false => "-".to_owned(),
                },
            ),
            (
                say::link_page_bytes_per_second().text(language),
                format!("{:.0} / {:.0}", rate(0), rate(1)),
            ),
            (sent, traffic.lines.to_string()),
            (segments, format!("{} ({:.0}/s)", traffic.segments, rate(2))),
            (
                say::link_page_sent_again().text(language),
                traffic.resent.to_string(),
            ),
            (
                say::link_page_made_no_sense().text(language),
                traffic.garbage.to_string(),
            ),
        ],
    }
}

fn contacts_section(language: Language, view: &LinkView) -> FigureSection {
    let not_wired = say::link_page_not_wired().text(language);
    let state_text = |input: &Input| {
        let mut inputs = view.inputs.iter();
        match inputs.find(|(other, _)| other == input)?.1 {
            _ if !view.is_connected => Some("-".to_owned()),
            None => Some(not_wired.clone()),
            Some(true) => Some(say::link_page_input_operated().text(language)),
            Some(false) => Some(say::link_page_input_free().text(language)),
        }
    };
    let mut rows: Vec<(String, String)> = words::input_rows()
        .into_iter()
        .map(|(inputs, name)| {
            let states: Vec<_> = inputs.iter().filter_map(state_text).collect();
            (name.text(language), states.join(" / "))
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
        say::link_page_other_contacts().text(language),
        if !view.is_connected {
            "-".to_owned()
        } else if contacts.is_empty() {
            not_wired
        } else {
            contacts.join("  ")
        },
    ));
    let outputs = view.outputs.filter(|_| view.is_connected).map_or_else(
        || {
            if !view.is_connected {
                "-".to_owned()
            } else {
                say::link_page_being_switched().text(language)
            }
        },
        |outputs| {
            let spindle = match outputs.spindle {
                SpindleDirection::Stop => "M05",
                SpindleDirection::Forward => "M03",
                SpindleDirection::Reverse => "M04",
            };
            let coolant = if outputs.coolant { "M08" } else { "M09" };
            let volts = f64::from(outputs.millivolts) / 1000.0;
            format!("{spindle} {volts:.2} V  {coolant}")
        },
    );
    rows.push((say::link_page_spindle_coolant().text(language), outputs));
    match view.encoder.filter(|_| view.is_connected) {
        Some(encoder) => rows.extend(encoder_rows(language, view, encoder)),
        None => {
            let name = say::link_page_spindle_index().text(language);
            rows.push((name, spindle_index_text(language, view)));
        }
    }
    if !view.missing_outputs.is_empty() {
        let names: Vec<_> = view
            .missing_outputs
            .iter()
            .map(|output| words::output_name(*output))
            .collect();
        let name = say::link_page_outputs_not_wired().text(language);
        rows.push((name, names.join(" ")));
    }
    FigureSection {
        title: say::link_page_inputs_outputs().text(language),
        rows,
    }
}

/// Speed, angle and ripple of a spindle with an encoder, and the phase error of the last thread.
fn encoder_rows(
    language: Language,
    view: &LinkView,
    encoder: EncoderReading,
) -> [(String, String); 4] {
    let speed = match view.spindle.map_or(0.0, |spindle| spindle.rpm) {
        rpm if rpm > 0.0 => format!("{rpm:.1} r/min"),
        _ => say::link_page_spindle_stands().text(language),
    };
    let angle = match encoder.angle {
        Some(turns) => format!("{:.1}°", turns * 360.0),
        None => say::link_page_index_not_passed().text(language),
    };
    let percent = |ripple: f64| format!("{:.1} %", ripple * 100.0);
    let ripple = encoder.ripple.map_or_else(|| "-".to_owned(), percent);
    let phase_error = match encoder.phase_error {
        Some(pulses) => say::link_page_pulses(pulses).text(language),
        None => "-".to_owned(),
    };
    [
        (say::link_page_spindle_speed().text(language), speed),
        (say::link_page_spindle_angle().text(language), angle),
        (say::link_page_spindle_ripple().text(language), ripple),
        (
            say::link_page_thread_phase_error().text(language),
            phase_error,
        ),
    ]
}

/// Describes the state of the spindle's index signal.
fn spindle_index_text(language: Language, view: &LinkView) -> String {
    if !view.is_connected {
        return "-".to_owned();
    }
    let Some(spindle) = view.spindle else {
        return say::link_page_not_wired().text(language);
    };
    if spindle.rpm <= 0.0 {
        return say::link_page_spindle_stands().text(language);
    }
    let variation = spindle.variation.map_or_else(
        || "-".to_owned(),
        |variation| format!("{:.2} %", variation * 100.0),
    );
    say::link_page_spindle_turns(spindle.rpm, variation).text(language)
}

fn whole_ms(time: Duration) -> u128 {
    time.as_millis()
}

fn tenths_ms(time: Duration) -> String {
    format!("{:.1}", time.as_secs_f64() * 1000.0)
}

#[cfg(test)]
mod tests {
    use gsk_core::units::PerAxis;
    use gsk_link::{BoardInfo, LinkState, SpindleView};

    use super::*;

    fn view() -> LinkView {
        LinkView {
            state: LinkState::Ready,
            is_connected: true,
            protocol: Protocol::Line,
            port: "COM3".to_owned(),
            board: BoardInfo::default(),
            position_known: true,
            round_trip: None,
            absence: (Duration::from_micros(2_300), Duration::from_millis(87)),
            outstanding: Duration::ZERO,
            lookahead: Duration::from_millis(150),
            traffic: Traffic::default(),
            inputs: Vec::new(),
            missing_outputs: Vec::new(),
            outputs: None,
            spindle: None,
            encoder: None,
            commanded: PerAxis::default(),
            counted: None,
            differences: Vec::new(),
            traffic_lines: Vec::new(),
            position_checks: Vec::new(),
        }
    }

    #[test]
    fn the_longest_poll_gap_is_shown_while_a_board_is_connected() {
        let value_of = |view: &LinkView, name: &str, language| {
            let sections = build_sections(language, view, &TrafficRates::default());
            let mut rows = sections.into_iter().flat_map(|section| section.rows);
            rows.find(|row| row.0.contains(name)).map(|row| row.1)
        };
        let mut view = view();
        let poll_gap = |view: &LinkView| value_of(view, "computer away", Language::En);
        assert_eq!(poll_gap(&view).as_deref(), Some("2.3 / 87.0 ms"));
        let chinese = value_of(&view, "电脑未查看端口", Language::Zh);
        assert_eq!(chinese.as_deref(), Some("2.3 / 87.0 ms"));
        view.is_connected = false;
        assert_eq!(poll_gap(&view).as_deref(), Some("-"));
    }

    #[test]
    fn a_spindle_with_an_encoder_has_its_angle_and_ripple() {
        let mut view = view();
        let rows = |view: &LinkView| {
            let sections = build_sections(Language::En, view, &TrafficRates::default());
            let rows = sections.into_iter().flat_map(|section| section.rows);
            let spindle = rows.filter(|row| row.0.contains("spindle"));
            spindle.map(|row| row.1).collect::<Vec<_>>()
        };
        let phase_error = |view: &LinkView, language| {
            let sections = build_sections(language, view, &TrafficRates::default());
            let mut rows = sections.into_iter().flat_map(|section| section.rows);
            rows.find(|row| row.0.contains("phase error") || row.0.contains("螺纹相位误差"))
                .map(|row| row.1)
        };
        assert_eq!(rows(&view).last().map(String::as_str), Some("not wired"));
        assert_eq!(phase_error(&view, Language::En), None);
        view.encoder = Some(EncoderReading::default());
        assert_eq!(rows(&view)[1..], ["stopped", "no index yet", "-"]);
        // A board that does not report it.
        assert_eq!(phase_error(&view, Language::En).as_deref(), Some("-"));
        view.spindle = Some(SpindleView {
            rpm: 600.0,
            ..SpindleView::default()
        });
        view.encoder = Some(EncoderReading {
            angle: Some(0.25),
            ripple: Some(0.123),
            phase_error: Some(0.634),
        });
        let error = phase_error(&view, Language::En);
        assert_eq!(error.as_deref(), Some("0.63 pulses"));
        let error = phase_error(&view, Language::Zh);
        assert_eq!(error.as_deref(), Some("0.63 脉冲"));
        assert_eq!(rows(&view)[1..], ["600.0 r/min", "90.0°", "12.3 %"]);
        view.is_connected = false;
        assert_eq!(rows(&view).last().map(String::as_str), Some("-"));
    }
}
