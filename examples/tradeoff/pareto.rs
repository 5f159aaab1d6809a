//! What nothing else beats in both of two figures.

/// The indices of the points that no other is below in one figure and at most equal in the other, by
/// growing first figure; of equal ones the first. O(n log n).
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| {
        let ((ax, ay), (bx, by)) = (points[a], points[b]);
        ax.total_cmp(&bx).then(ay.total_cmp(&by))
    });
    let mut least = f64::INFINITY;
    order.retain(|&point| {
        let y = points[point].1;
        let is_better = y < least;
        least = least.min(y);
        is_better
    });
    order
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn of_equal_points_one_is_on_the_front_and_ties_in_one_figure_are_beaten() {
        assert!(front(&[]).is_empty());
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0)]), [0]);
        assert_eq!(front(&[(1.0, 2.0), (1.0, 1.0), (0.5, 2.0), (2.0, 1.0)]), [2, 1]);
    }

    proptest! {
        /// Held against the definition, point by point. Few values make many ties.
        #[test]
        fn it_is_what_the_definition_says(points in prop::collection::vec((0..6u8, 0..6u8), 0..30)) {
            let points: Vec<(f64, f64)> =
                points.iter().map(|&(x, y)| (f64::from(x), f64::from(y))).collect();
            let beats = |a: (f64, f64), b: (f64, f64)| a != b && a.0 <= b.0 && a.1 <= b.1;
            let unbeaten = |n: usize| {
                let p = points[n];
                !points.iter().any(|&q| beats(q, p)) && !points[..n].contains(&p)
            };
            let mut expected: Vec<usize> = (0..points.len()).filter(|&n| unbeaten(n)).collect();
            expected.sort_by(|&a, &b| points[a].0.total_cmp(&points[b].0));
            prop_assert_eq!(front(&points), expected);
        }
    }
}
