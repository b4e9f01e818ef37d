use super::*;

const MS: u64 = 1_000_000;

fn booted() -> KlipperTwin {
    let mut twin = KlipperTwin::new(KlipperHardware::default());
    twin.advance(100 * MS);
    twin.read();
    twin
}

/// Sends commands in one block and returns the messages received within 20 ms.
fn send_commands(
    twin: &mut KlipperTwin,
    commands: &[(dictionary::Command, &[i64])],
) -> Vec<Vec<u8>> {
    let mut content = Vec::new();
    for (command, numbers) in commands {
        block::encode_vlq(&mut content, dictionary::command_id(*command));
        for number in *numbers {
            block::encode_vlq(&mut content, *number);
        }
    }
    let block = encode_block(twin.next_sequence, &content);
    twin.write(&block);
    twin.advance(20 * MS);
    contents(&twin.read())
}

fn contents(mut bytes: &[u8]) -> Vec<Vec<u8>> {
    let mut found = Vec::new();
    while let BufferFront::Block(length, _) = block::parse_front(bytes) {
        found.push(bytes[2..length - 3].to_vec());
        bytes = &bytes[length..];
    }
    assert_eq!(block::parse_front(bytes), BufferFront::Incomplete);
    found
}

use dictionary::Command as C;

/// Configures the steppers with the oids 0 and 2, and the trsync with the oid 1.
fn stepper(twin: &mut KlipperTwin) {
    send_commands(
        twin,
        &[
            (C::AllocateOids, &[3]),
            (C::ConfigStepper, &[0, 0, 1, 0, 32]),
            (C::ConfigStepper, &[2, 2, 3, 0, 32]),
            (C::ConfigTrsync, &[1]),
            (C::FinalizeConfig, &[77]),
        ],
    );
}

fn clock_in(twin: &KlipperTwin, ms: i64) -> i64 {
    i64::from((twin.clock() + ms * 16_000) as u32)
}

#[test]
fn encoded_blocks_match_the_fixtures() {
    assert_eq!(encode_block(0, &[]), [0x05, 0x10, 0x9e, 0x81, 0x7e]);
    assert_eq!(
        encode_block(1, &[1, 0, 40]),
        [0x08, 0x11, 0x01, 0x00, 0x28, 0x42, 0x24, 0x7e]
    );
}

#[test]
fn dictionary_has_91_chunks() {
    assert_eq!(
        dictionary::compressed_dictionary(CLOCK_HZ, 192, true).len(),
        3574
    );
    let mut twin = booted();
    let mut offset = 0;
    loop {
        let replies = send_commands(&mut twin, &[(C::Identify, &[offset, 40])]);
        let mut reply = replies[0].as_slice();
        assert_eq!(block::decode_vlq(&mut reply), Some(0));
        assert_eq!(block::decode_vlq(&mut reply), Some(offset as u32));
        if reply[0] == 0 {
            break;
        }
        offset += i64::from(reply[0]);
    }
    assert_eq!((offset, twin.statistics().identify_count), (3574, 91));
}

#[test]
fn block_with_wrong_sequence_number_is_not_executed() {
    let mut twin = booted();
    let block = encode_block(twin.next_sequence + 3, &[1, 0, 40]);
    twin.write(&block);
    twin.advance(20 * MS);
    assert_eq!(contents(&twin.read()), [Vec::<u8>::new()]);
    assert_eq!(twin.statistics().command_count, 0);
}

#[test]
fn steps_come_at_their_clocks() {
    let mut twin = booted();
    stepper(&mut twin);
    let from = twin.clock() + 50 * 16_000;
    send_commands(
        &mut twin,
        &[
            (C::ResetStepClock, &[0, i64::from(from as u32)]),
            (C::SetNextStepDir, &[0, 1]),
            (C::QueueStep, &[0, 16_000, 10, 160]),
        ],
    );
    twin.advance(60 * MS);
    assert_eq!(twin.pulses()[0], 10);
    // 10 intervals of 1 ms, and 45 times 10 µs.
    let last = twin.clock_to_ns(from + 10 * 16_000 + 45 * 160);
    assert_eq!(twin.last_pulse_ns(), last);
}

