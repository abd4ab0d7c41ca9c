//! `rtdsl gallery` from outside: what it makes, what it leaves alone, what it finds out.

mod checking;
mod desk;
mod link;
mod making;
mod owning;
