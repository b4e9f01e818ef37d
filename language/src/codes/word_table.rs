//! The words that each code of the GSK980TD reads, with their meanings: the one table of them,
//! for completion, hover and signature help. A test compares it with what the control reads.

use gsk_core::model::GCode;
use gsk_messages::{Message, say};

/// A word that a code reads: its letter, and its meaning with the unit of its value.
#[derive(Clone, Copy, Debug)]
pub struct CodeWord {
    /// Letter of the word.
    pub letter: char,
    /// Returns the meaning of the word.
    pub meaning: fn() -> Message,
}

/// The words of one block of a code.
pub type CodeForm = &'static [CodeWord];

const fn word(letter: char, meaning: fn() -> Message) -> CodeWord {
    CodeWord { letter, meaning }
}

const END_X: CodeWord = word('X', say::code_word_end_x);
const END_Z: CodeWord = word('Z', say::code_word_end_z);
const DISTANCE_U: CodeWord = word('U', say::code_word_distance_x);
const DISTANCE_W: CodeWord = word('W', say::code_word_distance_z);
const FEED: CodeWord = word('F', say::code_word_feed);
const LEAD: CodeWord = word('F', say::code_word_lead);
const PER_INCH: CodeWord = word('I', say::code_word_threads_per_inch);
const RUN_OUT_SHORT: CodeWord = word('J', say::code_word_run_out_short);
const RUN_OUT_LONG: CodeWord = word('K', say::code_word_run_out_long);
const TAPER: CodeWord = word('R', say::code_word_taper);
const PROFILE_FIRST: CodeWord = word('P', say::code_word_profile_first);
const PROFILE_LAST: CodeWord = word('Q', say::code_word_profile_last);
const RETRACT: CodeWord = word('R', say::code_word_retract);
const SPEED: CodeWord = word('S', say::code_word_spindle);
const TOOL: CodeWord = word('T', say::code_word_tool);

const MOVE: &[CodeForm] = &[&[END_X, END_Z, DISTANCE_U, DISTANCE_W]];
const LINE: &[CodeForm] = &[&[
    END_X,
    END_Z,
    DISTANCE_U,
    DISTANCE_W,
    FEED,
    word('I', say::code_word_chamfer_x),
    word('K', say::code_word_chamfer_z),
    word('R', say::code_word_corner_radius),
]];
const ARC: &[CodeForm] = &[&[
    END_X,
    END_Z,
    DISTANCE_U,
    DISTANCE_W,
    word('R', say::code_word_arc_radius),
    word('I', say::code_word_centre_x),
    word('K', say::code_word_centre_z),
    FEED,
]];
const DWELL: &[CodeForm] = &[&[
    word('P', say::code_word_dwell_ms),
    word('X', say::code_word_dwell_s),
    word('U', say::code_word_dwell_s),
]];
const REFERENCE: &[CodeForm] = &[&[
    word('X', say::code_word_via_x),
    word('Z', say::code_word_via_z),
    word('U', say::code_word_via_distance_x),
    word('W', say::code_word_via_distance_z),
]];
const THREAD: &[CodeForm] = &[&[
    END_X,
    END_Z,
    DISTANCE_U,
    DISTANCE_W,
    LEAD,
    PER_INCH,
    RUN_OUT_SHORT,
    RUN_OUT_LONG,
]];
const VARIABLE_THREAD: &[CodeForm] = &[&[
    END_X,
    END_Z,
    DISTANCE_U,
    DISTANCE_W,
    LEAD,
    PER_INCH,
    RUN_OUT_SHORT,
    RUN_OUT_LONG,
    word('R', say::code_word_lead_change),
]];
const TAPPING: &[CodeForm] = &[&[
    END_Z,
    DISTANCE_W,
    LEAD,
    PER_INCH,
    word('L', say::code_word_starts),
]];
const COORDINATES: &[CodeForm] = &[&[
    word('X', say::code_word_position_x),
    word('Z', say::code_word_position_z),
    word('U', say::code_word_shift_x),
    word('W', say::code_word_shift_z),
    word('S', say::code_word_max_speed),
]];
const MACRO_COMMAND: &[CodeForm] = &[&[
    word('H', say::code_word_macro_operation),
    word('P', say::code_word_macro_result),
    word('Q', say::code_word_macro_first),
    word('R', say::code_word_macro_second),
]];
const FINISHING: &[CodeForm] = &[&[PROFILE_FIRST, PROFILE_LAST]];
/// The second block of G71, G72 and G73.
const PROFILE_BLOCK: CodeForm = &[
    PROFILE_FIRST,
    PROFILE_LAST,
    word('U', say::code_word_allowance_x),
    word('W', say::code_word_allowance_z),
    FEED,
    SPEED,
    TOOL,
];
const TURNING_ROUGH: &[CodeForm] = &[
    &[
        word('U', say::code_word_depth_x),
        RETRACT,
        FEED,
        SPEED,
        TOOL,
    ],
    PROFILE_BLOCK,
];
const FACING_ROUGH: &[CodeForm] = &[
    &[
        word('W', say::code_word_depth_z),
        RETRACT,
        FEED,
        SPEED,
        TOOL,
    ],
    PROFILE_BLOCK,
];
const PATTERN: &[CodeForm] = &[
    &[
        word('U', say::code_word_path_x),
        word('W', say::code_word_path_z),
        word('R', say::code_word_pass_count),
        FEED,
        SPEED,
        TOOL,
    ],
    PROFILE_BLOCK,
];
const FACE_PECKING: &[CodeForm] = &[
    &[RETRACT],
    &[
        END_X,
        END_Z,
        DISTANCE_U,
        DISTANCE_W,
        word('P', say::code_word_step_x),
        word('Q', say::code_word_peck_z),
        word('R', say::code_word_retract_bottom_x),
        FEED,
    ],
];
const GROOVING: &[CodeForm] = &[
    &[RETRACT],
    &[
        END_X,
        END_Z,
        DISTANCE_U,
        DISTANCE_W,
        word('P', say::code_word_peck_x),
        word('Q', say::code_word_step_z),
        word('R', say::code_word_retract_bottom_z),
        FEED,
    ],
];
const COMPOUND_THREAD: &[CodeForm] = &[
    &[
        word('P', say::code_word_thread_data),
        word('Q', say::code_word_least_depth),
        word('R', say::code_word_thread_allowance),
    ],
    &[
        END_X,
        END_Z,
        DISTANCE_U,
        DISTANCE_W,
        TAPER,
        word('P', say::code_word_thread_height),
        word('Q', say::code_word_first_pass),
        LEAD,
        PER_INCH,
    ],
];
const TURNING_CYCLE: &[CodeForm] = &[&[END_X, END_Z, DISTANCE_U, DISTANCE_W, TAPER, FEED]];
const FACING_CYCLE: &[CodeForm] = &[&[
    END_X,
    END_Z,
    DISTANCE_U,
    DISTANCE_W,
    word('R', say::code_word_taper_z),
    FEED,
]];
const THREAD_CYCLE: &[CodeForm] = &[&[
    END_X,
    END_Z,
    DISTANCE_U,
    DISTANCE_W,
    TAPER,
    LEAD,
    PER_INCH,
    RUN_OUT_SHORT,
    RUN_OUT_LONG,
    word('L', say::code_word_starts),
]];
const SURFACE_SPEED: &[CodeForm] = &[&[word('S', say::code_word_surface_speed)]];
const SPINDLE_SPEED: &[CodeForm] = &[&[word('S', say::code_word_speed)]];
const FEED_UNIT: &[CodeForm] = &[&[FEED]];
const CALL: &[CodeForm] = &[&[word('P', say::code_word_call)]];
const RETURN: &[CodeForm] = &[&[word('P', say::code_word_return_block)]];

