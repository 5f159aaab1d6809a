//! The hierarchy-updating family: hand-worked traces of each rule and each trap, and what they save.

mod savings;
mod script;
mod traces;
