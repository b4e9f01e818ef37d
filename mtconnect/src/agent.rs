//! Answers requests from buffer and assets.

use std::sync::Arc;

use gsk_messages::Language;

use crate::agent_identity::AgentIdentity;
use crate::assets::{AgentAssets, AssetBuffer, AssetChange, AssetContent, StoredAsset};
use crate::buffer::{Observation, ObservationBuffer};
use crate::documents::DocumentContext;
use crate::documents::assets::write_assets;
use crate::documents::error::write_error;
use crate::documents::probe::write_probe;
use crate::documents::streams::write_streams;
use crate::model::{ASSET_CHANGED_ID, ASSET_REMOVED_ID};
use crate::query::{AgentError, AssetQuery, CurrentQuery, ErrorCode, SampleQuery};
use crate::reading::MachineReading;
use crate::status;
use crate::time_stamp::TimeStamp;

/// An MTConnectStreams document, with the sequence number at which the next one begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SampleDocument {
    /// The document as XML text.
    pub text: String,
    /// Sequence number from which the next document continues.
    pub next_sequence: u64,
    /// Whether the document has any observation.
    pub has_observations: bool,
}

/// The MTConnect agent: stores the observations and assets of a lathe, and writes its documents.
#[derive(Debug)]
pub struct Agent {
    identity: AgentIdentity,
    buffer: ObservationBuffer,
    assets: AssetBuffer,
    reading: MachineReading,
    /// Machine time of the whole selected program, s; `None` while it is not known.
    program_s: Option<f64>,
}

impl Agent {
    /// Creates an agent in which all items are unavailable.
    pub fn new(identity: AgentIdentity) -> Self {
        Self {
            buffer: ObservationBuffer::new(TimeStamp(identity.started_ms)),
            identity,
            assets: AssetBuffer::default(),
            reading: MachineReading::unavailable(),
            program_s: None,
        }
    }

    /// Returns names, addresses and versions of the agent and its lathe.
    pub const fn identity(&self) -> &AgentIdentity {
        &self.identity
    }

    /// Returns the sequence number that the next observation will get.
    pub const fn next_sequence(&self) -> u64 {
        self.buffer.next_sequence()
    }

    /// Records the values of all data items at `time_ms`, ms since 1970.
    pub fn record(&mut self, time_ms: u64, reading: MachineReading) {
        self.buffer.record(TimeStamp(time_ms), &reading);
        self.reading = reading;
    }

    /// Stores the current assets at `time_ms`, ms since 1970, and records which have changed.
    pub fn set_assets(&mut self, time_ms: u64, assets: &AgentAssets) {
        let time = TimeStamp(time_ms);
        for (change, element, id) in self.assets.update(time, assets) {
            let item = match change {
                AssetChange::Changed => ASSET_CHANGED_ID,
                AssetChange::Removed => ASSET_REMOVED_ID,
            };
            self.buffer.record_asset(time, item, element, &id);
        }
    }

    /// Sets the machine time of the whole selected program, s; `None` if it is not known.
    pub const fn set_program_time(&mut self, seconds: Option<f64>) {
        self.program_s = seconds;
    }

    /// Returns the text of the stored program asset with this name; `None` if it is not stored.
    pub fn program_text(&self, name: &str) -> Option<Arc<str>> {
        match &self.assets.get(name)?.content {
            AssetContent::Program { text } => Some(Arc::clone(text)),
            AssetContent::Tool { .. } => None,
        }
    }

    /// Returns the state of the lathe as JSON, for the page in the browser. `now_ms` is the time of
    /// the response, ms since 1970.
    pub fn status(&self, language: Language, now_ms: u64) -> String {
        let name = &self.identity.description.lathe_name;
        status::write_status(
            name,
            &self.reading,
            self.program_s,
            language,
            TimeStamp(now_ms),
        )
    }

    /// Writes the probe document, with the device model. `now_ms` is the time of the response, ms
    /// since 1970.
    pub fn probe(&self, now_ms: u64) -> String {
        write_probe(self.context(now_ms), self.assets.count())
    }

