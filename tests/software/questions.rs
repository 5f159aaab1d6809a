//! Answers against the plain loop over samples.

use glam::Vec3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use tercet::geom::{Aabb, PixelRect, Proxy, Question, View, Viewport};
use tercet::query::software::SoftwareQueries;
use tercet::query::{Answer, QueryBackend, Ticket, Wait, Want};

use crate::proxies::{flat, random_proxy};
use crate::support::{LEVELS, add, dice, draw, pixel_view, pool, soup, triangles};

/// The plain loop of the contract: visible and covered samples.
fn plain(proxy: &Proxy, queries: &SoftwareQueries) -> (u32, u32) {
    let (mut visible, mut total) = (0, 0);
    for y in proxy.rect.y0..proxy.rect.y1 {
        for x in proxy.rect.x0..proxy.rect.x1 {
            if proxy.covers(x, y) {
                total += 1;
                visible += u32::from(proxy.nearness(x, y) >= queries.depth().at(x, y));
            }
        }
    }
    (visible, total)
}

#[test]
fn answers_equal_the_plain_loop() {
    let sizes = [(1, 1), (1, 40), (40, 1), (17, 3), (64, 64), (333, 211), (1023, 767)];
    for (seed, (width, height)) in sizes.into_iter().enumerate() {
        let mut dice = dice(100 + seed as u64);
        let view = pixel_view(width, height);
        let near = soup(&triangles(&mut dice, 60, width, height));
        let far = soup(&triangles(&mut dice, 60, width, height));
        let count = if width > 1000 { 60 } else { 300 };
        let proxies: Vec<Proxy> = (0..count).map(|_| random_proxy(&mut dice, [width, height], 0.0)).collect();
        for threads in [1, 2, 4] {
            pool(threads).install(|| {
                for level in LEVELS {
                    let mut queries = SoftwareQueries::with_level(level);
                    draw(&mut queries, &view, std::slice::from_ref(&near));
                    // The second wave sees a hierarchy that was brought up to date in part.
                    for more in [None, Some(&far)] {
                        if let Some(mesh) = more {
                            add(&mut queries, std::slice::from_ref(mesh));
                        }
                        compare(&mut queries, &proxies);
                    }
                }
            });
        }
    }
}

/// Questions about few pixels are answered many at once: hidden, clear and mixed ones, of few and of
/// many edges, beside each other and beside large ones; in the middle and at the viewport's border.
#[test]
fn small_questions_equal_the_plain_loop() {
    let (mut hidden, mut clear, mut mixed) = (0, 0, 0);
    for (seed, (width, height)) in [(16, 16), (37, 5), (129, 67), (250, 131)].into_iter().enumerate() {
        let mut dice = dice(300 + seed as u64);
        let view = pixel_view(width, height);
        // Small ones leave much of a proxy in sight and hide the rest.
        let mut near = triangles(&mut dice, 300, width, height);
        near.retain(|t| (t[1] - t[0]).length().max((t[2] - t[0]).length()) < 30.0);
        let mesh = soup(&near);
        let mut proxies: Vec<Proxy> = (0..4000).map(|_| small_proxy(&mut dice, [width, height])).collect();
        proxies.retain(|proxy| proxy.rect.x0 < proxy.rect.x1 && proxy.rect.y0 < proxy.rect.y1);
        let mut drawn = SoftwareQueries::new();
        draw(&mut drawn, &view, std::slice::from_ref(&mesh));
        proxies.iter_mut().for_each(|proxy| touch(&mut dice, proxy, &drawn));
        for level in LEVELS {
            let mut queries = SoftwareQueries::with_level(level);
            draw(&mut queries, &view, std::slice::from_ref(&mesh));
            compare(&mut queries, &proxies);
            for (visible, total) in proxies.iter().map(|proxy| plain(proxy, &queries)) {
                hidden += u32::from(visible == 0 && total > 1);
                clear += u32::from(visible == total && total > 1);
                mixed += u32::from(0 < visible && visible < total);
            }
        }
    }
    assert!(hidden > 500 && clear > 500 && mixed > 100, "{hidden} hidden, {clear} clear, {mixed} mixed");
}

/// A proxy of a few pixels, cut off at the viewport's border; perhaps nothing is left.
fn small_proxy(dice: &mut ChaCha8Rng, [width, height]: [u32; 2]) -> Proxy {
    let side = [2, 6, 12, 17][dice.random_range(0..4)];
    let sides = [dice.random_range(1..=side), dice.random_range(1..=side)];
    let mut proxy = random_proxy(dice, sides, 0.0);
    let at = [dice.random_range(0..width), dice.random_range(0..height)];
    let PixelRect { x0, y0, x1, y1 } = &mut proxy.rect;
    (*x0, *x1) = (*x0 + at[0], (*x1 + at[0]).min(width));
    (*y0, *y1) = (*y0 + at[1], (*y1 + at[1]).min(height));
    proxy
}

