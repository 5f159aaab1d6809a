//! What was asked, and how counts become answers.

use std::ops::Range;

use wgpu::Limits;

use super::pack::{PackedCount, PackedProxy, PackedTile};
use crate::geom::{Proxy, View, Viewport};
use crate::query::{Answer, Ticket, Want};

/// Questions of one pass, in the order of asking.
#[derive(Debug, Default)]
pub(super) struct Questions {
    pub(super) asked: Vec<Asked>,
    /// What is counted.
    pub(super) proxies: Vec<PackedProxy>,
    pub(super) tiles: Vec<PackedTile>,
    /// How many pixels the rectangles of what is counted have together.
    pub(super) pixels: u64,
    /// What is drawn in native queries, and which of it each query draws.
    pub(super) drawn: Vec<PackedProxy>,
    pub(super) queries: Vec<Range<u32>>,
}

#[derive(Clone, Debug)]
pub(super) struct Asked {
    ticket: Ticket,
    by: By,
}

/// Where the answer to a question comes from.
#[derive(Clone, Debug)]
enum By {
    /// The count of a proxy.
    Dual(usize),
    /// Whether some count is not 0.
    AnyCount(Range<usize>),
    /// A native query.
    AnyQuery(usize),
    /// It cannot be answered: what was asked about is drawn.
    Nothing,
}

/// What packing a question needs to know.
#[derive(Clone, Copy, Debug)]
pub(super) struct Terms {
    pub(super) viewport: Viewport,
    samples: u32,
    /// Added to nearness; see `pack.rs`.
    slack: f32,
    /// Added to the nearness of what is asked about natively; None if nothing is.
    native_slack: Option<f32>,
    /// The most that buffers hold. What does not fit is drawn.
    pub(super) most_proxies: u64,
    pub(super) most_tiles: u64,
}

impl Terms {
    /// `native_slack` comes on top of `slack`, if there are native queries.
    pub(super) fn new(view: &View, slack: f32, native_slack: Option<f32>, limits: &Limits) -> Self {
        let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        Self {
            viewport: view.viewport(),
            samples: view.samples(),
            slack,
            native_slack: native_slack.map(|more| if more > 0.0 { (slack + more).next_up() } else { slack }),
            most_proxies: most / size_of::<PackedProxy>() as u64,
            most_tiles: most / size_of::<PackedTile>() as u64,
        }
    }

    /// Whether a proxy's samples can be counted in 32 bits: a count of 2³² would come out as 0. (It
    /// takes the longest sides and 16 samples a pixel.)
    fn counts_fit(&self, proxy: &PackedProxy) -> bool {
        proxy.pixels() * u64::from(self.samples) <= u64::from(u32::MAX)
    }
}

impl Questions {
    /// Adds a question.
    pub(super) fn ask(&mut self, ticket: Ticket, boxes: &[Proxy], want: Want, terms: &Terms) {
        let by = match (want, terms.native_slack) {
            (Want::Any, Some(slack)) => self.ask_natively(boxes, slack, terms).map(By::AnyQuery),
            (Want::Any, None) => self.count(boxes, want, terms).map(By::AnyCount),
            (Want::Dual, _) if boxes.len() == 1 => self.count(boxes, want, terms).map(|r| By::Dual(r.start)),
            (Want::Dual, _) => None,
        };
        self.asked.push(Asked { ticket, by: by.unwrap_or(By::Nothing) });
    }

    /// Adds boxes to what is counted; None if one of them cannot be.
    fn count(&mut self, boxes: &[Proxy], want: Want, terms: &Terms) -> Option<Range<usize>> {
        let pack = |proxy: &Proxy| {
            PackedProxy::new(proxy, terms.viewport, terms.slack, want == Want::Any)
                .filter(|packed| terms.counts_fit(packed))
        };
        let added = add(&mut self.proxies, boxes, pack, terms.most_proxies)?;
        let tiles: u64 = self.proxies[added.clone()].iter().map(PackedProxy::tile_count).sum();
        if self.tiles.len() as u64 + tiles > terms.most_tiles {
            self.proxies.truncate(added.start);
            return None;
        }
        for i in added.clone() {
            self.tiles.extend(self.proxies[i].tiles(i as u32));
            self.pixels += self.proxies[i].pixels();
        }
        Some(added)
    }

