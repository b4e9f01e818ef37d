//! The job of a program: stock, clamping and tools, stored in a RON file beside it.

use std::collections::BTreeMap;

use gsk_messages::{Message, say};
use gsk_units::{Diameter, Point};
use serde::{Deserialize, Serialize};

use crate::cutting::CuttingMaterial;
use crate::stock::Stock;
use crate::tool::{Tool, check_range};

/// Stock, tools and their true positions.
///
/// The control holds tool offsets, the job holds true tool lengths. If they differ, the
/// tool cuts the wrong size, as on a real lathe.
///
/// ```text
///   tip (part coordinates) = slide (machine coordinates) − zero − tool length
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Job {
    /// The stock, its clamping and the tailstock.
    pub stock: Stock,
    /// The tools by tool number, the first two digits of the T word.
    #[serde(default)]
    pub tools: BTreeMap<u8, Tool>,
    /// Ids in the tool library by tool number. A tool of the library replaces the one in `tools`,
    /// which is used where the library lacks it.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub library: BTreeMap<u8, String>,
    /// Machine coordinates of the slide when the tip of a tool of length 0 is at the zero of
    /// the part. With `None` the work zero of the control is used.
    #[serde(default)]
    pub zero: Option<DiameterPoint>,
    /// True tool lengths by tool number. A missing length is the tool offset that is
    /// active when the program first uses the tool.
    #[serde(default)]
    pub lengths: BTreeMap<u8, DiameterPoint>,
    /// Rake angles by tool number, degrees, for the cutting force. The force of a tool without one
    /// is that of the table of materials.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub rakes: BTreeMap<u8, f64>,
}

/// A point with X as a diameter, as operators write it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DiameterPoint {
    /// X of the point as a diameter, mm.
    pub x: Diameter,
    /// Z of the point, mm.
    pub z: f64,
}

impl DiameterPoint {
    /// Returns the point with X as a radius.
    pub const fn point(self) -> Point {
        Point::from_diameter(self.x, self.z)
    }
}

impl From<Point> for DiameterPoint {
    fn from(point: Point) -> Self {
        Self {
            x: point.diameter(),
            z: point.z,
        }
    }
}

impl Job {
    /// Creates a job with stock and without tools.
    pub const fn new(stock: Stock) -> Self {
        Self {
            stock,
            tools: BTreeMap::new(),
            library: BTreeMap::new(),
            zero: None,
            lengths: BTreeMap::new(),
            rakes: BTreeMap::new(),
        }
    }

    /// The material whose constants give the cutting force: the grade of the stock, else the
    /// usual one of its material; `None` for plastic.
    pub fn cutting_material(&self) -> Option<CuttingMaterial> {
        match &self.stock.grade {
            Some(grade) => CuttingMaterial::from_name(grade),
            None => CuttingMaterial::from_stock_material(self.stock.material),
        }
    }

    /// A material with the constants for the rake angle of a tool.
    pub fn material_at_rake(&self, material: &CuttingMaterial, tool: u8) -> CuttingMaterial {
        match self.rakes.get(&tool) {
            Some(rake) => material.with_rake(*rake),
            None => *material,
        }
    }

    /// Checks that all dimensions of stock and tools are in their ranges.
    ///
    /// # Errors
    /// The first value out of range, with the tool number.
    pub fn check(&self) -> Result<(), Message> {
        self.stock.check()?;
        if let Some(grade) = &self.stock.grade
            && CuttingMaterial::from_name(grade).is_none()
        {
            return Err(say::stock_unknown_grade(grade));
        }
        for (number, tool) in &self.tools {
            let with_number = |error: Message| say::job_of_tool(number, error);
            tool.check().map_err(with_number)?;
        }
        let points = self.zero.iter().chain(self.lengths.values());
        for point in points {
            if !point.x.0.is_finite() || !point.z.is_finite() {
                return Err(say::job_place_not_finite());
            }
        }
        for (number, rake) in &self.rakes {
            check_range(*rake, -20.0, 35.0, say::tool_word_rake())
                .map_err(|error| say::job_of_tool(number, error))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stock::StockForm;

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
    fn a_job_survives_a_round_trip_through_its_file() {
        let job: Job = ron::from_str(FILE).unwrap();
        job.check().unwrap();
        assert!(matches!(job.stock.form, StockForm::Bar { diameter } if diameter.0 == 54.0));
        assert_eq!(job.tools[&1], Tool::turning());
        assert_eq!(job.lengths[&3].point(), Point::new(2.0, -1.5));
        let text = ron::to_string(&job).unwrap();
        assert_eq!(ron::from_str::<Job>(&text).unwrap(), job);
    }

    #[test]
    fn the_grade_of_the_stock_is_one_of_the_table() {
        let mut job: Job = ron::from_str(FILE).unwrap();
        assert_eq!(job.cutting_material().unwrap().name, "C45");
        job.stock.grade = Some("42crmo4".to_owned());
        job.check().unwrap();
        assert_eq!(job.cutting_material().unwrap().name, "42CrMo4");
        job.stock.grade = Some("unobtainium".to_owned());
        assert!(job.check().unwrap_err().to_string().contains("unobtainium"));
    }

    #[test]
    fn an_error_names_the_tool_number() {
        let mut job: Job = ron::from_str(FILE).unwrap();
        job.tools.insert(7, Tool::grooving(-3.0));
        let text = job.check().unwrap_err().to_string();
        assert!(text.contains("T07") && text.contains("-3"), "{text}");
    }
}
