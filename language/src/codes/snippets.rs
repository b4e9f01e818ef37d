//! Contains the snippets of cycles and the letters that each code takes.

use gsk_core::model::GCode;

use super::word_table::code_forms;

/// Returns the blocks of a cycle as an editor snippet. `${1:2}` is the first field with the
/// default 2. `None` for codes with one word.
pub(crate) const fn snippet(code: GCode, is_mill: bool) -> Option<&'static str> {
    if is_mill {
        return mill_snippet(code);
    }
    Some(match code {
        GCode::Finishing => "G70 P${1:10} Q${2:20}",
        GCode::TurningRough => {
            "G71 U${1:2.0} R${2:1.0}\n\
             G71 P${3:10} Q${4:20} U${5:0.5} W${6:0.1} F${7:150}\n\
             N${3:10} G00 X${8}\n\
             ${0}\n\
             N${4:20} G01 X${9}"
        }
        GCode::FacingRough => {
            "G72 W${1:2.0} R${2:1.0}\n\
             G72 P${3:10} Q${4:20} U${5:0.5} W${6:0.1} F${7:150}\n\
             N${3:10} G00 Z${8}\n\
             ${0}\n\
             N${4:20} G01 Z${9}"
        }
        GCode::Pattern => {
            "G73 U${1:5.0} W${2:2.0} R${3:3}\n\
             G73 P${4:10} Q${5:20} U${6:0.5} W${7:0.1} F${8:150}\n\
             N${4:10} G00 X${9}\n\
             ${0}\n\
             N${5:20} G01 X${10}"
        }
        GCode::FacePecking => "G74 R${1:1.0}\nG74 Z${2:-30.0} Q${3:5000} F${4:60}",
        GCode::Grooving => "G75 R${1:1.0}\nG75 X${2:20.0} Z${3} P${4:2000} Q${5:3000} F${6:60}",
        GCode::CompoundThread => {
            "G76 P${1:020060} Q${2:100} R${3:0.1}\n\
             G76 X${4:18.05} Z${5:-30.0} P${6:975} Q${7:300} F${8:1.5}"
        }
        GCode::TurningCycle => "G90 X${1} Z${2} F${3:150}",
        GCode::ThreadCycle => "G92 X${1} Z${2} F${3:1.5}",
        GCode::FacingCycle => "G94 X${1} Z${2} F${3:150}",
        GCode::Thread => "G32 Z${1} F${2:1.5}",
        _ => return None,
    })
}

/// The blocks of a cycle of a mill as an editor snippet; `None` for codes with one word.
const fn mill_snippet(code: GCode) -> Option<&'static str> {
    Some(match code {
        GCode::HighSpeedPeck => "G73 X${1} Y${2} Z${3:-20.} R${4:2.} Q${5:4.} F${6:100}",
        GCode::PeckDrilling => "G83 X${1} Y${2} Z${3:-20.} R${4:2.} Q${5:4.} F${6:100}",
        GCode::Drilling => "G81 X${1} Y${2} Z${3:-10.} R${4:2.} F${5:100}",
        GCode::DrillingDwell => "G82 X${1} Y${2} Z${3:-10.} R${4:2.} P${5:500} F${6:100}",
        GCode::LeftTapping => "G74 X${1} Y${2} Z${3:-15.} R${4:5.} F${5:500}",
        GCode::RightTapping => "G84 X${1} Y${2} Z${3:-15.} R${4:5.} F${5:500}",
        GCode::FineBoring => "G76 X${1} Y${2} Z${3:-20.} R${4:2.} Q${5:0.2} F${6:50}",
        GCode::ScalingOn => "G51 X${1:0.} Y${2:0.} Z${3:0.} P${4:1000}\n${0}\nG50",
        GCode::RotationOn => "G68 X${1:0.} Y${2:0.} R${3:45.}\n${0}\nG69",
        GCode::OffsetInput => "G10 L${1:12} P${2:1} R${3:5.}",
        _ => return None,
    })
}

/// Returns whether a code is a hole cycle of a mill, which remains in force in the next
/// blocks.
pub(crate) const fn is_hole_cycle(code: GCode) -> bool {
    matches!(
        code,
        GCode::HighSpeedPeck
            | GCode::LeftTapping
            | GCode::FineBoring
            | GCode::Drilling
            | GCode::DrillingDwell
            | GCode::PeckDrilling
            | GCode::RightTapping
            | GCode::Boring
            | GCode::BoringStop
            | GCode::BackBoring
            | GCode::BoringByHand
            | GCode::BoringDwell
    )
}

/// Returns the letters that a G code takes besides M, S and T (manual I-3.2).
pub(crate) fn letters(code: GCode, is_mill: bool) -> Vec<char> {
    if is_mill {
        return mill_letters(code).chars().collect();
    }
    let mut letters: Vec<char> = Vec::new();
    for word in code_forms(code).iter().copied().flatten() {
        if !letters.contains(&word.letter) {
            letters.push(word.letter);
        }
    }
    match letters.is_empty() {
        true => "XZUWF".chars().collect(),
        false => letters,
    }
}

/// The letters that a G code of a mill takes besides M, S and T.
const fn mill_letters(code: GCode) -> &'static str {
    match code {
        _ if is_hole_cycle(code) => "XYZRQPFKL",
        GCode::Rapid | GCode::Reference | GCode::ReferenceCheck | GCode::ReferenceBack => "XYZ",
        GCode::FurtherReference => "PXYZ",
        GCode::PlaneArcClockwise | GCode::PlaneArcCounterclockwise => "XYZIJKRF",
        GCode::Dwell => "PX",
        GCode::OffsetInput => "LPR",
        GCode::CutterLeft | GCode::CutterRight => "DXYZF",
        GCode::LengthPlus | GCode::LengthMinus => "HXYZ",
        GCode::ScalingOn => "XYZPIJK",
        GCode::RotationOn => "XYZR",
        GCode::MacroCall | GCode::ModalMacroCall => "PLABCDEFHIJKMQRSTUVWXYZ",
        GCode::FeedPerMinute | GCode::FeedPerRevolution => "F",
        _ => "XYZF",
    }
}
