//! The connection to a broker from a page: a WebSocket that carries the bytes of MQTT.

use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::rc::Rc;

use gsk_messages::say;
use gsk_telemetry::BrokerUrl;
use js_sys::{Array, ArrayBuffer, Uint8Array};
use wasm_bindgen::closure::Closure;
use wasm_bindgen::{JsCast, JsValue};
use web_sys::{BinaryType, MessageEvent, WebSocket};
use web_time::Duration;

use crate::platform::{BrokerBytes, BrokerFailure};

/// Name of MQTT among the protocols of WebSocket.
const PROTOCOL: &str = "mqtt";
/// The path at which brokers serve WebSocket; Mosquitto accepts every path.
const PATH: &str = "mqtt";
/// Greatest number of bytes that wait in the browser for a slow broker.
const MAX_BUFFERED_BYTES: u32 = 4 * 1024 * 1024;

/// A connection that opens, is open or has been closed.
pub struct BrokerStream {
    socket: WebSocket,
    received: Rc<RefCell<VecDeque<u8>>>,
    is_lost: Rc<Cell<bool>>,
    /// What was written before the connection was open.
    waiting: Vec<u8>,
    /// The callbacks of the socket, which must live as long as it.
    _on_message: Closure<dyn FnMut(MessageEvent)>,
    _on_close: Closure<dyn FnMut()>,
}

impl core::fmt::Debug for BrokerStream {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let state = self.socket.ready_state();
        f.debug_tuple("BrokerStream").field(&state).finish()
    }
}

impl BrokerStream {
    /// Begins to connect to a broker. A page does not wait: reads return what has arrived.
    ///
    /// # Errors
    /// The address has no WebSocket, or the browser refuses it.
    pub fn open(
        url: &BrokerUrl,
        _poll_interval: Duration,
        mut before_attempt: impl FnMut(),
    ) -> Result<Self, BrokerFailure> {
        if !url.transport.is_web_socket() {
            return Err(say::mqtt_no_web_socket().into());
        }
        before_attempt();
        let without_prefix = BrokerUrl {
            prefix: PATH.to_owned(),
            ..url.clone()
        };
        let protocols = Array::of1(&JsValue::from_str(PROTOCOL));
        let address = without_prefix.to_string();
        // A page from HTTPS may open encrypted sockets only.
        let socket = WebSocket::new_with_str_sequence(&address, &protocols);
        let socket = socket.map_err(|_| say::mqtt_web_socket_refused())?;
        socket.set_binary_type(BinaryType::Arraybuffer);
        let received = Rc::new(RefCell::new(VecDeque::new()));
        let is_lost = Rc::new(Cell::new(false));
        let bytes = Rc::clone(&received);
        let on_message = Closure::<dyn FnMut(MessageEvent)>::new(move |event: MessageEvent| {
            if let Ok(buffer) = event.data().dyn_into::<ArrayBuffer>() {
                bytes.borrow_mut().extend(Uint8Array::new(&buffer).to_vec());
            }
        });
        let lost = Rc::clone(&is_lost);
        let on_close = Closure::<dyn FnMut()>::new(move || lost.set(true));
        socket.set_onmessage(Some(on_message.as_ref().unchecked_ref()));
        socket.set_onclose(Some(on_close.as_ref().unchecked_ref()));
        Ok(Self {
            socket,
            received,
            is_lost,
            waiting: Vec::new(),
            _on_message: on_message,
            _on_close: on_close,
        })
    }

    /// Whether the broker can receive bytes.
    pub fn is_established(&self) -> bool {
        self.socket.ready_state() == WebSocket::OPEN
    }

    /// Takes what the broker has sent.
    ///
    /// # Errors
    /// The connection was refused.
    pub fn read(&mut self, buffer: &mut [u8]) -> Result<BrokerBytes, BrokerFailure> {
        self.send_waiting()?;
        let mut received = self.received.borrow_mut();
        if received.is_empty() && self.is_lost.get() {
            return Ok(BrokerBytes::Closed);
        }
        let count = buffer.len().min(received.len());
        for (place, byte) in buffer.iter_mut().zip(received.drain(..count)) {
            *place = byte;
        }
        Ok(BrokerBytes::Received(count))
    }

    /// Writes bytes; those before the connection is open are sent then.
    ///
    /// # Errors
    /// The connection is lost, or the broker takes nothing.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), BrokerFailure> {
        self.waiting.extend(bytes);
        self.send_waiting()
    }

    fn send_waiting(&mut self) -> Result<(), BrokerFailure> {
        if self.socket.buffered_amount() > MAX_BUFFERED_BYTES {
            return Err(say::mqtt_silent().into());
        }
        if self.waiting.is_empty() || !self.is_established() {
            return Ok(());
        }
        let sent = self.socket.send_with_u8_array(&self.waiting);
        self.waiting.clear();
        sent.map_err(|_| say::mqtt_silent().into())
    }

    /// Closes the connection after everything that was written.
    pub fn close(self) {
        drop(self);
    }
}

impl Drop for BrokerStream {
    fn drop(&mut self) {
        self.socket.set_onmessage(None);
        self.socket.set_onclose(None);
        // A socket that the broker has closed needs nothing.
        let _ = self.socket.close();
    }
}
