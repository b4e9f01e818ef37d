//! The table of forms and their fields.

use crate::common_fields::{
    COOL, DEPTH, DIR, EDGE, EDGE_SIZE, F, FEED, FF, FILLET, FINX, FINZ, NOSE, SAFEX, SAFEZ,
    SEQUENCE, SIDE, SMAX, SPEED, SPIN, TOOL,
};
use crate::kind::FormKind;
use crate::shape_fields::{
    ALLOWANCE, BLADE, COMPENSATION, CORE, COUNT, DIAMETER, DWELL, FINISH_FACE, FINISH_PASSES,
    FIRST_PASS, FRONT, GROOVE_BOTTOM, HAND, HOLE, HOLE_DIAMETER, INSERT_ANGLE, LAST_PASS,
    LEAST_PASS, LENGTH, PECK, PITCH_OF_GROOVES, POINT_ANGLE, POINTS, POSITION, RUN_IN, RUN_OUT,
    STARTS, STOCK, THREAD, THREAD_DIAMETER, THREAD_PITCH, UNDERCUTS, WIDTH,
};
use crate::values::{FieldList, FormField, FormValues};

static FACE_FIELDS: FieldList = &[
    &STOCK,
    &CORE,
    &ALLOWANCE,
    &DEPTH,
    &FINISH_FACE,
    &TOOL,
    &NOSE,
    &SPIN,
    &SPEED,
    &SMAX,
    &DIR,
    &FEED,
    &F,
    &FF,
    &COOL,
    &SAFEX,
    &SAFEZ,
];
static TURN_FIELDS: FieldList = &[
    &STOCK, &DIAMETER, &FRONT, &LENGTH, &EDGE, &EDGE_SIZE, &FILLET, &DEPTH, &FINX, &FINZ, &TOOL,
    &NOSE, &SPIN, &SPEED, &SMAX, &DIR, &FEED, &F, &FF, &COOL, &SAFEX, &SAFEZ, &SEQUENCE,
];
static BORE_FIELDS: FieldList = &[
    &HOLE, &DIAMETER, &FRONT, &LENGTH, &EDGE, &EDGE_SIZE, &FILLET, &DEPTH, &FINX, &FINZ, &TOOL,
    &NOSE, &SPIN, &SPEED, &SMAX, &DIR, &FEED, &F, &FF, &COOL, &SAFEX, &SAFEZ, &SEQUENCE,
];
static CONTOUR_FIELDS: FieldList = &[
    &SIDE,
    &STOCK,
    &HOLE,
    &POINTS,
    &UNDERCUTS,
    &INSERT_ANGLE,
    &DEPTH,
    &FINX,
    &FINZ,
    &TOOL,
    &NOSE,
    &COMPENSATION,
    &SPIN,
    &SPEED,
    &SMAX,
    &DIR,
    &FEED,
    &F,
    &FF,
    &COOL,
    &SAFEX,
    &SAFEZ,
    &SEQUENCE,
];
static GROOVE_FIELDS: FieldList = &[
    &SIDE,
    &DIAMETER,
    &GROOVE_BOTTOM,
    &POSITION,
    &WIDTH,
    &COUNT,
    &PITCH_OF_GROOVES,
    &PECK,
    &TOOL,
    &BLADE,
    &SPIN,
    &SPEED,
    &SMAX,
    &DIR,
    &FEED,
    &F,
    &COOL,
    &SAFEX,
    &SAFEZ,
];
static PART_OFF_FIELDS: FieldList = &[
    &DIAMETER, &CORE, &LENGTH, &PECK, &TOOL, &BLADE, &SPIN, &SPEED, &SMAX, &DIR, &FEED, &F, &COOL,
    &SAFEX, &SAFEZ,
];
static THREAD_FIELDS: FieldList = &[
    &SIDE,
    &THREAD,
    &THREAD_DIAMETER,
    &THREAD_PITCH,
    &HAND,
    &STARTS,
    &LENGTH,
    &FIRST_PASS,
    &LEAST_PASS,
    &LAST_PASS,
    &FINISH_PASSES,
    &RUN_OUT,
    &RUN_IN,
    &TOOL,
    &SPEED,
    &DIR,
    &COOL,
    &SAFEX,
    &SAFEZ,
];
static DRILL_FIELDS: FieldList = &[
    &HOLE_DIAMETER,
    &LENGTH,
    &POINT_ANGLE,
    &PECK,
    &TOOL,
    &SPEED,
    &DIR,
    &FEED,
    &F,
    &COOL,
    &SAFEX,
    &SAFEZ,
];
static CENTER_FIELDS: FieldList = &[
    &HOLE_DIAMETER,
    &POINT_ANGLE,
    &DWELL,
    &TOOL,
    &SPEED,
    &DIR,
    &FEED,
    &F,
    &COOL,
    &SAFEX,
    &SAFEZ,
];

/// The fields of a form, in the order of the dialog.
pub fn form_fields(form: FormKind) -> &'static [&'static FormField] {
    match form {
        FormKind::Face => FACE_FIELDS,
        FormKind::Turn => TURN_FIELDS,
        FormKind::Bore => BORE_FIELDS,
        FormKind::Contour => CONTOUR_FIELDS,
        FormKind::Groove => GROOVE_FIELDS,
        FormKind::PartOff => PART_OFF_FIELDS,
        FormKind::Thread => THREAD_FIELDS,
        FormKind::Drill => DRILL_FIELDS,
        FormKind::Center => CENTER_FIELDS,
    }
}

impl FormValues {
    /// A form with defaults only.
    pub fn new(form: FormKind) -> Self {
        Self::with_fields(form, form_fields(form))
    }
}
