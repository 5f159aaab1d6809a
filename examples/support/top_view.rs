//! The last frame from above: what was drawn, what was culled, and the tree's cells.

use std::collections::HashSet;
use std::path::Path;

use glam::{DVec4, Vec2};
use plotters::prelude::*;
use tercet::geom::{Aabb, Frustum, View};
use tercet::scene::{ObjectId, Scene, SceneObject};
use tercet::tree::Role;

use super::canvas::{self, FAINT, INK, Key, Sheet, px, text};
use super::report::Summary;
use super::run::Eye;
use super::table::count;

const WIDTH: u32 = 1200;
/// Above the map: title, subtitle and legend.
const HEADING: u32 = 140;

const DRAWN: RGBColor = RGBColor(31, 119, 180);
const CULLED: RGBColor = RGBColor(235, 110, 60);
const OUTSIDE: RGBColor = RGBColor(196, 202, 210);
const STRADDLING: RGBColor = RGBColor(140, 60, 170);
const CELLS: RGBColor = RGBColor(110, 160, 130);
const FRUSTUM: RGBColor = RGBColor(252, 204, 60);

/// What became of an object in the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Fate {
    /// Its box does not meet the view frustum.
    Outside,
    /// Its box meets the frustum, and it was not drawn.
    Culled,
    /// It was drawn.
    Drawn,
}

/// An object on the map.
#[derive(Clone, Copy, Debug)]
struct Mark {
    /// In world space, metres.
    bounds: Aabb,
    /// What became of it.
    fate: Fate,
    /// Whether a splitting plane of the tree cuts it.
    straddles: bool,
}

/// Draws `top_view.png` into a folder that exists.
pub fn write(out: &Path, summary: &Summary, scene: &Scene, view: &View, eye: &Eye) -> anyhow::Result<()> {
    let tree = scene.tree();
    let cells: Vec<Aabb> =
        tree.nodes().filter(|n| n.is_leaf && n.role != Role::Straddle).map(|n| n.cell).collect();
    let mut cut = HashSet::new();
    let mut stack = vec![(tree.root(), false)];
    while let Some((node, below_cut)) = stack.pop() {
        let children = tree.children(node);
        // A binary tree keeps what its planes cut in the inner nodes themselves.
        if below_cut || children.is_some() {
            cut.extend(tree.own_objects(node).map(|(slot, _)| slot as usize));
        }
        for (i, child) in children.into_iter().flatten().enumerate() {
            stack.push((child, below_cut || i == 2));
        }
    }
    let drawn: HashSet<ObjectId> = eye.visible().iter().map(|object| object.id).collect();
    let frustum = Frustum::new(view);
    let mark = |object: SceneObject| {
        let bounds = object.bounds?;
        let fate = match drawn.contains(&object.object.id) {
            true => Fate::Drawn,
            false if frustum.intersects(&bounds) => Fate::Culled,
            false => Fate::Outside,
        };
        Some(Mark { bounds, fate, straddles: cut.contains(&object.object.id.slot()) })
    };
    let marks = scene.objects().filter_map(mark).collect();
    let subtitle = format!("{} · policy {}", summary.scene, summary.policy);
    save(&out.join("top_view.png"), &subtitle, &cells, marks, view)
}

/// Draws the map: x to the right, z downward, as seen from y = +∞. `cells` are those of the
/// tree's leaves.
fn save(
    path: &Path,
    subtitle: &str,
    cells: &[Aabb],
    mut marks: Vec<Mark>,
    view: &View,
) -> anyhow::Result<()> {
    let number = |fate| count(marks.iter().filter(|m| m.fate == fate).count() as f64);
    let straddlers = count(marks.iter().filter(|m| m.straddles).count() as f64);
    let keys = [
        Key::new(DRAWN, format!("drawn: {}", number(Fate::Drawn))),
        Key::new(CULLED, format!("culled inside the frustum: {}", number(Fate::Culled))),
        Key::new(OUTSIDE, format!("outside the frustum: {}", number(Fate::Outside))),
        Key::new(STRADDLING, format!("outlined: cut by a splitting plane: {straddlers}")),
        Key::new(CELLS, format!("the tree's {} leaf cells", count(cells.len() as f64))),
        Key::new(FRUSTUM, "the view frustum"),
    ];
    let extent = extent(&marks, view);
    let shape = (extent.size().z / extent.size().x).clamp(0.4, 1.2);
    let size = (WIDTH, HEADING + (WIDTH as f32 * shape) as u32);
    // Large things first: the small ones stand in them. Of the small ones, what was drawn last.
    let area = |m: &Mark| m.bounds.size().x * m.bounds.size().z;
    let small = 1e-4 * extent.size().x * extent.size().z;
    let key = |m: &Mark| (area(m) < small).then_some(m.fate);
    marks.sort_by(|a, b| key(a).cmp(&key(b)).then(area(b).total_cmp(&area(a))));
    canvas::save(path, size, |sheet| {
        let below = canvas::heading(sheet, "The last frame from above", subtitle, &keys)?;
        let map = Map::new(&below, &extent);
        let wedge = map.wedge(view);
        map.sheet.draw(&Polygon::new(wedge, FRUSTUM.mix(0.22)))?;
        for cell in cells {
            map.sheet.draw(&Rectangle::new(map.rectangle(cell, 0), CELLS.mix(0.22).stroke_width(1)))?;
        }
        for mark in &marks {
            map.object(mark)?;
        }
        map.eye(view)?;
        map.bar()
    })
}

