//! First-order forms: what a formula gives all over a small region of the picture, to first order exactly and with a bound on
//! the rest.
//!
//! A region has coordinates ξ and η from −1 to 1, and a quantity over it is c + xξ + yη ± r (affine arithmetic with two symbols:
//! Comba, Stolfi, SIBGRAPI 1993; de Figueiredo, Stolfi, *Self-Validated Numerical Methods*, 1997). What plain intervals
//! lose, that neighbouring quantities rise and fall together, is kept in x and y. The linear part has a known mean, so of a
//! region's mean only r is uncertain, and that is of second order in the region's size.
//!
//! Sound in machine numbers: every rounding of c, x and y is charged to r, and r itself is rounded upwards. The claim is
//! about exact arithmetic, not about what `f64` makes of the same formula.

mod real;
#[cfg(test)]
mod tests;

/// c + xξ + yη ± r for every ξ and η from −1 to 1; r is infinite where nothing is known.
///
/// Where the quantity isn't defined (the root of what is negative) or the caller has excluded a part of the region, the claim
/// is about the rest.
///
/// `MUTANT` is 0. Any other number up to [`MUTANTS`](Form::MUTANTS) leaves out the rounding of one operation, or halves its
/// remainder: to show that tests notice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Form<const MUTANT: u8 = 0> {
    /// Value in the middle.
    pub c: f64,
    /// Change from the middle to ξ = 1.
    pub x: f64,
    /// Change from the middle to η = 1.
    pub y: f64,
    /// How far the quantity may be off that, anywhere.
    pub r: f64,
}

/// Operations, as mutants count them: 2·op − 1 leaves out the rounding, 2·op halves the remainder.
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const RECIPROCAL: u8 = 3;
const ROOT: u8 = 4;
const RECIPROCAL_ROOT: u8 = 5;
const POWER: u8 = 6;
const KINK: u8 = 7;
const HULL: u8 = 8;
const ARCSINE: u8 = 9;

/// Unit roundoff.
const U: f64 = f64::EPSILON / 2.0;

/// More than underflow can lose in all steps of one operation: each loses 2^-1075 at most.
const UNDERFLOW: f64 = f64::MIN_POSITIVE;

impl<const MUTANT: u8> Form<MUTANT> {
    /// How many mutants there are.
    pub const MUTANTS: u8 = 2 * ARCSINE;
    /// Nothing is known.
    pub const ALL: Self = Form { c: 0.0, x: 0.0, y: 0.0, r: f64::INFINITY };

    /// The same everywhere, exactly.
    pub const fn constant(c: f64) -> Self {
        Form { c, x: 0.0, y: 0.0, r: 0.0 }
    }

    /// Anything from `lo` to `hi`.
    pub fn between(lo: f64, hi: f64) -> Self {
        if lo == hi {
            return Self::constant(lo);
        }
        let c = 0.5 * lo + 0.5 * hi;
        // The larger of both ways, each rounded once.
        let (down, up) = (c - lo, hi - c);
        Self::made(HULL, [c, 0.0, 0.0], if down > up { down } else { up }, c.abs() + up.abs())
    }

    /// Whether anything is known.
    pub fn is_known(self) -> bool {
        self.r < f64::INFINITY
    }

    /// Whether it is one number.
    fn is_constant(self) -> bool {
        self.x == 0.0 && self.y == 0.0 && self.r == 0.0
    }

    /// How far values may be from c, rounded upwards.
    #[inline]
    pub fn radius(self) -> f64 {
        let sum = self.x.abs() + self.y.abs() + self.r;
        if sum == 0.0 { 0.0 } else { sum * (1.0 + 4.0 * U) + UNDERFLOW }
    }

    /// No value is below.
    #[inline]
    pub fn lo(self) -> f64 {
        let radius = self.radius();
        if radius == 0.0 { self.c } else { (self.c - radius).next_down() }
    }

    /// No value is above.
    #[inline]
    pub fn hi(self) -> f64 {
        let radius = self.radius();
        if radius == 0.0 { self.c } else { (self.c + radius).next_up() }
    }

    /// The same with another `r` added, at least 0.
    pub fn widened(self, by: f64) -> Self {
        if by == 0.0 { self } else { Self::made(SUM, [self.c, self.x, self.y], self.r + by, 0.0) }
    }

