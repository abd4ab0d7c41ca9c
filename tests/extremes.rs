//! The programme of proofs, in its quick size: every figure of every check within its bound.

use rayon::ThreadPoolBuilder;
use rtdsl::app::verify::built_in::built_in;
use rtdsl::verify::{Figure, Outcome, Size, Subject, hashed, pictures, programme};
use std::sync::LazyLock;

/// The built-in scenes.
static SUBJECTS: LazyLock<Vec<Subject>> = LazyLock::new(|| built_in().expect("the built-in scenes are right"));

/// Runs a check on so many threads.
fn outcome(name: &str, threads: usize) -> Outcome {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| {
        let check = programme().into_iter().find(|c| c.name == name);
        let picture = pictures().into_iter().find(|c| c.name == name);
        match (check, picture) {
            (Some(check), None) => (check.run)(Size::Quick),
            (None, Some(check)) => (check.run)(&SUBJECTS, Size::Quick),
            _ => panic!("one check has the name `{name}`"),
        }
    })
}

/// Fails with what is out of bounds.
#[track_caller]
fn assert_kept(name: &str) {
    let outcome = outcome(name, 2);
    assert!(outcome.cases > 0 && !outcome.figures.is_empty(), "it tries something");
    let say = |f: &Figure| format!("{}: {} {}, {:?}", f.what, f.value, f.unit, f.bound);
    let broken: Vec<String> = outcome.figures.iter().filter(|f| !f.is_within()).map(say).collect();
    let first = outcome.first_failure.unwrap_or_default();
    assert!(broken.is_empty(), "{}\nfirst: {first}", broken.join("\n"));
    assert_eq!(first, "", "a case failed, so a figure must be out of bounds");
}

macro_rules! checks {
    ($($name:ident),* $(,)?) => {
        /// The checks that are tests here.
        const LISTED: &[&str] = &[$(stringify!($name)),*];
        $(
            #[test]
            fn $name() {
                assert_kept(stringify!($name));
            }
        )*
    };
}

checks! {
    quadrics,
    tangents,
    tori,
    watertight,
    leaving,
    contact,
    tree,
    intervals,
    energy,
    coverage,
    filtered,
    powers,
    scales,
    moves,
    mirrored,
    turned,
    order,
    treeless,
    parts,
    instructions,
    stated,
}

#[test]
fn every_check_of_the_programme_is_a_test_here() {
    let names = programme().into_iter().map(|c| c.name).chain(pictures().into_iter().map(|c| c.name));
    assert_eq!(names.collect::<Vec<_>>(), LISTED);
}

/// A change that moves a bit of a picture shows here: the new hashes go into `src/app/verify/built_in.rs`.
#[test]
fn pictures_have_the_hashes_that_the_program_states() {
    let stated: Vec<(&str, &str)> = SUBJECTS.iter().map(|s| (s.name.as_str(), s.hash.unwrap_or_default())).collect();
    let made: Vec<(&str, String)> = SUBJECTS.iter().map(|s| (s.name.as_str(), hashed(&s.scene).hash())).collect();
    assert_eq!(made.iter().map(|(name, hash)| (*name, hash.as_str())).collect::<Vec<_>>(), stated);
}

/// The same cases and the same figures on any number of threads. What checks of pictures have of this is a law of its own.
#[test]
fn checks_are_deterministic() {
    for check in programme() {
        assert_eq!(outcome(check.name, 1), outcome(check.name, 3), "{}", check.name);
    }
}