#[test]
fn impossible_commands_cause_shutdown_with_reason() {
    type Commands = Vec<(C, Vec<i64>)>;
    let mut twin = booted();
    stepper(&mut twin);
    let now = twin.clock();
    let table: [(&str, Commands); 6] = [
        (
            "Invalid count parameter",
            vec![(C::QueueStep, vec![0, 100, 0, 0])],
        ),
        (
            "Timer too close",
            vec![
                (C::ResetStepClock, vec![0, now - 16_000]),
                (C::QueueStep, vec![0, 100, 1, 0]),
            ],
        ),
        (
            "Can't reset time when stepper active",
            vec![
                (C::ResetStepClock, vec![0, now + 160_000]),
                (C::QueueStep, vec![0, 160_000, 1, 0]),
                (C::ResetStepClock, vec![0, now]),
            ],
        ),
        ("Invalid oid type", vec![(C::TrsyncTrigger, vec![0, 1])]),
        ("Command request", vec![(C::EmergencyStop, vec![])]),
        ("Invalid command", vec![(C::EmergencyStop, vec![0])]),
    ];
    for (reason, commands) in table {
        let mut twin = twin.clone();
        if reason == "Invalid command" {
            twin.write(&encode_block(twin.next_sequence, &[0x5f]));
            twin.advance(20 * MS);
        } else {
            let commands: Vec<(C, &[i64])> = commands
                .iter()
                .map(|(name, numbers)| (*name, numbers.as_slice()))
                .collect();
            send_commands(&mut twin, &commands);
        }
        assert_eq!(twin.state(), KlipperState::Shutdown(reason));
    }
}

#[test]
fn full_move_queue_overflows() {
    let mut twin = booted();
    stepper(&mut twin);
    let clock = clock_in(&twin, 1000);
    send_commands(&mut twin, &[(C::ResetStepClock, &[0, clock])]);
    for _ in 0..690 {
        send_commands(&mut twin, &[(C::QueueStep, &[0, 16_000_000, 1, 0])]);
    }
    assert_eq!(twin.state(), KlipperState::Shutdown("Move queue overflow"));
}

#[test]
fn step_rate_limit_is_between_40_and_50_kilohertz() {
    for (interval, made) in [(400, true), (320, false)] {
        let mut twin = booted();
        stepper(&mut twin);
        let clock = clock_in(&twin, 100);
        for oid in [0, 2] {
            send_commands(
                &mut twin,
                &[
                    (C::ResetStepClock, &[oid, clock]),
                    (C::QueueStep, &[oid, interval, 20_000, 0]),
                ],
            );
        }
        twin.advance(1000 * MS);
        assert_eq!(
            twin.state() == KlipperState::Running,
            made,
            "{:?}",
            twin.state()
        );
    }
}

#[test]
fn expired_trsync_stops_its_steppers() {
    let mut twin = booted();
    stepper(&mut twin);
    let (clock, timeout) = (clock_in(&twin, 50), clock_in(&twin, 250));
    let from = twin.now();
    send_commands(
        &mut twin,
        &[
            (C::TrsyncStart, &[1, clock, 1_600_000, 4]),
            (C::StepperStopOnTrigger, &[0, 1]),
            (C::TrsyncSetTimeout, &[1, timeout]),
            (C::ResetStepClock, &[0, clock]),
        ],
    );
    send_commands(&mut twin, &[(C::QueueStep, &[0, 1600, 60_000, 0])]);
    twin.advance(1000 * MS);
    let stood = twin.last_pulse_ns() - from;
    assert!((249 * MS..=250 * MS).contains(&stood), "{stood}");
    // The stepper does not move until its step clock is reset.
    let count = twin.pulses()[0];
    send_commands(&mut twin, &[(C::QueueStep, &[0, 1600, 100, 0])]);
    twin.advance(1000 * MS);
    assert_eq!(
        (twin.pulses()[0], twin.state()),
        (count, KlipperState::Running)
    );
    // A stepper whose trsync can still trigger cannot join another trsync.
    let clock = clock_in(&twin, 50);
    send_commands(
        &mut twin,
        &[
            (C::TrsyncStart, &[1, clock, 0, 4]),
            (C::StepperStopOnTrigger, &[0, 1]),
        ],
    );
    send_commands(&mut twin, &[(C::StepperStopOnTrigger, &[0, 1])]);
    assert_eq!(
        twin.state(),
        KlipperState::Shutdown("Can't add signal that is already active")
    );
}

#[test]
fn output_not_renewed_causes_shutdown() {
    let mut twin = booted();
    send_commands(
        &mut twin,
        &[
            (C::AllocateOids, &[4]),
            (C::ConfigDigitalOut, &[3, 88, 0, 0, 8_000_000]),
            (C::FinalizeConfig, &[1]),
        ],
    );
    let clock = clock_in(&twin, 100);
    send_commands(&mut twin, &[(C::QueueDigitalOut, &[3, clock, 1])]);
    twin.advance(100 * MS);
    assert_eq!(twin.output("PL0"), Some(1));
    twin.advance(450 * MS);
    assert_eq!(twin.state(), KlipperState::Running);
    twin.advance(60 * MS);
    assert_eq!(
        twin.state(),
        KlipperState::Shutdown("Missed scheduling of next digital out event")
    );
    assert_eq!(twin.output("PL0"), Some(0));
}

#[test]
fn configuration_survives_the_host_but_not_a_reset() {
    let mut twin = booted();
    stepper(&mut twin);
    twin.advance(10_000 * MS);
    assert_eq!(twin.crc, Some(77));
    send_commands(&mut twin, &[(C::Reset, &[])]);
    twin.advance(100 * MS);
    assert_eq!(
        (twin.crc, twin.next_sequence, twin.state()),
        (None, 1, KlipperState::Running)
    );
}

