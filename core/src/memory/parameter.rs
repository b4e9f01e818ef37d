//! Numbers of data parameters that modules pass on, as constants: the column `id` of the table, written by `cargo xtask tables`.

/// 015: X command multiply ratio (electronic gear numerator).
pub const X_MULTIPLIER: u16 = 15;

/// 016: Z command multiply ratio.
pub const Z_MULTIPLIER: u16 = 16;

/// 017: X command divide ratio (gear denominator).
pub const X_DIVISOR: u16 = 17;

/// 018: Z command divide ratio.
pub const Z_DIVISOR: u16 = 18;

/// 019: thread run-out width = value x 0.1 x lead (G92, G76).
pub const THREAD_RUN_OUT: u16 = 19;

/// 021: spindle analog gain at 10 V.
pub const SPINDLE_GAIN: u16 = 21;

/// 022: X rapid speed.
pub const X_RAPID: u16 = 22;

/// 023: Z rapid speed.
pub const Z_RAPID: u16 = 23;

/// 024: X rapid linear acceleration time constant (about 400 for steppers).
pub const X_RAPID_TIME: u16 = 24;

/// 025: Z rapid linear acceleration time constant.
pub const Z_RAPID_TIME: u16 = 25;

/// 026: X exponential time constant in threads (run-out).
pub const THREAD_TIME: u16 = 26;

/// 027: cutting feed upper limit.
pub const FEED_LIMIT: u16 = 27;

/// 028: lower speed limit of exponential acceleration in threads (start/end speed).
pub const THREAD_LOW_SPEED: u16 = 28;

/// 029: exponential time constant of cutting feed and jog.
pub const FEED_TIME: u16 = 29;

/// 030: lower speed limit of exponential acceleration in cutting feed.
pub const FEED_LOW_SPEED: u16 = 30;

/// 033: zero-return low speed FL.
pub const ZERO_LOW_SPEED: u16 = 33;

/// 034: X backlash.
pub const X_BACKLASH: u16 = 34;

/// 035: Z backlash.
pub const Z_BACKLASH: u16 = 35;

/// 037: spindle speed at 10 V in gear 1.
pub const GEAR_SPEED_1: u16 = 37;

/// 049: X absolute coordinate set after reference return when APRS=1.
pub const X_AT_REFERENCE: u16 = 49;

/// 050: Z absolute coordinate set after reference return.
pub const Z_AT_REFERENCE: u16 = 50;

/// 051: G71/G72 depth of cut per pass (radius), written by the cycle.
pub const ROUGHING_DEPTH: u16 = 51;

/// 052: G71/G72 escape amount, written by the cycle.
pub const ROUGHING_RETRACT: u16 = 52;

/// 053: G73 X relief (radius), written by the cycle.
pub const PATTERN_RELIEF_X: u16 = 53;

/// 054: G73 Z relief, written by the cycle.
pub const PATTERN_RELIEF_Z: u16 = 54;

/// 055: G73 number of passes, written by the cycle.
pub const PATTERN_PASSES: u16 = 55;

/// 056: G74/G75 return amount, written by the cycle.
pub const PECKING_RETRACT: u16 = 56;

/// 057: G76 finishing passes (0 counts as 1).
pub const THREAD_PASSES: u16 = 57;

/// 058: G76 tool angle.
pub const THREAD_ANGLE: u16 = 58;

/// 059: G76 minimum depth of cut.
pub const THREAD_LEAST: u16 = 59;

/// 060: G76 finishing allowance.
pub const THREAD_ALLOWANCE: u16 = 60;

/// 065: gear change time 1.
pub const GEAR_TIME_1: u16 = 65;

/// 066: gear change time 2.
pub const GEAR_TIME_2: u16 = 66;

/// 069: low pressure alarm delay.
pub const PRESSURE_TIME: u16 = 69;

/// 070: spindle encoder lines (outside 100..5000 alarm 092 when used).
pub const ENCODER_LINES: u16 = 70;

/// 076: time limit per tool station in a tool change.
pub const STATION_TIME: u16 = 76;

/// 078: time limit from first to last tool.
pub const TURRET_TIME: u16 = 78;

/// 080: M code execution time (980TA: value x 128 ms).
pub const M_TIME: u16 = 80;

/// 081: S code execution time.
pub const S_TIME: u16 = 81;

/// 082: delay T1 from end of forward rotation to reverse clamping.
pub const CLAMP_DELAY: u16 = 82;

/// 083: alarm time T2 without *TCP.
pub const CLAMP_LIMIT: u16 = 83;

/// 085: reverse clamping time.
pub const CLAMP_TIME: u16 = 85;

/// 087: delay from spindle stop to brake output.
pub const BRAKE_DELAY: u16 = 87;

/// 089: brake output time.
pub const BRAKE_TIME: u16 = 89;

/// 090: X pitch compensation lowest point number.
pub const X_PITCH_LOWEST: u16 = 90;

/// 091: Z pitch compensation lowest point number.
pub const Z_PITCH_LOWEST: u16 = 91;

/// 094: X pitch compensation highest point number.
pub const X_PITCH_HIGHEST: u16 = 94;

/// 095: Z pitch compensation highest point number.
pub const Z_PITCH_HIGHEST: u16 = 95;

/// 098: X pitch compensation point of the reference position.
pub const X_PITCH_ORIGIN: u16 = 98;

/// 099: Z pitch compensation point of the reference position.
pub const Z_PITCH_ORIGIN: u16 = 99;

/// 102: X pitch compensation interval (0 = no compensation; negative taken absolute).
pub const X_PITCH_INTERVAL: u16 = 102;

/// 103: Z pitch compensation interval (0 = no compensation; negative taken absolute).
pub const Z_PITCH_INTERVAL: u16 = 103;

/// 108: spindle jog time.
pub const JOG_TIME: u16 = 108;

/// 110: encoder gearing: spindle teeth.
pub const SPINDLE_TEETH: u16 = 110;

/// 111: encoder gearing: encoder teeth.
pub const ENCODER_TEETH: u16 = 111;

/// 112: lubrication on-time; 0 = unlimited.
pub const LUBRICATION_TIME: u16 = 112;

/// 113: zero-return rapid speed (X halved automatically).
pub const ZERO_HIGH_SPEED: u16 = 113;
