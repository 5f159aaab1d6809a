//! Waves of questions: what may be asked together, and what is held back for a later wave (see
//! [`order`](super::order)).

use std::collections::VecDeque;

use super::front::Front;
use super::order::TileRect;
use super::{Action, Extent, ScreenTiles, Ticket};
use crate::geom::{Proxy, Viewport};
use crate::query::{Wait, Want};
use crate::tree::NodeId;

/// A node with its question, until the question may be asked. Small, since those that are held
/// back are looked at again in each wave.
#[derive(Clone, Copy, Debug)]
pub(super) struct Waiting {
    pub(super) front: Front,
    /// The number of its proxy.
    pub(super) proxy: u32,
    tiles: TileRect,
    /// Whether others need not wait for it.
    expected_hidden: bool,
}

/// The questions of a frame, wave by wave, and the draws between them.
#[derive(Clone, Debug)]
pub(super) struct Waves {
    tiles: ScreenTiles,
    /// What is asked in this wave; a ticket is an index.
    asked: Vec<Waiting>,
    /// Questions held back in the last wave, nearest first, and how many have had their turn.
    held: Vec<Waiting>,
    turns: usize,
    /// Those held back in this one.
    held_again: Vec<Waiting>,
    /// Proxies of the frame, so that a node held back is not projected again.
    proxies: Vec<Proxy>,
    /// Actions decided on, in order.
    out: VecDeque<Step>,
}

#[derive(Clone, Copy, Debug)]
enum Step {
    Draw(NodeId, Extent),
    Ask(usize),
    Wait,
}

impl Default for Waves {
    fn default() -> Self {
        Self {
            tiles: ScreenTiles::new(Viewport::new(1, 1)),
            asked: Vec::new(),
            held: Vec::new(),
            turns: 0,
            held_again: Vec::new(),
            proxies: Vec::new(),
            out: VecDeque::new(),
        }
    }
}

impl Waves {
    /// Starts a frame.
    pub(super) fn begin(&mut self, viewport: Viewport) {
        self.tiles = ScreenTiles::new(viewport);
        self.proxies.clear();
        self.out.clear();
        self.held_again.clear();
        self.start();
    }

    /// Starts a wave: those that were held back have their turn, nearest first.
    pub(super) fn start(&mut self) {
        self.asked.clear();
        self.tiles.clear();
        self.held.clear();
        self.turns = 0;
        std::mem::swap(&mut self.held, &mut self.held_again);
    }

    /// A question about a node.
    pub(super) fn question(&mut self, front: Front, proxy: Proxy, expected_hidden: bool) -> Waiting {
        let (number, tiles) = (self.proxies.len() as u32, self.tiles.of(proxy.rect));
        self.proxies.push(proxy);
        Waiting { front, proxy: number, tiles, expected_hidden }
    }

    /// The next of those that were held back, unless what is new is nearer.
    pub(super) fn next_held(&mut self, new: Option<&Front>) -> Option<Waiting> {
        let next = self.held.get(self.turns)?;
        if new.is_some_and(|new| next.front < *new) {
            return None;
        }
        self.turns += 1;
        Some(*next)
    }

    /// Asks in this wave, or holds back where the question must wait for a nearer one. Farther ones
    /// may have to wait for it: its tiles are covered from now on, whether it waits or not.
    pub(super) fn add(&mut self, question: Waiting, may_wait: bool) {
        let Waiting { tiles, expected_hidden, .. } = question;
        let meets = if expected_hidden { self.tiles.meets(tiles) } else { self.tiles.cover(tiles) };
        if meets && may_wait {
            self.held_again.push(question);
        } else {
            self.asked.push(question);
        }
    }

    /// Asks in this wave, whatever it meets.
    pub(super) fn ask(&mut self, question: Waiting) {
        self.asked.push(question);
    }

    /// Draws after what has been decided on so far.
    pub(super) fn draw(&mut self, node: NodeId, extent: Extent) {
        self.out.push_back(Step::Draw(node, extent));
    }

    /// Ends a wave. Its questions go out after all draws: one flush a wave, and the most is in the
    /// depth buffer when it asks.
    pub(super) fn close(&mut self) {
        if !self.asked.is_empty() {
            self.out.extend((0..self.asked.len()).map(Step::Ask));
            self.out.push_back(Step::Wait);
        }
    }

    /// Whether everything decided on was handed out.
    pub(super) fn is_idle(&self) -> bool {
        self.out.is_empty()
    }

    /// The next action decided on; done if there is none.
    pub(super) fn action(&mut self) -> Action<'_> {
        match self.out.pop_front() {
            Some(Step::Draw(node, extent)) => Action::Draw(node, extent),
            Some(Step::Ask(i)) => {
                let proxy = &self.proxies[self.asked[i].proxy as usize];
                Action::Ask { ticket: Ticket(i as u32), boxes: std::slice::from_ref(proxy), want: Want::Dual }
            }
            Some(Step::Wait) => Action::Wait(Wait::Block),
            None => Action::Done,
        }
    }

    /// The node that a question of this wave is about.
    pub(super) fn node(&self, index: usize) -> Option<Front> {
        self.asked.get(index).map(|question| question.front)
    }
}
