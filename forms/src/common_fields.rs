//! Fields that several forms share: tool, spindle, feed, safe position, allowances.

use gsk_messages::say;

use crate::fields::{FieldOption, FieldUnit};
use crate::kind::FormKind;
use crate::thousandths::Thousandths;
use crate::values::{FormField, FormValues};

/// Distance of the safe position beyond the surface that the form cuts, mm.
const SAFE_BEYOND_MM: f64 = 40.0;

pub(crate) static SIDE: FormField = FormField::choice(
    "SIDE",
    (say::form_field_side, say::form_field_side_tip),
    &[
        FieldOption {
            word: "OUT",
            name: say::form_option_out,
        },
        FieldOption {
            word: "IN",
            name: say::form_option_in,
        },
    ],
);
pub(crate) static EDGE: FormField = FormField::choice(
    "EDGE",
    (say::form_field_edge, say::form_field_edge_tip),
    &[
        FieldOption {
            word: "SHARP",
            name: say::form_option_sharp,
        },
        FieldOption {
            word: "CHAMFER",
            name: say::form_option_chamfer,
        },
        FieldOption {
            word: "RADIUS",
            name: say::form_option_radius,
        },
    ],
);
pub(crate) static EDGE_SIZE: FormField = FormField::number(
    "C",
    (say::form_field_c, say::form_field_c_tip),
    FieldUnit::Length,
    (10, 100_000),
    |_| Thousandths::whole(1),
)
.shown_if(|values| !values.has("EDGE", "SHARP"));
pub(crate) static FILLET: FormField = FormField::number(
    "R",
    (say::form_field_r, say::form_field_r_tip),
    FieldUnit::Length,
    (0, 100_000),
    |_| Thousandths(0),
);
pub(crate) static DEPTH: FormField = FormField::number(
    "DEPTH",
    (say::form_field_depth, say::form_field_depth_tip),
    FieldUnit::Length,
    (50, 20_000),
    |values| match values.form() {
        FormKind::Turn => Thousandths(2_000),
        _ => Thousandths(1_000),
    },
);
pub(crate) static FINX: FormField = FormField::number(
    "FINX",
    (say::form_field_finx, say::form_field_finx_tip),
    FieldUnit::Diameter,
    (0, 5_000),
    |_| Thousandths(400),
);
pub(crate) static FINZ: FormField = FormField::number(
    "FINZ",
    (say::form_field_finz, say::form_field_finz_tip),
    FieldUnit::Length,
    (0, 2_000),
    |_| Thousandths(100),
);
pub(crate) static TOOL: FormField = FormField::number(
    "TOOL",
    (say::form_field_tool, say::form_field_tool_tip),
    FieldUnit::Count,
    (1_000, 32_000),
    |values| {
        Thousandths::whole(match values.form() {
            FormKind::Bore => 2,
            FormKind::Contour if values.has("SIDE", "IN") => 2,
            FormKind::Face | FormKind::Turn | FormKind::Contour => 1,
            FormKind::Groove | FormKind::PartOff => 3,
            FormKind::Thread | FormKind::Drill | FormKind::Center => 4,
        })
    },
);
pub(crate) static NOSE: FormField = FormField::number(
    "NOSE",
    (say::form_field_nose, say::form_field_nose_tip),
    FieldUnit::Length,
    (0, 2_400),
    |_| Thousandths(400),
);
pub(crate) static SPIN: FormField = FormField::choice(
    "SPIN",
    (say::form_field_spin, say::form_field_spin_tip),
    &[
        FieldOption {
            word: "RPM",
            name: say::form_option_rpm,
        },
        FieldOption {
            word: "CSS",
            name: say::form_option_css,
        },
    ],
);
pub(crate) static SPEED: FormField = FormField::number(
    "S",
    (say::form_field_s, say::form_field_s_tip),
    FieldUnit::Speed,
    (1_000, 9_999_000),
    |values| {
        Thousandths::whole(match values.form() {
            _ if values.has("SPIN", "CSS") => 150,
            FormKind::Thread => 500,
            FormKind::Groove | FormKind::PartOff => 600,
            _ => 800,
        })
    },
);
pub(crate) static SMAX: FormField = FormField::number(
    "SMAX",
    (say::form_field_smax, say::form_field_smax_tip),
    FieldUnit::Revolutions,
    (100_000, 9_999_000),
    |_| Thousandths::whole(2000),
)
.shown_if(|values| values.has("SPIN", "CSS"));
pub(crate) static DIR: FormField = FormField::choice(
    "DIR",
    (say::form_field_dir, say::form_field_dir_tip),
    &[
        FieldOption {
            word: "FWD",
            name: say::form_option_fwd,
        },
        FieldOption {
            word: "REV",
            name: say::form_option_rev,
        },
    ],
);
pub(crate) static FEED: FormField = FormField::choice(
    "FEED",
    (say::form_field_feed, say::form_field_feed_tip),
    &[
        FieldOption {
            word: "TURN",
            name: say::form_option_per_turn,
        },
        FieldOption {
            word: "MIN",
            name: say::form_option_per_minute,
        },
    ],
);
pub(crate) static F: FormField = FormField::number(
    "F",
    (say::form_field_f, say::form_field_f_tip),
    FieldUnit::Feed,
    (1, 8_000_000),
    |values| {
        let per_turn = match values.form() {
            FormKind::Groove | FormKind::PartOff | FormKind::Center => 60,
            FormKind::Drill => 120,
            _ => 200,
        };
        feed(values, per_turn)
    },
);
pub(crate) static FF: FormField = FormField::number(
    "FF",
    (say::form_field_ff, say::form_field_ff_tip),
    FieldUnit::Feed,
    (1, 8_000_000),
    |values| feed(values, 100),
);
pub(crate) static COOL: FormField = FormField::choice(
    "COOL",
    (say::form_field_cool, say::form_field_cool_tip),
    &[
        FieldOption {
            word: "ON",
            name: say::form_option_on,
        },
        FieldOption {
            word: "OFF",
            name: say::form_option_off,
        },
    ],
);
pub(crate) static SAFEX: FormField = FormField::number(
    "SAFEX",
    (say::form_field_safex, say::form_field_safex_tip),
    FieldUnit::Diameter,
    (10_000, 900_000),
    |values| {
        let widest = crate::blocks::outside_diameter(values);
        Thousandths::round(libm::ceil((widest + SAFE_BEYOND_MM) / 10.0) * 10.0)
    },
);
pub(crate) static SAFEZ: FormField = FormField::number(
    "SAFEZ",
    (say::form_field_safez, say::form_field_safez_tip),
    FieldUnit::Length,
    (5_000, 900_000),
    |_| Thousandths::whole(100),
);
pub(crate) static SEQUENCE: FormField = FormField::number(
    "N",
    (say::form_field_n, say::form_field_n_tip),
    FieldUnit::Count,
    (1_000, 9_998_000),
    |_| Thousandths::whole(100),
);

/// A feed per revolution, or the same per minute at about 500 r/min, thousandths.
fn feed(values: &FormValues, per_turn: i64) -> Thousandths {
    match values.has("FEED", "MIN") {
        true => Thousandths::whole(per_turn / 2),
        false => Thousandths(per_turn),
    }
}
