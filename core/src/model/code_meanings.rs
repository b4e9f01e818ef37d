//! Meanings of the G and M codes of all control models. The record of a model assigns
//! numbers to meanings; a number may have another meaning in another model.

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

/// Declares an enum of meanings with a description of each.
macro_rules! meanings {
    ($(#[$about:meta])* $name:ident { $($(#[$doc:meta])* $variant:ident => $text:ident,)* }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
        pub enum $name {
            $($(#[$doc])* $variant,)*
        }

        impl $name {
            /// The description for the operator.
            pub fn text(self) -> Message {
                match self {
                    $(Self::$variant => say::$text(),)*
                }
            }
        }
    };
}

meanings! {
    /// The meaning of a G code.
    GCode {
        /// G00: each axis moves at its own rapid rate.
        Rapid => g_is_rapid,
        /// G00 in a straight line: both axes arrive at the same time.
        StraightRapid => g_is_straight_rapid,
        /// G01.
        Line => g_is_line,
        /// G02: I is a radius value, R is for up to half a circle.
        ArcClockwise => g_is_arc_clockwise,
        /// G03: I is a radius value, R is for up to half a circle.
        ArcCounterclockwise => g_is_arc_counterclockwise,
        /// G02: a negative R is for more than half a circle.
        LongArcClockwise => g_is_long_arc_clockwise,
        /// G03: a negative R is for more than half a circle.
        LongArcCounterclockwise => g_is_long_arc_counterclockwise,
        /// G02: I is a difference of diameters.
        DiameterArcClockwise => g_is_diameter_arc_clockwise,
        /// G03: I is a difference of diameters.
        DiameterArcCounterclockwise => g_is_diameter_arc_counterclockwise,
        /// G02 in the plane of G17 to G19.
        PlaneArcClockwise => g_is_plane_arc_clockwise,
        /// G03 in the plane of G17 to G19.
        PlaneArcCounterclockwise => g_is_plane_arc_counterclockwise,
        /// G04: P, ms, has precedence over X, s.
        Dwell => g_is_dwell,
        /// G04: X, s, has precedence over P, ms.
        DwellSecondsFirst => g_is_dwell_seconds_first,
        /// G04: K, s.
        DwellByK => g_is_dwell_by_k,
        /// G09.
        ExactStop => g_is_exact_stop,
        /// G10.
        OffsetInput => g_is_offset_input,
        /// G15.
        PolarOff => g_is_polar_off,
        /// G16.
        PolarOn => g_is_polar_on,
        /// G17.
        PlaneXy => g_is_plane_xy,
        /// G18.
        PlaneZx => g_is_plane_zx,
        /// G19.
        PlaneYz => g_is_plane_yz,
        /// G20 of the mill.
        InchInput => g_is_inch_input,
        /// G21 of the mill.
        MetricInput => g_is_metric_input,
        /// G20 of the Huaxing lathe.
        SubprogramCall => g_is_subprogram_call,
        /// G22.
        SubprogramBegin => g_is_subprogram_begin,
        /// G24.
        SubprogramEnd => g_is_subprogram_end,
        /// G25.
        RepeatAndGoOnThere => g_is_repeat_and_go_on_there,
        /// G26.
        RepeatAndComeBack => g_is_repeat_and_come_back,
        /// G27 of the Huaxing lathe.
        EndlessLoop => g_is_endless_loop,
        /// G27 of the mill.
        ReferenceCheck => g_is_reference_check,
        /// G27 of the NC-B08.
        ReferenceDirect => g_is_reference_direct,
        /// G28 to machine zero.
        Reference => g_is_reference,
        /// G28 to the reference point of P108 and P109.
        ReferenceByParameter => g_is_reference_by_parameter,
        /// G29.
        ReferenceBack => g_is_reference_back,
        /// G30 of the mill.
        FurtherReference => g_is_further_reference,
        /// G31 of the mill.
        Skip => g_is_skip,
        /// G30 of the Huaxing lathe.
        ScaleOff => g_is_scale_off,
        /// G31 of the Huaxing lathe.
        ScaleOn => g_is_scale_on,
        /// G32.
        Thread => g_is_thread,
        /// G33.
        Tapping => g_is_tapping,
        /// G34.
        VariableThread => g_is_variable_thread,
        /// G33 of the Huaxing lathe.
        MetricThreadPass => g_is_metric_thread_pass,
        /// G34 of the Huaxing lathe.
        InchThreadPass => g_is_inch_thread_pass,
        /// G37 of the mill.
        ToolMeasure => g_is_tool_measure,
        /// G40.
        NoseOff => g_is_nose_off,
        /// G41.
        NoseLeft => g_is_nose_left,
        /// G42.
        NoseRight => g_is_nose_right,
        /// G40 of the mill.
        CutterOff => g_is_cutter_off,
        /// G41 of the mill.
        CutterLeft => g_is_cutter_left,
        /// G42 of the mill.
        CutterRight => g_is_cutter_right,
        /// G43.
        LengthPlus => g_is_length_plus,
        /// G44.
        LengthMinus => g_is_length_minus,
        /// G49.
        LengthOff => g_is_length_off,
        /// G50 of the lathe, G92 of the other models.
        Coordinates => g_is_coordinates,
        /// G50 of the mill.
        ScalingOff => g_is_scaling_off,
        /// G51.
        ScalingOn => g_is_scaling_on,
        /// G52.
        LocalCoordinates => g_is_local_coordinates,
        /// G53.
        MachineCoordinates => g_is_machine_coordinates,
        /// G54 of the mill.
        WorkCoordinates1 => g_is_work_coordinates_1,
        /// G55 of the mill.
        WorkCoordinates2 => g_is_work_coordinates_2,
        /// G56 of the mill.
        WorkCoordinates3 => g_is_work_coordinates_3,
        /// G57 of the mill.
        WorkCoordinates4 => g_is_work_coordinates_4,
        /// G58.
        WorkCoordinates5 => g_is_work_coordinates_5,
        /// G59.
        WorkCoordinates6 => g_is_work_coordinates_6,
        /// G54 of the Huaxing lathe.
        ZeroOffsetOff => g_is_zero_offset_off,
        /// G55 of the Huaxing lathe.
        ZeroOffsetAbsolute => g_is_zero_offset_absolute,
        /// G56 of the Huaxing lathe.
        ZeroOffsetIncremental => g_is_zero_offset_incremental,
        /// G57 of the Huaxing lathe.
        ZeroOffsetHere => g_is_zero_offset_here,
        /// G61.
        ExactStopMode => g_is_exact_stop_mode,
        /// G64.
        CuttingMode => g_is_cutting_mode,
        /// G65 H.
        MacroCommand => g_is_macro_command,
        /// G65 P.
        MacroCall => g_is_macro_call,
        /// G66.
        ModalMacroCall => g_is_modal_macro_call,
        /// G67.
        ModalMacroCallOff => g_is_modal_macro_call_off,
        /// G68.
        RotationOn => g_is_rotation_on,
        /// G69.
        RotationOff => g_is_rotation_off,
        /// G70.
        Finishing => g_is_finishing,
        /// G71 with the profile from P to Q.
        TurningRough => g_is_turning_rough,
        /// G72 with the profile from P to Q.
        FacingRough => g_is_facing_rough,
        /// G73 with the profile from P to Q.
        Pattern => g_is_pattern,
        /// G71 with a profile of N blocks.
        CountedTurningRough => g_is_counted_turning_rough,
        /// G72 with a profile of N blocks.
        CountedFacingRough => g_is_counted_facing_rough,
        /// G73 with a profile of N blocks.
        CountedPattern => g_is_counted_pattern,
        /// G74 of the lathe.
        FacePecking => g_is_face_pecking,
        /// G75 of the lathe.
        Grooving => g_is_grooving,
        /// G76 of the lathe.
        CompoundThread => g_is_compound_thread,
        /// G74 of the Huaxing lathe.
        MachineZero => g_is_machine_zero,
        /// G75 of the Huaxing lathe.
        StartByMachine => g_is_start_by_machine,
        /// G76 of the Huaxing lathe.
        StartByWork => g_is_start_by_work,
        /// G73 of the mill.
        HighSpeedPeck => g_is_high_speed_peck,
        /// G74 of the mill.
        LeftTapping => g_is_left_tapping,
        /// G76 of the mill.
        FineBoring => g_is_fine_boring,
        /// G80.
        DrillingOff => g_is_drilling_off,
        /// G81 of the mill.
        Drilling => g_is_drilling,
        /// G82 of the mill.
        DrillingDwell => g_is_drilling_dwell,
        /// G83.
        PeckDrilling => g_is_peck_drilling,
        /// G83 of the Huaxing lathe.
        DeepHole => g_is_deep_hole,
        /// G84 of the mill.
        RightTapping => g_is_right_tapping,
        /// G85 of the mill.
        Boring => g_is_boring,
        /// G86 of the mill.
        BoringStop => g_is_boring_stop,
        /// G87 of the mill.
        BackBoring => g_is_back_boring,
        /// G88.
        BoringByHand => g_is_boring_by_hand,
        /// G89.
        BoringDwell => g_is_boring_dwell,
        /// G81 of the Huaxing lathe.
        SteppedTurning => g_is_stepped_turning,
        /// G82 of the Huaxing lathe.
        SteppedFacing => g_is_stepped_facing,
        /// G84 of the Huaxing lathe.
        MetricRigidTapping => g_is_metric_rigid_tapping,
        /// G85 of the Huaxing lathe.
        InchRigidTapping => g_is_inch_rigid_tapping,
        /// G86 of the Huaxing lathe.
        MetricThreadCycle => g_is_metric_thread_cycle,
        /// G87 of the Huaxing lathe.
        InchThreadCycle => g_is_inch_thread_cycle,
        /// G90 of the lathe.
        TurningCycle => g_is_turning_cycle,
        /// G92 of the lathe.
        ThreadCycle => g_is_thread_cycle,
        /// G94 of the lathe.
        FacingCycle => g_is_facing_cycle,
        /// G90 of the other models.
        Absolute => g_is_absolute,
        /// G91.
        Incremental => g_is_incremental,
        /// G96.
        SurfaceSpeed => g_is_surface_speed,
        /// G97.
        SpindleSpeed => g_is_spindle_speed,
        /// G98 of the lathe, G94 of the mill.
        FeedPerMinute => g_is_feed_per_minute,
        /// G99 of the lathe, G95 of the mill.
        FeedPerRevolution => g_is_feed_per_revolution,
        /// G98 of the mill.
        ReturnInitial => g_is_return_initial,
        /// G99 of the mill.
        ReturnR => g_is_return_r,
    }
}

impl GCode {
    /// Whether the code is one of the dwells.
    pub const fn is_dwell(self) -> bool {
        matches!(self, Self::Dwell | Self::DwellSecondsFirst | Self::DwellByK)
    }

    /// Whether the code depends on the plane: an arc, or a radius compensation.
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
    /// The meaning of an M code.
    MCode {
        /// M00.
        Stop => m_is_stop,
        /// M01 of the other models.
        OptionalStop => m_is_optional_stop,
        /// M01 of the NC-B08.
        InputWait => m_is_input_wait,
        /// M30, M02.
        End => m_is_end,
        /// M03.
        SpindleForward => m_is_spindle_forward,
        /// M04.
        SpindleReverse => m_is_spindle_reverse,
        /// M05.
        SpindleStop => m_is_spindle_stop,
        /// M08.
        CoolantOn => m_is_coolant_on,
        /// M09.
        CoolantOff => m_is_coolant_off,
        /// M10 of the GSK980TD.
        TailstockForward => m_is_tailstock_forward,
        /// M11 of the GSK980TD.
        TailstockBack => m_is_tailstock_back,
        /// M12 of the GSK980TD.
        ChuckClamp => m_is_chuck_clamp,
        /// M13 of the GSK980TD.
        ChuckRelease => m_is_chuck_release,
        /// M10 of the Huaxing lathe.
        SpindleClamp => m_is_spindle_clamp,
        /// M11 of the Huaxing lathe.
        SpindleRelease => m_is_spindle_release,
        /// M12 of the Huaxing lathe.
        HighGearOn => m_is_high_gear_on,
        /// M13 of the Huaxing lathe.
        HighGearOff => m_is_high_gear_off,
        /// M32.
        LubricationOn => m_is_lubrication_on,
        /// M33.
        LubricationOff => m_is_lubrication_off,
        /// M41.
        Gear1 => m_is_gear_1,
        /// M42.
        Gear2 => m_is_gear_2,
        /// M43.
        Gear3 => m_is_gear_3,
        /// M44.
        Gear4 => m_is_gear_4,
        /// M10 of the NC-B08.
        OutputOn => m_is_output_on,
        /// M11 of the NC-B08.
        OutputOff => m_is_output_off,
        /// M20 of the Huaxing lathe.
        RelayOn => m_is_relay_on,
        /// M21 of the Huaxing lathe.
        RelayOff => m_is_relay_off,
        /// M24 of the Huaxing lathe.
        OffsetNumber => m_is_offset_number,
        /// M28 of the Huaxing lathe.
        SpeedMode => m_is_speed_mode,
        /// M29 of the Huaxing lathe.
        PositionMode => m_is_position_mode,
        /// M06.
        ToolChange => m_is_tool_change,
        /// M29 of the mill.
        RigidTapping => m_is_rigid_tapping,
        /// M71 to M85 of the Huaxing lathe.
        PulseOutput => m_is_pulse_output,
        /// M21 of the NC-B08.
        Clamp => m_is_clamp,
        /// M22 of the NC-B08.
        ClampOff => m_is_clamp_off,
        /// M40 to M71 of the NC-B08.
        OutputPair => m_is_output_pair,
        /// M80 of the NC-B08.
        TailstockOut => m_is_tailstock_out,
        /// M81 of the NC-B08.
        TailstockIn => m_is_tailstock_in,
        /// M98.
        Call => m_is_call,
        /// M99.
        Return => m_is_return,
    }
}
