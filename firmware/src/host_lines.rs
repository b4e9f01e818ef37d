//! The lines to the host, USB and UART. The line that has brought the last byte is the one that
//! is answered.

use core::cell::RefCell;

use embassy_futures::join::join4;
use embassy_futures::yield_now;
use embassy_rp::pac;
use embassy_rp::peripherals::USB;
use embassy_rp::usb::Driver;
use embassy_usb::class::cdc_acm::{CdcAcmClass, Receiver, Sender, State};
use embassy_usb::{Builder, Config};
use gsk_motion::messages::RECEIVE_WINDOW;
use gsk_motion::{Event, Request, Session};
use heapless::Deque;
use heapless::spsc::{Consumer, Producer};
use static_cell::StaticCell;

/// Size of a USB packet, bytes.
const PACKET: usize = 64;
/// Capacity of the queue of bytes to the host.
const SENDS: usize = 2048;
/// USB numbers of the board: those that the project `pid.codes` gives for tests.
const USB_IDS: (u16, u16) = (0x1209, 0x0001);

/// A line to the host.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Line {
    Usb,
    Uart,
}

/// The queues of bytes between a line and the session.
struct Bytes {
    from_usb: Deque<u8, { 2 * RECEIVE_WINDOW }>,
    to_host: Deque<u8, SENDS>,
    line: Line,
}

/// Serves both lines.
pub async fn serve(
    driver: Driver<'static, USB>,
    mut requests: Producer<'static, Request>,
    mut events: Consumer<'static, Event>,
) {
    static CONFIGURATION: StaticCell<[u8; 256]> = StaticCell::new();
    static DESCRIPTOR: StaticCell<[u8; 256]> = StaticCell::new();
    static CONTROL: StaticCell<[u8; 64]> = StaticCell::new();
    static STATE: StaticCell<State<'static>> = StaticCell::new();
    let mut config = Config::new(USB_IDS.0, USB_IDS.1);
    config.manufacturer = Some("gsk980td");
    config.product = Some("Pulse board");
    config.serial_number = Some("1");
    let mut builder = Builder::new(
        driver,
        config,
        CONFIGURATION.init([0; 256]),
        DESCRIPTOR.init([0; 256]),
        &mut [],
        CONTROL.init([0; 64]),
    );
    let class = CdcAcmClass::new(&mut builder, STATE.init(State::new()), PACKET as u16);
    let mut device = builder.build();
    let (sender, receiver) = class.split();
    let bytes = RefCell::new(Bytes {
        from_usb: Deque::new(),
        to_host: Deque::new(),
        line: Line::Uart,
    });
    join4(
        device.run(),
        receive_usb(receiver, &bytes),
        send_usb(sender, &bytes),
        run_session(&bytes, &mut requests, &mut events),
    )
    .await;
}

async fn receive_usb(
    mut receiver: Receiver<'static, Driver<'static, USB>>,
    bytes: &RefCell<Bytes>,
) {
    let mut packet = [0; PACKET];
    loop {
        receiver.wait_connection().await;
        while let Ok(length) = receiver.read_packet(&mut packet).await {
            for byte in &packet[..length] {
                while bytes.borrow_mut().from_usb.push_back(*byte).is_err() {
                    yield_now().await;
                }
            }
        }
    }
}

async fn send_usb(mut sender: Sender<'static, Driver<'static, USB>>, bytes: &RefCell<Bytes>) {
    loop {
        sender.wait_connection().await;
        loop {
            let mut packet = heapless::Vec::<u8, PACKET>::new();
            {
                let mut bytes = bytes.borrow_mut();
                while bytes.line == Line::Usb
                    && packet.len() < PACKET - 1
                    && let Some(byte) = bytes.to_host.pop_front()
                {
                    packet.extend([byte]);
                }
            }
            if packet.is_empty() {
                yield_now().await;
            } else if sender.write_packet(&packet).await.is_err() {
                break;
            }
        }
    }
}

/// Passes bytes, requests and events between the host and the engine.
async fn run_session(
    bytes: &RefCell<Bytes>,
    requests: &mut Producer<'static, Request>,
    events: &mut Consumer<'static, Event>,
) {
    let uart = pac::UART0;
    let mut session = Session::default();
    loop {
        crate::watchdog::note_line_call();
        for _ in 0..PACKET {
            // A block has at most as many commands as the queue is long.
            if requests.len() > 0 {
                break;
            }
            let Some(byte) = receive(bytes) else {
                break;
            };
            let mut bytes = bytes.borrow_mut();
            session.push(
                byte,
                |block| bytes.to_host.extend(block),
                |request| {
                    let _ = requests.enqueue(request);
                },
            );
        }
        let mut out = bytes.borrow_mut();
        while out.to_host.len() + PACKET < SENDS
            && let Some(event) = events.dequeue()
        {
            let block = session.encode(&event);
            out.to_host.extend(block);
        }
        while out.line == Line::Uart
            && !uart.uartfr().read().txff()
            && let Some(byte) = out.to_host.pop_front()
        {
            uart.uartdr().write(|data| data.set_data(byte));
        }
        drop(out);
        yield_now().await;
    }
}

/// Returns the next byte of the host.
fn receive(bytes: &RefCell<Bytes>) -> Option<u8> {
    let mut bytes = bytes.borrow_mut();
    let uart = pac::UART0;
    let (line, byte) = if !uart.uartfr().read().rxfe() {
        (Line::Uart, uart.uartdr().read().data())
    } else {
        (Line::Usb, bytes.from_usb.pop_front()?)
    };
    if line != bytes.line {
        bytes.line = line;
        bytes.to_host.clear();
    }
    Some(byte)
}
