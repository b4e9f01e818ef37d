//! Continues a preview after the alarm that ended it, to find further errors.

use gsk_core::alarm::Alarm;
use gsk_core::command::SourcePosition;
use gsk_core::interpreter::WalkedBlock;
use gsk_core::preview::{MAX_FURTHER_ALARMS, PreviewProgress};
use gsk_core::program::ProgramBlock;

use super::{BLOCKS_PER_CALLBACK, Run};
use crate::block::{self, BlockFlow};
use crate::path::travel::ProgressCallback;
use crate::words::BlockWords;

/// Number of blocks after the first alarm that are searched for further alarms.
const MAX_FURTHER_BLOCKS: u64 = 100_000;

impl Run<'_> {
    /// Searches the blocks after an alarm for further ones that are refused regardless of the
    /// tool's position.
    pub(super) fn find_further_alarms(
        &mut self,
        first: Option<&Alarm>,
        on_progress: &mut ProgressCallback<'_>,
    ) -> Vec<Alarm> {
        let mut lines: Vec<SourcePosition> =
            first.and_then(|alarm| alarm.source).into_iter().collect();
        let mut further = Vec::new();
        for count in 1..=MAX_FURTHER_BLOCKS {
            let progress = || PreviewProgress {
                blocks: self.blocks + count,
                ..self.progress()
            };
            if count % BLOCKS_PER_CALLBACK == 0 && !on_progress(&progress()) {
                break;
            }
            let alarm = match self.read() {
                Ok(WalkedBlock::Ended) => break,
                Ok(WalkedBlock::Nothing) => continue,
                Ok(WalkedBlock::Words(block)) => {
                    let source = self.source();
                    match self.check_words(&block) {
                        Ok(true) => break,
                        Ok(false) => continue,
                        Err(alarm) => alarm.with_source(source),
                    }
                }
                Err(alarm) => alarm,
            };
            let Some(source) = alarm.source else { break };
            if lines.contains(&source) {
                break;
            }
            lines.push(source);
            further.push(alarm);
            if further.len() >= MAX_FURTHER_ALARMS {
                break;
            }
        }
        further
    }

    /// Checks a block by its words alone, without motion. Returns whether the program ends
    /// with it.
    fn check_words(&mut self, block: &ProgramBlock) -> Result<bool, Alarm> {
        let mut words = BlockWords::parse(block, self.memory.model.record(), self.state.axes)?;
        let called = self.take_call(&mut words)?;
        words.check()?;
        let flow = block::block_flow(&words, &self.memory)?;
        if !matches!(flow, BlockFlow::Macro { .. }) {
            words.check_axes()?;
        }
        self.state.modal.inch = words.inch.unwrap_or(self.state.modal.inch);
        if let Some(call) = called {
            return self.enter_called(&call, &flow).map(|()| false);
        }
        match flow {
            BlockFlow::End => Ok(true),
            flow => self.follow(flow, block),
        }
    }
}
