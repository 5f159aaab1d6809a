//! How long the device takes for passes, by timestamps that it writes itself.
//!
//! The timestamps of a frame are read back with the first commands of the next one, so that they
//! cost no submission of their own, and nothing ever waits for them.

use std::time::Duration;

use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, ComputePass, ComputePassDescriptor,
    ComputePassTimestampWrites, Device, Features, QuerySet, QuerySetDescriptor, QueryType, Queue, RenderPass,
    RenderPassDescriptor, RenderPassTimestampWrites,
};

use super::read_back::{ReadBack, State};

/// What a pass is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// The app draws.
    Draw,
    /// Questions are answered.
    Question,
}

/// What the passes of a frame took.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(super) struct Times {
    pub(super) draw: Duration,
    /// The part of `draw` that came before the last question: what an answer had to wait for.
    pub(super) awaited_draw: Duration,
    pub(super) question: Duration,
}

/// Commands are recorded through this, so that every pass is timed.
pub(super) struct Tape<'a> {
    pub(super) device: &'a Device,
    pub(super) encoder: &'a mut CommandEncoder,
    pub(super) clock: Option<&'a mut Clock>,
}

impl Tape<'_> {
    pub(super) fn render_pass(&mut self, purpose: Purpose, what: RenderPassDescriptor<'_>) -> RenderPass<'_> {
        let pair = self.clock.as_mut().and_then(|clock| clock.pair(purpose));
        let timestamp_writes = pair.map(|(query_set, [begin, end])| RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(end),
        });
        self.encoder.begin_render_pass(&RenderPassDescriptor { timestamp_writes, ..what })
    }

    /// A compute pass that answers questions.
    pub(super) fn compute_pass(&mut self, label: &str) -> ComputePass<'_> {
        let pair = self.clock.as_mut().and_then(|clock| clock.pair(Purpose::Question));
        let timestamp_writes = pair.map(|(query_set, [begin, end])| ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(end),
        });
        self.encoder.begin_compute_pass(&ComputePassDescriptor { label: Some(label), timestamp_writes })
    }
}

/// Passes of a frame that are timed; a frame with more is not.
const MOST_PASSES: usize = 1024;

/// Frames whose timestamps may be on their way at once. If more are, some are not timed.
const MOST_FRAMES: usize = 4;

/// Frames whose times are kept: views that share a backend have one in so many.
const KEPT: usize = 16;

/// The timestamps of passes.
#[derive(Debug)]
pub(super) struct Clock {
    set: QuerySet,
    resolved: Buffer,
    /// Nanoseconds a tick.
    period: f64,
    /// What the passes of this frame are for, in the order of their pairs of timestamps.
    passes: Vec<Purpose>,
    /// How many of them the device has; None if some will never be submitted.
    submitted: Option<usize>,
    /// The passes of the last frame, until they are read back.
    finished: Vec<Purpose>,
    frames: [TimedFrame; MOST_FRAMES],
    /// How many frames there were.
    count: u64,
    /// The last frame that could not be timed; 0 for none.
    untimed: u64,
    /// Of the last frame whose timestamps have arrived, unless one that is not timed came later.
    times: Option<Times>,
    /// By frame, modulo their number: which one, and its times.
    told: [(u64, Times); KEPT],
}

/// Timestamps on their way.
#[derive(Debug)]
struct TimedFrame {
    /// Which of the frames, from 1 on.
    number: u64,
    passes: Vec<Purpose>,
    ticks: ReadBack,
}

