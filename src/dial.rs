//! Dials: settings reached by name, for `--set KEY=VALUE` and for a window's controls.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

use crate::Error;

/// One setting of a policy or of the tree, as text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dial {
    /// The name that `set` takes.
    pub key: &'static str,
    /// The present value.
    pub value: String,
    /// What it does, and which values it takes.
    pub about: String,
    /// What kind of value it takes: which control fits it.
    pub kind: DialKind,
}

/// What kind of value a [`Dial`] takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DialKind {
    /// true or false.
    Switch,
    /// A whole number.
    Whole,
    /// A number.
    Real,
    /// One of these.
    Choice(Vec<&'static str>),
    /// Whatever the description says.
    Text,
}

/// A type whose values a dial shows as they are.
pub(crate) trait Plain: Display {
    /// What a dial of this type takes.
    const KIND: DialKind;
}

impl Plain for bool {
    const KIND: DialKind = DialKind::Switch;
}

impl Plain for u32 {
    const KIND: DialKind = DialKind::Whole;
}

impl Plain for f32 {
    const KIND: DialKind = DialKind::Real;
}

impl Plain for String {
    const KIND: DialKind = DialKind::Text;
}

impl Dial {
    pub(crate) fn new<T: Plain>(key: &'static str, value: T, about: &str) -> Self {
        Self { key, value: value.to_string(), about: about.to_owned(), kind: T::KIND }
    }

    /// A dial that takes one of a few named values.
    pub(crate) fn choice<T: PartialEq>(
        key: &'static str,
        value: T,
        names: &[(&'static str, T)],
        about: &str,
    ) -> Self {
        let current = choice_name(value, names);
        let kind = DialKind::Choice(names.iter().map(|(name, _)| *name).collect());
        Self { key, value: current.to_owned(), about: format!("{about}: {}", join(names)), kind }
    }
}

/// The name of one of a few named values.
pub(crate) fn choice_name<T: PartialEq>(value: T, names: &[(&'static str, T)]) -> &'static str {
    names.iter().find(|(_, v)| *v == value).map_or("", |(name, _)| *name)
}

/// Reads a value within a range.
pub(crate) fn number<T>(key: &str, value: &str, range: RangeInclusive<T>) -> Result<T, Error>
where
    T: FromStr + PartialOrd + Display,
{
    let fail = || Error::Dial {
        key: key.to_owned(),
        value: value.to_owned(),
        why: format!("it takes {} to {}", range.start(), range.end()),
    };
    let parsed = value.trim().parse().map_err(|_| fail())?;
    if range.contains(&parsed) { Ok(parsed) } else { Err(fail()) }
}

/// Reads true or false.
pub(crate) fn switch(key: &str, value: &str) -> Result<bool, Error> {
    choice(key, value, &[("true", true), ("false", false)])
}

/// Reads one of a few named values.
pub(crate) fn choice<T: Clone>(key: &str, value: &str, names: &[(&'static str, T)]) -> Result<T, Error> {
    names.iter().find(|(name, _)| *name == value.trim()).map(|(_, v)| v.clone()).ok_or_else(|| Error::Dial {
        key: key.to_owned(),
        value: value.to_owned(),
        why: format!("it takes one of: {}", join(names)),
    })
}

/// The error for a dial that is not there.
pub(crate) fn unknown(key: &str, value: &str, dials: &[Dial]) -> Error {
    let names: Vec<_> = dials.iter().map(|d| d.key).collect();
    let why = if names.is_empty() {
        "there are no dials here".to_owned()
    } else {
        format!("there is no such dial; there are: {}", names.join(", "))
    };
    Error::Dial { key: key.to_owned(), value: value.to_owned(), why }
}

fn join<T>(names: &[(&'static str, T)]) -> String {
    names.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}
