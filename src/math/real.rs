//! One formula, many scalars. A kernel is written once over [`Real`] and instantiated for each scalar it is needed in;
//! [`Lane`] adds what a ray batch needs on top: loading, storing and compressing several values at a time.
//!
//! Comparisons give a [`Mask`] and branches are written as [`Real::select`], so that the same text serves one value or
//! several. Only operations that IEEE 754 rounds correctly appear here, so every instance of one precision gives the
//! same bits on every machine.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// The stored form of a scalar: `f64` or `f32`.
pub trait Elem: Copy + PartialOrd + Default + Send + Sync + 'static {
    /// Half an ulp of 1: the largest relative error of one rounded operation.
    const UNIT_ROUNDOFF: f64;
    /// The value as `f64`, exactly.
    fn to_f64(self) -> f64;
    /// The nearest value of this type.
    fn from_f64(x: f64) -> Self;
}

/// The result of comparing [`Real`]s: a truth value for each lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// The same truth value in every lane.
    fn splat(value: bool) -> Self;
    /// True in the lanes whose bit is set, lane 0 lowest.
    fn from_bits(bits: u32) -> Self;
    /// One bit a lane, lane 0 lowest.
    fn bits(self) -> u32;
    /// True in the first `n` lanes, at most 32.
    #[inline(always)]
    fn first(n: usize) -> Self {
        Self::from_bits(((1u64 << n) - 1) as u32)
    }
    /// Whether any lane is true.
    #[inline(always)]
    fn any(self) -> bool {
        self.bits() != 0
    }
}

/// A scalar that formulas are written in.
///
/// `mul_add` is always fused (one rounding). The binary operators round once each and are never contracted.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// What comparisons give.
    type Mask: Mask;
    /// One value of this kind alone, in which is computed what branches too much for masks: for lanes, `f64`.
    type Single: Single;
    /// A more exact scalar, for the few cases that hang on the last bits: of machine numbers, double-double.
    type Fine: Single;
    /// Half an ulp of 1 in this precision.
    const UNIT_ROUNDOFF: f64;
    /// The smallest positive normal number: nothing but "more than 0", whatever the scene's scale.
    const LEAST: f64;

    /// The constant `x`, rounded to this precision.
    fn splat(x: f64) -> Self;
    /// `self * b + c` with one rounding.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;
    /// The largest integer not above.
    fn floor(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// Magnitude of `self`, sign of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// `self < o`; false for NaN.
    fn lt(self, o: Self) -> Self::Mask;
    /// `self <= o`; false for NaN.
    fn le(self, o: Self) -> Self::Mask;
    /// `self == o`; false for NaN.
    fn same(self, o: Self) -> Self::Mask;
    /// `a` where `m`, else `b`.
    fn select(m: Self::Mask, a: Self, b: Self) -> Self;
    /// A function of N values that gives M, applied lane by lane to [`Single`](Real::Single) values: for elementary
    /// functions, look-ups in tables, and whatever branches too much to be written with masks.
    fn each<const N: usize, const M: usize>(
        v: [Self; N],
        f: impl FnMut([Self::Single; N]) -> [Self::Single; M],
    ) -> [Self; M];

    /// `f`, in a function of its own that is compiled for the instructions of this scalar. What is over lanes and isn't inlined
    /// into such a function would call every operation.
    #[inline(always)]
    fn vectorize<T>(f: impl FnOnce() -> T) -> T {
        f()
    }

    /// Does `task` with one number at a time, in a function that all lanes of a machine share, compiled for its fused
    /// multiply-add: for what is too large to be there once for each kind of lane.
    #[inline(always)]
    fn alone<T: Task>(task: T) -> T::Output {
        task.run()
    }

    /// `rough`, but what `f` makes of `given` in [`Fine`](Real::Fine) in the lanes of `doubt`. Scalars that are themselves more
    /// than a machine number keep `rough`.
    #[inline(always)]
    fn again<const N: usize, const M: usize>(
        doubt: Self::Mask,
        given: [Self; N],
        rough: [Self; M],
        f: impl FnMut([Self::Fine; N]) -> [Self::Fine; M],
    ) -> [Self; M] {
        let _ = (doubt, given, f);
        rough
    }

    /// `self + o` and its exact rounding error, 0 where the scalar isn't rounded to a machine number (Knuth's TwoSum; Ogita,
    /// Rump, Oishi, SIAM J. Sci. Comput. 26, 2005).
    #[inline(always)]
    fn two_sum(self, o: Self) -> (Self, Self) {
        let s = self + o;
        let back = s - self;
        (s, (self - (s - back)) + (o - back))
    }
    /// `self * o` and its exact rounding error, by a fused multiply-add (barring under- and overflow); 0 where the scalar
    /// isn't rounded to a machine number.
    #[inline(always)]
    fn two_prod(self, o: Self) -> (Self, Self) {
        let p = self * o;
        (p, self.mul_sub(o, p))
    }
    /// `self·b − c·d` to within 2 units of roundoff, so its sign is exact (Kahan; Jeannerod, Louvet, Muller, Math. Comp. 82,
    /// 2013).
    #[inline(always)]
    fn difference_of_products(self, b: Self, c: Self, d: Self) -> Self {
        let w = c * d;
        let e = (-c).mul_add(d, w);
        self.mul_sub(b, w) + e
    }

    /// Zero.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }
    /// One.
    #[inline(always)]
    fn one() -> Self {
        Self::splat(1.0)
    }
    /// [`each`](Real::each) of one value.
    #[inline(always)]
    fn map(self, mut f: impl FnMut(Self::Single) -> Self::Single) -> Self {
        Self::each([self], |[x]| [f(x)])[0]
    }
    /// `self * b - c` with one rounding.
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self.mul_add(b, -c)
    }
    /// The smaller; `o` when they compare equal or `self` is NaN.
    #[inline(always)]
    fn min(self, o: Self) -> Self {
        Self::select(self.lt(o), self, o)
    }
    /// The larger; `o` when they compare equal or `self` is NaN.
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Self::select(o.lt(self), self, o)
    }
}

