//! Forms hold what they say: random operations at random points, judged in double-double; and no rounding or remainder could be
//! left out.

use super::Form;
use crate::math::hash::KeyedHash;
use crate::math::{Dd, Real, Single};

/// Relative error that results in double-double may have: 2^-98, far below a unit of roundoff.
const FINE: f64 = 1.0 / (1u64 << 49) as f64 / (1u64 << 49) as f64;

struct Draw {
    key: KeyedHash,
    n: u64,
}

impl Draw {
    fn unit(&mut self) -> f64 {
        self.n += 1;
        self.key.with(self.n).unit()
    }
    /// From −1 to 1; often one of both, or 0.
    fn signed(&mut self) -> f64 {
        match (self.unit() * 8.0) as u32 {
            0 => -1.0,
            1 => 1.0,
            2 => 0.0,
            _ => self.unit() * 2.0 - 1.0,
        }
    }
    /// Of a random power of two, often 0.
    fn size(&mut self, largest: i32, smallest: i32) -> f64 {
        if self.unit() < 0.2 {
            return 0.0;
        }
        let k = smallest + (self.unit() * (largest - smallest) as f64) as i32;
        self.signed() * f64::from_bits(((1023 + k) as u64) << 52)
    }
    fn form<const M: u8>(&mut self) -> Form<M> {
        if self.unit() < 0.05 {
            // Products of these underflow.
            let [c, x, y, r] = [(); 4].map(|_| self.size(-500, -1022));
            return Form { c, x, y, r: r.abs() };
        }
        let c = self.size(6, -6);
        let near = if self.unit() < 0.5 { 0 } else { -30 };
        Form {
            c,
            x: self.size(near, near - 30),
            y: self.size(near, near - 30),
            r: self.size(near - 1, near - 40).abs(),
        }
    }
}

/// A value that the form holds at (ξ, η), exactly enough.
fn value<const M: u8>(f: Form<M>, at: [f64; 2], within: f64) -> Dd {
    let [x, y] = at.map(Dd::new);
    Dd::new(f.c) + Dd::new(f.x) * x + Dd::new(f.y) * y + Dd::new(f.r) * Dd::new(within)
}

/// Whether the form holds the value there, which was computed from numbers up to `size`.
fn holds<const M: u8>(f: Form<M>, at: [f64; 2], v: Dd, size: f64) -> bool {
    if !f.is_known() {
        return true;
    }
    let off = v - value(Form::<M> { r: 0.0, ..f }, at, 0.0);
    let slack = FINE * (f.c.abs() + f.x.abs() + f.y.abs() + v.hi.abs() + size);
    Real::abs(off - Dd::new(0.0)).hi <= f.r + slack
}

const OPERATIONS: u64 = 14;

/// Tries one random operation; whether its result holds what exact arithmetic gives.
fn tried<const M: u8>(case: u64) -> bool {
    let mut d = Draw { key: KeyedHash::new().with(case), n: 0 };
    let (mut a, mut b): (Form<M>, Form<M>) = (d.form(), d.form());
    let mut at = [d.signed(), d.signed()];
    let zero = Dd::new(0.0);
    let op = case % OPERATIONS;
    if op == 11 || op == 13 {
        // A cosine.
        let shrink = 1.0 / (1.0 + a.c.abs() + a.x.abs() + a.y.abs() + a.r);
        a = Form { c: a.c.abs() * shrink, x: a.x * shrink, y: a.y * shrink, r: a.r * shrink };
    }
    if op == 8 && d.unit() < 0.5 {
        // Hardly below 0, at its upper end: there is little but rounding.
        let sum = a.x.abs() + a.y.abs() + a.r;
        a.c = sum - sum * d.size(-12, -40).abs();
        at = [a.x.signum(), a.y.signum()];
    }
    if op == 12 && d.unit() < 0.5 {
        // All but the same.
        b = Form { c: a.c.next_up(), ..a };
    }
    let (u, v) = (value(a, at, d.signed()), value(b, at, d.signed()));
    let largest = |x: Dd| if x.lt(zero).0 { zero } else { x };
    let (form, exact) = match op {
        0 => (a + b, u + v),
        1 => (a - b, u - v),
        2 => (a * b, u * v),
        3 => (a.mul_add(b, a), u * v + u),
        4 => (a / b, u / v),
        5 => (a.reciprocal(), Dd::new(1.0) / u),
        6 if u.hi < 0.0 => return true,
        6 => (a.sqrt(), u.sqrt()),
        7 if u.hi <= 0.0 => return true,
        7 => (a.reciprocal_root(), Dd::new(1.0) / u.sqrt()),
        8 => (a.positive_part(), largest(u)),
        9 => (a.max(b), if u.lt(v).0 { v } else { u }),
        10 => (Real::abs(a), Real::abs(u)),
        11 => {
            let n = [1.0, 2.0, 5.0, 20.0, 200.0][(d.unit() * 5.0) as usize];
            let mut p = Dd::new(1.0);
            for _ in 0..n as u32 {
                p = p * largest(u);
            }
            (a.power(n), p)
        }
        12 => (a.hull(b), if d.unit() < 0.5 { u } else { v }),
        _ => (a.arcsine(), arcsine(u)),
    };
    let within = exact.hi >= form.lo() && exact.hi <= form.hi();
    !exact.hi.is_finite() || (holds(form, at, exact, (1.0 + a.magnitude()) * (1.0 + b.magnitude())) && within)
}

