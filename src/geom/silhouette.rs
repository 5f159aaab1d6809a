//! The outline of a box, by which of its faces are turned to the viewer.
//!
//! A viewer outside a box sees at most one of two opposite faces, so one, two or three in all. The
//! edges between a turned and an unturned face are the outline: 4, 6 and 6 of them (Schmalstieg
//! and Tobler, *Fast Projected Area Computation for Three-Dimensional Bounding Boxes*, 1999); the
//! test below counts them. Of the four edges along an axis either none or two are in it.

/// The outline's edges, two along each of `len` axes, each from the corner with the lesser
/// coordinate to that with the greater (indices as in [`Aabb::corners`](super::Aabb::corners)).
#[derive(Clone, Copy)]
pub(crate) struct Silhouette {
    pub(crate) pairs: [[[usize; 2]; 2]; 3],
    pub(crate) len: usize,
}

/// For each combination of turned faces: entry `t[0] + 3·t[1] + 9·t[2]`, where `t[axis]` is 0 if
/// neither of the two faces of that axis is turned to the viewer, 1 if that at the least
/// coordinate is, 2 if the other.
pub(crate) const SILHOUETTES: [Silhouette; 27] = {
    let mut table = [Silhouette { pairs: [[[0; 2]; 2]; 3], len: 0 }; 27];
    let mut index = 0;
    while index < 27 {
        table[index] = silhouette([index % 3, index / 3 % 3, index / 9]);
        index += 1;
    }
    table
};

/// The edges between a face that is turned to the viewer and one that is not.
const fn silhouette(turned: [usize; 3]) -> Silhouette {
    let mut found = Silhouette { pairs: [[[0; 2]; 2]; 3], len: 0 };
    let mut axis = 0;
    while axis < 3 {
        let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
        let (mut edge, mut along) = (0, 0);
        while edge < 4 {
            // The edge between the faces `p_side` of axis p and `q_side` of axis q.
            let (p_side, q_side) = (edge & 1, edge >> 1);
            if (turned[p] == p_side + 1) != (turned[q] == q_side + 1) {
                let corner = p_side << p | q_side << q;
                found.pairs[found.len][along] = [corner, corner | 1 << axis];
                along += 1;
            }
            edge += 1;
        }
        // Either none or two: the const evaluation would fail at a third.
        found.len += along / 2;
        axis += 1;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_have_at_most_six_edges() {
        for (index, silhouette) in SILHOUETTES.iter().enumerate() {
            let turned = [index % 3, index / 3 % 3, index / 9].iter().filter(|&&t| t != 0).count();
            let edges = silhouette.pairs[..silhouette.len].as_flattened();
            assert_eq!(edges.len(), [0, 4, 6, 6][turned], "of entry {index}");
            // A closed outline passes each of its corners twice.
            let mut ends = [0; 8];
            edges.iter().flatten().for_each(|&corner| ends[corner] += 1);
            assert!(ends.iter().all(|&n| n == 0 || n == 2), "of entry {index}: {ends:?}");
        }
    }
}