/// The blocks of a G code of a lathe with the words that each reads, besides M, S and T where
/// they act by themselves. Empty for codes that are described by the letters of their words
/// only.
pub const fn code_forms(code: GCode) -> &'static [CodeForm] {
    match code {
        GCode::Rapid | GCode::StraightRapid => MOVE,
        GCode::Line => LINE,
        GCode::ArcClockwise
        | GCode::ArcCounterclockwise
        | GCode::LongArcClockwise
        | GCode::LongArcCounterclockwise
        | GCode::DiameterArcClockwise
        | GCode::DiameterArcCounterclockwise => ARC,
        GCode::Dwell | GCode::DwellSecondsFirst => DWELL,
        GCode::Reference | GCode::ReferenceByParameter | GCode::ReferenceDirect => REFERENCE,
        GCode::Thread => THREAD,
        GCode::VariableThread => VARIABLE_THREAD,
        GCode::Tapping => TAPPING,
        GCode::Coordinates => COORDINATES,
        GCode::MacroCommand => MACRO_COMMAND,
        GCode::Finishing => FINISHING,
        GCode::TurningRough => TURNING_ROUGH,
        GCode::FacingRough => FACING_ROUGH,
        GCode::Pattern => PATTERN,
        GCode::FacePecking => FACE_PECKING,
        GCode::Grooving => GROOVING,
        GCode::CompoundThread => COMPOUND_THREAD,
        GCode::TurningCycle => TURNING_CYCLE,
        GCode::FacingCycle => FACING_CYCLE,
        GCode::ThreadCycle => THREAD_CYCLE,
        GCode::SurfaceSpeed => SURFACE_SPEED,
        GCode::SpindleSpeed => SPINDLE_SPEED,
        GCode::FeedPerMinute | GCode::FeedPerRevolution => FEED_UNIT,
        _ => &[],
    }
}

/// The block of an M code with the words that it reads; `None` for codes without words.
pub(crate) const fn function_form(number: u32) -> Option<&'static [CodeForm]> {
    match number {
        98 => Some(CALL),
        99 => Some(RETURN),
        _ => None,
    }
}

/// Returns the index of the block of a code that has the words `letters`. A block with words of
/// both is the one after `before`, the block of the same code above it.
pub(crate) fn form_index(
    forms: &[CodeForm],
    letters: impl Iterator<Item = char>,
    before: Option<usize>,
) -> usize {
    let [first, second] = forms else { return 0 };
    let is_in = |form: &CodeForm, letter| form.iter().any(|it| it.letter == letter);
    for letter in letters {
        match (is_in(first, letter), is_in(second, letter)) {
            (true, false) => return 0,
            (false, true) => return 1,
            _ => {}
        }
    }
    usize::from(before == Some(0))
}

/// Returns the word of a form with a letter; `None` if the code does not read it.
pub(crate) fn find_word(form: CodeForm, letter: char) -> Option<CodeWord> {
    form.iter().find(|word| word.letter == letter).copied()
}