/// Lets a proxy, more often than not, just reach or just miss what is stored for one of its pixels: so
/// a single tile decides.
fn touch(dice: &mut ChaCha8Rng, proxy: &mut Proxy, queries: &SoftwareQueries) {
    let PixelRect { x0, y0, x1, y1 } = proxy.rect;
    let pixels = (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y)));
    let depth = |&(x, y): &(u32, u32)| queries.depth().at(x, y);
    let by_depth = |a: &(u32, u32), b: &(u32, u32)| depth(a).total_cmp(&depth(b));
    let pixel = match dice.random_range(0..4) {
        0 => return,
        1 => (dice.random_range(x0..x1), dice.random_range(y0..y1)),
        2 => pixels.min_by(by_depth).expect("a pixel"),
        _ => pixels.max_by(by_depth).expect("a pixel"),
    };
    let at = depth(&pixel) + [0.0, 1e-4, -1e-4][dice.random_range(0..3)];
    *proxy = flat(proxy.rect, 1.0);
    if dice.random_range(0..2) == 0 {
        proxy.nearest = at;
    } else {
        let [a, b] = [dice.random_range(-0.1..0.1), dice.random_range(-0.1..0.1)];
        let (dx, dy) = ((pixel.0 - x0) as f32 + 0.5, (pixel.1 - y0) as f32 + 0.5);
        proxy.planes[0] = [a, b, at - a * dx - b * dy];
    }
}

/// Asks about each proxy in both ways and compares.
fn compare(queries: &mut SoftwareQueries, proxies: &[Proxy]) {
    for (i, proxy) in proxies.iter().enumerate() {
        queries.ask(Ticket(2 * i as u32), &[*proxy], Want::Dual).expect("ask");
        queries.ask(Ticket(2 * i as u32 + 1), &[*proxy], Want::Any).expect("ask");
    }
    let mut answers = Vec::new();
    queries
        .answers(Wait::Block, |ticket, answer| match answer {
            Answer::Dual { visible, total } => answers.push((ticket.0, visible, total)),
            Answer::Any(visible) => answers.push((ticket.0, u32::from(visible), 0)),
            other => panic!("{other:?}"),
        })
        .expect("answers");
    assert_eq!(answers.len(), 2 * proxies.len());
    for (ticket, visible, total) in answers {
        let proxy = &proxies[ticket as usize / 2];
        let want = plain(proxy, queries);
        if ticket % 2 == 0 {
            assert_eq!((visible, total), want, "{proxy:?}");
        } else {
            assert_eq!(visible > 0, want.0 > 0, "{proxy:?}");
        }
    }
}

/// Depth equal to the proxy's counts as visible, one step nearer does not; over whole tiles and
/// parts of them.
#[test]
fn equal_depth_is_visible() {
    let view = pixel_view(128, 64);
    let nearness = 0.3_f32;
    for (step, visible) in [(nearness, true), (nearness.next_up(), false), (nearness.next_down(), true)] {
        let quad = |z| {
            let [a, b, c, d] =
                [(-8.0, -8.0), (136.0, -8.0), (136.0, 72.0), (-8.0, 72.0)].map(|(x, y)| Vec3::new(x, y, z));
            soup(&[[a, b, c], [a, c, d]])
        };
        let mut queries = SoftwareQueries::new();
        draw(&mut queries, &view, &[quad(step)]);
        for rect in [
            PixelRect { x0: 0, y0: 0, x1: 128, y1: 64 },
            PixelRect { x0: 3, y0: 5, x1: 70, y1: 41 },
            PixelRect { x0: 127, y0: 63, x1: 128, y1: 64 },
        ] {
            queries.ask(Ticket(1), &[flat(rect, nearness)], Want::Dual).expect("ask");
            queries
                .answers(Wait::Block, |_, answer| {
                    let total = rect.area() as u32;
                    let want = if visible { total } else { 0 };
                    assert!(
                        matches!(answer, Answer::Dual { visible, total: t } if visible == want && t == total),
                        "{answer:?}"
                    );
                })
                .expect("answers");
        }
    }
}

/// What is drawn after a question must not change its answer.
#[test]
fn answers_are_about_the_time_of_asking() {
    let view = pixel_view(64, 64);
    let wall = |z: f32| {
        soup(&[[Vec3::new(-200.0, -200.0, z), Vec3::new(400.0, -200.0, z), Vec3::new(-200.0, 400.0, z)]])
    };
    let proxy = flat(PixelRect { x0: 4, y0: 4, x1: 60, y1: 60 }, 0.5);
    let mut queries = SoftwareQueries::new();
    draw(&mut queries, &view, &[wall(0.2)]);
    queries.ask(Ticket(1), &[proxy], Want::Any).expect("ask");
    add(&mut queries, &[wall(0.9)]);
    queries.ask(Ticket(2), &[proxy], Want::Any).expect("ask");
    queries.ask(Ticket(3), &[proxy, flat(proxy.rect, 0.95)], Want::Any).expect("ask");
    let mut answers = Vec::new();
    queries
        .answers(Wait::Poll, |ticket, answer| answers.push((ticket.0, answer.is_visible(0))))
        .expect("answers");
    answers.sort_unstable();
    assert_eq!(answers, [(1, true), (2, false), (3, true)]);
    queries.answers(Wait::Block, |ticket, _| panic!("{ticket:?} is answered twice")).expect("answers");
}

