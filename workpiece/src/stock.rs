//! The stock before the first cut, and what holds it.

use gsk_messages::{Message, say};
use gsk_units::{Diameter, Point};
use serde::{Deserialize, Serialize};

use crate::grid::{Contour, GridPoint, grid, to_grid};
use crate::region::Region;
use crate::tool::within;

/// Longest stock, mm.
const LONGEST: f64 = 5000.0;
/// Thickest stock, mm of diameter.
const THICKEST: f64 = 2000.0;

/// Stock, its zero at the finished face.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stock {
    /// Its form.
    pub form: Form,
    /// How far it stands out in front of the zero, mm.
    #[serde(default)]
    pub face: f64,
    /// Its whole length, mm.
    pub length: f64,
    /// How far it stands out of the jaws, from its front, mm.
    pub overhang: f64,
    /// What clamps it.
    #[serde(default)]
    pub chuck: Chuck,
    /// What holds it at its other end.
    #[serde(default)]
    pub tailstock: Option<Tailstock>,
}

/// Form of the stock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Form {
    /// A round bar.
    Bar {
        /// Its diameter, mm.
        diameter: Diameter,
    },
    /// A tube.
    Tube {
        /// Outside diameter, mm.
        diameter: Diameter,
        /// Inside diameter, mm.
        bore: Diameter,
    },
    /// Turned before: corners of the half section from the front to the back.
    Contour {
        /// Diameter and Z of each corner, mm; lines between them.
        corners: Vec<(Diameter, f64)>,
        /// Inside diameter, mm; 0 for none.
        bore: Diameter,
    },
}

/// A chuck with jaws.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Chuck {
    /// Diameter of its body, mm.
    pub diameter: Diameter,
    /// Length of its body, mm.
    pub length: f64,
    /// How far the jaws stand out of it, mm.
    pub jaws: f64,
    /// Height of a jaw above the stock, mm.
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
    /// Diameter of the centre's cone where it leaves the part, mm.
    pub center: Diameter,
}

impl Stock {
    /// A bar that stands out so far in front of the zero and of the jaws.
    pub fn bar(diameter: f64, face: f64, overhang: f64) -> Self {
        let chuck = Chuck::default();
        Self {
            form: Form::Bar {
                diameter: Diameter(diameter),
            },
            face,
            length: overhang + chuck.jaws + 10.0,
            overhang,
            chuck,
            tailstock: None,
        }
    }

    /// Whether its lengths make stock.
    ///
    /// # Errors
    /// The rule that is broken.
    pub fn check(&self) -> Result<(), Message> {
        within(self.length, 1.0, LONGEST, say::stock_word_length())?;
        within(self.overhang, 1.0, self.length, say::stock_word_overhang())?;
        within(self.face, 0.0, self.overhang, say::stock_word_face())?;
        let (outside, bore) = match &self.form {
            Form::Bar { diameter } => (*diameter, Diameter(0.0)),
            Form::Tube { diameter, bore } => (*diameter, *bore),
            Form::Contour { corners, bore } => {
                if corners.len() < 2 {
                    return Err(say::stock_few_corners());
                }
                for (diameter, z) in corners {
                    within(diameter.0, 0.0, THICKEST, say::stock_word_diameter())?;
                    within(*z, -LONGEST, LONGEST, say::stock_word_corner())?;
                }
                if corners.windows(2).any(|pair| pair[1].1 > pair[0].1) {
                    return Err(say::stock_corners_back());
                }
                let greatest = corners.iter().map(|corner| corner.0.0);
                (Diameter(greatest.fold(0.0, f64::max)), *bore)
            }
        };
        within(outside.0, 0.5, THICKEST, say::stock_word_diameter())?;
        within(bore.0, 0.0, outside.0 - 0.1, say::stock_word_bore())?;
        if let Some(Tailstock { quill, center }) = self.tailstock {
            within(quill.0, 1.0, 500.0, say::stock_word_quill())?;
            within(center.0, 0.1, quill.0, say::stock_word_center())?;
        }
        self.chuck.check()
    }

    /// Its greatest radius, mm.
    pub fn radius(&self) -> f64 {
        match &self.form {
            Form::Bar { diameter } | Form::Tube { diameter, .. } => diameter.radius(),
            Form::Contour { corners, .. } => corners
                .iter()
                .map(|corner| corner.0.radius())
                .fold(0.0, f64::max),
        }
    }

    /// Z of its front, mm.
    pub const fn front(&self) -> f64 {
        self.face
    }

