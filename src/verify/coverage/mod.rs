//! Do pixels keep the errors that are stated of them, as often as stated?
//!
//! Two kinds of pictures tell. Of shapes in a parallel view the true value of each pixel is a closed form; any scene
//! can be compared with a picture of it to a far smaller error. Pixels that are proved may never be off by more than is
//! stated; those that are bounded as often as the confidence leaves open, which an exact binomial limit decides; of those that
//! are estimated the share is told as it is. A last figure weakens every bound and expects to be caught.

mod binomial;
mod closed_form;
mod covered;
mod filtered;
mod kept;
mod scenes;

pub use binomial::lower_limit;
pub use closed_form::CHECK;
pub use filtered::CHECK as FILTERED;
pub use scenes::CHECK as PICTURES;
