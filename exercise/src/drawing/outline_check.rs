//! Compares the outline of a task with the dimensions that it marks.

use gsk_messages::{Message, say};

use crate::criterion::CriterionRule;
use crate::outline::locate;
use crate::task::ExerciseTask;

/// Greatest permitted difference between the outline and a dimension of the task, mm or degrees.
const TOLERANCE: f64 = 0.01;

/// Returns a message for each dimension of the task that its outline does not have, or has with
/// another size.
pub fn check_outline(task: &ExerciseTask) -> Vec<Message> {
    let Some(outline) = &task.outline else {
        return Vec::new();
    };
    let mut faults = Vec::new();
    for criterion in &task.criteria {
        let CriterionRule::Size(dimension, size) = &criterion.rule else {
            continue;
        };
        match locate(outline, dimension) {
            None => faults.push(say::exercise_outline_without(&criterion.id)),
            Some((_, Some(drawn))) if (drawn - size.nominal).abs() > TOLERANCE => {
                let other = say::exercise_outline_size(drawn, &criterion.id, size.nominal);
                faults.push(other);
            }
            Some(_) => {}
        }
    }
    faults
}
