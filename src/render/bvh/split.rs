//! Parts items in two where that makes rays meet least: the surface area heuristic, over bins.

use super::build::around;
use super::node::Box4;

/// With what else a primitive may share a leaf.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Company {
    /// Nothing.
    Alone,
    /// Other triangles: several are tested as fast as their box.
    Triangles,
    /// Other balls, whose boxes are told by them.
    Balls,
}

/// A primitive to be sorted into the tree: its box, its number in the bits of the fourth lower coordinate, and its company in those
/// of the upper, so that all fill two registers.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct Item {
    /// The box; its fourth coordinates aren't coordinates.
    pub bounds: Box4,
}

impl Item {
    /// Primitive `id` with its box.
    pub fn new(id: u32, mut bounds: Box4, company: Company) -> Item {
        (bounds.lo[3], bounds.hi[3]) = (f32::from_bits(id), f32::from_bits(company as u32));
        Item { bounds }
    }
    /// With what it may share a leaf.
    pub fn is_of(&self, company: Company) -> bool {
        self.bounds.hi[3].to_bits() == company as u32
    }
    /// The primitive's number.
    pub fn id(&self) -> u32 {
        self.bounds.lo[3].to_bits()
    }
    /// The middle of the box, doubled.
    #[inline(always)]
    pub fn centre(&self) -> [f32; 4] {
        let (lo, hi) = (self.bounds.lo, self.bounds.hi);
        [lo[0] + hi[0], lo[1] + hi[1], lo[2] + hi[2], 0.0]
    }
}

/// Items that follow one another.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// The first one's place among all.
    pub first: usize,
    /// How many.
    pub count: usize,
    /// Around them.
    pub bounds: Box4,
    /// Around their centres, doubled.
    pub centres: Box4,
    /// Half the surface of `bounds`.
    pub area: f32,
}

impl Part {
    /// All of `items`, which begin at place `first`.
    pub fn over(items: &[Item], first: usize) -> Part {
        let (bounds, centres) = around(items);
        Part::new(first, items.len(), bounds, centres)
    }

    fn new(first: usize, count: usize, bounds: Box4, centres: Box4) -> Part {
        Part { first, count, bounds, centres, area: half_area(&bounds, 1.0) }
    }
}

/// Half the surface, of sides multiplied by `unit`.
#[inline(always)]
fn half_area(b: &Box4, unit: f32) -> f32 {
    let [x, y, z] = b.extent().map(|e| e * unit);
    x * y + y * z + z * x
}

/// Bins a split is chosen from: more change the tree little (Wald 2007, section 3).
const BINS: usize = 16;
/// The same of few items.
const FEW_BINS: usize = 8;
/// How many are few.
const FEW: usize = 32;

/// Maps centres to bins: x to ⌊(x − lo)·scale⌋, by adding a number so large that the sum has no room for a fraction.
#[derive(Clone, Copy)]
struct Bins<const BINS: usize> {
    lo: [f32; 4],
    scale: [f32; 4],
}

/// From 2^23 on, numbers of `f32` are whole.
const WHOLE: f32 = (1 << 23) as f32;

impl<const BINS: usize> Bins<BINS> {
    /// The last bin's upper end, less what rounding could add; half a bin down, for the sum rounds to the nearest.
    const SPAN: f32 = BINS as f32 - 1.0;

    fn new(centres: &Box4) -> Bins<BINS> {
        let mut bins = Bins { lo: [0.0; 4], scale: [0.0; 4] };
        for i in 0..3 {
            let extent = centres.hi[i] - centres.lo[i];
            let scale = Self::SPAN / extent;
            if extent > 0.0 && extent.is_finite() && scale.is_finite() {
                (bins.lo[i], bins.scale[i]) = (centres.lo[i], scale);
            }
        }
        bins
    }

    #[inline(always)]
    fn of(&self, centre: [f32; 4]) -> [usize; 4] {
        let mut k = [0; 4];
        for i in 0..4 {
            k[i] = ((centre[i] - self.lo[i]) * self.scale[i] + WHOLE).to_bits() as usize & (BINS - 1);
        }
        k
    }
}

/// Parts `items`, at least two, by the cheapest of the binned planes, or halves them where no plane parts them. Up to `most` cost as
/// much as one: so leaves get full.
pub fn split(items: &mut [Item], part: &Part, most: usize) -> (Part, Part) {
    match items.len() <= FEW {
        true => split_over::<FEW_BINS>(items, part, most as u32),
        false => split_over::<BINS>(items, part, most as u32),
    }
}

fn split_over<const BINS: usize>(items: &mut [Item], part: &Part, most: u32) -> (Part, Part) {
    let bins = Bins::<BINS>::new(&part.centres);
    let mut boxes = [[Box4::EMPTY; BINS]; 3];
    let mut counts = [[0u32; BINS]; 3];
    for item in items.iter() {
        let k = bins.of(item.centre());
        for axis in 0..3 {
            let bin = &mut boxes[axis][k[axis]];
            *bin = bin.union(item.bounds);
            counts[axis][k[axis]] += 1;
        }
    }
    // Areas of tiny boxes would vanish.
    let unit = 1.0 / part.bounds.extent().into_iter().fold(f32::MIN_POSITIVE, |a, b| if b > a { b } else { a });
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in (0..3).filter(|&a| bins.scale[a] > 0.0) {
        let (boxes, counts) = (&boxes[axis], &counts[axis]);
        let mut right = [0.0; BINS];
        let (mut b, mut n) = (Box4::EMPTY, 0);
        for k in (1..BINS).rev() {
            (b, n) = (b.union(boxes[k]), n + counts[k]);
            right[k] = if n > 0 { half_area(&b, unit) * n.div_ceil(most) as f32 } else { f32::INFINITY };
        }
        let (mut b, mut n) = (Box4::EMPTY, 0);
        for k in 1..BINS {
            (b, n) = (b.union(boxes[k - 1]), n + counts[k - 1]);
            let cost = half_area(&b, unit) * n.div_ceil(most) as f32 + right[k];
            if n > 0 && cost < f32::INFINITY && best.is_none_or(|x| cost < x.0) {
                best = Some((cost, axis, k));
            }
        }
    }
    let Some((_, axis, plane)) = best else { return halve(items, part) };
    let around = |range: std::ops::Range<usize>| boxes[axis][range].iter().fold(Box4::EMPTY, |b, x| b.union(*x));
    let (left, right) = (around(0..plane), around(plane..BINS));
    // In place, from both ends.
    let (mut centres, mut other) = (Box4::EMPTY, Box4::EMPTY);
    let (mut i, mut end) = (0, items.len());
    while i < end {
        let centre = items[i].centre();
        let point = Box4 { lo: centre, hi: centre };
        if bins.of(centre)[axis] < plane {
            centres = centres.union(point);
            i += 1;
        } else {
            other = other.union(point);
            end -= 1;
            items.swap(i, end);
        }
    }
    (Part::new(part.first, i, left, centres), Part::new(part.first + i, part.count - i, right, other))
}

/// Parts the items at the median along the longest axis of their centres.
pub fn halve(items: &mut [Item], part: &Part) -> (Part, Part) {
    let extent = part.centres.extent();
    let axis = (1..3).fold(0, |best, i| if extent[i] > extent[best] { i } else { best });
    let middle = items.len() / 2;
    if middle > 0 {
        // By number where centres coincide: which half an item falls into is then no accident.
        let key = |i: &Item| i.centre()[axis];
        items.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.id().cmp(&b.id())));
    }
    let (a, b) = items.split_at(middle);
    (Part::over(a, part.first), Part::over(b, part.first + middle))
}
