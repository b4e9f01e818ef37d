//! The stock before the first cut, its chuck and its tailstock.

use gsk_messages::{Message, say};
use gsk_units::{Diameter, Point};
use serde::{Deserialize, Serialize};

use crate::grid::{GridContour, GridPoint, grid, to_grid};
use crate::region::Region;
use crate::tool::check_range;

/// Greatest permitted length of stock, mm.
const MAX_LENGTH_MM: f64 = 5000.0;
/// Greatest permitted diameter of stock, mm.
const MAX_DIAMETER_MM: f64 = 2000.0;

/// The stock and its clamping. Z 0 is at the finished face.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stock {
    /// The form of the stock: bar, tube or a turned contour.
    pub form: StockForm,
    /// The facing allowance: length of the stock in front of Z 0, mm.
    #[serde(default)]
    pub face: f64,
    /// The whole length of the stock, mm.
    pub length: f64,
    /// The length of the stock in front of the jaws, mm.
    pub overhang: f64,
    /// The material of the stock: the drawn chips and colours, and the cutting force if no
    /// grade is named.
    #[serde(default)]
    pub material: StockMaterial,
    /// The grade of the material in the table of materials, for instance `C45`; `None` for the
    /// usual one of the material.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grade: Option<String>,
    /// The chuck that clamps the stock.
    #[serde(default)]
    pub chuck: Chuck,
    /// The tailstock that supports the front end; `None` without one.
    #[serde(default)]
    pub tailstock: Option<Tailstock>,
}

/// The form of the stock: bar, tube or turned contour.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum StockForm {
    /// A round bar without a bore.
    Bar {
        /// The diameter of the bar, mm.
        diameter: Diameter,
    },
    /// A bar with a through bore.
    Tube {
        /// Outside diameter of the tube, mm.
        diameter: Diameter,
        /// Inside diameter of the tube, mm.
        bore: Diameter,
    },
    /// A turned blank, given by the corners of its half section from front to back.
    Contour {
        /// Diameter and Z of each corner of the contour, mm; straight lines join them.
        corners: Vec<(Diameter, f64)>,
        /// Inside diameter of the contour, mm; 0 without a bore.
        bore: Diameter,
    },
}

/// The material of the stock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum StockMaterial {
    /// The stock is carbon steel.
    #[default]
    Steel,
    /// The stock is stainless steel, whose chips do not break.
    Stainless,
    /// The stock is grey cast iron, whose chips crumble.
    CastIron,
    /// The stock is aluminium alloy.
    Aluminium,
    /// The stock is brass, whose chips are short.
    Brass,
    /// The stock is plastic.
    Plastic,
}

impl StockMaterial {
    /// All materials, in the order in which lists show them.
    pub const ALL: [Self; 6] = [
        Self::Steel,
        Self::Stainless,
        Self::CastIron,
        Self::Aluminium,
        Self::Brass,
        Self::Plastic,
    ];

    /// Returns the name of the material for the user.
    pub fn name(self) -> Message {
        match self {
            Self::Steel => say::stock_material_steel(),
            Self::Stainless => say::stock_material_stainless(),
            Self::CastIron => say::stock_material_cast_iron(),
            Self::Aluminium => say::stock_material_aluminium(),
            Self::Brass => say::stock_material_brass(),
            Self::Plastic => say::stock_material_plastic(),
        }
    }
}

/// A chuck with its jaws.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Chuck {
    /// Diameter of the chuck body, mm.
    pub diameter: Diameter,
    /// Length of the chuck body, mm.
    pub length: f64,
    /// Length of the jaws in front of the chuck body, mm.
    pub jaws: f64,
    /// Height of a jaw above the surface of the stock, mm.
    pub jaw_height: f64,
}

impl Default for Chuck {
    fn default() -> Self {
        Self {
            diameter: Diameter(125.0),
            length: 70.0,
            jaws: 30.0,
            jaw_height: 25.0,
        }
    }
}

/// A tailstock with a live centre of 60°.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tailstock {
    /// Diameter of the quill, mm.
    pub quill: Diameter,
    /// Diameter of the centre's cone at the front of the stock, mm.
    pub center: Diameter,
}

impl Stock {
    /// Creates a bar in the default chuck. `diameter`, `face` (the facing allowance in front
    /// of Z 0) and `overhang` (the length in front of the jaws) are in mm.
    pub fn bar(diameter: f64, face: f64, overhang: f64) -> Self {
        let chuck = Chuck::default();
        Self {
            form: StockForm::Bar {
                diameter: Diameter(diameter),
            },
            face,
            length: overhang + chuck.jaws + 10.0,
            overhang,
            chuck,
            material: StockMaterial::default(),
            grade: None,
            tailstock: None,
        }
    }

