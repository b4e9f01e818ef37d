//! Runs the program with virtual boards in separate processes, in real time. The tests mostly
//! wait: four run per processor.

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

/// The tests of the modules, by their functions, the longest modules first. A function that is
/// not listed is dead code, which the lints refuse.
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
    arguments.test_threads.get_or_insert(4 * processors);
    run(&arguments, weave_exclusive_trials(trials())).exit()
}

/// Spreads the tests that run two at a time among the others: side by side in the queue they
/// would keep all threads waiting for each other.
fn weave_exclusive_trials(trials: Vec<Trial>) -> Vec<Trial> {
    let is_exclusive = |trial: &Trial| trial.name().starts_with("partner_gone");
    let (exclusive, others): (Vec<_>, Vec<_>) = trials.into_iter().partition(is_exclusive);
    let others_between = others.len() / exclusive.len().max(1);
    let mut others = others.into_iter();
    let mut woven = Vec::new();
    for trial in exclusive {
        woven.push(trial);
        woven.extend(others.by_ref().take(others_between));
    }
    woven.extend(others);
    woven
}

fn trials() -> Vec<Trial> {
    trials! {
        operate_link {
            a_script_makes_a_part_and_the_pulses_are_logged,
            a_board_with_different_settings_is_refused,
            ctrl_c_stops_the_board_in_motion_and_saves,
        }
        link_command {
            a_test_that_is_interrupted_in_motion_stops_the_board,
            a_board_at_a_network_address_is_tested_like_one_at_a_port,
            a_wrong_data_path_creates_no_folder_and_no_new_control,
            an_invalid_travel_or_feed_is_refused_before_the_port_is_opened,
            a_feed_above_the_limit_of_the_board_is_refused_before_motion,
            a_board_that_is_not_ready_in_time_fails_the_test,
            a_test_ends_with_a_stop_command_to_a_step_board,
            the_test_motion_does_not_exceed_its_travel,
            a_monitor_reports_an_alarm_at_once_and_ends_by_ctrl_c,
            a_monitor_shows_the_stop_command_at_its_end,
            an_operated_switch_is_named_before_motion,
            a_link_that_breaks_while_the_board_is_idle_is_reported,
            firmware_is_copied_to_the_drive_of_a_pico_only,
        }
        partner_gone {
            a_line_board_is_stopped_when_the_program_is_suspended,
            a_line_board_is_stopped_when_the_program_is_killed,
            a_board_at_a_network_address_is_stopped_when_the_program_is_killed,
            a_line_board_is_stopped_when_the_program_crashes,
            a_board_of_timed_steps_is_stopped_when_the_program_is_killed,
            session_signals_do_not_end_the_holder,
            a_killed_holder_is_replaced_and_reported,
            a_normal_end_leaves_no_process,
            a_holder_started_by_hand_explains_itself,
        }
        run_link {
            a_restart_begins_with_the_code_of_its_differences,
            the_operator_confirms_each_difference_of_a_restart,
            a_program_runs_to_its_end_and_the_pulses_agree,
            a_step_board_runs_a_program_to_its_end,
            a_dnc_program_runs_to_its_end,
            m00_ends_a_run_without_an_operator,
            enter_at_the_terminal_continues_after_m00,
            the_operator_confirms_each_further_part,
            a_signal_stops_the_board_in_motion,
            an_unplugged_board_ends_the_run,
            the_time_limit_holds_the_program,
            a_repeating_program_is_held_after_its_part,
            without_a_reference_no_axis_moves,
            options_for_simulation_only_are_refused_before_the_port_is_opened,
        }
        board {
            a_line_board_in_another_process_makes_a_part_and_is_unplugged,
            a_board_of_timed_steps_in_another_process_makes_a_part_and_is_unplugged,
            the_scope_shows_only_known_values_of_the_real_lathe,
            the_link_page_shows_the_longest_poll_gap,
            a_port_in_use_is_refused_with_its_name,
            a_known_board_is_queried_little_and_no_file_is_trusted,
        }
    }
}
