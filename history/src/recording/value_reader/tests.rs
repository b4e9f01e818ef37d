//! Values that `rmp_serde` writes are read back; other bytes are refused.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{MAX_DEPTH, ValueError, read_value};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum Sample {
    Unit,
    Newtype(i64),
    Tuple(u8, f32),
    Struct { name: String, next: Box<Sample> },
    List(Vec<Sample>),
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
enum Untagged {
    Number(f64),
    Text(String),
    Numbers(Vec<i32>),
    Fields { first: bool },
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Marker;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Everything {
    samples: Vec<Sample>,
    untagged: Vec<Untagged>,
    unsigned: (u8, u16, u32, u64),
    signed: Vec<(i8, i16, i32, i64)>,
    float: f64,
    letter: char,
    map: BTreeMap<u64, Option<bool>>,
    marker: Marker,
    unit: (),
    #[serde(default, skip_serializing_if = "Option::is_none")]
    absent: Option<u8>,
    long: String,
}

fn everything() -> Everything {
    let text = Sample::Struct {
        name: "主轴".to_owned(),
        next: Box::new(Sample::Tuple(7, 0.25)),
    };
    Everything {
        samples: vec![Sample::Unit, Sample::List(vec![text; 20])],
        untagged: vec![
            Untagged::Number(1.5),
            Untagged::Text("X".to_owned()),
            Untagged::Numbers(vec![-1, 70_000]),
            Untagged::Fields { first: true },
        ],
        unsigned: (u8::MAX, u16::MAX, u32::MAX, u64::MAX),
        signed: vec![
            (i8::MIN, i16::MIN, i32::MIN, i64::MIN),
            (-1, -33, -129, -40_000),
            (i8::MAX, i16::MAX, i32::MAX, i64::MAX),
        ],
        float: -0.0,
        letter: '刀',
        map: (0..40).map(|key| (key * 9, Some(key % 2 == 0))).collect(),
        marker: Marker,
        unit: (),
        absent: None,
        long: "G01".repeat(30_000),
    }
}

#[test]
fn what_is_written_is_read_back() {
    let value = everything();
    let bytes = rmp_serde::to_vec_named(&value).expect("it is representable");
    assert_eq!(read_value(&bytes), Ok(value.clone()));
    for integer in [Sample::Newtype(-32), Sample::Newtype(i64::from(u32::MAX))] {
        let bytes = rmp_serde::to_vec_named(&integer).expect("it is representable");
        assert_eq!(read_value(&bytes), Ok(integer));
    }
}

#[test]
fn unknown_fields_are_skipped() {
    #[derive(Debug, PartialEq, Deserialize)]
    struct Part {
        letter: char,
        float: f64,
    }
    let bytes = rmp_serde::to_vec_named(&everything()).expect("it is representable");
    let part: Part = read_value(&bytes).expect("the fields are there");
    assert_eq!((part.letter, part.float), ('刀', 0.0));
}

#[test]
fn a_value_that_ends_early_or_late_is_refused() {
    let mut value = everything();
    value.long.truncate(3);
    let mut bytes = rmp_serde::to_vec_named(&value).expect("it is representable");
    for end in 0..bytes.len() {
        assert!(
            read_value::<Everything>(&bytes[..end]).is_err(),
            "after {end} bytes"
        );
    }
    bytes.push(0xc0);
    assert_eq!(
        read_value::<Everything>(&bytes),
        Err(ValueError::BytesAfterValue)
    );
}

#[test]
fn lengths_without_content_reserve_no_memory() {
    for head in [0xdb, 0xdd, 0xdf, 0xc6] {
        let bytes = [head, 0xff, 0xff, 0xff, 0xff];
        assert!(read_value::<Vec<u64>>(&bytes).is_err());
        assert!(read_value::<Untagged>(&bytes).is_err());
        assert!(read_value::<BTreeMap<u8, u8>>(&bytes).is_err());
    }
}

#[test]
fn nesting_is_limited() {
    let nested = |depth: u32| {
        let lists = [0x81, 0xa4, b'L', b'i', b's', b't', 0x91].repeat(depth as usize / 2);
        [lists, b"\xa4Unit".to_vec()].concat()
    };
    assert!(read_value::<Sample>(&nested(MAX_DEPTH)).is_ok());
    assert_eq!(
        read_value::<Sample>(&nested(MAX_DEPTH + 2)),
        Err(ValueError::TooDeep)
    );
}

#[test]
fn changed_bytes_are_read_as_the_other_reader_does_or_refused() {
    let mut value = everything();
    value.long.truncate(3);
    let bytes = rmp_serde::to_vec_named(&value).expect("it is representable");
    let mut read = 0;
    for position in 0..bytes.len() {
        for change in (1..=u8::MAX).step_by(5) {
            let mut changed = bytes.clone();
            changed[position] ^= change;
            let Ok(ours) = read_value::<Everything>(&changed) else {
                continue;
            };
            let theirs: Everything =
                rmp_serde::from_slice(&changed).expect("the other reader accepts it too");
            // Not compared as values: a changed number may be NaN.
            assert_eq!(
                format!("{ours:?}"),
                format!("{theirs:?}"),
                "byte {position} ^ {change}"
            );
            read += 1;
        }
    }
    assert!(read > 3_000, "{read} changed values were readable");
}
