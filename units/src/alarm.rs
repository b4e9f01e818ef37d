//! Alarm numbers, as constants: the column `id` of the table, written by `cargo xtask tables`.

/// 000: Macro alarm, or a parameter that needs a power cycle was set.
pub const POWER_CYCLE: u16 = 0;

/// 002: Command word value not recognisable.
pub const BAD_VALUE: u16 = 2;

/// 005: No data after an address.
pub const NO_VALUE: u16 = 5;

/// 006: Illegal word; unrecognised character in the program.
pub const BAD_CHARACTER: u16 = 6;

/// 007: Decimal point error.
pub const BAD_POINT: u16 = 7;

/// 009: Illegal address letter.
pub const BAD_ADDRESS: u16 = 9;

/// 010: G code cannot be used.
pub const BAD_G: u16 = 10;

/// 011: No or unsuitable feed, or spindle speed 0 in G99.
pub const NO_FEED: u16 = 11;

/// 012: Too many words in one block.
pub const TOO_MANY_WORDS: u16 = 12;

/// 013: Arc data error.
pub const ARC_DATA: u16 = 13;

/// 014: G50 without X or Z.
pub const EMPTY_G50: u16 = 14;

/// 015: R and U, or R and W, inconsistent in G90/G92/G94.
pub const CYCLE_TAPER: u16 = 15;

/// 016: Compound cycle: too many blocks, start/end numbers reversed or equal.
pub const PROFILE_RANGE: u16 = 16;

/// 018: Address defined twice in one block.
pub const ADDRESS_TWICE: u16 = 18;

/// 019: M code error.
pub const BAD_M: u16 = 19;

/// 023: Negative R in circular interpolation.
pub const NEGATIVE_RADIUS: u16 = 23;

/// 024: Two G codes that cannot share a block.
pub const G_CONFLICT: u16 = 24;

/// 025: *STEN signal not active.
pub const START_DISABLED: u16 = 25;

/// 029: Offset value (tool number) of the T code too large.
pub const TOOL_TOO_GREAT: u16 = 29;

/// 030: Offset number out of range.
pub const BAD_OFFSET: u16 = 30;

/// 031: Program file not found in automatic mode.
pub const PROGRAM_MISSING: u16 = 31;

/// 032: Tool number outside the set range.
pub const BAD_TOOL: u16 = 32;

/// 034: Arc commanded at start-up of compensation C.
pub const NOSE_START_ON_ARC: u16 = 34;

/// 036: M98/M99 in compensation mode.
pub const NOSE_CALL: u16 = 36;

/// 043: Data out of range.
pub const OUT_OF_RANGE: u16 = 43;

/// 046: Compensation C: division by zero.
pub const NOSE_DIVISION_BY_ZERO: u16 = 46;

/// 048: Compensation C: arc end point not on the arc.
pub const NOSE_ARC_END: u16 = 48;

/// 049: Compensation C: internal function error.
pub const NOSE_NO_RESULT: u16 = 49;

/// 050: Compensation C: two points coincide.
pub const NOSE_SAME_POINT: u16 = 50;

/// 051: Compensation C: arc centre = start point.
pub const NOSE_CENTER_AT_START: u16 = 51;

/// 052: Compensation C: arc centre = end point.
pub const NOSE_CENTER_AT_END: u16 = 52;

/// 053: Compensation C: arc radius smaller than nose radius.
pub const NOSE_SMALL_ARC: u16 = 53;

/// 054: Compensation C: two arcs have no intersection.
pub const NOSE_ARC_TO_ARC: u16 = 54;

/// 055: Compensation C: angle too small.
pub const NOSE_SHARP_CORNER: u16 = 55;

/// 056: Arc commanded at compensation cancel.
pub const NOSE_CANCEL_ON_ARC: u16 = 56;

/// 057: Compensation C: interference.
pub const NOSE_INTERFERENCE: u16 = 57;

/// 058: Line to arc: no intersection with this nose radius.
pub const NOSE_LINE_TO_ARC: u16 = 58;

/// 059: Arc to line: no intersection with this nose radius.
pub const NOSE_ARC_TO_LINE: u16 = 59;

/// 060: Sequence number not found in search.
pub const SEQUENCE_MISSING: u16 = 60;