#[test]
fn edge_counter_counts_two_edges_per_turn() {
    let mut twin = booted();
    send_commands(
        &mut twin,
        &[
            (C::AllocateOids, &[6]),
            (C::ConfigCounter, &[5, 19, 0]),
            (C::FinalizeConfig, &[1]),
        ],
    );
    twin.run_spindle("PC3", 600.0);
    let clock = clock_in(&twin, 10);
    send_commands(&mut twin, &[(C::QueryCounter, &[5, clock, 1600, 320_000])]);
    twin.advance(1000 * MS);
    let last = contents(&twin.read())
        .into_iter()
        .rfind(|content| !content.is_empty())
        .unwrap();
    let mut reply = last.as_slice();
    for _ in 0..3 {
        block::decode_vlq(&mut reply);
    }
    let count = block::decode_vlq(&mut reply).unwrap();
    assert!((19..=22).contains(&count), "{count}");
}

#[test]
fn the_outputs_drive_the_spindle() {
    let mut twin = booted();
    twin.attach_spindle(SpindleWiring {
        index_pin: "PC3",
        forward_pin: "PB4",
        reverse_pin: "PB5",
        speed_pin: "PH6",
        full_speed_rpm: 2550.0,
        time_constant_s: 0.1,
    });
    let pin = |name| i64::from(pins::pin_number(name).unwrap());
    send_commands(
        &mut twin,
        &[
            (C::AllocateOids, &[5]),
            (C::ConfigDigitalOut, &[3, pin("PB4"), 0, 0, 0]),
            (C::ConfigPwmOut, &[4, pin("PH6"), 16_000, 0, 0, 0]),
            (C::FinalizeConfig, &[1]),
        ],
    );
    let clock = clock_in(&twin, 100);
    send_commands(
        &mut twin,
        &[
            (C::QueueDigitalOut, &[3, clock, 1]),
            (C::QueuePwmOut, &[4, clock, 60]),
        ],
    );
    twin.advance(80 * MS);
    assert_eq!(twin.spindle_rpm(), 0.0);
    // After one time constant the spindle has two thirds of its speed.
    twin.advance(100 * MS);
    assert!(
        (twin.spindle_rpm() - 379.0).abs() < 5.0,
        "{}",
        twin.spindle_rpm()
    );
    twin.advance(2000 * MS);
    assert!((twin.spindle_rpm() - 600.0).abs() < 0.01);
    // Ripple causes no jump and does not change the mean speed of 10 r/s.
    let turns = |twin: &KlipperTwin| twin.spindle_turns(twin.now());
    let begin = turns(&twin);
    twin.set_speed_ripple(1.0, 0.5);
    assert!((turns(&twin) - begin).abs() < 1e-9);
    let (mut least, mut most) = (f64::MAX, 0.0_f64);
    for _ in 0..200 {
        let before = turns(&twin);
        twin.advance(10 * MS);
        let turned = turns(&twin) - before;
        (least, most) = (least.min(turned), most.max(turned));
    }
    assert!((turns(&twin) - begin - 20.0).abs() < 1e-6);
    assert!((least - 0.099).abs() < 1e-5 && (most - 0.101).abs() < 1e-5);
    // A shutdown lets the spindle run down.
    twin.force_shutdown("test");
    twin.advance(2000 * MS);
    assert!(twin.spindle_rpm().abs() < 0.01);
}

#[test]
fn wrong_pins_and_oids_cause_shutdown() {
    let pin = |name| i64::from(pins::pin_number(name).unwrap());
    let (timer_1, plain, none) = (pin("PB6"), pin("PA4"), 64);
    for (command, numbers, reason) in [
        (
            C::ConfigPwmOut,
            [0, timer_1, 16_000, 0, 0, 0],
            "Can not use timer1 for PWM; timer1 is used for timers",
        ),
        (
            C::ConfigPwmOut,
            [0, plain, 16_000, 0, 0, 0],
            "Not a valid PWM pin",
        ),
        (
            C::ConfigDigitalOut,
            [0, none, 0, 0, 0, 0],
            "Not an output pin",
        ),
        (
            C::ConfigStepper,
            [0, plain, none, 0, 32, 0],
            "Not an output pin",
        ),
        (
            C::ConfigEndstop,
            [0, none, 1, 0, 0, 0],
            "Not a valid input pin",
        ),
        (C::ConfigTrsync, [1, 0, 0, 0, 0, 0], "Can't assign oid"),
    ] {
        let mut twin = booted();
        let (_, text) = dictionary::COMMANDS[command as usize];
        let numbers = &numbers[..text.matches('=').count()];
        send_commands(
            &mut twin,
            &[
                (C::AllocateOids, &[1]),
                (command, numbers),
                (C::FinalizeConfig, &[7]),
            ],
        );
        assert_eq!(twin.state(), KlipperState::Shutdown(reason));
        assert_eq!(twin.crc, None, "{reason}");
    }
}
