//! Elementary functions with the same bits on every machine: pinned pure-Rust `libm`, and trigonometry of angles in
//! degrees whose exact cases are exact (`cos(90deg)` is 0, `sin(30deg)` is 0.5).

pub use libm::{acos, asin, atan, atan2, cbrt, erf, exp, exp2, hypot, log as ln, log1p, log2, log10, pow, sqrt};

/// Sine of an angle in degrees. Exact at every multiple of 30° where the sine is rational.
pub fn sin_deg(degrees: f64) -> f64 {
    if !degrees.is_finite() {
        return f64::NAN;
    }
    let d = within_a_turn(degrees);
    let (d, sign) = if d < 0.0 { (-d, -1.0) } else { (d, 1.0) };
    let (d, sign) = if d >= 180.0 { (d - 180.0, -sign) } else { (d, sign) };
    let d = if d > 90.0 { 180.0 - d } else { d };
    sign * quadrant_sin(d)
}

/// Cosine of an angle in degrees. Exact at every multiple of 30° where the cosine is rational.
pub fn cos_deg(degrees: f64) -> f64 {
    if !degrees.is_finite() {
        return f64::NAN;
    }
    let d = within_a_turn(degrees).abs();
    let d = if d > 180.0 { 360.0 - d } else { d };
    if d > 90.0 { -quadrant_cos(180.0 - d) } else { quadrant_cos(d) }
}

/// Tangent of an angle in degrees; infinite at odd multiples of 90°.
pub fn tan_deg(degrees: f64) -> f64 {
    let (s, c) = (sin_deg(degrees), cos_deg(degrees));
    if (degrees % 45.0 == 0.0) && c != 0.0 { sign_or_zero(s) * sign_or_zero(c) } else { s / c }
}

/// The angle in degrees, −90 to 90, whose sine is `x`; NaN outside −1..=1. `sin_deg` of it is `x` again wherever a float is.
pub fn asin_deg(x: f64) -> f64 {
    if x.abs() == 0.5 { 30f64.copysign(x) } else { returning(asin(x).to_degrees(), sin_deg, x) }
}

/// The angle in degrees, 0 to 180, whose cosine is `x`; NaN outside −1..=1. `cos_deg` of it is `x` again wherever a float is.
pub fn acos_deg(x: f64) -> f64 {
    match x {
        0.5 => 60.0,
        -0.5 => 120.0,
        _ => returning(acos(x).to_degrees(), cos_deg, x),
    }
}

/// The angle in degrees, between −90 and 90, whose tangent is `x`. `tan_deg` of it is `x` again wherever a float is.
pub fn atan_deg(x: f64) -> f64 {
    returning(atan(x).to_degrees(), tan_deg, x)
}

/// `d`, or a float near it for which `f` gives `x`: the radians' rounding to degrees costs an ulp or two.
fn returning(d: f64, f: fn(f64) -> f64, x: f64) -> f64 {
    let (up, down) = (d.next_up(), d.next_down());
    [d, up, down, up.next_up(), down.next_down()].into_iter().find(|d| f(*d) == x).unwrap_or(d)
}

/// What is left without whole turns: exact, for the remainder of two floats is a float.
fn within_a_turn(degrees: f64) -> f64 {
    // Mostly there is nothing to take away, and a remainder takes as long as a sine.
    if degrees.abs() < 360.0 { degrees } else { degrees % 360.0 }
}

fn sign_or_zero(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { 1f64.copysign(x) }
}

fn quadrant_sin(d: f64) -> f64 {
    match d {
        30.0 => 0.5,
        90.0 => 1.0,
        _ if d > 45.0 => libm::cos((90.0 - d).to_radians()),
        _ => libm::sin(d.to_radians()),
    }
}

fn quadrant_cos(d: f64) -> f64 {
    quadrant_sin(90.0 - d)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_cases_are_exact() {
        for k in -8..=8 {
            let turn = 360.0 * k as f64;
            assert_eq!(sin_deg(turn + 30.0), 0.5);
            assert_eq!(sin_deg(turn + 210.0), -0.5);
            assert_eq!(cos_deg(turn + 90.0), 0.0);
            assert_eq!(cos_deg(turn - 90.0), 0.0);
            assert_eq!(cos_deg(turn + 120.0), -0.5);
            assert_eq!(cos_deg(turn + 180.0), -1.0);
            assert_eq!(sin_deg(turn + 180.0), 0.0);
            assert_eq!(tan_deg(turn + 45.0), 1.0);
            assert_eq!(tan_deg(turn + 135.0), -1.0);
        }
    }

    #[test]
    fn inverses_lead_back() {
        assert_eq!(
            [asin_deg(-0.5), asin_deg(1.0), acos_deg(0.0), acos_deg(-0.5), atan_deg(-1.0)],
            [-30.0, 90.0, 90.0, 120.0, -45.0]
        );
        assert!(asin_deg(1.1).is_nan() && acos_deg(-2.0).is_nan());
        assert_eq!(tan_deg(2.0 * atan_deg(0.25) / 2.0), 0.25);
        let back = (1..1000).filter(|i| tan_deg(atan_deg(f64::from(*i) / 1000.0)) == f64::from(*i) / 1000.0);
        assert!(back.count() > 650, "most have such an angle");
        for i in -100..=100 {
            let x = f64::from(i) / 100.0;
            assert!((sin_deg(asin_deg(x)) - x).abs() < 1e-15 && (cos_deg(acos_deg(x)) - x).abs() < 1e-15);
        }
    }

    #[test]
    fn the_rest_agrees_with_radians() {
        for i in -4000..4000 {
            let d = i as f64 * 0.37;
            assert!((sin_deg(d) - libm::sin(d.to_radians())).abs() < 1e-14);
            assert!((cos_deg(d) - libm::cos(d.to_radians())).abs() < 1e-14);
        }
    }
}