    /// Writes the document with the values of the selected items at one moment.
    ///
    /// # Errors
    ///
    /// Returns an error if the queried sequence number is not stored.
    pub fn current(&self, query: &CurrentQuery, now_ms: u64) -> Result<String, AgentError> {
        let past = match query.at {
            Some(at) => Some(
                self.buffer
                    .state_at(at)
                    .ok_or_else(|| self.out_of_range("at", at))?,
            ),
            None => None,
        };
        let state = past.as_ref().unwrap_or_else(|| self.buffer.latest());
        let is_selected = |it: &&Observation| is_selected(query.items.as_deref(), it);
        let listed: Vec<&Observation> = state.observations().filter(is_selected).collect();
        let next = query.at.map_or_else(|| self.next_sequence(), |at| at + 1);
        Ok(write_streams(
            self.context(now_ms),
            &self.buffer,
            next,
            &listed,
        ))
    }

    /// Writes the document with observations from the sequence number `from` on, or from that of
    /// the query.
    ///
    /// # Errors
    ///
    /// Returns an error if the first observation is no longer stored.
    pub fn sample(
        &self,
        query: &SampleQuery,
        from: Option<u64>,
        now_ms: u64,
    ) -> Result<SampleDocument, AgentError> {
        let (first, end) = (self.buffer.first_sequence(), self.next_sequence());
        let begin = from.or(query.from).unwrap_or(first);
        // 0 names the oldest observation in many clients.
        let begin = if begin == 0 { first } else { begin };
        if begin < first || begin > end {
            return Err(self.out_of_range("from", begin));
        }
        if let Some(to) = query.to
            && to < begin
        {
            return Err(self.out_of_range("to", to));
        }
        let last = query.to.unwrap_or(u64::MAX);
        let selected = (self.buffer.since(begin))
            .take_while(|it| it.sequence <= last)
            .filter(|it| is_selected(query.items.as_deref(), it));
        let mut listed: Vec<&Observation> = selected.take(query.count + 1).collect();
        // The client continues with the first observation that is left out.
        let next_sequence = match listed.len() > query.count {
            true => listed.pop().map_or(end, |left_out| left_out.sequence),
            false => last.saturating_add(1).min(end),
        };
        Ok(SampleDocument {
            text: write_streams(self.context(now_ms), &self.buffer, next_sequence, &listed),
            next_sequence,
            has_observations: !listed.is_empty(),
        })
    }

    /// Writes the document with the selected assets.
    ///
    /// # Errors
    ///
    /// Returns an error if an asset is not stored.
    pub fn assets(&self, query: &AssetQuery, now_ms: u64) -> Result<String, AgentError> {
        let mut listed: Vec<&StoredAsset> = Vec::new();
        for id in &query.ids {
            listed.push(self.assets.get(id).ok_or_else(|| {
                let reason = format!("There is no asset `{id}`.");
                AgentError::new(ErrorCode::AssetNotFound, reason)
            })?);
        }
        if query.ids.is_empty() {
            let wanted = query.asset_type.as_deref();
            let all = self.assets.newest_first();
            let all = all.filter(|it| wanted.is_none_or(|wanted| wanted == it.element()));
            let all = all.filter(|it| query.with_removed || !it.is_removed);
            listed.extend(all.take(query.count));
        }
        Ok(write_assets(
            self.context(now_ms),
            self.assets.count(),
            &listed,
        ))
    }

    /// Writes the document that reports a refused request to the client.
    pub fn error(&self, error: &AgentError, now_ms: u64) -> String {
        write_error(self.context(now_ms), error)
    }

    const fn context(&self, now_ms: u64) -> DocumentContext<'_> {
        DocumentContext {
            identity: &self.identity,
            now: TimeStamp(now_ms),
        }
    }

    fn out_of_range(&self, parameter: &str, value: u64) -> AgentError {
        let (first, next) = (self.buffer.first_sequence(), self.next_sequence());
        let reason = format!(
            "`{parameter}` is {value}; the buffer has {first} to {}.",
            next - 1
        );
        AgentError::new(ErrorCode::OutOfRange, reason)
    }
}

fn is_selected(items: Option<&[bool]>, observation: &Observation) -> bool {
    items.is_none_or(|items| items.get(observation.item) == Some(&true))
}
