//! Counts on screens of every size, against closed forms: boxes and what stands before them end on the
//! borders of pixels, so that how many samples there are is a product.

use glam::{Affine3A, Mat4, Vec2};
use tercet::geom::{Aabb, Question, View, Viewport, projection};
use tercet::query::software::SoftwareQueries;
use tercet::query::{Answer, QueryBackend, Ticket, Wait, Want};

use super::flight::solid;
use super::setting;

/// Where the pixels begin and end, in pixels from the middle of the screen, x to the right and y up.
#[derive(Clone, Copy)]
struct Rect {
    min: Vec2,
    max: Vec2,
}

impl Rect {
    fn new(x: [f32; 2], y: [f32; 2]) -> Self {
        Self { min: Vec2::new(x[0], y[0]), max: Vec2::new(x[1], y[1]) }
    }

    fn samples(self) -> u64 {
        let size = (self.max - self.min).max(Vec2::ZERO);
        size.x as u64 * size.y as u64
    }

    fn overlap(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// The box over these pixels at a distance.
    fn at(self, distance: f32) -> Aabb {
        Aabb::new(self.min.extend(-distance - 1.0), self.max.extend(-distance))
    }
}

/// One occluder, and boxes before it, behind it, and partly behind it.
fn check(side: u32) {
    let screen = Viewport::new(side, side);
    let clip_from_view = projection::orthographic(side as f32, side as f32, 0.0, 64.0);
    let view = View::new(Mat4::IDENTITY, clip_from_view, screen).expect("a view");
    let (half, part) = (side as f32 / 2.0, side as f32 / 16.0);
    let occluder = Rect::new([-5.0 * part, 3.0 * part], [-2.0 * part, 6.0 * part]);
    let boxes = [
        // Of the whole screen, behind and before.
        (Rect::new([-half, half], [-half, half]), 20.0),
        (Rect::new([-half, half], [-half, half]), 2.0),
        // A pixel in a corner, and one behind the occluder.
        (Rect::new([half - 1.0, half], [half - 1.0, half]), 20.0),
        (Rect::new([0.0, 1.0], [0.0, 1.0]), 20.0),
        // As large as the occluder, and a little larger: a frame of a pixel.
        (occluder, 20.0),
        (Rect { min: occluder.min - 1.0, max: occluder.max + 1.0 }, 20.0),
        // Half behind it.
        (Rect::new([0.0, 6.0 * part], [-part, 2.0 * part]), 20.0),
    ];
    let mut queries = SoftwareQueries::new();
    queries.begin(&view).expect("begin");
    let wall = solid(&occluder.at(10.0));
    queries.draw(|pass| pass.draw_mesh(&wall, &Affine3A::IDENTITY)).expect("draw");
    for (i, (rect, distance)) in boxes.into_iter().enumerate() {
        let Question::Ask(proxy) = Question::new(&rect.at(distance), &view) else {
            panic!("box {i} can be asked about")
        };
        queries.ask(Ticket(i as u32), &[proxy], Want::Dual).expect("ask");
    }
    let mut answered = 0;
    queries
        .answers(Wait::Block, |Ticket(i), answer| {
            let (rect, distance) = boxes[i as usize];
            let hidden = if distance > 10.0 { rect.overlap(occluder).samples() } else { 0 };
            let expected = (rect.samples() - hidden, rect.samples());
            let Answer::Dual { visible, total } = answer else { panic!("a count") };
            assert_eq!((u64::from(visible), u64::from(total)), expected, "box {i} on {side} × {side}");
            answered += 1;
        })
        .expect("answers");
    queries.end().expect("end");
    assert_eq!(answered, boxes.len());
}

/// On a machine with 8 GiB to spare, `TERCET_LARGE=1` adds 16384 × 16384.
#[test]
fn counts_are_products_on_screens_of_every_size() {
    for side in [16, 32, 64, 256, 1024] {
        check(side);
    }
    if setting("TERCET_LARGE", 0) == 0 {
        eprintln!("16384 × 16384 is skipped: set TERCET_LARGE=1");
        return;
    }
    check(Viewport::MAX_SIDE);
}