/// The sheet and how metres become its pixels.
struct Map<'a> {
    sheet: Sheet<'a>,
    center: Vec2,
    pixels_per_metre: f32,
    size: Vec2,
}

impl<'a> Map<'a> {
    /// A map that shows all of a box.
    fn new(below: &Sheet<'a>, extent: &Aabb) -> Self {
        let sheet = below.margin(0, px(20), px(20), px(20));
        let (w, h) = sheet.dim_in_pixel();
        let size = Vec2::new(w as f32, h as f32);
        let metres = Vec2::new(extent.size().x, extent.size().z);
        Self {
            sheet,
            center: Vec2::new(extent.center().x, extent.center().z),
            pixels_per_metre: 0.97 * (size / metres).min_element(),
            size,
        }
    }

    fn pixel(&self, xz: Vec2) -> (i32, i32) {
        let p = (xz - self.center) * self.pixels_per_metre + self.size * 0.5;
        let p = p.clamp(Vec2::ZERO, self.size);
        (p.x as i32, p.y as i32)
    }

    /// The box's outline, never thinner than `least` pixels a side.
    fn rectangle(&self, bounds: &Aabb, least: i32) -> [(i32, i32); 2] {
        let (x0, y0) = self.pixel(Vec2::new(bounds.min.x, bounds.min.z));
        let (x1, y1) = self.pixel(Vec2::new(bounds.max.x, bounds.max.z));
        [(x0, y0), (x1.max(x0 + least), y1.max(y0 + least))]
    }

    fn object(&self, mark: &Mark) -> anyhow::Result<()> {
        let corners = self.rectangle(&mark.bounds, px(2));
        let [(x0, y0), (x1, y1)] = corners;
        // The larger, the fainter: storeys lie over each other, and floors would hide it all.
        let side = (((x1 - x0) * (y1 - y0)) as f64).sqrt();
        let opacity = (f64::from(px(5)) / side).clamp(0.04, 0.8);
        let color = match mark.fate {
            Fate::Drawn => DRAWN,
            Fate::Culled => CULLED,
            Fate::Outside => OUTSIDE,
        };
        self.sheet.draw(&Rectangle::new(corners, color.mix(opacity).filled()))?;
        if mark.straddles {
            self.sheet.draw(&Rectangle::new(corners, STRADDLING.mix(0.6 * opacity).stroke_width(1)))?;
        }
        Ok(())
    }

