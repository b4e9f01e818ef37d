use gsk_motion::messages::Command;
use pico_bench::Bench;
use std::collections::BTreeMap;
#[test]
fn profile2() {
    let mut bench = Bench::start();
    bench.configure();
    bench.renew();
    let from = i64::from((bench.clock() + 150_000) as u32);
    for axis in 0..2 {
        bench.send(Command::ResetStepClock, &[axis, from]);
        bench.send(Command::QueueStep, &[axis, 90, 20000, 0]);
    }
    bench.run(3_500_000);
    let e0 = bench.edges.len();
    let c0 = bench.cycle();
    let mut h: BTreeMap<u32, u64> = BTreeMap::new();
    for _ in 0..100_000 {
        bench.run(1);
        let (pc, c) = bench.pc();
        *h.entry(pc & !1).or_default() += c;
    }
    for (pc, n) in h {
        println!("PROF {pc:08x} {n}");
    }
    println!(
        "edges {} in {} {:?}",
        bench.edges.len() - e0,
        bench.cycle() - c0,
        bench.shutdown_text()
    );
}