/// 061: P or Q missing in G70-G73.
pub const PROFILE_WORDS: u16 = 61;

/// 062: Cycle data: depth <= 0 (G71/G72); passes <= 0 (G73); bad step (G74/G75); G76 allowance > thread height.
pub const CYCLE_DATA: u16 = 62;

/// 063: Sequence number P of G70-G73 not found.
pub const PROFILE_MISSING: u16 = 63;

/// 064: M98/M99 inside G70-G73.
pub const PROFILE_CALL: u16 = 64;

/// 065: Block P of G71-G73: no G00/G01, or wrong or undetermined direction.
pub const PROFILE_START: u16 = 65;

/// 066: Forbidden G code between P and Q.
pub const PROFILE_CODE: u16 = 66;

/// 067: G70-G73 with P or Q in MDI.
pub const PROFILE_IN_MDI: u16 = 67;

/// 068: Program memory full.
pub const MEMORY_FULL: u16 = 68;

/// 069: File memory partly damaged.
pub const MEMORY_DAMAGED: u16 = 69;

/// 071: Searched data or program not found.
pub const NOT_FOUND: u16 = 71;

/// 072: Too many programs.
pub const TOO_MANY_PROGRAMS: u16 = 72;

/// 073: Program number already stored.
pub const PROGRAM_STORED: u16 = 73;

/// 074: Program number out of range or operation level too low.
pub const PROGRAM_NUMBER: u16 = 74;

/// 076: M98 without P.
pub const CALL_WITHOUT_P: u16 = 76;

/// 077: Too many subprogram levels.
pub const CALL_TOO_DEEP: u16 = 77;

/// 078: Program or sequence number P of M98/M99 not found.
pub const TARGET_MISSING: u16 = 78;

/// 085: Serial input overflow, parity or framing error.
pub const SERIAL_GARBLED: u16 = 85;

/// 086: Interface ready signal DR off.
pub const SERIAL_NOT_READY: u16 = 86;

/// 090: Reference return cannot run: start point too near or speed too low.
pub const ZERO_RETURN: u16 = 90;

/// 091: Spindle speed fluctuation in a thread above the limit of 106.
pub const SPEED_FLUCTUATES: u16 = 91;

/// 092: Spindle encoder lines outside 100-5000.
pub const ENCODER_LINES: u16 = 92;

/// 093: Zero point not defined in zero-return method A.
pub const ZERO_UNDEFINED: u16 = 93;

/// 094: Spindle speed unsuitable for threading.
pub const THREAD_SPEED: u16 = 94;

/// 097: Speed too high for the electronic gear ratio.
pub const GEAR_SPEED: u16 = 97;

/// 098: Spindle stopped unexpectedly, feed stopped.
pub const SPINDLE_STOPPED: u16 = 98;

/// 100: Parameter switch is ON.
pub const PARAMETER_SWITCH: u16 = 100;

/// 101: Power lost while memory was being written.
pub const WRITE_INTERRUPTED: u16 = 101;

/// 110: Part program file already exists.
pub const PROGRAM_EXISTS: u16 = 110;

/// 111: Macro result out of range.
pub const MACRO_RANGE: u16 = 111;

/// 112: Division by zero.
pub const DIVISION_BY_ZERO: u16 = 112;

/// 114: Undefined H in G65.
pub const BAD_OPERATION: u16 = 114;

/// 115: Illegal variable number.
pub const BAD_VARIABLE: u16 = 115;

/// 116: Variable P is write-protected.
pub const READ_ONLY: u16 = 116;

/// 118: Brackets nested more than five deep.
pub const BRACKETS_TOO_DEEP: u16 = 118;

/// 119: Negative argument of SQRT or BCD.
pub const NEGATIVE_ARGUMENT: u16 = 119;

/// 122: More than four modal calls.
pub const MODAL_CALLS: u16 = 122;

/// 124: DO and END do not belong together.
pub const LOOP_MISMATCH: u16 = 124;

/// 125: Address not allowed in G65.
pub const BAD_IN_MACRO: u16 = 125;

/// 126: Loop number other than 1, 2 or 3.
pub const LOOP_NUMBER: u16 = 126;

/// 127: Macro statement and words in one block.
pub const MIXED_BLOCK: u16 = 127;

