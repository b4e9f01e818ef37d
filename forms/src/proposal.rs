//! Speed, feed and depth that a form proposes for a material.

use gsk_workpiece::cutting::{CuttingMaterial, CuttingOperation, StartingValues};

use crate::error::FormError;
use crate::kind::FormKind;
use crate::values::{FormValue, FormValues};

/// Share of the nose radius that a feed may have.
const FEED_PER_NOSE: f64 = 2.0 / 3.0;

impl FormValues {
    /// Sets speed, feed and depth to the mean starting values for a material, at constant surface
    /// speed and with a feed per revolution. Returns false, and changes nothing, if the table has
    /// none for this form.
    ///
    /// # Errors
    /// A value is out of the range of its field.
    pub fn propose(&mut self, material: &CuttingMaterial) -> Result<bool, FormError> {
        let find = |operation| {
            let mut rows = StartingValues::of_material(material);
            rows.find(|it| it.operation == operation)
        };
        let finishing = find(CuttingOperation::Finishing);
        let main = match self.form() {
            FormKind::Groove | FormKind::PartOff => find(CuttingOperation::Grooving),
            FormKind::Face | FormKind::Turn | FormKind::Bore | FormKind::Contour => {
                find(CuttingOperation::Roughing).or(finishing)
            }
            FormKind::Thread | FormKind::Drill | FormKind::Center => None,
        };
        let Some(main) = main else {
            return Ok(false);
        };
        let mut proposed = self.clone();
        proposed.set_text("SPIN", "CSS")?;
        proposed.set_text("FEED", "TURN")?;
        proposed.set_text("S", &format!("{:.0}", mean(main.speed_m_per_min)))?;
        let greatest_feed = proposed.greatest_feed();
        let feed = |range| format!("{:.2}", mean(range).min(greatest_feed));
        proposed.set_text("F", &feed(main.feed_mm))?;
        if let (Some(finishing), Ok(_)) = (finishing, self.field("FF")) {
            proposed.set_text("FF", &feed(finishing.feed_mm))?;
        }
        if let (Some(depth), Ok(_)) = (main.depth_mm, self.field("DEPTH")) {
            proposed.set_text("DEPTH", &format!("{:.2}", mean(depth)))?;
        }
        *self = proposed;
        Ok(true)
    }

    /// The greatest feed for the nose of the form's insert, mm; infinite without a nose.
    fn greatest_feed(&self) -> f64 {
        let nose = self.field("NOSE").map(|field| self.get(field));
        match nose {
            Ok(FormValue::Number(nose)) if nose.value() > 0.0 => nose.value() * FEED_PER_NOSE,
            _ => f64::INFINITY,
        }
    }
}

fn mean((least, greatest): (f64, f64)) -> f64 {
    f64::midpoint(least, greatest)
}