/// Something to do; a trait and not a closure, for a closure within a function over lanes is another one for each of them.
pub trait Task {
    /// What comes of it.
    type Output;
    /// Does it; to be inlined.
    fn run(self) -> Self::Output;
}

/// A [`Real`] that holds one value: what branches is written for it.
pub trait Single: Real<Single = Self> {
    /// Its magnitude, or a bound on it, roughly: for choosing a power of two to scale by.
    fn magnitude(self) -> f64;

    /// The roots of a polynomial of degree 3 or 4, highest coefficient first, within −`span`..`span`, as enclosures: pairs of
    /// root and 1 for a root, 0 for none, the whole of 0..1 for what may be one. `None` for scalars that are numbers, whose
    /// roots are found by deciding comparisons.
    #[inline(always)]
    fn enclosed_roots(poly: &[Self], span: Self) -> Option<[(Self, Self); 4]> {
        let _ = (poly, span);
        None
    }
}

/// A [`Real`] that moves between registers and the arrays of a ray batch.
pub trait Lane: Real<Single = f64> {
    /// The stored form.
    type Elem: Elem;
    /// A register of up to eight `f32` of the same instructions: eight boxes of a tree are tested in it.
    type Boxes: Lane<Elem = f32>;
    /// One such number alone, on the same instructions.
    type One: Lane<Elem = Self::Elem>;
    /// How many values one `Lane` holds.
    const WIDTH: usize;

    /// The first [`WIDTH`](Lane::WIDTH) values of `src`, which must hold that many.
    fn load(src: &[Self::Elem]) -> Self;
    /// Writes [`WIDTH`](Lane::WIDTH) values to the front of `dst`.
    fn store(self, dst: &mut [Self::Elem]);
    /// Packs the lanes that `m` selects to the front of `dst`; lanes after them may be overwritten, so `dst` must hold
    /// [`WIDTH`](Lane::WIDTH) values.
    fn compress(self, m: Self::Mask, dst: &mut [Self::Elem]);
}

/// The mask of a single value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bool(pub bool);

impl BitAnd for Bool {
    type Output = Bool;
    #[inline(always)]
    fn bitand(self, o: Bool) -> Bool {
        Bool(self.0 & o.0)
    }
}
impl BitOr for Bool {
    type Output = Bool;
    #[inline(always)]
    fn bitor(self, o: Bool) -> Bool {
        Bool(self.0 | o.0)
    }
}
impl Not for Bool {
    type Output = Bool;
    #[inline(always)]
    fn not(self) -> Bool {
        Bool(!self.0)
    }
}
impl Mask for Bool {
    #[inline(always)]
    fn splat(value: bool) -> Bool {
        Bool(value)
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Bool {
        Bool(bits & 1 == 1)
    }
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0 as u32
    }
}

/// Bound on the relative error of `n` rounded operations in sequence: n·u / (1 − n·u) (Higham, *Accuracy and Stability
/// of Numerical Algorithms*, section 3.1).
pub const fn gamma(n: f64, unit_roundoff: f64) -> f64 {
    n * unit_roundoff / (1.0 - n * unit_roundoff)
}

/// The three values of an expression for i = 0, 1, 2: `three!(i => a[i] + b[i])`. A macro and not a function of a closure, so that
/// it is surely inlined: kernels are compiled for more instructions than what they call, and a closure that isn't inlined
/// would call every operation.
macro_rules! three {
    ($i:ident => $value:expr) => {
        [
            {
                let $i: usize = 0;
                $value
            },
            {
                let $i: usize = 1;
                $value
            },
            {
                let $i: usize = 2;
                $value
            },
        ]
    };
}
pub(crate) use three;

/// The expression for each of three values: `each3!(v, x => x.abs())`; see [`three`].
macro_rules! each3 {
    ($v:expr, $x:pat => $value:expr) => {{
        let [a, b, c] = $v;
        [
            {
                let $x = a;
                $value
            },
            {
                let $x = b;
                $value
            },
            {
                let $x = c;
                $value
            },
        ]
    }};
}
pub(crate) use each3;

/// Dot product of 3-vectors; fused, in a fixed order.
#[inline(always)]
pub fn dot<R: Real>(a: [R; 3], b: [R; 3]) -> R {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// `a + s·b` for 3-vectors.
#[inline(always)]
pub fn axpy<R: Real>(s: R, b: [R; 3], a: [R; 3]) -> [R; 3] {
    [s.mul_add(b[0], a[0]), s.mul_add(b[1], a[1]), s.mul_add(b[2], a[2])]
}

/// `s·a` for a 3-vector.
#[inline(always)]
pub fn scaled<R: Real>(s: R, a: [R; 3]) -> [R; 3] {
    [s * a[0], s * a[1], s * a[2]]
}

/// `a − b` for 3-vectors.
#[inline(always)]
pub fn minus<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// A constant 3-vector in every lane.
#[inline(always)]
pub fn splat3<R: Real>(v: [f64; 3]) -> [R; 3] {
    each3!(v, x => R::splat(x))
}

/// `a` where `m`, else `b`, for 3-vectors.
#[inline(always)]
pub fn select3<R: Real>(m: R::Mask, a: [R; 3], b: [R; 3]) -> [R; 3] {
    [R::select(m, a[0], b[0]), R::select(m, a[1], b[1]), R::select(m, a[2], b[2])]
}