impl Clock {
    /// None if the device writes no timestamps.
    pub(super) fn new(device: &Device, queue: &Queue) -> Option<Self> {
        if !device.features().contains(Features::TIMESTAMP_QUERY) {
            return None;
        }
        let set = device.create_query_set(&QuerySetDescriptor {
            label: Some("tercet timestamps"),
            ty: QueryType::Timestamp,
            count: 2 * MOST_PASSES as u32,
        });
        let resolved = device.create_buffer(&BufferDescriptor {
            label: Some("tercet timestamps"),
            size: bytes(MOST_PASSES),
            usage: BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        Some(Self {
            set,
            resolved,
            period: queue.get_timestamp_period().into(),
            passes: Vec::new(),
            submitted: Some(0),
            finished: Vec::new(),
            frames: std::array::from_fn(|_| TimedFrame {
                number: 0,
                passes: Vec::new(),
                ticks: ReadBack::new(device, bytes(MOST_PASSES)),
            }),
            count: 0,
            untimed: 0,
            times: None,
            told: Default::default(),
        })
    }

    /// Of the last frame whose timestamps had arrived when this one began; None if a later one
    /// could not be timed.
    pub(super) fn times(&self) -> Option<Times> {
        self.times
    }

    /// Which frame has begun, from 1 on.
    pub(super) fn now(&self) -> u64 {
        self.count
    }

    /// Of one of the last frames, if its timestamps had arrived when this one began.
    pub(super) fn times_of(&self, frame: u64) -> Option<Times> {
        let (of, times) = self.told[frame as usize % KEPT];
        (of == frame && frame > 0).then_some(times)
    }

    /// Looks what has arrived, and starts anew.
    pub(super) fn begin_frame(&mut self) {
        self.frames.sort_unstable_by_key(|frame| frame.number);
        for frame in &self.frames {
            let times = frame.ticks.read(|bytes| times(&frame.passes, bytes, self.period));
            if let Some(times) = times {
                self.told[frame.number as usize % KEPT] = (frame.number, times);
            }
            self.times = times.filter(|_| frame.number > self.untimed).or(self.times);
            // What was recorded and not submitted never will be.
            frame.ticks.reclaim();
        }
        self.finished.clear();
        // A timestamp that was never written must not be waited for.
        if self.submitted == Some(self.passes.len()) && self.passes.len() <= MOST_PASSES {
            std::mem::swap(&mut self.finished, &mut self.passes);
        } else {
            // Times of other frames would say nothing about this one: it had more passes, or failed.
            (self.untimed, self.times) = (self.count, None);
        }
        self.count += 1;
        self.passes.clear();
        self.submitted = Some(0);
    }

    /// Records the way of the last frame's timestamps into memory that can be read; to be called
    /// before any pass of this frame is recorded.
    pub(super) fn read_back(&mut self, device: &Device, encoder: &mut CommandEncoder) {
        let passes = std::mem::take(&mut self.finished);
        let free = self.frames.iter_mut().find(|frame| frame.ticks.state() == State::Free);
        let Some(frame) = free.filter(|_| !passes.is_empty()) else { return };
        (frame.number, frame.passes) = (self.count - 1, passes);
        let bytes = bytes(frame.passes.len());
        frame.ticks.claim(device, bytes);
        encoder.resolve_query_set(&self.set, 0..2 * frame.passes.len() as u32, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, frame.ticks.buffer(), 0, bytes);
    }

    /// To be called when everything that was recorded has been submitted.
    pub(super) fn submitted(&mut self) {
        self.submitted = self.submitted.map(|_| self.passes.len());
        let recorded = self.frames.iter().filter(|frame| frame.ticks.state() == State::Recorded);
        recorded.for_each(|frame| frame.ticks.await_bytes());
    }

    /// To be called when what was recorded will never be submitted.
    pub(super) fn dropped(&mut self) {
        self.submitted = None;
        for frame in self.frames.iter().filter(|frame| frame.ticks.state() == State::Recorded) {
            frame.ticks.reclaim();
        }
    }

    /// The places of a pass's timestamps.
    fn pair(&mut self, purpose: Purpose) -> Option<(&QuerySet, [u32; 2])> {
        let first = 2 * self.passes.len() as u32;
        self.passes.push(purpose);
        (self.passes.len() <= MOST_PASSES).then_some((&self.set, [first, first + 1]))
    }
}

/// The bytes of the timestamps of some passes.
fn bytes(passes: usize) -> u64 {
    (16 * passes) as u64
}

/// Adds up what passes took, from ticks before and after each.
fn times(passes: &[Purpose], bytes: &[u8], period: f64) -> Times {
    let mut times = Times::default();
    let asked_last = passes.iter().rposition(|&purpose| purpose == Purpose::Question);
    let tick = |bytes: &[u8; 8]| u64::from_le_bytes(*bytes);
    for (i, (purpose, pair)) in passes.iter().zip(bytes.as_chunks::<8>().0.chunks_exact(2)).enumerate() {
        // A device that changes its clock may report an end before the beginning.
        let ticks = tick(&pair[1]).saturating_sub(tick(&pair[0]));
        let took = Duration::from_nanos((ticks as f64 * period) as u64);
        match purpose {
            Purpose::Draw => {
                times.draw += took;
                if asked_last > Some(i) {
                    times.awaited_draw += took;
                }
            }
            Purpose::Question => times.question += took,
        }
    }
    times
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_add_up_by_purpose() {
        let ticks: [u64; 8] = [10, 40, 100, 150, 200, 190, 300, 310];
        let bytes: Vec<u8> = ticks.iter().flat_map(|tick| tick.to_le_bytes()).collect();
        let of = |passes: [Purpose; 4]| {
            let Times { draw, awaited_draw, question } = times(&passes, &bytes, 2.5);
            [draw, awaited_draw, question].map(|time| time.as_nanos())
        };
        use Purpose::{Draw, Question};
        assert_eq!(of([Question, Draw, Question, Draw]), [150, 125, 75]);
        assert_eq!(of([Draw, Draw, Draw, Question]), [200, 200, 25]);
        assert_eq!(of([Question, Draw, Draw, Draw]), [150, 0, 75]);
        assert_eq!(of([Draw; 4]), [225, 0, 0]);
    }
}
