//! Waves of questions: what may be asked together, and what is held back for a later wave (see
//! [`order`](super::order)).

use super::ScreenTiles;
use super::front::Front;
use super::order::TileRect;
use crate::geom::{Proxy, Viewport};

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

/// The questions of a frame, wave by wave.
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
        }
    }
}

impl Waves {
    /// Starts a frame.
    pub(super) fn begin(&mut self, viewport: Viewport) {
        self.tiles = ScreenTiles::new(viewport);
        self.proxies.clear();
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

    /// How many questions are asked in this wave.
    pub(super) fn len(&self) -> usize {
        self.asked.len()
    }

    /// The node that a question of this wave is about.
    pub(super) fn node(&self, index: usize) -> Option<Front> {
        self.asked.get(index).map(|question| question.front)
    }

    /// What a question of this wave asks about.
    pub(super) fn proxy(&self, index: usize) -> &Proxy {
        &self.proxies[self.asked[index].proxy as usize]
    }
}