/// 128: Branch target out of range or not found.
pub const BAD_JUMP: u16 = 128;

/// 129: Address that carries no argument.
pub const BAD_ARGUMENT: u16 = 129;

/// 201: X positive travel limit.
pub const X_PLUS_LIMIT: u16 = 201;

/// 202: X negative travel limit.
pub const X_MINUS_LIMIT: u16 = 202;

/// 203: Z positive travel limit.
pub const Z_PLUS_LIMIT: u16 = 203;

/// 204: Z negative travel limit.
pub const Z_MINUS_LIMIT: u16 = 204;

/// 205: Y positive travel limit.
pub const Y_PLUS_LIMIT: u16 = 205;

/// 206: Y negative travel limit.
pub const Y_MINUS_LIMIT: u16 = 206;

/// 207: Overtravel switch or emergency stop.
pub const EMERGENCY_STOP: u16 = 207;

/// 211: X drive not ready.
pub const X_DRIVE_NOT_READY: u16 = 211;

/// 212: Z drive not ready.
pub const Z_DRIVE_NOT_READY: u16 = 212;

/// 221: X drive alarm.
pub const X_DRIVE_ALARM: u16 = 221;

/// 222: Z drive alarm.
pub const Z_DRIVE_ALARM: u16 = 222;

/// 251: X and Z drives not ready.
pub const DRIVES_NOT_READY: u16 = 251;

/// 252: X and Z drive alarm.
pub const DRIVES_ALARM: u16 = 252;

/// 433: Arc by R whose end is its start.
pub const CIRCLE_BY_RADIUS: u16 = 433;

/// 500: User alarm by G65 H99 P n.
pub const USER_ALARM: u16 = 500;

/// 599: the last one of these.
pub const USER_ALARM_LAST: u16 = 599;

/// 3000: Alarm of a program by #3000=n.
pub const MACRO_ALARM: u16 = 3000;

/// 3099: the last one of these.
pub const MACRO_ALARM_LAST: u16 = 3099;

/// 601: Drive link: no answer from the board.
pub const BOARD_SILENT: u16 = 601;

/// 602: Drive link: firmware not supported.
pub const BOARD_UNSUPPORTED: u16 = 602;

/// 603: Drive link: board settings differ.
pub const BOARD_SETTINGS: u16 = 603;

/// 604: Drive link: program not possible on this board.
pub const BOARD_CANNOT: u16 = 604;

/// 605: Drive link: link lost.
pub const LINK_LOST: u16 = 605;

/// 606: Drive link: board was reset.
pub const BOARD_RESET: u16 = 606;

/// 607: Drive link: fault reported by the board.
pub const BOARD_FAULT: u16 = 607;

/// 608: Drive link: protocol error.
pub const LINK_PROTOCOL: u16 = 608;

/// 609: Drive link: reference return failed.
pub const BOARD_ZERO_RETURN: u16 = 609;

/// 610: Drive link: machine coordinate not established.
pub const NO_REFERENCE: u16 = 610;

/// 611: Drive link: position check failed.
pub const POSITION_CHECK: u16 = 611;

/// 612: Drive link: samples late.
pub const STEPS_TOO_LATE: u16 = 612;

/// 613: Drive link: following error too large.
pub const FOLLOWING_ERROR: u16 = 613;

/// 614: Drive link: fault of the spindle encoder.
pub const SPINDLE_ENCODER: u16 = 614;

/// 621: Drive link: X limit input of the board.
pub const X_BOARD_LIMIT: u16 = 621;

/// 622: Drive link: Z limit input of the board.
pub const Z_BOARD_LIMIT: u16 = 622;

/// 1008: Tailstock function not active.
pub const NO_TAILSTOCK: u16 = 1008;

/// 1009: Tailstock must not retract while the spindle turns.
pub const TAILSTOCK_WHILE_TURNING: u16 = 1009;

/// 1010: M03/M04 without M05 in between.
pub const OTHER_DIRECTION: u16 = 1010;

/// 1012: Chuck must not release while the spindle turns.
pub const CHUCK_WHILE_TURNING: u16 = 1012;

/// 1013: Chuck function not active.
pub const NO_CHUCK: u16 = 1013;
