//! A job: the stock and the tools of a program, as they stand in a file beside it.

use std::collections::BTreeMap;

use gsk_messages::{Message, say};
use gsk_units::{Diameter, Point};
use serde::{Deserialize, Serialize};

use crate::stock::Stock;
use crate::tool::Tool;

/// Stock, tools, and where they really are.
///
/// The control knows offsets, the lathe has lengths: where both agree, the part comes
/// out as programmed; a wrong offset cuts wrong.
///
/// ```text
///   tip in the part = slide (machine coordinates) − zero − length of the tool
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Job {
    /// The stock and its clamping.
    pub stock: Stock,
    /// The tools by their T number.
    #[serde(default)]
    pub tools: BTreeMap<u8, Tool>,
    /// Machine coordinates of the slide when the tip of a tool of no length stands on
    /// the zero of the part. None: where the control has its zero.
    #[serde(default)]
    pub zero: Option<Place>,
    /// Real lengths of the tools. Of a tool without one: what the control has as its
    /// offset when it first uses it.
    #[serde(default)]
    pub lengths: BTreeMap<u8, Place>,
}

/// A point as people write it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// X as a diameter, mm.
    pub x: Diameter,
    /// Z, mm.
    pub z: f64,
}

impl Place {
    /// As a point, X a radius.
    pub const fn point(self) -> Point {
        Point::from_diameter(self.x, self.z)
    }
}

impl From<Point> for Place {
    fn from(point: Point) -> Self {
        Self {
            x: point.diameter(),
            z: point.z,
        }
    }
}

impl Job {
    /// Only stock; tools follow.
    pub const fn new(stock: Stock) -> Self {
        Self {
            stock,
            tools: BTreeMap::new(),
            zero: None,
            lengths: BTreeMap::new(),
        }
    }

    /// Whether everything in it is what it can be.
    ///
    /// # Errors
    /// The rule that is broken, with the tool it is about.
    pub fn check(&self) -> Result<(), Message> {
        self.stock.check()?;
        for (number, tool) in &self.tools {
            let named = |rule: Message| say::job_of_tool(number, rule);
            tool.check().map_err(named)?;
        }
        let places = self.zero.iter().chain(self.lengths.values());
        for place in places {
            if !place.x.0.is_finite() || !place.z.is_finite() {
                return Err(say::job_place_not_finite());
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stock::Form;

    const FILE: &str = "(
        stock: (
            form: Bar(diameter: 54), face: 2, length: 120, overhang: 82,
        ),
        tools: {
            1: (insert: Turning(letter: C, entering: 95, size: 12.7, nose: 0.8), tip: 3,
                holder: Shank(width: 20, length: 60)),
            3: (insert: Grooving(width: 3, nose: 0.1, reach: 16), tip: 3),
        },
        lengths: { 3: (x: 4, z: -1.5) },
    )";

    #[test]
    fn a_job_is_read_from_its_file_and_written_back() {
        let job: Job = ron::from_str(FILE).unwrap();
        job.check().unwrap();
        assert!(matches!(job.stock.form, Form::Bar { diameter } if diameter.0 == 54.0));
        assert_eq!(job.tools[&1], Tool::turning());
        assert_eq!(job.lengths[&3].point(), Point::new(2.0, -1.5));
        let text = ron::to_string(&job).unwrap();
        assert_eq!(ron::from_str::<Job>(&text).unwrap(), job);
    }

    #[test]
    fn a_tool_that_is_none_is_named() {
        let mut job: Job = ron::from_str(FILE).unwrap();
        job.tools.insert(7, Tool::grooving(-3.0));
        let said = job.check().unwrap_err().to_string();
        assert!(said.contains("T07") && said.contains("-3"), "{said}");
    }
}