/// A band that nothing is drawn on holds nothing of the frame before.
#[test]
fn questions_about_an_empty_frame_do_not_see_the_last_one() {
    let view = pixel_view(64, 256);
    let quad = |z: f32, bottom: f32| {
        let [a, b, c, d] =
            [(-8.0, -8.0), (72.0, -8.0), (72.0, bottom), (-8.0, bottom)].map(|(x, y)| Vec3::new(x, y, z));
        soup(&[[a, b, c], [a, c, d]])
    };
    let proxies = [
        flat(PixelRect { x0: 0, y0: 0, x1: 64, y1: 256 }, 0.5),
        flat(PixelRect { x0: 3, y0: 200, x1: 9, y1: 207 }, 0.5),
    ];
    let mut queries = SoftwareQueries::new();
    for (second, visible) in [(vec![], true), (vec![quad(0.9, 20.0)], true), (vec![quad(0.9, 270.0)], false)]
    {
        draw(&mut queries, &view, &[quad(0.9, 270.0)]);
        draw(&mut queries, &view, &second);
        compare(&mut queries, &proxies);
        queries.ask(Ticket(0), &proxies[1..], Want::Any).expect("ask");
        queries.answers(Wait::Block, |_, answer| assert_eq!(answer.is_visible(0), visible)).expect("answers");
    }
}

/// Before any frame there is nothing to ask about, and nothing is hidden.
#[test]
fn questions_before_the_first_frame_are_not_answered() {
    let mut queries = SoftwareQueries::new();
    let proxy = flat(PixelRect { x0: 0, y0: 0, x1: 8, y1: 8 }, 0.5);
    queries.ask(Ticket(5), &[proxy], Want::Any).expect("ask");
    let mut answers = 0;
    queries
        .answers(Wait::Block, |_, answer| {
            assert!(matches!(answer, Answer::Unknown));
            answers += 1;
        })
        .expect("answers");
    assert_eq!(answers, 1);
}

/// A proxy that cannot be evaluated, or a dual question about several, is never a reason to hide.
#[test]
fn what_cannot_be_evaluated_is_visible() {
    let mut queries = SoftwareQueries::new();
    let view = pixel_view(32, 32);
    draw(&mut queries, &view, &[]);
    let whole = PixelRect { x0: 0, y0: 0, x1: 32, y1: 32 };
    let mut broken = flat(whole, 0.5);
    broken.edges[0] = [f32::INFINITY, f32::NAN, 0.0];
    queries.ask(Ticket(1), &[broken], Want::Any).expect("ask");
    queries.ask(Ticket(2), &[broken], Want::Dual).expect("ask");
    queries.ask(Ticket(3), &[flat(whole, 0.5); 2], Want::Dual).expect("ask");
    queries.ask(Ticket(4), &[], Want::Dual).expect("ask");
    let mut count = 0;
    queries
        .answers(Wait::Block, |ticket, answer| {
            assert!(answer.is_visible(0), "{ticket:?}: {answer:?}");
            count += 1;
        })
        .expect("answers");
    assert_eq!(count, 4);
}

/// The proxies of real boxes, behind and before real triangles: the same counts as the plain loop,
/// and a box is never hidden by what lies inside it.
#[test]
fn boxes_are_not_hidden_by_their_own_triangles() {
    let mut dice = dice(77);
    let viewport = Viewport::new(320, 200);
    let view = View::look_at(Vec3::new(0.0, 2.0, 9.0), Vec3::ZERO, 60.0, 0.1, viewport).expect("a view");
    let mut asked = 0;
    for _ in 0..300 {
        let mut v =
            |r: f32| Vec3::new(dice.random_range(-r..r), dice.random_range(-r..r), dice.random_range(-r..r));
        let (at, size) = (v(5.0), v(1.0).abs());
        let all: Vec<[Vec3; 3]> = (0..40).map(|_| [v(1.0), v(1.0), v(1.0)].map(|p| at + p * size)).collect();
        let bounds = Aabb::from_points(all.iter().flatten().copied());
        let Question::Ask(proxy) = Question::new(&bounds, &view) else { continue };
        let mut queries = SoftwareQueries::new();
        draw(&mut queries, &view, &[soup(&all)]);
        let drawn: usize =
            (0..viewport.height).map(|y| queries.depth().row(y).filter(|&n| n > 0.0).count()).sum();
        compare(&mut queries, &[proxy]);
        let (visible, _) = plain(&proxy, &queries);
        assert!(visible as usize >= drawn, "{bounds:?} owns {drawn} samples, its proxy sees {visible}");
        asked += 1;
    }
    assert!(asked > 250, "only {asked} boxes were asked about");
}