    /// Adds boxes to what is drawn, in a query of their own; None if one of them cannot be.
    fn ask_natively(&mut self, boxes: &[Proxy], slack: f32, terms: &Terms) -> Option<usize> {
        let pack = |proxy: &Proxy| PackedProxy::new(proxy, terms.viewport, slack, true);
        let added = add(&mut self.drawn, boxes, pack, terms.most_proxies)?;
        self.queries.push(added.start as u32..added.end as u32);
        Some(self.queries.len() - 1)
    }

    /// Hands out the answers; all unknown if the results were lost. `results` has the counts of all
    /// proxies, and the words of all queries' results after them.
    pub(super) fn deliver(
        &self,
        results: Option<&[PackedCount]>,
        deliver: &mut impl FnMut(Ticket, Answer<'_>),
    ) {
        for asked in &self.asked {
            deliver(asked.ticket, self.answer(&asked.by, results).unwrap_or(Answer::Unknown));
        }
    }

    fn answer(&self, by: &By, results: Option<&[PackedCount]>) -> Option<Answer<'static>> {
        let (counts, queries) = results?.split_at_checked(self.proxies.len())?;
        Some(match by {
            By::Dual(i) => {
                let PackedCount { visible, total } = *counts.get(*i)?;
                Answer::Dual { visible, total }
            }
            By::AnyCount(range) => Answer::Any(counts.get(range.clone())?.iter().any(|c| c.visible > 0)),
            By::AnyQuery(i) => queries.get(*i).map(|&words| Answer::Any(words != PackedCount::default()))?,
            By::Nothing => Answer::Unknown,
        })
    }

    pub(super) fn clear(&mut self) {
        self.asked.clear();
        self.proxies.clear();
        self.tiles.clear();
        self.pixels = 0;
        self.drawn.clear();
        self.queries.clear();
    }
}

/// Adds all boxes, packed; None, and no change, if one of them cannot be packed or they do not fit.
fn add(
    to: &mut Vec<PackedProxy>,
    boxes: &[Proxy],
    pack: impl Fn(&Proxy) -> Option<PackedProxy>,
    most: u64,
) -> Option<Range<usize>> {
    let first = to.len();
    to.extend(boxes.iter().map_while(pack));
    let all = to.len() - first == boxes.len() && to.len() as u64 <= most;
    if !all {
        to.truncate(first);
        return None;
    }
    Some(first..to.len())
}

#[cfg(test)]
mod tests {
    use glam::Mat4;

    use super::*;
    use crate::geom::{DepthDirection, DepthFormat, PixelRect, projection};

    fn terms(side: u32, samples: u32, native_slack: Option<f32>) -> Terms {
        let clip_from_view = projection::perspective(1.0, 1.0, 0.1);
        let view = View::new(Mat4::IDENTITY, clip_from_view, Viewport::new(side, side)).expect("a view");
        let view = view.with_target(DepthDirection::Reversed, DepthFormat::Depth32Float, samples);
        Terms::new(&view, 0.0, native_slack, &Limits::default())
    }

    fn flat(side: u32) -> Proxy {
        let rect = PixelRect { x0: 0, y0: 0, x1: side, y1: side };
        Proxy { rect, edges: [[0.0; 3]; 6], planes: [[0.0, 0.0, f32::MAX]; 3], nearest: 0.5 }
    }

    fn answers(questions: &Questions, counts: Option<&[PackedCount]>) -> Vec<String> {
        let mut all = Vec::new();
        questions.deliver(counts, &mut |ticket, answer| all.push(format!("{} {answer:?}", ticket.0)));
        all
    }