    /// Z of its back, mm.
    pub const fn back(&self) -> f64 {
        self.face - self.length
    }

    /// Z of the front of the jaws, mm.
    pub const fn clamped(&self) -> f64 {
        self.face - self.overhang
    }

    /// Its half section.
    pub fn section(&self) -> Region {
        let (outside, bore): (Region, Diameter) = match &self.form {
            Form::Bar { diameter } => (self.cylinder(*diameter), Diameter(0.0)),
            Form::Tube { diameter, bore } => (self.cylinder(*diameter), *bore),
            Form::Contour { corners, bore } => {
                let mut contour: Contour = corners
                    .iter()
                    .map(|(diameter, z)| to_grid(Point::from_diameter(*diameter, *z)))
                    .collect();
                // Down to the axis at both ends.
                if let (Some(first), Some(last)) = (contour.first(), contour.last()) {
                    let (front, back) = (GridPoint::new(first.x, 0), GridPoint::new(last.x, 0));
                    contour.extend([back, front]);
                }
                (Region::of(&[contour]), *bore)
            }
        };
        if bore.0 <= 0.0 {
            return outside;
        }
        let hole = Region::rectangle(
            GridPoint::new(grid(-2.0 * LONGEST), -1),
            GridPoint::new(grid(2.0 * LONGEST), grid(bore.radius())),
        );
        outside.without(hole.contours())
    }

    fn cylinder(&self, diameter: Diameter) -> Region {
        Region::rectangle(
            to_grid(Point::new(0.0, self.back())),
            to_grid(Point::new(diameter.radius(), self.front())),
        )
    }

    /// The chuck's body and its jaws closed on the stock, as half sections.
    pub fn chuck_section(&self) -> (Region, Region) {
        let chuck = &self.chuck;
        let face = self.clamped() - chuck.jaws;
        let low = Point::new(0.0, face - chuck.length);
        let high = Point::new(chuck.diameter.radius(), face);
        let body = Region::rectangle(to_grid(low), to_grid(high));
        (body, self.jaws(self.radius()))
    }

    /// The jaws when a power chuck has let the stock go.
    pub fn open_jaws(&self) -> Region {
        /// How far they go outwards, mm.
        const OPEN: f64 = 5.0;
        self.jaws(self.radius() + OPEN)
    }

    /// The jaws with their inside at a radius.
    fn jaws(&self, radius: f64) -> Region {
        let end = self.clamped();
        let low = Point::new(radius, end - self.chuck.jaws);
        let high = Point::new(radius + self.chuck.jaw_height, end);
        Region::rectangle(to_grid(low), to_grid(high))
    }

    /// The tailstock's half section: the cone of its centre and the quill.
    pub fn tailstock_section(&self) -> Region {
        let Some(tailstock) = self.tailstock else {
            return Region::default();
        };
        /// Length of the quill that is drawn, mm.
        const QUILL: f64 = 80.0;
        let (small, large) = (tailstock.center.radius(), tailstock.quill.radius());
        // 60°: the cone grows by tan 30°.
        let cone = (large - small).max(0.0) * 1.732_050_807_568_877_2;
        let front = self.front();
        let corners = [
            Point::new(0.0, front),
            Point::new(small, front),
            Point::new(large, front + cone),
            Point::new(large, front + cone + QUILL),
            Point::new(0.0, front + cone + QUILL),
        ];
        Region::of(&[corners.map(to_grid).to_vec()])
    }
}

impl Chuck {
    fn check(&self) -> Result<(), Message> {
        within(self.diameter.0, 20.0, 1000.0, say::stock_word_chuck())?;
        within(self.length, 10.0, 500.0, say::stock_word_chuck_length())?;
        within(self.jaws, 1.0, 300.0, say::stock_word_jaws())?;
        within(self.jaw_height, 1.0, 300.0, say::stock_word_jaw_height())
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
            form: Form::Tube {
                diameter: Diameter(60.0),
                bore: Diameter(20.0),
            },
            ..bar.clone()
        };
        assert!((tube.section().volume() / (pi * 800.0 * 120.0) - 1.0).abs() < 1e-12);
        let cone = Stock {
            form: Form::Contour {
                corners: vec![(Diameter(0.0), 0.0), (Diameter(40.0), -30.0)],
                bore: Diameter(0.0),
            },
            ..bar
        };
        assert!((cone.section().volume() / (pi * 400.0 * 10.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_makes_no_stock_is_named() {
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
    fn jaws_lie_on_the_stock_and_the_chuck_behind_them() {
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
