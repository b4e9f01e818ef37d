//! Joins the exchange with a board and the inputs of the machine to the events of a recording.

use super::RecordingEvent;
use crate::board_exchange::{BoardStep, StampedStep};
use crate::moment::RecordedInput;

/// Joins inputs and steps of the exchange in the order in which they acted.
pub fn join_exchange(inputs: &[RecordedInput], steps: &[StampedStep]) -> Vec<RecordingEvent> {
    let mut events = Vec::with_capacity(inputs.len() + steps.len());
    let mut inputs = inputs.iter().peekable();
    let as_event = |input: &RecordedInput| RecordingEvent::Input(Box::new(input.clone()));
    let board = |step| RecordingEvent::Board(Box::new(step));
    for StampedStep { tick, step } in steps {
        while let Some(input) = inputs.next_if(|input| input.tick <= *tick) {
            events.push(as_event(input));
        }
        let BoardStep::Ticked(count, is_refused) = *step else {
            events.push(board(step.clone()));
            continue;
        };
        let end = tick + u64::from(count);
        let mut at = *tick;
        while let Some(input) = inputs.next_if(|input| input.tick < end) {
            if input.tick > at {
                events.push(board(BoardStep::Ticked((input.tick - at) as u32, false)));
                at = input.tick;
            }
            events.push(as_event(input));
        }
        events.push(board(BoardStep::Ticked((end - at) as u32, is_refused)));
    }
    events.extend(inputs.map(as_event));
    events
}