    /// Checks that all dimensions are in their ranges.
    ///
    /// # Errors
    /// The first dimension out of range, or a contour with too few corners or with corners
    /// that do not run from front to back.
    pub fn check(&self) -> Result<(), Message> {
        check_range(self.length, 1.0, MAX_LENGTH_MM, say::stock_word_length())?;
        check_range(self.overhang, 1.0, self.length, say::stock_word_overhang())?;
        check_range(self.face, 0.0, self.overhang, say::stock_word_face())?;
        let (outside, bore) = match &self.form {
            StockForm::Bar { diameter } => (*diameter, Diameter(0.0)),
            StockForm::Tube { diameter, bore } => (*diameter, *bore),
            StockForm::Contour { corners, bore } => {
                if corners.len() < 2 {
                    return Err(say::stock_few_corners());
                }
                for (diameter, z) in corners {
                    check_range(diameter.0, 0.0, MAX_DIAMETER_MM, say::stock_word_diameter())?;
                    check_range(*z, -MAX_LENGTH_MM, MAX_LENGTH_MM, say::stock_word_corner())?;
                }
                if corners.windows(2).any(|pair| pair[1].1 > pair[0].1) {
                    return Err(say::stock_corners_back());
                }
                let greatest = corners.iter().map(|corner| corner.0.0);
                (Diameter(greatest.fold(0.0, f64::max)), *bore)
            }
        };
        check_range(outside.0, 0.5, MAX_DIAMETER_MM, say::stock_word_diameter())?;
        check_range(bore.0, 0.0, outside.0 - 0.1, say::stock_word_bore())?;
        if let Some(Tailstock { quill, center }) = self.tailstock {
            check_range(quill.0, 1.0, 500.0, say::stock_word_quill())?;
            check_range(center.0, 0.1, quill.0, say::stock_word_center())?;
        }
        self.chuck.check()
    }

    /// Returns the greatest radius of the stock, mm.
    pub fn radius(&self) -> f64 {
        match &self.form {
            StockForm::Bar { diameter } | StockForm::Tube { diameter, .. } => diameter.radius(),
            StockForm::Contour { corners, .. } => corners
                .iter()
                .map(|corner| corner.0.radius())
                .fold(0.0, f64::max),
        }
    }

    /// Returns Z of the front face of the stock, mm.
    pub const fn front(&self) -> f64 {
        self.face
    }

    /// Returns Z of the back face of the stock, mm.
    pub const fn back(&self) -> f64 {
        self.face - self.length
    }

    /// Returns Z of the front of the jaws, mm.
    pub const fn jaw_front(&self) -> f64 {
        self.face - self.overhang
    }

    /// Returns the half section of the stock.
    pub fn section(&self) -> Region {
        let (outside, bore): (Region, Diameter) = match &self.form {
            StockForm::Bar { diameter } => (self.cylinder(*diameter), Diameter(0.0)),
            StockForm::Tube { diameter, bore } => (self.cylinder(*diameter), *bore),
            StockForm::Contour { corners, bore } => {
                let mut contour: GridContour = corners
                    .iter()
                    .map(|(diameter, z)| to_grid(Point::from_diameter(*diameter, *z)))
                    .collect();
                // Close the contour along the spindle axis.
                if let (Some(first), Some(last)) = (contour.first(), contour.last()) {
                    let (front, back) = (GridPoint::new(first.x, 0), GridPoint::new(last.x, 0));
                    contour.extend([back, front]);
                }
                (Region::from_contours(&[contour]), *bore)
            }
        };
        if bore.0 <= 0.0 {
            return outside;
        }
        let hole = Region::rectangle(
            GridPoint::new(grid(-2.0 * MAX_LENGTH_MM), -1),
            GridPoint::new(grid(2.0 * MAX_LENGTH_MM), grid(bore.radius())),
        );
        outside.difference(hole.contours())
    }

    fn cylinder(&self, diameter: Diameter) -> Region {
        Region::rectangle(
            to_grid(Point::new(0.0, self.back())),
            to_grid(Point::new(diameter.radius(), self.front())),
        )
    }

    /// The half sections of the chuck body and of the jaws, closed on the stock.
    pub fn chuck_section(&self) -> (Region, Region) {
        let chuck = &self.chuck;
        let face = self.jaw_front() - chuck.jaws;
        let low = Point::new(0.0, face - chuck.length);
        let high = Point::new(chuck.diameter.radius(), face);
        let body = Region::rectangle(to_grid(low), to_grid(high));
        (body, self.jaws(self.radius()))
    }

