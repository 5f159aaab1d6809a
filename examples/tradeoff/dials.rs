//! Which dials are turned, through which values, and what a combination of them is called.

use anyhow::Context;
use tercet::policy::Policy;
use tercet::{Dial, Tradeoff};

/// A dial of the table: its name, and its values in the order of the plots. The base's own need not be
/// among them. After a value, others' may follow: `2 swept=true`.
type Row = (&'static str, &'static [&'static str]);

const TABLE: &[Row] = &[
    ("visible_pixels", &["1", "4", "16", "64", "256", "1024"]),
    ("resolution_divisor", &["2", "4", "8"]),
    ("latency", &["1", "2", "4", "1 swept=true", "2 swept=true", "4 swept=true"]),
    ("query_budget", &["500", "200", "50"]),
    ("pixel_budget", &["10000000", "3000000", "1000000"]),
    ("ms_budget", &["8", "4", "2"]),
    ("n_av", &["1", "5", "10", "20"]),
    ("p_skip", &["0.25", "0.5", "0.75", "0.9"]),
    ("tight_boxes", &["never", "settled", "always"]),
    ("max_error_px", &["2", "4", "8"]),
];

/// A dial that is turned.
pub struct Sweep {
    /// Its name.
    pub key: &'static str,
    /// The dials that each of its values sets, the base's own value first.
    values: Vec<Vec<(String, String)>>,
}

/// The dials that are turned, around a base. A point is an index for each: 0 is the base's value.
pub struct Space {
    base: Tradeoff,
    /// The dials.
    pub sweeps: Vec<Sweep>,
}

/// A combination of dials.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// All of them.
    pub tradeoff: Tradeoff,
    /// Those that differ from the exact ones, in one order whatever they were set in: equal settings have
    /// equal names.
    pub name: String,
}

/// The names of all dials that can be turned.
pub fn names() -> impl Iterator<Item = &'static str> {
    TABLE.iter().map(|(key, _)| *key)
}

/// Those of them that a policy may have a use for: two are dials of some policies, and a policy that has
/// none of that name does the same at each value.
pub fn names_for(policy: &dyn Policy) -> Vec<&'static str> {
    let own = policy.dials();
    let has_use = |key: &&str| !["n_av", "p_skip"].contains(key) || own.iter().any(|dial| dial.key == *key);
    names().filter(has_use).collect()
}

impl Setting {
    /// A setting by its dials.
    pub fn new(tradeoff: Tradeoff) -> Self {
        let exact = Tradeoff::EXACT.dials();
        let differs = |dial: &Dial| !exact.contains(dial);
        let dials = tradeoff.dials().into_iter().filter(differs);
        let words: Vec<String> = dials.map(|dial| format!("{}={}", dial.key, dial.value)).collect();
        Self { tradeoff, name: if words.is_empty() { "exact".to_owned() } else { words.join(" ") } }
    }

    /// How many dials differ from the exact ones.
    pub fn turned(&self) -> usize {
        self.name.matches('=').count()
    }
}

impl Space {
    /// The dials of these names, around a base.
    ///
    /// # Errors
    /// When a dial does not take a value of the table.
    pub fn new(base: Tradeoff, keys: &[&'static str]) -> anyhow::Result<Self> {
        let rows = TABLE.iter().filter(|(key, _)| keys.contains(key));
        let sweeps = rows.map(|row| Sweep::new(&base, row)).collect::<anyhow::Result<_>>()?;
        Ok(Self { base, sweeps })
    }

    /// How many values each dial has.
    pub fn lengths(&self) -> Vec<usize> {
        self.sweeps.iter().map(|sweep| sweep.values.len()).collect()
    }

    /// The base, and each other value of each dial alone.
    pub fn singles(&self) -> Vec<Vec<usize>> {
        let base = vec![0; self.sweeps.len()];
        let mut points = vec![base.clone()];
        for (dial, length) in self.lengths().into_iter().enumerate() {
            points.extend((1..length).map(|value| {
                let mut point = base.clone();
                point[dial] = value;
                point
            }));
        }
        points
    }

    /// Every combination.
    pub fn grid(&self) -> Vec<Vec<usize>> {
        let longer = |points: Vec<Vec<usize>>, length: usize| {
            let with = |point: &Vec<usize>, value| [point.as_slice(), &[value]].concat();
            points.iter().flat_map(|point| (0..length).map(move |value| with(point, value))).collect()
        };
        self.lengths().into_iter().fold(vec![Vec::new()], longer)
    }

    /// The setting of a point.
    ///
    /// # Errors
    /// When values cannot be combined.
    pub fn setting(&self, point: &[usize]) -> anyhow::Result<Setting> {
        let mut tradeoff = self.base;
        for (sweep, &value) in self.sweeps.iter().zip(point) {
            for (key, value) in &sweep.values[value] {
                tradeoff.set(key, value)?;
            }
        }
        Ok(Setting::new(tradeoff))
    }
}

impl Sweep {
    fn new(base: &Tradeoff, (key, texts): &Row) -> anyhow::Result<Self> {
        let mut values = vec![Vec::new()];
        for text in *texts {
            let dials = assignments(key, text)?;
            let mut turned = *base;
            dials.iter().try_for_each(|(key, value)| turned.set(key, value))?;
            if turned != *base {
                values.push(dials);
            }
        }
        Ok(Self { key, values })
    }
}

/// What a value of the table sets.
fn assignments(key: &str, text: &str) -> anyhow::Result<Vec<(String, String)>> {
    let mut words = text.split(' ');
    let first = words.next().context("a value is a word at least")?;
    let mut dials = vec![(key.to_owned(), first.to_owned())];
    for word in words {
        let (key, value) = word.split_once('=').context("a further value is KEY=VALUE")?;
        dials.push((key.to_owned(), value.to_owned()));
    }
    Ok(dials)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_of_the_table_is_taken_and_is_another_setting() {
        let keys: Vec<_> = names().collect();
        let space = Space::new(Tradeoff::EXACT, &keys).expect("a dial takes the values of the table");
        let names: Vec<String> =
            space.singles().iter().map(|point| space.setting(point).expect("one dial").name).collect();
        let values: usize = TABLE.iter().map(|(_, values)| values.len()).sum();
        assert_eq!(names.len(), 1 + values, "none of them is the exact one");
        let mut distinct = names.clone();
        distinct.sort();
        distinct.dedup();
        assert_eq!(distinct.len(), names.len(), "{names:?}");
        assert_eq!(names[0], "exact");
    }

    #[test]
    fn the_base_s_own_value_comes_first_and_only_once() {
        let mut base = Tradeoff::EXACT;
        base.set("visible_pixels", "4").expect("it takes that");
        let space = Space::new(base, &["visible_pixels"]).expect("its values");
        let first = space.setting(&[0]).expect("the base");
        assert_eq!((first.tradeoff, first.name.as_str()), (base, "visible_pixels=4"));
        let same =
            space.grid().iter().filter(|point| space.setting(point).expect("one").name == first.name).count();
        assert_eq!(same, 1);
    }
}