/// Newton's step from what the library gives, its sine and cosine by their series around multiples of 1/8.
fn arcsine(x: Dd) -> Dd {
    let near = Dd::new(super::super::fun::asin(x.hi));
    let (mut sine, mut cosine) = (Dd::new(0.0), Dd::new(0.0));
    let mut term = Dd::new(1.0);
    for k in 0..40u32 {
        match k % 4 {
            0 => cosine = cosine + term,
            1 => sine = sine + term,
            2 => cosine = cosine - term,
            _ => sine = sine - term,
        }
        term = term * near / Dd::new((k + 1) as f64);
    }
    near + (x - sine) / cosine
}

fn violations<const M: u8>(cases: std::ops::Range<u64>) -> usize {
    cases.filter(|&i| !tried::<M>(i)).count()
}

#[test]
fn forms_hold_what_exact_arithmetic_gives() {
    assert_eq!(violations::<0>(0..400_000), 0);
}

#[test]
#[ignore = "millions of cases"]
fn forms_hold_what_exact_arithmetic_gives_in_millions_of_cases() {
    assert_eq!(violations::<0>(0..20_000_000), 0);
}

#[test]
fn no_rounding_and_no_remainder_could_be_left_out() {
    macro_rules! mutants {
        ($($m:literal)*) => {{
            $(assert_ne!(violations::<$m>(0..100_000), 0, "mutant {} goes unnoticed", $m);)*
            [$($m),*].len() as u8
        }};
    }
    assert_eq!(mutants!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18), Form::<0>::MUTANTS);
}

#[test]
fn comparisons_are_certain_only_where_they_are() {
    let f = Form::<0> { c: 1.0, x: 0.5, y: 0.0, r: 0.25 };
    let (one, two) = (Form::constant(1.0), Form::constant(2.0));
    assert!(f.lt(two).certain && f.le(one).possible && !f.le(one).certain && !two.lt(f).possible);
    assert!(one.same(Form::constant(1.0)).certain && !f.same(f).certain, "nothing says that it is twice the same");
    assert!(f.lt(f + one).certain, "what varies together is told apart");
    assert!(!Form::<0>::ALL.lt(one).certain && Form::<0>::ALL.lt(one).possible);
    assert_eq!(Single::magnitude(one), 1.0);
}

#[test]
fn nothing_is_made_of_what_is_unknown() {
    let unknown = Form::<0>::ALL;
    let f = Form::<0> { c: 1.0, x: 2.0, y: 0.0, r: 0.0 };
    let made = [unknown + f, unknown * f, f.reciprocal(), unknown.sqrt(), unknown.reciprocal_root(), unknown.hull(f)];
    assert!(made.iter().all(|f| !f.is_known()), "{made:?}");
    let huge = Form::<0> { c: 1e300, x: 1e300, y: 0.0, r: 0.0 };
    assert!(!(huge * huge).is_known());
}
