//! From linear colours to picture files: the picture in linear light, its display codes, the formats, and writing whole
//! files or none; reading the files of others, and telling how far a picture is from the true one.

pub mod buffer;
pub mod develop;
pub mod format;
pub mod metric;
pub mod png;
pub mod read;
pub mod recipe;
pub mod write;

pub use buffer::{Digest, Film};
pub use develop::{Depth, Developer};
pub use format::{Format, encode};
pub use png::{Compression, PngWriter};
pub use read::{Picture, ReadError, read};
pub use recipe::Recipe;
pub use write::OutputFile;
