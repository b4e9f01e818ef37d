//! The pulse board on a Raspberry Pi Pico: one processor has the lines to the host, the other
//! runs the engine without interruption.

#![no_std]
#![no_main]

mod board_port;
mod encoders;
mod host_lines;
mod pins;
mod step_outputs;
mod watchdog;

use board_port::BoardPort;
use cortex_m::peripheral::SYST;
use embassy_executor::Spawner;
use embassy_rp::multicore::{Stack, spawn_core1};
use embassy_rp::peripherals::USB;
use embassy_rp::uart::{Blocking, Config, Uart};
use embassy_rp::usb::{Driver, InterruptHandler};
use embassy_rp::{Peri, bind_interrupts};
use gsk_motion::{Engine, Event, Request};
use heapless::spsc::{Consumer, Producer, Queue};
use static_cell::{ConstStaticCell, StaticCell};
use watchdog::Watchdog;

/// Capacity of the queues between the processors, and a place that remains free.
const REQUESTS: usize = 64;
const EVENTS: usize = 64;
/// Number of polls of the engine between two requests.
const POLLS: u32 = 4;
/// Rate of the serial port, bits/s.
const BAUD: u32 = 250_000;

bind_interrupts!(struct Interrupts {
    USBCTRL_IRQ => InterruptHandler<USB>;
});

static ENGINE: ConstStaticCell<Engine> = ConstStaticCell::new(Engine::new());
/// Large enough for a whole engine, in case the compiler builds one there before it stores it.
static STACK: ConstStaticCell<Stack<49_152>> = ConstStaticCell::new(Stack::new());
static REQUEST_QUEUE: StaticCell<Queue<Request, REQUESTS>> = StaticCell::new();
static EVENT_QUEUE: StaticCell<Queue<Event, EVENTS>> = StaticCell::new();

/// Restarts the board: the outputs are off, and the host receives that it has restarted.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    watchdog::restart()
}

/// Runs the engine on the second processor.
fn run_engine(
    mut requests: Consumer<'static, Request>,
    mut events: Producer<'static, Event>,
    engine: &'static mut Engine,
) -> ! {
    // This processor has its own cycle counter, which no other code uses.
    let mut systick: SYST = unsafe { cortex_m::Peripherals::steal() }.SYST;
    let mut port = BoardPort::start(&mut systick);
    let mut watchdog = Watchdog::start();
    engine.report_start();
    loop {
        for _ in 0..POLLS {
            engine.poll(&mut port);
        }
        if engine.takes_request()
            && let Some(request) = requests.dequeue()
        {
            engine.execute(&request, &mut port);
        }
        if let Some(event) = engine.next_event() {
            // The other processor empties this queue as fast as the line takes bytes; the
            // engine takes no request while its own queue is half full.
            while !events.ready() {
                engine.poll(&mut port);
            }
            let _ = events.enqueue(event);
        }
        watchdog.feed();
    }
}

/// Starts the serial port on GPIO 0 and 1.
fn start_uart(
    uart: Peri<'static, embassy_rp::peripherals::UART0>,
    tx: Peri<'static, embassy_rp::peripherals::PIN_0>,
    rx: Peri<'static, embassy_rp::peripherals::PIN_1>,
) -> Uart<'static, Blocking> {
    let mut config = Config::default();
    config.baudrate = BAUD;
    Uart::new_blocking(uart, tx, rx, config)
}

#[embassy_executor::main]
async fn main(_spawner: Spawner) {
    let peripherals = embassy_rp::init(embassy_rp::config::Config::default());
    let (request_producer, request_consumer) = REQUEST_QUEUE.init(Queue::new()).split();
    let (event_producer, event_consumer) = EVENT_QUEUE.init(Queue::new()).split();
    let engine = ENGINE.take();
    let _uart = start_uart(peripherals.UART0, peripherals.PIN_0, peripherals.PIN_1);
    spawn_core1(peripherals.CORE1, STACK.take(), move || {
        run_engine(request_consumer, event_producer, engine)
    });
    let driver = Driver::new(peripherals.USB, Interrupts);
    host_lines::serve(driver, request_producer, event_consumer).await;
}
