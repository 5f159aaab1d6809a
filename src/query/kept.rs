//! Answers that outlive their delivery.

use super::{Answer, Ticket};
use crate::scene::ObjectSet;

/// An answer, to be delivered later.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "record", derive(serde::Serialize, serde::Deserialize))]
pub enum KeptAnswer {
    /// See [`Answer::Any`].
    Any(bool),
    /// See [`Answer::Dual`]: visible, total.
    Dual(u32, u32),
    /// See [`Answer::Swept`].
    Swept(ObjectSet),
    /// See [`Answer::Unknown`].
    Unknown,
}

impl KeptAnswer {
    /// Delivers the answer.
    pub fn deliver(&self, ticket: Ticket, deliver: &mut impl FnMut(Ticket, Answer<'_>)) {
        let answer = match self {
            &Self::Any(visible) => Answer::Any(visible),
            &Self::Dual(visible, total) => Answer::Dual { visible, total },
            Self::Swept(found) => Answer::Swept(found),
            Self::Unknown => Answer::Unknown,
        };
        deliver(ticket, answer);
    }
}

impl From<Answer<'_>> for KeptAnswer {
    fn from(answer: Answer<'_>) -> Self {
        match answer {
            Answer::Any(visible) => Self::Any(visible),
            Answer::Dual { visible, total } => Self::Dual(visible, total),
            Answer::Swept(found) => Self::Swept(found.clone()),
            Answer::Unknown => Self::Unknown,
        }
    }
}
