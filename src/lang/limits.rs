//! Budgets against runaway scenes. Every one ends in an ordinary error that names it.

/// How much a scene may use.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Bytes of one file: a hundred times the largest hand-written scene.
    pub file_bytes: usize,
    /// Files that import each other, one inside the other.
    pub import_depth: usize,
    /// Calls and turns of loops, all together: some seconds.
    pub steps: u64,
    /// Calls within calls.
    pub call_depth: usize,
    /// Expressions within expressions over all running calls; what keeps the stack ([`STACK_BYTES`]) from overflowing.
    pub nesting: usize,
    /// Values in one list.
    pub list_length: usize,
    /// Lists, records and functions that hold others: what keeps the stack from overflowing when a chain of them is let go.
    pub containers: usize,
    /// Bytes of one text.
    pub text_length: usize,
    /// Bytes of all texts that are made.
    pub text_total: usize,
    /// Shapes, lights, groups and transforms that are made, and likewise patterns and materials: about a gigabyte of them.
    pub objects: usize,
    /// Shapes and lights in the world, a shared one counted at each of its places.
    pub instances: u64,
    /// Patterns within patterns: the tracer's recursion.
    pub pattern_depth: u32,
    /// Patterns that one pattern is made of, each counted at every use: the tracer evaluates them as a tree, at every hit.
    pub pattern_size: u64,
    /// Triangles and points of one mesh file; and all surfaces in the world, a mesh's triangles counted at each of its places:
    /// their numbers are exact in 32-bit lanes.
    pub surfaces: u64,
    /// Texels of one picture file.
    pub image_texels: u64,
    /// Mistakes reported in one run.
    pub errors: usize,
}

/// Brackets within brackets; no readable scene comes near, and the parser's recursion stays small.
pub const BRACKET_DEPTH: usize = 256;
/// `=>` within `=>`.
pub const ARROW_DEPTH: u32 = 32;
/// Parts of one expression that lie within each other: `a + b + c + …` counts every sign.
pub const EXPRESSION_DEPTH: u32 = 1_000;
/// Stack of the thread that evaluates: 10 kB for each of `nesting`'s levels, several times what a debug build needs.
pub const STACK_BYTES: usize = 512 << 20;

impl Default for Limits {
    fn default() -> Self {
        Limits {
            file_bytes: 16 << 20,
            import_depth: 32,
            steps: 50_000_000,
            call_depth: 5_000,
            nesting: 50_000,
            list_length: 10_000_000,
            containers: 1_000_000,
            text_length: 1_000_000,
            text_total: 256 << 20,
            objects: 4_000_000,
            instances: 10_000_000,
            pattern_depth: 200,
            pattern_size: 100_000,
            surfaces: (1 << 24) - 1,
            image_texels: 1 << 28,
            errors: 50,
        }
    }
}
