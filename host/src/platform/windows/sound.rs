//! Sound: samples go through a queue to the default output device of Windows.

use std::sync::Arc;

use cpal::traits::{DeviceTrait, HostTrait, StreamTrait};
use cpal::{FromSample, SampleFormat, SizedSample, StreamConfig};
use crossbeam::queue::ArrayQueue;
use gsk_messages::{Message, say};

/// Capacity of the queue between program and sound device, samples.
const QUEUE: usize = 16_384;

/// Returns true: Windows can play sound if the computer has an output device.
pub const fn has_sound() -> bool {
    true
}

/// An open sound output device.
pub struct Player {
    waiting: Arc<ArrayQueue<i16>>,
    /// The output stream; it plays until this value is dropped.
    _stream: cpal::Stream,
}

impl Player {
    /// Opens the default output device at this sample rate, Hz.
    ///
    /// # Errors
    /// There is no device, or it does not open.
    pub fn open(rate: u32) -> Result<Self, Message> {
        let device = cpal::default_host()
            .default_output_device()
            .ok_or_else(say::sound_no_device)?;
        let config = device
            .default_output_config()
            .map_err(|why| say::sound_failed(why.to_string()))?;
        let format = config.sample_format();
        let config = StreamConfig::from(config);
        let waiting = Arc::new(ArrayQueue::new(QUEUE));
        let from = Arc::clone(&waiting);
        let stream = match format {
            SampleFormat::F32 => stream::<f32>(&device, config, from, rate),
            SampleFormat::I32 => stream::<i32>(&device, config, from, rate),
            _ => stream::<i16>(&device, config, from, rate),
        };
        let stream = stream.map_err(|why| say::sound_failed(why.to_string()))?;
        stream
            .play()
            .map_err(|why| say::sound_failed(why.to_string()))?;
        Ok(Self {
            waiting,
            _stream: stream,
        })
    }

    /// Plays samples; the queue drops the oldest when it is full.
    ///
    /// # Errors
    /// Never: a device that has gone leaves silence.
    pub fn play(&mut self, samples: &[i16]) -> Result<(), Message> {
        for sample in samples {
            // The oldest samples go: late sound is of no use.
            self.waiting.force_push(*sample);
        }
        Ok(())
    }
}

/// Opens a stream that plays the samples of `waiting`, recorded at `rate` Hz, at the rate and on
/// all channels of the device. Returns an error if the device refuses it.
fn stream<T: SizedSample + FromSample<i16>>(
    device: &cpal::Device,
    config: StreamConfig,
    waiting: Arc<ArrayQueue<i16>>,
    rate: u32,
) -> Result<cpal::Stream, cpal::Error> {
    let channels = usize::from(config.channels).max(1);
    let step = f64::from(rate) / f64::from(config.sample_rate);
    let (mut passed, mut sample) = (0.0, 0_i16);
    let fill = move |output: &mut [T], _: &cpal::OutputCallbackInfo| {
        for frame in output.chunks_mut(channels) {
            passed += step;
            while passed >= 1.0 {
                passed -= 1.0;
                sample = waiting.pop().unwrap_or(0);
            }
            frame.fill(T::from_sample(sample));
        }
    };
    // A device that goes leaves silence; the next start finds another one.
    device.build_output_stream(config, fill, |_| {}, None)
}
