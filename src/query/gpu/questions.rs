//! What was asked, and how counts become answers.

use std::ops::Range;

use wgpu::Limits;

use super::pack::{PackedCount, PackedProxy, PackedTile};
use crate::geom::{Proxy, Viewport};
use crate::query::{Answer, Ticket, Want};

/// Questions of one pass, in the order of asking.
#[derive(Debug, Default)]
pub(super) struct Questions {
    pub(super) asked: Vec<Asked>,
    pub(super) proxies: Vec<PackedProxy>,
    pub(super) tiles: Vec<PackedTile>,
    /// How many pixels the rectangles have together.
    pub(super) pixels: u64,
}

#[derive(Clone, Debug)]
pub(super) struct Asked {
    ticket: Ticket,
    want: Want,
    proxies: Range<usize>,
    /// Whether it can be answered at all; if not, the answer is "visible".
    usable: bool,
}

/// What packing a question needs to know.
#[derive(Clone, Copy, Debug)]
pub(super) struct Terms {
    pub(super) viewport: Viewport,
    /// Added to nearness; see `pack.rs`.
    pub(super) slack: f32,
    /// The most that buffers hold. What does not fit is drawn.
    pub(super) most_proxies: u64,
    pub(super) most_tiles: u64,
}

impl Terms {
    pub(super) fn new(viewport: Viewport, slack: f32, limits: &Limits) -> Self {
        let most = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        Self {
            viewport,
            slack,
            most_proxies: most / size_of::<PackedProxy>() as u64,
            most_tiles: most / size_of::<PackedTile>() as u64,
        }
    }
}

impl Questions {
    /// Adds a question.
    pub(super) fn ask(&mut self, ticket: Ticket, boxes: &[Proxy], want: Want, terms: &Terms) {
        let first = self.proxies.len();
        let any = want == Want::Any;
        let pack = |proxy| PackedProxy::new(proxy, terms.viewport, terms.slack, any);
        self.proxies.extend(boxes.iter().map_while(pack));
        let all_packed = self.proxies.len() - first == boxes.len();
        let tiles: u64 = self.proxies[first..].iter().map(PackedProxy::tile_count).sum();
        let fits = self.proxies.len() as u64 <= terms.most_proxies
            && self.tiles.len() as u64 + tiles <= terms.most_tiles;
        let usable = all_packed && fits && (any || boxes.len() == 1);
        if !usable {
            self.proxies.truncate(first);
        }
        for i in first..self.proxies.len() {
            self.tiles.extend(self.proxies[i].tiles(i as u32));
            self.pixels += self.proxies[i].pixels();
        }
        self.asked.push(Asked { ticket, want, proxies: first..self.proxies.len(), usable });
    }

    /// Hands out the answers; all unknown if the counts were lost.
    pub(super) fn deliver(
        &self,
        counts: Option<&[PackedCount]>,
        deliver: &mut impl FnMut(Ticket, Answer<'_>),
    ) {
        for asked in &self.asked {
            let counts = counts.filter(|_| asked.usable).and_then(|all| all.get(asked.proxies.clone()));
            let answer = match (asked.want, counts) {
                (Want::Any, Some(counts)) => Answer::Any(counts.iter().any(|c| c.visible > 0)),
                (Want::Dual, Some([c])) => Answer::Dual { visible: c.visible, total: c.total },
                _ => Answer::Unknown,
            };
            deliver(asked.ticket, answer);
        }
    }

    pub(super) fn clear(&mut self) {
        self.asked.clear();
        self.proxies.clear();
        self.tiles.clear();
        self.pixels = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::PixelRect;

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
        let terms = Terms::new(Viewport::new(256, 256), 0.0, &Limits::default());
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
        let mut terms = Terms::new(Viewport::new(256, 256), 0.0, &Limits::default());
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
}
