//! What one would write first: an exact depth buffer, a triangle and a sample at a time, and
//! questions as plain loops over their samples. It says how fast the machine is today.

use glam::{Affine3A, Mat4, Vec3};
use tercet::geom::{Proxy, View};
use tercet::query::software::Faces;
use tercet::scene::mesh::Mesh;

const SUBPIXELS: f32 = 256.0;

/// A depth buffer in reversed z.
pub struct Plain {
    width: usize,
    height: usize,
    depth: Vec<f32>,
    /// Column and row in subpixels, and depth.
    vertices: Vec<(i64, i64, f32)>,
}

impl Plain {
    pub fn new() -> Self {
        Self { width: 0, height: 0, depth: Vec::new(), vertices: Vec::new() }
    }

    /// Clears and draws. Everything lies before the camera, and nothing is mirrored.
    pub fn draw(&mut self, view: &View, faces: Faces, calls: &[(Mesh, Affine3A)]) {
        (self.width, self.height) = (view.viewport().width as usize, view.viewport().height as usize);
        self.depth.clear();
        self.depth.resize(self.width * self.height, 0.0);
        let clip_from_world = view.clip_from_world().as_mat4();
        for (mesh, placed) in calls {
            let level = &mesh.levels()[0];
            let clip_from_object = clip_from_world * Mat4::from(*placed);
            let half = Vec3::new(self.width as f32, self.height as f32, 0.0) * 0.5;
            self.vertices.clear();
            self.vertices.extend(level.positions.iter().map(|p| {
                let clip = clip_from_object * p.extend(1.0);
                let inverse = 1.0 / clip.w;
                let x = (clip.x * inverse + 1.0) * half.x * SUBPIXELS;
                let y = (1.0 - clip.y * inverse) * half.y * SUBPIXELS;
                (x.round_ties_even() as i64, y.round_ties_even() as i64, clip.z * inverse)
            }));
            for corners in level.indices.as_chunks::<3>().0 {
                self.triangle(faces, corners.map(|i| self.vertices[i as usize]));
            }
        }
    }

    fn triangle(&mut self, faces: Faces, [a, mut b, mut c]: [(i64, i64, f32); 3]) {
        let mut area = edge(a, b, c.0, c.1);
        // Rows go down: clockwise is positive.
        if area > 0 && faces == Faces::Front {
            return;
        }
        if area < 0 {
            (b, c) = (c, b);
            area = -area;
        }
        let first = |v: i64| ((v + 127) >> 8).max(0);
        let last = |v: i64, side: usize| ((v - 128) >> 8).min(side as i64 - 1);
        let (x0, x1) = (first(a.0.min(b.0).min(c.0)), last(a.0.max(b.0).max(c.0), self.width));
        let (y0, y1) = (first(a.1.min(b.1).min(c.1)), last(a.1.max(b.1).max(c.1), self.height));
        if area == 0 || x0 > x1 || y0 > y1 {
            return;
        }
        let inverse = 1.0 / area as f32;
        let edges = [(b, c), (c, a), (a, b)];
        // What decides where the edge function is 0: top and left edges cover.
        let bias = edges.map(|(p, q)| i64::from(!(q.1 < p.1 || (q.1 == p.1 && q.0 > p.0))));
        let corner = (x0 * 256 + 128, y0 * 256 + 128);
        let mut rows = edges.map(|(p, q)| edge(p, q, corner.0, corner.1));
        for y in y0..=y1 {
            let mut e = rows;
            let row = &mut self.depth[y as usize * self.width..][..self.width];
            for kept in &mut row[x0 as usize..=x1 as usize] {
                if e[0] >= bias[0] && e[1] >= bias[1] && e[2] >= bias[2] {
                    let (u, v) = (e[1] as f32 * inverse, e[2] as f32 * inverse);
                    let depth = a.2 + (u * (b.2 - a.2) + v * (c.2 - a.2));
                    if depth > *kept {
                        *kept = depth;
                    }
                }
                for (e, (p, q)) in e.iter_mut().zip(&edges) {
                    *e -= (q.1 - p.1) * 256;
                }
            }
            for (e, (p, q)) in rows.iter_mut().zip(&edges) {
                *e += (q.0 - p.0) * 256;
            }
        }
    }

    /// How many samples of a box are in sight, and how many it covers.
    pub fn dual(&self, proxy: &Proxy) -> (u32, u32) {
        let (mut visible, mut total) = (0, 0);
        for y in proxy.rect.y0..proxy.rect.y1 {
            for x in proxy.rect.x0..proxy.rect.x1 {
                if proxy.covers(x, y) {
                    total += 1;
                    let kept = self.depth[y as usize * self.width + x as usize];
                    visible += u32::from(proxy.nearness(x, y) >= kept);
                }
            }
        }
        (visible, total)
    }
}

fn edge(p: (i64, i64, f32), q: (i64, i64, f32), x: i64, y: i64) -> i64 {
    (q.0 - p.0) * (y - p.1) - (q.1 - p.1) * (x - p.0)
}
