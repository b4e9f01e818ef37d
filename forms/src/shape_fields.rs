//! Fields with the dimensions of the cut.

use gsk_messages::say;

use crate::fields::{FieldInput, FieldOption, FieldUnit};
use crate::kind::FormKind;
use crate::thousandths::Thousandths;
use crate::values::FormField;

const fn mm(value: i64) -> Thousandths {
    Thousandths::whole(value)
}

pub(crate) static STOCK: FormField = FormField::number(
    "STOCK",
    (say::form_field_stock, say::form_field_stock_tip),
    FieldUnit::Diameter,
    (3_000, 500_000),
    |_| mm(50),
)
.shown_if(|values| !values.has("SIDE", "IN"));
pub(crate) static HOLE: FormField = FormField::number(
    "HOLE",
    (say::form_field_hole, say::form_field_hole_tip),
    FieldUnit::Diameter,
    (6_000, 400_000),
    |_| mm(20),
)
.shown_if(|values| values.form() == FormKind::Bore || values.has("SIDE", "IN"));
pub(crate) static CORE: FormField = FormField::number(
    "BORE",
    (say::form_field_core, say::form_field_core_tip),
    FieldUnit::Diameter,
    (0, 400_000),
    |_| mm(0),
);
pub(crate) static ALLOWANCE: FormField = FormField::number(
    "ALLOW",
    (say::form_field_allow, say::form_field_allow_tip),
    FieldUnit::Length,
    (10, 50_000),
    |_| mm(2),
);
pub(crate) static FINISH_FACE: FormField = FormField::number(
    "FIN",
    (say::form_field_finz, say::form_field_finz_tip),
    FieldUnit::Length,
    (0, 2_000),
    |_| Thousandths(200),
);
pub(crate) static DIAMETER: FormField = FormField::number(
    "D",
    (say::form_field_d, say::form_field_d_tip),
    FieldUnit::Diameter,
    (1_000, 500_000),
    |values| match values.form() {
        FormKind::Bore => mm(30),
        FormKind::Groove if values.has("SIDE", "IN") => mm(30),
        _ => mm(40),
    },
);
pub(crate) static FRONT: FormField = FormField::number(
    "DF",
    (say::form_field_df, say::form_field_df_tip),
    FieldUnit::Diameter,
    (1_000, 500_000),
    |values| values.number("D"),
);
pub(crate) static LENGTH: FormField = FormField::number(
    "L",
    (say::form_field_l, say::form_field_l_tip),
    FieldUnit::Length,
    (500, 1_000_000),
    |values| match values.form() {
        FormKind::Thread => mm(20),
        _ => mm(30),
    },
);
pub(crate) static POINTS: FormField = FormField {
    id: "POINTS",
    name: say::form_field_points,
    tip: say::form_field_points_tip,
    input: FieldInput::Outline {
        default: "X20Z0C1/Z-15/X30A30R2/Z-35R2/X44C1/Z-50",
    },
    is_shown: |_| true,
};
pub(crate) static GROOVE_BOTTOM: FormField = FormField::number(
    "DB",
    (say::form_field_db, say::form_field_db_tip),
    FieldUnit::Diameter,
    (1_000, 500_000),
    |values| match values.has("SIDE", "IN") {
        true => values.number("D") + mm(6),
        false => values.number("D") - mm(8),
    },
);
pub(crate) static POSITION: FormField = FormField::number(
    "POS",
    (say::form_field_pos, say::form_field_pos_tip),
    FieldUnit::Length,
    (0, 1_000_000),
    |_| mm(10),
);
pub(crate) static WIDTH: FormField = FormField::number(
    "W",
    (say::form_field_w, say::form_field_w_tip),
    FieldUnit::Length,
    (500, 200_000),
    |_| mm(5),
);
pub(crate) static BLADE: FormField = FormField::number(
    "TW",
    (say::form_field_tw, say::form_field_tw_tip),
    FieldUnit::Length,
    (500, 10_000),
    |_| mm(3),
);
pub(crate) static COUNT: FormField = FormField::number(
    "COUNT",
    (say::form_field_count, say::form_field_count_tip),
    FieldUnit::Count,
    (1_000, 50_000),
    |_| mm(1),
);
pub(crate) static PITCH_OF_GROOVES: FormField = FormField::number(
    "STEP",
    (say::form_field_step, say::form_field_step_tip),
    FieldUnit::Length,
    (500, 500_000),
    |values| values.number("W") + mm(5),
)
.shown_if(|values| values.number("COUNT").0 > 1_000);
pub(crate) static PECK: FormField = FormField::number(
    "PECK",
    (say::form_field_peck, say::form_field_peck_tip),
    FieldUnit::Length,
    (100, 100_000),
    |values| match values.form() {
        FormKind::Drill => mm(5),
        _ => mm(2),
    },
);
pub(crate) static THREAD: FormField = FormField {
    id: "THREAD",
    name: say::form_field_thread,
    tip: say::form_field_thread_tip,
    input: FieldInput::Thread { default: "M20x1.5" },
    is_shown: |_| true,
};
pub(crate) static THREAD_DIAMETER: FormField = FormField::number(
    "D",
    (say::form_field_thread_d, say::form_field_thread_d_tip),
    FieldUnit::Diameter,
    (2_000, 300_000),
    |_| mm(20),
)
.shown_if(|values| values.has("THREAD", "FREE"));
pub(crate) static THREAD_PITCH: FormField = FormField::number(
    "PITCH",
    (say::form_field_pitch, say::form_field_pitch_tip),
    FieldUnit::Length,
    (200, 12_000),
    |_| Thousandths(1_500),
)
.shown_if(|values| values.has("THREAD", "FREE"));
pub(crate) static HAND: FormField = FormField::choice(
    "HAND",
    (say::form_field_hand, say::form_field_hand_tip),
    &[
        FieldOption {
            word: "RIGHT",
            name: say::form_option_right,
        },
        FieldOption {
            word: "LEFT",
            name: say::form_option_left,
        },
    ],
);
pub(crate) static STARTS: FormField = FormField::number(
    "STARTS",
    (say::form_field_starts, say::form_field_starts_tip),
    FieldUnit::Count,
    (1_000, 8_000),
    |_| mm(1),
);
pub(crate) static FIRST_PASS: FormField = FormField::number(
    "FIRST",
    (say::form_field_first, say::form_field_first_tip),
    FieldUnit::Length,
    (20, 2_000),
    |_| Thousandths(300),
);
pub(crate) static LEAST_PASS: FormField = FormField::number(
    "LEAST",
    (say::form_field_least, say::form_field_least_tip),
    FieldUnit::Length,
    (0, 1_000),
    |_| Thousandths(50),
);
pub(crate) static LAST_PASS: FormField = FormField::number(
    "LAST",
    (say::form_field_last, say::form_field_last_tip),
    FieldUnit::Length,
    (0, 500),
    |_| Thousandths(20),
);
pub(crate) static FINISH_PASSES: FormField = FormField::number(
    "PASSES",
    (say::form_field_passes, say::form_field_passes_tip),
    FieldUnit::Count,
    (1_000, 20_000),
    |_| mm(2),
);
pub(crate) static RUN_OUT: FormField = FormField::number(
    "RUNOUT",
    (say::form_field_runout, say::form_field_runout_tip),
    FieldUnit::Leads,
    (0, 9_900),
    |_| mm(1),
);
pub(crate) static RUN_IN: FormField = FormField::number(
    "RUNIN",
    (say::form_field_runin, say::form_field_runin_tip),
    FieldUnit::Length,
    (500, 100_000),
    crate::blocks::default_run_in,
);
pub(crate) static HOLE_DIAMETER: FormField = FormField::number(
    "D",
    (say::form_field_drill_d, say::form_field_drill_d_tip),
    FieldUnit::Diameter,
    (500, 100_000),
    |values| match values.form() {
        FormKind::Center => mm(6),
        _ => mm(10),
    },
);
pub(crate) static POINT_ANGLE: FormField = FormField::number(
    "POINT",
    (say::form_field_point, say::form_field_point_tip),
    FieldUnit::Angle,
    (60_000, 180_000),
    |values| match values.form() {
        FormKind::Center => mm(60),
        _ => mm(118),
    },
);
pub(crate) static DWELL: FormField = FormField::number(
    "DWELL",
    (say::form_field_dwell, say::form_field_dwell_tip),
    FieldUnit::Seconds,
    (0, 10_000),
    |_| Thousandths(200),
);
pub(crate) static COMPENSATION: FormField = FormField::choice(
    "COMP",
    (say::form_field_comp, say::form_field_comp_tip),
    &[
        FieldOption {
            word: "BLOCKS",
            name: say::form_option_comp_blocks,
        },
        FieldOption {
            word: "G41",
            name: say::form_option_comp_codes,
        },
    ],
)
.shown_if(|values| values.number("NOSE").0 > 0);
pub(crate) static UNDERCUTS: FormField = FormField::choice(
    "UNDER",
    (say::form_field_under, say::form_field_under_tip),
    &[
        FieldOption {
            word: "NO",
            name: say::form_option_under_no,
        },
        FieldOption {
            word: "YES",
            name: say::form_option_under_yes,
        },
    ],
);
pub(crate) static INSERT_ANGLE: FormField = FormField::number(
    "INSERT",
    (say::form_field_insert, say::form_field_insert_tip),
    FieldUnit::Angle,
    (35_000, 80_000),
    |_| mm(35),
)
.shown_if(|values| values.has("UNDER", "YES"));