    /// What an operation gives: its linear part, what may be missing, and the sum of the magnitudes that were rounded, each
    /// as often as it was. All sums here have less than 16 terms, which the last factor covers.
    #[inline(always)]
    fn made(op: u8, [c, x, y]: [f64; 3], remainder: f64, rounded: f64) -> Self {
        let remainder = if MUTANT == 2 * op { 0.5 * remainder } else { remainder };
        let rounded = if MUTANT == 2 * op - 1 { 0.0 } else { rounded };
        // Nothing but sums is known to be exact here: what else seems to be 0 may have underflowed.
        if op == SUM && remainder == 0.0 && rounded == 0.0 {
            return Form { c, x, y, r: 0.0 };
        }
        let r = (remainder + U * rounded) * (1.0 + 32.0 * U) + UNDERFLOW;
        // An infinite or undefined coefficient is in `rounded` too, but for constants that were given so.
        if r < f64::INFINITY && (c + x + y).is_finite() { Form { c, x, y, r } } else { Self::ALL }
    }

    /// slope·self + something between `low` and `high`, which were themselves off by up to `rounded` units of roundoff.
    #[inline(always)]
    fn line(self, op: u8, slope: f64, (low, high): (f64, f64), rounded: f64) -> Self {
        let middle = 0.5 * low + 0.5 * high;
        let [p, x, y] = [slope * self.c, slope * self.x, slope * self.y];
        let spread = 0.5 * (high - low);
        let rounded = rounded + 3.0 * (low.abs() + high.abs()) + 2.0 * (p.abs() + x.abs() + y.abs());
        Self::made(op, [p + middle, x, y], slope.abs() * self.r + if spread > 0.0 { spread } else { 0.0 }, rounded)
    }

    /// 1/self. Nothing is known where 0 may be among the values.
    ///
    /// The line through both ends of 1/x lies above it; below, the parallel that touches: 1/x − mx is least, 2√−m, where its
    /// slope is 0, whatever negative m is taken.
    pub fn reciprocal(self) -> Self {
        let (lo, hi) = (self.lo(), self.hi());
        if hi < 0.0 {
            return -(-self).reciprocal();
        }
        if !(lo > 0.0 && hi < f64::INFINITY) {
            return Self::ALL;
        }
        let m = -1.0 / (lo * hi);
        let (a, b) = (1.0 / lo - m * lo, 1.0 / hi - m * hi);
        let (low, high) = (2.0 * (-m).sqrt(), if a > b { a } else { b });
        self.line(RECIPROCAL, m, (low, high), 3.0 * (low + high))
    }

    /// √self, of the values between `lo` and `hi` that aren't negative: what the caller knows of the part that counts.
    ///
    /// The line through both ends of √x lies below it; above, the parallel that touches: √x − mx is at most 1/(4m).
    pub fn root_within(self, lo: f64, hi: f64) -> Self {
        let (own_lo, own_hi) = (self.lo(), self.hi());
        let lo = if own_lo > lo { own_lo } else { lo };
        let hi = if own_hi < hi { own_hi } else { hi };
        let lo = if lo > 0.0 { lo } else { 0.0 };
        if !(hi > 0.0) {
            return Self::constant(0.0);
        }
        if hi == f64::INFINITY {
            return Self::ALL;
        }
        let (a, b) = (lo.sqrt(), hi.sqrt());
        let m = 1.0 / (a + b);
        let (at_lo, at_hi) = (a - m * lo, b - m * hi);
        self.line(ROOT, m, (if at_lo < at_hi { at_lo } else { at_hi }, 0.25 / m), 4.0 * (a + b))
    }

    /// 1/√self: tangent in the middle, and Taylor's remainder by the second derivative ¾x^(−5/2), which is largest at the lower
    /// end. Nothing is known where values may be 0 or less.
    pub fn reciprocal_root(self) -> Self {
        let lo = self.lo();
        if !(lo > 0.0 && self.is_known()) {
            return Self::ALL;
        }
        let f = 1.0 / self.c.sqrt();
        let m = -0.5 * f / self.c;
        let radius = self.radius();
        let most = 0.375 * radius * radius / (lo * lo * lo.sqrt());
        let base = f - m * self.c;
        self.line(RECIPROCAL_ROOT, m, (base, base + most), 6.0 * (base + most) + 9.0 * most)
    }

    /// A share: self between 0 and 1, and beyond them the nearer; anything between, where nothing is known.
    pub fn share(self) -> Self {
        let one = Form::constant(1.0);
        if self.is_known() { one - (one - self.positive_part()).positive_part() } else { Form::between(0.0, 1.0) }
    }