    /// The frustum's outline from above, clipped to the map.
    fn wedge(&self, view: &View) -> Vec<(i32, i32)> {
        let beyond = 2.0 * self.size.max_element() / self.pixels_per_metre;
        let mut corners = Vec::new();
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let at = |z| {
                let p = view.world_from_clip() * DVec4::new(x, y, z, 1.0);
                let p = p.truncate() / p.w;
                Vec2::new(p.x as f32, p.z as f32)
            };
            // Two depths give the edge's direction, for perspective and orthographic views,
            // whichever end is near.
            let (a, b) = (at(0.75), at(0.25));
            let eye = view.eye();
            let from = if eye.w == 0.0 { a } else { Vec2::new(eye.x, eye.z) };
            let along = if (b - a).dot(flat_forward(view)) < 0.0 { a - b } else { b - a };
            corners.extend([from, from + along.normalize_or_zero() * beyond]);
        }
        let half = self.size * 0.5 / self.pixels_per_metre;
        let clipped = clip_to_box(hull(corners), self.center - half, self.center + half);
        clipped.into_iter().map(|p| self.pixel(p)).collect()
    }

    fn eye(&self, view: &View) -> anyhow::Result<()> {
        let eye = view.eye();
        if eye.w == 0.0 {
            return Ok(());
        }
        let (x, y) = self.pixel(Vec2::new(eye.x, eye.z));
        let along = flat_forward(view) * px(40) as f32;
        let tip = (x + along.x as i32, y + along.y as i32);
        self.sheet.draw(&PathElement::new([(x, y), tip], INK.stroke_width(px(2) as u32)))?;
        self.sheet.draw(&Circle::new((x, y), px(7), WHITE.filled()))?;
        self.sheet.draw(&Circle::new((x, y), px(5), INK.filled()))?;
        self.sheet.draw_text("eye", &text(14, INK), (x + px(10), y + px(6)))?;
        Ok(())
    }

    /// The scale bar.
    fn bar(&self) -> anyhow::Result<()> {
        let metres = 10f32.powf((0.2 * self.size.x / self.pixels_per_metre).log10().floor());
        let length = (metres * self.pixels_per_metre) as i32;
        let (x, y) = (px(8), self.size.y as i32 - px(10));
        let ticks = [(x, y - px(5)), (x, y), (x + length, y), (x + length, y - px(5))];
        self.sheet.draw(&PathElement::new(ticks, INK.stroke_width(px(1) as u32)))?;
        self.sheet.draw_text(&format!("{metres} m"), &text(13, FAINT), (x + px(6), y - px(18)))?;
        Ok(())
    }
}

/// The box around every object and the eye, never flat.
fn extent(marks: &[Mark], view: &View) -> Aabb {
    let eye = view.eye();
    let seen_from = if eye.w == 0.0 { Aabb::EMPTY } else { Aabb::from_points([eye.truncate()]) };
    marks.iter().fold(seen_from, |all, m| all.union(&m.bounds)).inflated(1e-3)
}

/// The direction of view on the map.
fn flat_forward(view: &View) -> Vec2 {
    let forward = view.forward();
    Vec2::new(forward.x, forward.z).normalize_or_zero()
}

/// The convex hull, by Andrew's monotone chain.
fn hull(mut points: Vec<Vec2>) -> Vec<Vec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = Vec2>| {
        let mut chain: Vec<Vec2> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(p - b) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut outline = half(&mut points.iter().copied());
    outline.extend(half(&mut points.iter().rev().copied()));
    outline
}

/// The part of a convex polygon inside a rectangle (Sutherland and Hodgman).
fn clip_to_box(polygon: Vec<Vec2>, min: Vec2, max: Vec2) -> Vec<Vec2> {
    let sides = [(Vec2::X, -min.x), (-Vec2::X, max.x), (Vec2::Y, -min.y), (-Vec2::Y, max.y)];
    sides.into_iter().fold(polygon, |polygon, (normal, offset)| {
        let inside = |p: Vec2| p.dot(normal) + offset;
        let mut kept = Vec::new();
        for (i, &b) in polygon.iter().enumerate() {
            let a = polygon[(i + polygon.len() - 1) % polygon.len()];
            let (da, db) = (inside(a), inside(b));
            if (da < 0.0) != (db < 0.0) {
                kept.push(a.lerp(b, da / (da - db)));
            }
            if db >= 0.0 {
                kept.push(b);
            }
        }
        kept
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_drops_the_points_inside() {
        let square = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        let outline = hull([&square[..], &[Vec2::splat(0.5), Vec2::new(0.2, 0.7)]].concat());
        assert_eq!(outline.len(), 4);
        assert!(square.iter().all(|corner| outline.contains(corner)));
    }

    #[test]
    fn clipping_keeps_the_part_inside() {
        let triangle = vec![Vec2::new(-1.0, 0.5), Vec2::new(0.5, 0.5), Vec2::new(0.5, 2.0)];
        let clipped = clip_to_box(triangle, Vec2::ZERO, Vec2::ONE);
        let area: f32 =
            (0..clipped.len()).map(|i| clipped[i].perp_dot(clipped[(i + 1) % clipped.len()]) * 0.5).sum();
        assert!((area.abs() - 0.25).abs() < 1e-6, "{clipped:?}");
        assert!(clip_to_box(vec![Vec2::splat(3.0); 3], Vec2::ZERO, Vec2::ONE).is_empty());
    }
}
