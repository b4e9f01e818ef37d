//! Compares results with the fields that an expectation names.

use serde_json::Value;

/// Greatest difference of two coordinates that the display shows alike, mm.
const COORDINATE_TOLERANCE_MM: f64 = 0.000_6;

/// Returns the differences between an expectation and a result, a line each. Only the fields
/// in the expectation are compared. `path` names the result in the lines. `time_tolerance`, s,
/// applies to fields of time.
pub fn list_differences(
    path: &str,
    expected: &Value,
    actual: &Value,
    time_tolerance: f64,
) -> Vec<String> {
    match (expected, actual) {
        (Value::Object(expected), Value::Object(seen)) => expected
            .iter()
            .flat_map(|(name, value)| {
                let place = format!("{path}.{name}");
                let seen = seen.get(name).unwrap_or(&Value::Null);
                list_differences(&place, value, seen, time_tolerance)
            })
            .collect(),
        (Value::Array(expected), Value::Array(seen)) if path.ends_with(".modal") => expected
            .iter()
            .filter(|code| !seen.contains(code))
            .map(|code| format!("{path}: {code} expected among {seen:?}"))
            .collect(),
        (Value::Array(expected), Value::Array(seen)) if expected.len() == seen.len() => expected
            .iter()
            .zip(seen)
            .enumerate()
            .flat_map(|(index, (expected, seen))| {
                list_differences(&format!("{path}[{index}]"), expected, seen, time_tolerance)
            })
            .collect(),
        (Value::Number(expected), Value::Number(seen)) => {
            let time = path.ends_with("dt") || path.ends_with("time_s");
            let tolerance = if time {
                time_tolerance
            } else {
                COORDINATE_TOLERANCE_MM
            };
            let (a, b) = (
                expected.as_f64().unwrap_or(f64::NAN),
                seen.as_f64().unwrap_or(f64::NAN),
            );
            if (a - b).abs() <= tolerance {
                Vec::new()
            } else {
                vec![format!("{path}: {expected} expected, {seen} seen")]
            }
        }
        (expected, seen) if expected == seen => Vec::new(),
        (expected, seen) => vec![format!("{path}: {expected} expected, {seen} seen")],
    }
}

/// Returns the expectation with its values replaced by those of the result.
pub fn update_expectation(expected: &Value, actual: &Value) -> Value {
    match (expected, actual) {
        (Value::Object(expected), Value::Object(seen)) => Value::Object(
            expected
                .iter()
                .map(|(name, value)| {
                    let seen = seen.get(name).unwrap_or(&Value::Null);
                    (name.clone(), update_expectation(value, seen))
                })
                .collect(),
        ),
        (_, seen) => seen.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn only_named_fields_count() {
        let seen = json!({"x": 10.0003, "z": 5, "dt": 1.5});
        assert!(list_differences("", &json!({"x": 10}), &seen, 0.0).is_empty());
        assert_eq!(
            list_differences("", &json!({"x": 10.01, "q": 1}), &seen, 0.0).len(),
            2
        );
        assert!(list_differences("", &json!({"dt": 1.4}), &seen, 0.2).is_empty());
        assert_eq!(
            list_differences("", &json!({"dt": 1.4}), &seen, 0.05).len(),
            1
        );
    }

    #[test]
    fn an_update_keeps_the_choice_of_fields() {
        let seen = json!({"x": 10.5, "z": 5, "final": {"abs": [1, 2], "rel": [3, 4]}});
        let expected = json!({"x": 0, "final": {"abs": [0, 0]}});
        let wanted = json!({"x": 10.5, "final": {"abs": [1, 2]}});
        assert_eq!(update_expectation(&expected, &seen), wanted);
    }
}