    /// The larger of self and 0: the line through both ends lies above the kink, and its parallel through 0 below.
    pub fn positive_part(self) -> Self {
        let (lo, hi) = (self.lo(), self.hi());
        if lo >= 0.0 {
            return self;
        }
        if hi <= 0.0 {
            return Self::constant(0.0);
        }
        if !self.is_known() {
            return Self::ALL;
        }
        let m = hi / (hi - lo);
        let (a, b) = (-m * lo, hi - m * hi);
        // Rounding of m may change what is left at the upper end by more than it is itself.
        self.line(KINK, m, (0.0, if a > b { a } else { b }), 4.0 * (hi * m - lo * m))
    }

    /// The larger of self and 0, to the power `n` ≥ 0; self isn't above 1.
    ///
    /// For n ≥ 2 the tangent in the middle and Taylor's remainder by the second derivative, n(n − 1)x^(n−2), which is largest at
    /// the upper end; else, and where that is wider, all that lies between both ends.
    pub fn power(self, n: f64) -> Self {
        if !self.is_known() {
            return Self::between(0.0, 1.0);
        }
        let clamped = |x: f64| x.clamp(0.0, 1.0);
        let (lo, hi) = (clamped(self.lo()), clamped(self.hi()));
        // By how much powers may be off, relatively: squaring makes n roundings of one, the library's function stays below 2.
        let off = 2.0 * n + 8.0;
        let (low, high) = (raised(lo, n), raised(hi, n));
        let flat = Form::constant(0.0).line(POWER, 0.0, (low, high), off * (low + high));
        if n < 2.0 || !(hi > 0.0) {
            return flat;
        }
        let c = clamped(self.c);
        let steep = raised(c, n - 2.0);
        let (f, m) = (steep * c * c, n * steep * c);
        let reach = self.radius() + (self.c - c).abs();
        let most = 0.5 * n * (n - 1.0) * raised(hi, n - 2.0) * reach * reach;
        let base = f - m * c;
        let curved = self.line(POWER, m, (base, base + most), off * (f + 4.0 * m * (c + reach) + 2.0 * most));
        if curved.r < flat.r { curved } else { flat }
    }

    /// arcsin self, by its tangent in the middle and Taylor's remainder: the second derivative, x/(1 − x²)^(3/2), grows with x.
    /// Nothing is known where values may reach ±1.
    pub fn arcsine(self) -> Self {
        let (lo, hi) = (self.lo(), self.hi());
        if !(lo > -1.0 && hi < 1.0) {
            return Self::ALL;
        }
        let cosine = |x: f64| ((1.0 - x) * (1.0 + x)).sqrt();
        let bend = |x: f64| {
            let k = cosine(x);
            0.5 * x / (k * k * k)
        };
        let (f, m) = (super::fun::asin(self.c), 1.0 / cosine(self.c));
        let square = self.radius() * self.radius();
        let (least, most) = (bend(lo) * square, bend(hi) * square);
        let (least, most) = (if least < 0.0 { least } else { 0.0 }, if most > 0.0 { most } else { 0.0 });
        let base = f - m * self.c;
        // The function's last bit, and that of the slope all the way to the ends.
        let rounded = 2.0 * f.abs() + 6.0 * m * (self.c.abs() + self.radius()) + 12.0 * (most - least);
        self.line(ARCSINE, m, (base + least, base + most), rounded)
    }

    /// One that holds both.
    pub fn hull(self, o: Self) -> Self {
        if self == o {
            return self;
        }
        let mid = |a: f64, b: f64| 0.5 * a + 0.5 * b;
        let [c, x, y] = [mid(self.c, o.c), mid(self.x, o.x), mid(self.y, o.y)];
        let apart = 0.5 * ((self.c - o.c).abs() + (self.x - o.x).abs() + (self.y - o.y).abs());
        let sizes = c.abs() + x.abs() + y.abs() + 4.0 * apart;
        Self::made(HULL, [c, x, y], apart + if self.r > o.r { self.r } else { o.r }, sizes)
    }
}

/// x^n for x from 0 to 1; whole exponents by squaring.
fn raised(x: f64, n: f64) -> f64 {
    if n.fract() != 0.0 || !(0.0..=4096.0).contains(&n) {
        return if x > 0.0 || n == 0.0 { super::fun::pow(x, n) } else { 0.0 };
    }
    let (mut k, mut square, mut product) = (n as u32, x, 1.0);
    while k > 0 {
        if k & 1 == 1 {
            product *= square;
        }
        square *= square;
        k >>= 1;
    }
    product
}
