//! Meanings of the G and M codes of all control models. The record of a model assigns
//! numbers to meanings; a number may have another meaning in another model.

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// Declares an enum of code meanings, with a function that returns the description of each.
macro_rules! meanings {
    ($(#[$about:meta])* $name:ident { $($(#[$doc:meta])* $variant:ident => $text:ident,)* }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        pub enum $name {
            $($(#[$doc])* $variant,)*
        }

        impl $name {
            /// The message that describes the meaning of the code for the operator.
            pub fn text(self) -> Message {
                match self {
                    $(Self::$variant => say::$text(),)*
                }
            }
        }
    };
}

meanings! {
    /// The meaning of a G code, whose number differs from model to model.
    GCode {
        /// G00: rapid in which each axis moves at its own rapid rate.
        Rapid => g_is_rapid,
        /// G00: rapid in a straight line; both axes arrive at the same time.
        StraightRapid => g_is_straight_rapid,
        /// G01: straight cut.
        Line => g_is_line,
        /// G02: clockwise arc. I is a radius value; R is for up to half a circle.
        ArcClockwise => g_is_arc_clockwise,
        /// G03: counter-clockwise arc. I is a radius value; R is for up to half a circle.
        ArcCounterclockwise => g_is_arc_counterclockwise,
        /// G02: clockwise arc. A negative R is for more than half a circle.
        LongArcClockwise => g_is_long_arc_clockwise,
        /// G03: counter-clockwise arc. A negative R is for more than half a circle.
        LongArcCounterclockwise => g_is_long_arc_counterclockwise,
        /// G02: clockwise arc. I is a difference of diameters.
        DiameterArcClockwise => g_is_diameter_arc_clockwise,
        /// G03: counter-clockwise arc. I is a difference of diameters.
        DiameterArcCounterclockwise => g_is_diameter_arc_counterclockwise,
        /// G02: clockwise arc in the plane of G17 to G19.
        PlaneArcClockwise => g_is_plane_arc_clockwise,
        /// G03: counter-clockwise arc in the plane of G17 to G19.
        PlaneArcCounterclockwise => g_is_plane_arc_counterclockwise,
        /// G04: dwell. P, ms, has precedence over X, s.
        Dwell => g_is_dwell,
        /// G04: dwell. X, s, has precedence over P, ms.
        DwellSecondsFirst => g_is_dwell_seconds_first,
        /// G04: dwell of K seconds.
        DwellByK => g_is_dwell_by_k,
        /// G09: exact stop.
        ExactStop => g_is_exact_stop,
        /// G10: offset input.
        OffsetInput => g_is_offset_input,
        /// G15: polar coordinates off.
        PolarOff => g_is_polar_off,
        /// G16: polar coordinates on.
        PolarOn => g_is_polar_on,
        /// G17: XY plane.
        PlaneXy => g_is_plane_xy,
        /// G18: ZX plane.
        PlaneZx => g_is_plane_zx,
        /// G19: YZ plane.
        PlaneYz => g_is_plane_yz,
        /// G20 of the mill: input in inches.
        InchInput => g_is_inch_input,
        /// G21 of the mill: input in millimetres.
        MetricInput => g_is_metric_input,
        /// G20 of the Huaxing lathe: subprogram call.
        SubprogramCall => g_is_subprogram_call,
        /// G22: subprogram definition.
        SubprogramBegin => g_is_subprogram_begin,
        /// G24: subprogram end, return.
        SubprogramEnd => g_is_subprogram_end,
        /// G25: repeats blocks and continues after them.
        RepeatAndGoOnThere => g_is_repeat_and_go_on_there,
        /// G26: repeats blocks and returns to the block after G26.
        RepeatAndComeBack => g_is_repeat_and_come_back,
        /// G27 of the Huaxing lathe: endless loop.
        EndlessLoop => g_is_endless_loop,
        /// G27 of the mill: reference point check.
        ReferenceCheck => g_is_reference_check,
        /// G27 of the NC-B08: straight to the reference point.
        ReferenceDirect => g_is_reference_direct,
        /// G28: to machine zero through an intermediate point.
        Reference => g_is_reference,
        /// G28: through an intermediate point to the reference point of P108 and P109.
        ReferenceByParameter => g_is_reference_by_parameter,
        /// G29: back from the reference point.
        ReferenceBack => g_is_reference_back,
        /// G30 of the mill: to the 2nd to 4th reference point.
        FurtherReference => g_is_further_reference,
        /// G31 of the mill: cut that a signal ends (skip).
        Skip => g_is_skip,
        /// G30 of the Huaxing lathe: scaling off.
        ScaleOff => g_is_scale_off,
        /// G31 of the Huaxing lathe: all values multiplied by L.
        ScaleOn => g_is_scale_on,
        /// G32 of the lathe, G33 of the mill: thread cut.
        Thread => g_is_thread,
        /// G33: tapping cycle.
        Tapping => g_is_tapping,
        /// G34: thread of variable lead.
        VariableThread => g_is_variable_thread,
        /// G33 of the Huaxing lathe: one pass of a metric thread.
        MetricThreadPass => g_is_metric_thread_pass,
        /// G34 of the Huaxing lathe: one pass of an inch thread.
        InchThreadPass => g_is_inch_thread_pass,
        /// G37 of the mill: tool length measurement.
        ToolMeasure => g_is_tool_measure,
        /// G40: nose radius compensation off.
        NoseOff => g_is_nose_off,
        /// G41: nose radius compensation left.
        NoseLeft => g_is_nose_left,
        /// G42: nose radius compensation right.
        NoseRight => g_is_nose_right,
        /// G40 of the mill: cutter radius compensation off.
        CutterOff => g_is_cutter_off,
        /// G41 of the mill: cutter radius compensation left.
        CutterLeft => g_is_cutter_left,
        /// G42 of the mill: cutter radius compensation right.
        CutterRight => g_is_cutter_right,
        /// G43: tool length offset plus.
        LengthPlus => g_is_length_plus,
        /// G44: tool length offset minus.
        LengthMinus => g_is_length_minus,
        /// G49: tool length offset off.
        LengthOff => g_is_length_off,
        /// G50 of the lathe, G92 of the other models: coordinate system set, no motion.
        Coordinates => g_is_coordinates,
        /// G50 of the mill: scaling off.
        ScalingOff => g_is_scaling_off,
        /// G51: scaling about a centre on.
        ScalingOn => g_is_scaling_on,
        /// G52: local coordinates.
        LocalCoordinates => g_is_local_coordinates,
        /// G53: machine coordinates.
        MachineCoordinates => g_is_machine_coordinates,
        /// G54 of the mill: work coordinates 1.
        WorkCoordinates1 => g_is_work_coordinates_1,
        /// G55 of the mill: work coordinates 2.
        WorkCoordinates2 => g_is_work_coordinates_2,
        /// G56 of the mill: work coordinates 3.
        WorkCoordinates3 => g_is_work_coordinates_3,
        /// G57 of the mill: work coordinates 4.
        WorkCoordinates4 => g_is_work_coordinates_4,
        /// G58: work coordinates 5.
        WorkCoordinates5 => g_is_work_coordinates_5,
        /// G59: work coordinates 6.
        WorkCoordinates6 => g_is_work_coordinates_6,
        /// G54 of the Huaxing lathe: zero offset cancelled.
        ZeroOffsetOff => g_is_zero_offset_off,
        /// G55 of the Huaxing lathe: zero offset, absolute.
        ZeroOffsetAbsolute => g_is_zero_offset_absolute,
        /// G56 of the Huaxing lathe: zero offset, added.
        ZeroOffsetIncremental => g_is_zero_offset_incremental,
        /// G57 of the Huaxing lathe: zero offset to the present point.
        ZeroOffsetHere => g_is_zero_offset_here,
        /// G61: exact stop mode.
        ExactStopMode => g_is_exact_stop_mode,
        /// G64: cutting mode; cuts blend into each other.
        CuttingMode => g_is_cutting_mode,
        /// G65 H: command of macro A.
        MacroCommand => g_is_macro_command,
        /// G65 P: macro call with arguments.
        MacroCall => g_is_macro_call,
        /// G66: modal macro call, repeated after each move.
        ModalMacroCall => g_is_modal_macro_call,
        /// G67: modal macro call off.
        ModalMacroCallOff => g_is_modal_macro_call_off,
        /// G68: coordinate rotation on.
        RotationOn => g_is_rotation_on,
        /// G69: coordinate rotation off.
        RotationOff => g_is_rotation_off,
        /// G70: finishing cycle.
        Finishing => g_is_finishing,
        /// G71: roughing in the direction of Z, with the profile from P to Q.
        TurningRough => g_is_turning_rough,
        /// G72: roughing in the direction of X, with the profile from P to Q.
        FacingRough => g_is_facing_rough,
        /// G73: pattern repeating, with the profile from P to Q.
        Pattern => g_is_pattern,
        /// G71: roughing in the direction of Z, with a profile of N blocks.
        CountedTurningRough => g_is_counted_turning_rough,
        /// G72: roughing in the direction of X, with a profile of N blocks.
        CountedFacingRough => g_is_counted_facing_rough,
        /// G73: pattern repeating, with a profile of N blocks.
        CountedPattern => g_is_counted_pattern,
        /// G74 of the lathe: face pecking cycle.
        FacePecking => g_is_face_pecking,
        /// G75 of the lathe: grooving cycle.
        Grooving => g_is_grooving,
        /// G76 of the lathe: multi-pass thread cycle.
        CompoundThread => g_is_compound_thread,
        /// G74 of the Huaxing lathe: to machine zero.
        MachineZero => g_is_machine_zero,
        /// G75 of the Huaxing lathe: back to the start by machine coordinates.
        StartByMachine => g_is_start_by_machine,
        /// G76 of the Huaxing lathe: back to the start by work coordinates.
        StartByWork => g_is_start_by_work,
        /// G73 of the mill: high-speed peck drilling.
        HighSpeedPeck => g_is_high_speed_peck,
        /// G74 of the mill: left-hand tapping.
        LeftTapping => g_is_left_tapping,
        /// G76 of the mill: fine boring.
        FineBoring => g_is_fine_boring,
        /// G80: drilling cycles off.
        DrillingOff => g_is_drilling_off,
        /// G81 of the mill: drilling.
        Drilling => g_is_drilling,
        /// G82 of the mill: drilling with dwell.
        DrillingDwell => g_is_drilling_dwell,
        /// G83 of the mill: peck drilling.
        PeckDrilling => g_is_peck_drilling,
        /// G83 of the Huaxing lathe: deep hole in pecks of I.
        DeepHole => g_is_deep_hole,
        /// G84 of the mill: right-hand tapping.
        RightTapping => g_is_right_tapping,
        /// G85 of the mill: boring, back at feed.
        Boring => g_is_boring,
        /// G86 of the mill: boring, back with the spindle stopped.
        BoringStop => g_is_boring_stop,
        /// G87 of the mill: back boring.
        BackBoring => g_is_back_boring,
        /// G88: boring, back by hand.
        BoringByHand => g_is_boring_by_hand,
        /// G89: boring with dwell, back at feed.
        BoringDwell => g_is_boring_dwell,
        /// G81 of the Huaxing lathe: turning cycle in steps.
        SteppedTurning => g_is_stepped_turning,
        /// G82 of the Huaxing lathe: facing cycle in steps.
        SteppedFacing => g_is_stepped_facing,
        /// G84 of the Huaxing lathe: rigid tapping, metric.
        MetricRigidTapping => g_is_metric_rigid_tapping,
        /// G85 of the Huaxing lathe: rigid tapping, inch.
        InchRigidTapping => g_is_inch_rigid_tapping,
        /// G86 of the Huaxing lathe: thread cycle, metric.
        MetricThreadCycle => g_is_metric_thread_cycle,
        /// G87 of the Huaxing lathe: thread cycle, inch.
        InchThreadCycle => g_is_inch_thread_cycle,
        /// G90 of the lathe: turning cycle.
        TurningCycle => g_is_turning_cycle,
        /// G92 of the lathe: thread cycle.
        ThreadCycle => g_is_thread_cycle,
        /// G94 of the lathe: facing cycle.
        FacingCycle => g_is_facing_cycle,
        /// G90 of the other models: coordinates are absolute.
        Absolute => g_is_absolute,
        /// G91: coordinates are increments.
        Incremental => g_is_incremental,
        /// G96: constant surface speed.
        SurfaceSpeed => g_is_surface_speed,
        /// G97: spindle speed in r/min, constant surface speed off.
        SpindleSpeed => g_is_spindle_speed,
        /// G98 of the lathe, G94 of the mill: feed per minute.
        FeedPerMinute => g_is_feed_per_minute,
        /// G99 of the lathe, G95 of the mill: feed per revolution.
        FeedPerRevolution => g_is_feed_per_revolution,
        /// G98 of the mill: cycles return to the initial level.
        ReturnInitial => g_is_return_initial,
        /// G99 of the mill: cycles return to the R level.
        ReturnR => g_is_return_r,
    }
}

impl GCode {
    /// Whether the code is a dwell.
    pub const fn is_dwell(self) -> bool {
        matches!(self, Self::Dwell | Self::DwellSecondsFirst | Self::DwellByK)
    }

    /// Whether the code depends on the active plane: an arc, or a radius compensation left or
    /// right.
    pub const fn is_arc_or_compensation(self) -> bool {
        matches!(
            self,
            Self::ArcClockwise
                | Self::ArcCounterclockwise
                | Self::LongArcClockwise
                | Self::LongArcCounterclockwise
                | Self::DiameterArcClockwise
                | Self::DiameterArcCounterclockwise
                | Self::PlaneArcClockwise
                | Self::PlaneArcCounterclockwise
                | Self::NoseLeft
                | Self::NoseRight
                | Self::CutterLeft
                | Self::CutterRight
        )
    }
}

meanings! {
    /// The meaning of an M code, whose number differs from model to model.
    MCode {
        /// M00: program stop.
        Stop => m_is_stop,
        /// M01 of the other models: optional stop.
        OptionalStop => m_is_optional_stop,
        /// M01 of the NC-B08: waits for an input.
        InputWait => m_is_input_wait,
        /// M30, M02: end of program.
        End => m_is_end,
        /// M03: spindle forward.
        SpindleForward => m_is_spindle_forward,
        /// M04: spindle reverse.
        SpindleReverse => m_is_spindle_reverse,
        /// M05: spindle stop.
        SpindleStop => m_is_spindle_stop,
        /// M08: coolant on.
        CoolantOn => m_is_coolant_on,
        /// M09: coolant off.
        CoolantOff => m_is_coolant_off,
        /// M10 of the GSK980TD: tailstock forward.
        TailstockForward => m_is_tailstock_forward,
        /// M11 of the GSK980TD: tailstock back.
        TailstockBack => m_is_tailstock_back,
        /// M12 of the GSK980TD: chuck clamped.
        ChuckClamp => m_is_chuck_clamp,
        /// M13 of the GSK980TD: chuck released.
        ChuckRelease => m_is_chuck_release,
        /// M10 of the Huaxing lathe: spindle clamped.
        SpindleClamp => m_is_spindle_clamp,
        /// M11 of the Huaxing lathe: spindle released.
        SpindleRelease => m_is_spindle_release,
        /// M12 of the Huaxing lathe: high-gear relay on.
        HighGearOn => m_is_high_gear_on,
        /// M13 of the Huaxing lathe: high-gear relay off.
        HighGearOff => m_is_high_gear_off,
        /// M32: lubrication on.
        LubricationOn => m_is_lubrication_on,
        /// M33: lubrication off.
        LubricationOff => m_is_lubrication_off,
        /// M41: selects spindle gear 1.
        Gear1 => m_is_gear_1,
        /// M42: selects spindle gear 2.
        Gear2 => m_is_gear_2,
        /// M43: selects spindle gear 3.
        Gear3 => m_is_gear_3,
        /// M44: selects spindle gear 4.
        Gear4 => m_is_gear_4,
        /// M10 of the NC-B08: switches the output P on.
        OutputOn => m_is_output_on,
        /// M11 of the NC-B08: switches the output P off.
        OutputOff => m_is_output_off,
        /// M20 of the Huaxing lathe: switches the relay K on.
        RelayOn => m_is_relay_on,
        /// M21 of the Huaxing lathe: switches the relay K off.
        RelayOff => m_is_relay_off,
        /// M24 of the Huaxing lathe: selects the offset number K.
        OffsetNumber => m_is_offset_number,
        /// M28 of the Huaxing lathe: spindle in speed mode.
        SpeedMode => m_is_speed_mode,
        /// M29 of the Huaxing lathe: spindle in position mode.
        PositionMode => m_is_position_mode,
        /// M06: tool change.
        ToolChange => m_is_tool_change,
        /// M29 of the mill: rigid tapping.
        RigidTapping => m_is_rigid_tapping,
        /// M71 to M85 of the Huaxing lathe: pulse of an output.
        PulseOutput => m_is_pulse_output,
        /// M21 of the NC-B08: clamps the chuck for the time P41.
        Clamp => m_is_clamp,
        /// M22 of the NC-B08: releases the chuck.
        ClampOff => m_is_clamp_off,
        /// M40 to M71 of the NC-B08: one output of a pair on, the other one off.
        OutputPair => m_is_output_pair,
        /// M80 of the NC-B08: tailstock out.
        TailstockOut => m_is_tailstock_out,
        /// M81 of the NC-B08: tailstock in.
        TailstockIn => m_is_tailstock_in,
        /// M98: subprogram call.
        Call => m_is_call,
        /// M99: return from a subprogram.
        Return => m_is_return,
    }
}
