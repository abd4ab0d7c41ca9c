//! An instruction of the wide registers is an instruction, never a call.
//!
//! The kernels are written once and compiled for each set of instructions, by inlining all of them into one function that may use
//! that set. What isn't inlined, a closure handed to `Option::map_or` for instance, is compiled without the set: each of its
//! instructions becomes a call, some twenty times slower, and no picture changes, so nothing but this would tell.

/// Calls show as functions of the programme, under their mangled names.
#[test]
#[cfg(all(target_arch = "x86_64", target_os = "linux"))]
#[cfg_attr(debug_assertions, ignore = "only optimised builds inline")]
fn instructions_are_not_called() {
    let programme = std::fs::read(env!("CARGO_BIN_EXE_rtdsl")).unwrap();
    let called = |name: &[u8]| programme.windows(name.len()).any(|w| w == name);
    // A name that has to be there: symbols aren't stripped.
    assert!(called(b"5rtdsl3app"), "no symbols to look at");
    for name in [
        "_mm256_mul_pd",
        "_mm256_fmadd_pd",
        "_mm256_blendv_pd",
        "_mm512_mul_pd",
        "_mm512_fmadd_pd",
        "_mm512_mask_blend_pd",
    ] {
        assert!(
            !called(name.as_bytes()),
            "{name} is a function of the programme: something that uses it wasn't inlined"
        );
    }
}
