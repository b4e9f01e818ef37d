use gsk_motion::messages::Command;
use pico_bench::Bench;
#[test]
fn profile() {
    for (interval, axes) in [(1000, 1), (300, 1), (100, 1), (78, 1), (78, 2)] {
        let mut bench = Bench::start();
        bench.configure();
        bench.renew();
        let from = i64::from((bench.clock() + 150_000) as u32);
        for axis in 0..axes {
            bench.send(Command::ResetStepClock, &[axis, from]);
            bench.send(Command::QueueStep, &[axis, interval, 20000, 0]);
        }
        bench.run(3_000_000);
        let t: Vec<_> = bench
            .edges
            .iter()
            .filter(|e| e.axis == 0)
            .take(40)
            .map(|e| e.cycle)
            .collect();
        println!(
            "{interval} {axes}: first {} {:?} {:?} fall {:?}",
            t[0] as i64 / 8,
            t.windows(2).map(|p| p[1] - p[0]).collect::<Vec<_>>(),
            bench.shutdown_text(),
            bench.falls.iter().find(|f| f.1 > t[0]).map(|f| f.1 - t[0])
        );
    }
}
