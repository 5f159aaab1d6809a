//! Each operation at each level that the machine has, against the plain arrays: on random numbers
//! and on those that instructions are known to differ by.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::super::isa::{Isa, LANES, Mask, Portable, TABLE};
use super::super::level::SimdLevel;
use super::x86::{Avx2, Avx512, Sse41};

const INTEGERS: [i32; 10] =
    [0, 1, -1, i32::MAX, i32::MIN, i32::MIN + 1, 0x7FFF, -0x8000, 0x0100_0001, -0x0100_0003];
const FLOATS: [f32; 18] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    // Below the least normal number.
    1e-45,
    -1e-45,
    1e-40,
    f32::MAX,
    f32::MIN,
    f32::EPSILON,
    16_777_216.0,
    0.1,
    -12_582_912.5,
];

fn integers(dice: &mut ChaCha8Rng) -> [i32; LANES] {
    std::array::from_fn(|_| match dice.random_range(0..3) {
        0 => INTEGERS[dice.random_range(0..INTEGERS.len())],
        1 => dice.random_range(-9..9),
        _ => dice.random(),
    })
}

fn floats(dice: &mut ChaCha8Rng) -> [f32; LANES] {
    std::array::from_fn(|_| match dice.random_range(0..3) {
        0 => FLOATS[dice.random_range(0..FLOATS.len())],
        1 => dice.random_range(-2.0..2.0),
        _ => f32::from_bits(dice.random()),
    })
}

/// Equal to the bit, but that one NaN is as good as another.
fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}

/// What differs between a level and the plain arrays on one set of input, by name.
fn differences<I: Isa>(dice: &mut ChaCha8Rng) -> Vec<&'static str> {
    type P = Portable;
    let (a, b, x, y) = (integers(dice), integers(dice), floats(dice), floats(dice));
    let mask: Mask = dice.random_range(0..1 << LANES);
    let (ia, ib, fx, fy) = (I::load(&a), I::load(&b), I::load_f(&x), I::load_f(&y));
    let bytes: [u8; LANES] = std::array::from_fn(|_| dice.random());
    let table: [i32; TABLE] = std::array::from_fn(|_| dice.random());
    let table_f = table.map(|bits| f32::from_bits(bits as u32));
    let (small, small_f): ([i32; LANES], [f32; LANES]) =
        (std::array::from_fn(|i| table[i]), std::array::from_fn(|i| table_f[i]));
    let at: [i32; LANES] = std::array::from_fn(|_| dice.random_range(0..TABLE as i32));
    let near = at.map(|i| i % LANES as i32);
    let mut found = Vec::new();

    for (name, got, want) in [
        ("splat", I::splat(a[0]), P::splat(a[0])),
        ("widen", I::widen(&bytes), P::widen(&bytes)),
        ("look_up", I::look_up(&table, I::load(&at)), P::look_up(&table, at)),
        ("pick", I::pick(&small, I::load(&near)), P::pick(&small, near)),
        ("add", I::add(ia, ib), P::add(a, b)),
        ("sub", I::sub(ia, ib), P::sub(a, b)),
        ("mul", I::mul(ia, ib), P::mul(a, b)),
        ("min", I::min(ia, ib), P::min(a, b)),
        ("max", I::max(ia, ib), P::max(a, b)),
        ("and", I::and(ia, ib), P::and(a, b)),
        ("or", I::or(ia, ib), P::or(a, b)),
        ("shift_left 1", I::shift_left::<1>(ia), P::shift_left::<1>(a)),
        ("shift_left 31", I::shift_left::<31>(ia), P::shift_left::<31>(a)),
        ("shift_right 1", I::shift_right::<1>(ia), P::shift_right::<1>(a)),
        ("shift_right 31", I::shift_right::<31>(ia), P::shift_right::<31>(a)),
        ("blend", I::blend(mask, ia, ib), P::blend(mask, a, b)),
        ("bits", I::bits(fx), P::bits(x)),
    ] {
        if I::store(got) != want {
            found.push(name);
        }
    }
    let compressed = (I::store(I::compress(mask, ia)), P::compress(mask, a));
    let count = mask.count_ones() as usize;
    if compressed.0[..count] != compressed.1[..count] {
        found.push("compress");
    }

    for (name, got, want) in [
        ("splat_f", I::splat_f(x[0]), P::splat_f(x[0])),
        ("look_up_f", I::look_up_f(&table_f, I::load(&at)), P::look_up_f(&table_f, at)),
        ("pick_f", I::pick_f(&small_f, I::load(&near)), P::pick_f(&small_f, near)),
        ("to_f", I::to_f(ia), P::to_f(a)),
        ("add_f", I::add_f(fx, fy), P::add_f(x, y)),
        ("sub_f", I::sub_f(fx, fy), P::sub_f(x, y)),
        ("mul_f", I::mul_f(fx, fy), P::mul_f(x, y)),
        ("div_f", I::div_f(fx, fy), P::div_f(x, y)),
        ("min_f", I::min_f(fx, fy), P::min_f(x, y)),
        ("max_f", I::max_f(fx, fy), P::max_f(x, y)),
        ("blend_f", I::blend_f(mask, fx, fy), P::blend_f(mask, x, y)),
    ] {
        if !I::store_f(got).iter().zip(&want).all(|(&a, &b)| same(a, b)) {
            found.push(name);
        }
    }

    for (name, got, want) in [
        ("gt", I::gt(ia, ib), P::gt(a, b)),
        ("gt_f", I::gt_f(fx, fy), P::gt_f(x, y)),
        ("ge_f", I::ge_f(fx, fy), P::ge_f(x, y)),
    ] {
        if got != want {
            found.push(name);
        }
    }

    // Of numbers: which of two zeros is less, and what a NaN is, nobody says.
    let runs: [[f32; LANES]; LANES] =
        std::array::from_fn(|_| floats(dice).map(|v| if v.is_nan() { 0.5 } else { v }));
    if I::store_f(I::least(&runs)) != P::least(&runs) {
        found.push("least");
    }
    if I::store_f(I::greatest(&runs)) != P::greatest(&runs) {
        found.push("greatest");
    }
    found
}

fn compare<I: Isa>(level: SimdLevel) {
    if level > SimdLevel::detect() {
        return;
    }
    let mut dice = ChaCha8Rng::seed_from_u64(1);
    for round in 0..3000 {
        let found = differences::<I>(&mut dice);
        assert!(found.is_empty(), "{level:?}, round {round}: {found:?}");
    }
}

#[test]
fn every_operation_means_the_same_at_every_level() {
    compare::<Sse41>(SimdLevel::Sse41);
    compare::<Avx2>(SimdLevel::Avx2);
    compare::<Avx512>(SimdLevel::Avx512);
}
