//! Which trees are run: the base, several times, and one for each other value of each dial.

use anyhow::Context;
use tercet::tree::TreeConfig;

use crate::dials::DIALS;

/// What is run.
pub struct Plan {
    /// The trees, each run once; the first [`Plan::COPIES`] are the base.
    pub trees: Vec<TreeConfig>,
    /// The dials.
    pub sweeps: Vec<Sweep>,
}

/// One dial.
pub struct Sweep {
    /// Its name.
    pub dial: &'static str,
    /// Its values, the base's among them.
    pub points: Vec<Point>,
}

/// One value of a dial.
pub struct Point {
    /// As it is set.
    pub value: String,
    /// Index into [`Plan::trees`]; 0 for the base's value.
    pub tree: usize,
}

impl Plan {
    /// How often the base is run: what differs among the copies is noise.
    pub const COPIES: usize = 3;

    /// Turns the dials of these names around a base; all dials, if none is named.
    ///
    /// # Errors
    /// When the tree does not take a value.
    pub fn new(base: &TreeConfig, names: &[String]) -> anyhow::Result<Self> {
        let mut plan = Self { trees: vec![base.clone(); Self::COPIES], sweeps: Vec::new() };
        let wanted = |dial: &str| names.is_empty() || names.iter().any(|name| name == dial);
        for (dial, values) in DIALS.iter().filter(|(dial, _)| wanted(dial)) {
            let mut points = Vec::new();
            for value in *values {
                let tree = plan.tree_with(dial, value)?;
                points.push(Point { value: (*value).to_owned(), tree });
            }
            if points.iter().all(|point| point.tree != 0) {
                let known = base.dials().into_iter().find(|known| known.key == *dial);
                let value = known.context("a dial that was set is listed")?.value;
                let at = points.partition_point(|point| comes_before(&point.value, &value));
                points.insert(at, Point { value, tree: 0 });
            }
            plan.sweeps.push(Sweep { dial, points });
        }
        Ok(plan)
    }

    /// The index of the base with one dial turned.
    fn tree_with(&mut self, dial: &str, value: &str) -> anyhow::Result<usize> {
        let mut tree = self.trees[0].clone();
        tree.set(dial, value)?;
        if tree == self.trees[0] {
            return Ok(0);
        }
        self.trees.push(tree);
        Ok(self.trees.len() - 1)
    }
}

/// Numbers come in their order; a word goes to the front.
fn comes_before(a: &str, b: &str) -> bool {
    matches!((a.parse::<f64>(), b.parse::<f64>()), (Ok(a), Ok(b)) if a < b)
}
