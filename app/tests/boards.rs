//! Runs the program with virtual boards in separate processes, in real time. The tests mostly
//! wait: two run per processor.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "tests fail by panicking"
)]

#[path = "common/at_board.rs"]
mod at_board;
mod board;
mod link_command;
mod operate_link;
mod partner_gone;
#[path = "common/process.rs"]
mod process;
mod run_link;
#[path = "common/twin.rs"]
mod twin;

use std::thread::available_parallelism;

use libtest_mimic::{Arguments, Trial, run};

/// The tests of the modules, by their functions. A function that is not listed is dead code,
/// which the lints refuse.
macro_rules! trials {
    ($($module:ident { $($test:ident,)* })*) => {
        vec![$($(
            Trial::test(concat!(stringify!($module), "::", stringify!($test)), || {
                $module::$test();
                Ok(())
            }),
        )*)*]
    };
}

fn main() {
    let mut arguments = Arguments::from_args();
    let processors = available_parallelism().map_or(1, usize::from);
    arguments.test_threads.get_or_insert(2 * processors);
    run(&arguments, trials()).exit()
}

fn trials() -> Vec<Trial> {
    trials! {
        board {
            a_line_board_in_another_process_makes_a_part_and_is_unplugged,
            a_board_of_timed_steps_in_another_process_makes_a_part_and_is_unplugged,
            the_scope_shows_what_is_known_of_the_real_lathe,
            the_link_page_is_told_how_long_the_computer_was_away,
            a_port_in_use_is_refused_with_its_name,
            a_board_met_before_is_asked_little_and_no_file_is_trusted,
        }
        link_command {
            a_board_at_a_network_address_is_tried_as_one_at_a_port,
            a_slip_of_the_pen_in_data_makes_no_folder_and_is_no_new_control,
            a_way_or_feed_that_cannot_be_made_is_refused_before_anything_is_opened,
            a_feed_beyond_the_board_is_refused_before_anything_moves,
            a_board_that_was_never_known_is_no_board_in_order,
            a_test_leaves_a_board_of_timed_steps_stopped_by_command,
            the_drill_goes_no_farther_than_it_was_sent,
            a_monitor_tells_an_alarm_when_it_comes_and_ends_by_ctrl_c,
            a_monitor_shows_what_stops_the_board_at_its_end,
            a_test_that_is_ended_in_motion_stops_the_board,
            a_switch_that_is_operated_is_named_before_anything_moves,
            a_link_that_breaks_while_the_board_is_idle_is_told,
        }
        operate_link {
            a_script_makes_a_part_at_a_board_and_its_count_is_in_the_log,
            settings_that_differ_are_no_board_to_work_with,
            ctrl_c_stops_the_board_in_motion_and_saves,
        }
        partner_gone {
            a_line_board_is_stopped_when_the_program_is_killed,
            a_board_at_a_network_address_is_stopped_when_the_program_is_killed,
            a_line_board_is_stopped_when_the_program_breaks_down,
            a_board_of_timed_steps_is_stopped_when_the_program_is_killed,
            a_line_board_is_stopped_when_the_program_stands_still,
            the_holder_outlives_the_signals_of_the_session,
            when_the_holder_is_killed_another_one_stops_the_board_and_the_program_says_it,
            a_normal_end_leaves_no_process_behind,
            whoever_starts_the_holder_by_hand_is_told_what_it_is,
        }
        run_link {
            a_program_runs_to_its_end_and_the_board_has_made_its_pulses,
            a_board_of_timed_steps_makes_it_too,
            a_program_comes_in_through_the_line,
            nobody_answers_m00_for_a_person,
            enter_at_the_terminal_goes_on_behind_m00,
            each_part_more_is_allowed_by_a_person,
            a_signal_stops_the_board_in_motion,
            a_board_that_is_gone_ends_the_run,
            the_limit_of_time_holds_the_program,
            a_program_that_begins_again_is_held_behind_its_part,
            without_a_reference_nothing_moves,
            what_a_real_machine_does_not_do_is_refused_before_the_port_is_opened,
        }
    }
}
