//! Logs changes of the control and its board: alarms, states of the link, and delays of the kernel
//! thread.

use gsk_core::alarm::Alarm;
use gsk_core::cnc::Cnc;
use gsk_link::LinkState;
use tracing::{info, warn};
use web_time::{Duration, Instant};

/// Shortest delay of the kernel thread that is logged.
const MIN_LOGGED_DELAY: Duration = Duration::from_millis(100);
/// Shortest time between two logged delays.
const REPEAT_INTERVAL: Duration = Duration::from_secs(10);

/// Alarms and link state at the last check, for the log of changes.
#[derive(Debug, Default)]
pub(super) struct ChangeLog {
    alarms: Vec<Alarm>,
    link: Option<LinkState>,
    last_delay_logged: Option<Instant>,
}

impl ChangeLog {
    /// Logs the alarms and the link state that have changed since the last check.
    pub(super) fn log_changes(&mut self, cnc: &Cnc, link: Option<LinkState>) {
        self.log_alarm_changes(cnc.alarms());
        self.log_link_changes(link, cnc.alarms().first());
    }

    fn log_alarm_changes(&mut self, now: &[Alarm]) {
        if self.alarms == now {
            return;
        }
        for alarm in now.iter().filter(|alarm| !self.alarms.contains(alarm)) {
            warn!(
                number = alarm.number,
                line = alarm.source.map(|source| source.line),
                detail = alarm.detail.as_ref().map(tracing::field::display),
                "alarm raised: {}",
                alarm.line_text_en()
            );
        }
        for alarm in self.alarms.iter().filter(|alarm| !now.contains(alarm)) {
            info!(number = alarm.number, "alarm cleared");
        }
        self.alarms = now.to_vec();
    }

    fn log_link_changes(&mut self, now: Option<LinkState>, alarm: Option<&Alarm>) {
        if self.link == now {
            return;
        }
        let before = core::mem::replace(&mut self.link, now);
        match (before, now) {
            (_, None) => info!("link closed"),
            (before, Some(LinkState::Fault | LinkState::Lost | LinkState::Tripped)) => warn!(
                from = before.map(LinkState::name),
                state = now.map(LinkState::name),
                cause = alarm.map(Alarm::line_text_en),
                "link stopped"
            ),
            (None, Some(state)) => info!(state = state.name(), "link opened"),
            (before, Some(state)) => info!(
                from = before.map(LinkState::name),
                state = state.name(),
                "link changed"
            ),
        }
    }

    /// Logs the delay of a turn of the kernel thread that was due at `due` and begins at `now`, if
    /// it is longer than 100 ms and none was logged recently.
    pub(super) fn log_delay(&mut self, now: Instant, due: Instant) {
        let late = now.saturating_duration_since(due);
        let recently_logged = self
            .last_delay_logged
            .is_some_and(|logged| now < logged + REPEAT_INTERVAL);
        if late > MIN_LOGGED_DELAY && !recently_logged {
            self.last_delay_logged = Some(now);
            warn!(ms = late.as_millis(), "the kernel thread was late");
        }
    }
}