    #[test]
    fn each_question_gets_its_own_counts() {
        let terms = terms(256, 1, None);
        let mut questions = Questions::default();
        questions.ask(Ticket(1), &[flat(1)], Want::Dual, &terms);
        questions.ask(Ticket(2), &[flat(1), flat(65)], Want::Any, &terms);
        questions.ask(Ticket(3), &[flat(1), flat(1)], Want::Dual, &terms);
        questions.ask(Ticket(4), &[], Want::Dual, &terms);
        questions.ask(Ticket(5), &[flat(1)], Want::Any, &terms);
        let broken = Proxy { nearest: f32::NAN, ..flat(1) };
        questions.ask(Ticket(6), &[flat(1), broken], Want::Any, &terms);
        assert_eq!((questions.proxies.len(), questions.tiles.len()), (4, 7));
        let count = |visible, total| PackedCount { visible, total };
        let counts = [count(1, 2), count(0, 0), count(3, 0), count(0, 0)];
        let want = [
            "1 Dual { visible: 1, total: 2 }",
            "2 Any(true)",
            "3 Unknown",
            "4 Unknown",
            "5 Any(false)",
            "6 Unknown",
        ];
        assert_eq!(answers(&questions, Some(&counts)), want);
        assert!(answers(&questions, None).iter().all(|answer| answer.ends_with("Unknown")));
        assert!(answers(&questions, Some(&[])).iter().all(|answer| answer.ends_with("Unknown")));
    }

    #[test]
    fn what_does_not_fit_is_not_asked() {
        let mut terms = terms(256, 1, None);
        terms.most_tiles = 8;
        let mut questions = Questions::default();
        questions.ask(Ticket(1), &[flat(128)], Want::Dual, &terms);
        questions.ask(Ticket(2), &[flat(129)], Want::Dual, &terms);
        questions.ask(Ticket(3), &[flat(128)], Want::Dual, &terms);
        assert_eq!((questions.proxies.len(), questions.tiles.len()), (2, 8));
        terms.most_proxies = 2;
        questions.ask(Ticket(4), &[flat(1)], Want::Any, &terms);
        assert_eq!(questions.proxies.len(), 2);
        let count = PackedCount { visible: 0, total: 9 };
        let found = answers(&questions, Some(&[count, count]));
        assert!(found[1].ends_with("Unknown") && found[3].ends_with("Unknown"), "{found:?}");
        assert!(found[0].ends_with("total: 9 }") && found[2].ends_with("total: 9 }"), "{found:?}");
    }

    #[test]
    fn native_queries_are_about_any_alone() {
        let terms = terms(256, 1, Some(0.25));
        let mut questions = Questions::default();
        questions.ask(Ticket(1), &[flat(1), flat(2)], Want::Any, &terms);
        questions.ask(Ticket(2), &[flat(1)], Want::Dual, &terms);
        questions.ask(Ticket(3), &[Proxy { nearest: f32::NAN, ..flat(1) }], Want::Any, &terms);
        questions.ask(Ticket(4), &[flat(1)], Want::Any, &terms);
        questions.ask(Ticket(5), &[flat(1)], Want::Any, &terms);
        assert_eq!((questions.proxies.len(), &questions.queries[..]), (1, &[0..2, 2..3, 3..4][..]));
        assert!(questions.drawn.iter().all(|proxy| proxy.nearest >= 0.75), "they are raised");
        assert!(questions.proxies.iter().all(|proxy| proxy.nearest == 0.5), "those counted are not");
        // A result has 64 bits: each half counts.
        let words = |visible, total| PackedCount { visible, total };
        let results = [words(3, 4), words(1, 0), words(0, 0), words(0, 1)];
        let want =
            ["1 Any(true)", "2 Dual { visible: 3, total: 4 }", "3 Unknown", "4 Any(false)", "5 Any(true)"];
        assert_eq!(answers(&questions, Some(&results)), want);
        assert!(answers(&questions, Some(&results[..3]))[4].ends_with("Unknown"));
        questions.clear();
        assert!(questions.drawn.is_empty() && questions.queries.is_empty());
    }

    #[test]
    fn what_32_bits_cannot_count_is_not_asked() {
        let side = Viewport::MAX_SIDE;
        let all = flat(side);
        let row_less = Proxy { rect: PixelRect { y1: side - 1, ..all.rect }, ..all };
        for (samples, proxy, fits) in [(16, &all, false), (16, &row_less, true), (8, &all, true)] {
            let mut terms = terms(side, samples, None);
            terms.most_tiles = u64::MAX;
            for want in [Want::Dual, Want::Any] {
                let mut questions = Questions::default();
                questions.ask(Ticket(1), &[*proxy], want, &terms);
                assert_eq!(questions.proxies.len(), usize::from(fits), "{samples} samples, {want:?}");
                let most = PackedCount { visible: u32::MAX, total: u32::MAX };
                assert_eq!(answers(&questions, Some(&[most]))[0].ends_with("Unknown"), !fits);
            }
        }
    }
}
