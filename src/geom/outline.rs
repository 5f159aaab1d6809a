//! What a question looks like on the screen, for pictures.

use glam::{DVec2, Vec2};

use super::Proxy;

/// A convex polygon on the screen, in pixels of the viewport, y down.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScreenOutline {
    /// The corners in order; fewer than three for nothing.
    pub points: Vec<Vec2>,
}

impl Proxy {
    /// The polygon in which pixel centres are covered: the proxy's rectangle, cut by its edges. At
    /// most ten corners. To look at; nothing is decided by it.
    pub fn outline(&self) -> ScreenOutline {
        let [width, height] = [f64::from(self.rect.width()), f64::from(self.rect.height())];
        let corners = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]];
        let whole = corners.map(DVec2::from_array).to_vec();
        let kept = self.edges.iter().fold(whole, |polygon, edge| cut(&polygon, edge.map(f64::from)));
        let [x0, y0] = self.origin().map(f64::from);
        ScreenOutline { points: kept.into_iter().map(|p| (p + DVec2::new(x0, y0)).as_vec2()).collect() }
    }
}

/// The part of a convex polygon where `a·x + b·y + c ≥ 0`.
fn cut(polygon: &[DVec2], [a, b, c]: [f64; 3]) -> Vec<DVec2> {
    let inside = |p: DVec2| a * p.x + b * p.y + c;
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (at_p, at_q) = (inside(p), inside(q));
        if at_p >= 0.0 {
            kept.push(p);
        }
        if (at_p >= 0.0) != (at_q >= 0.0) {
            kept.push(p.lerp(q, at_p / (at_p - at_q)));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::geom::{Aabb, Question, View, Viewport};

    /// A pixel is covered just if its centre lies in the polygon, but for a hair along its border.
    #[test]
    fn the_polygon_holds_the_centres_that_the_proxy_covers() {
        let view =
            View::look_at(Vec3::new(3.0, 4.0, 5.0), Vec3::ZERO, 50.0, 0.1, Viewport::new(120, 80)).unwrap();
        let aabb = Aabb::from_center(Vec3::new(0.3, 0.1, -0.2), Vec3::new(1.0, 0.6, 0.8));
        let Question::Ask(proxy) = Question::new(&aabb, &view) else { panic!("it lies ahead") };
        let points = proxy.outline().points;
        assert!((5..=10).contains(&points.len()), "{points:?}");
        let mut covered = 0;
        for (x, y) in
            (proxy.rect.y0..proxy.rect.y1).flat_map(|y| (proxy.rect.x0..proxy.rect.x1).map(move |x| (x, y)))
        {
            let centre = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let sides = points.iter().zip(points.iter().cycle().skip(1));
            let least = sides.map(|(p, q)| (q - p).normalize_or_zero().perp_dot(centre - p)).reduce(f32::min);
            let least = least.expect("there are corners");
            if least.abs() > 1e-3 {
                assert_eq!(proxy.covers(x, y), least > 0.0, "({x}, {y}): {least}");
            }
            covered += u32::from(proxy.covers(x, y));
        }
        assert!(covered > 500, "{covered}");
    }

    #[test]
    fn what_is_cut_away_whole_has_no_corners() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(DVec2::from_array);
        assert!(cut(&square, [0.0, 0.0, -1.0]).is_empty());
        assert_eq!(cut(&square, [0.0, 0.0, 0.0]), square);
        assert!(cut(&[], [1.0, 0.0, 0.0]).is_empty());
    }
}