    /// The half section of the jaws of a power chuck when it is open.
    pub fn open_jaws(&self) -> Region {
        /// Radial travel of the jaws between clamped and open, mm.
        const JAW_TRAVEL_MM: f64 = 5.0;
        self.jaws(self.radius() + JAW_TRAVEL_MM)
    }

    /// The half section of the jaws with their clamping surface at a radius, mm.
    fn jaws(&self, radius: f64) -> Region {
        let end = self.jaw_front();
        let low = Point::new(radius, end - self.chuck.jaws);
        let high = Point::new(radius + self.chuck.jaw_height, end);
        Region::rectangle(to_grid(low), to_grid(high))
    }

    /// The half section of the tailstock: the cone of its centre and the quill. Empty
    /// without a tailstock.
    pub fn tailstock_section(&self) -> Region {
        let Some(tailstock) = self.tailstock else {
            return Region::default();
        };
        /// Length of the quill in front of the tailstock, mm.
        const QUILL_LENGTH_MM: f64 = 80.0;
        let (small, large) = (tailstock.center.radius(), tailstock.quill.radius());
        // Half the cone angle is 30°: the length is the radius times cot 30°.
        let cone = (large - small).max(0.0) * 1.732_050_807_568_877_2;
        let front = self.front();
        let corners = [
            Point::new(0.0, front),
            Point::new(small, front),
            Point::new(large, front + cone),
            Point::new(large, front + cone + QUILL_LENGTH_MM),
            Point::new(0.0, front + cone + QUILL_LENGTH_MM),
        ];
        Region::from_contours(&[corners.map(to_grid).to_vec()])
    }
}

impl Chuck {
    fn check(&self) -> Result<(), Message> {
        check_range(self.diameter.0, 20.0, 1000.0, say::stock_word_chuck())?;
        check_range(self.length, 10.0, 500.0, say::stock_word_chuck_length())?;
        check_range(self.jaws, 1.0, 300.0, say::stock_word_jaws())?;
        check_range(self.jaw_height, 1.0, 300.0, say::stock_word_jaw_height())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stock_has_the_volume_of_its_form() {
        let pi = core::f64::consts::PI;
        let bar = Stock::bar(50.0, 1.0, 80.0);
        bar.check().unwrap();
        assert!((bar.section().volume() / (pi * 625.0 * 120.0) - 1.0).abs() < 1e-12);
        let tube = Stock {
            form: StockForm::Tube {
                diameter: Diameter(60.0),
                bore: Diameter(20.0),
            },
            ..bar.clone()
        };
        assert!((tube.section().volume() / (pi * 800.0 * 120.0) - 1.0).abs() < 1e-12);
        let cone = Stock {
            form: StockForm::Contour {
                corners: vec![(Diameter(0.0), 0.0), (Diameter(40.0), -30.0)],
                bore: Diameter(0.0),
            },
            ..bar
        };
        assert!((cone.section().volume() / (pi * 400.0 * 10.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn an_error_names_the_value_out_of_range() {
        let mut stock = Stock::bar(50.0, 1.0, 80.0);
        stock.overhang = 500.0;
        assert!(stock.check().unwrap_err().to_string().contains("500"));
        stock = Stock::bar(f64::NAN, 1.0, 80.0);
        assert!(stock.check().is_err());
        stock = Stock::bar(50.0, 1.0, 80.0);
        stock.tailstock = Some(Tailstock {
            quill: Diameter(40.0),
            center: Diameter(-6.0),
        });
        assert!(stock.check().unwrap_err().to_string().contains("-6"));
    }

    #[test]
    fn stock_without_a_material_is_steel() {
        let written = "(form: Bar(diameter: 50), length: 90, overhang: 60)";
        let stock: Stock = ron::from_str(written).unwrap();
        assert_eq!(stock.material, StockMaterial::Steel);
        let brass = written.replace("length", "material: Brass, length");
        let stock: Stock = ron::from_str(&brass).unwrap();
        assert_eq!(stock.material, StockMaterial::Brass);
    }

    #[test]
    fn closed_jaws_touch_the_stock_and_the_chuck_body() {
        let stock = Stock::bar(50.0, 0.0, 60.0);
        let (body, jaws) = stock.chuck_section();
        let (body, jaws) = (body.bounds().unwrap(), jaws.bounds().unwrap());
        assert_eq!(jaws.low.y, grid(25.0));
        assert_eq!(jaws.high.x, grid(-60.0));
        assert_eq!(jaws.low.x, body.high.x);
        let open = stock.open_jaws().bounds().unwrap();
        assert!(open.low.y > jaws.low.y && open.high.x == jaws.high.x);
    }
}
