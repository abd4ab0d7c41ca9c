//! Values of arguments, read from the command line; what is wrong with one is said in a sentence that shows a right one.

use crate::film::{Compression, Depth};
use crate::render::Crop;
use crate::scene::{Accuracy, AntiAliasing, PixelFilter, Precision, range};
use std::net::SocketAddr;
use std::time::Duration;

/// `count=50`.
pub fn assignment(s: &str) -> Result<(String, String), String> {
    match s.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => Ok((name.trim().to_string(), value.trim().to_string())),
        _ => Err("write the parameter's name, `=` and its value, as in `count=50`".into()),
    }
}

/// `1280x720`.
pub fn size(s: &str) -> Result<(u32, u32), String> {
    let (w, h) = s.split_once(['x', 'X']).ok_or("write width and height in pixels, as in `1280x720`")?;
    let side = |s: &str| match s.parse::<u64>() {
        Ok(n) if (1..=range::LARGEST_SIDE as u64).contains(&n) => Ok(n as u32),
        _ => Err(format!("a side is a whole number of pixels from 1 to {}, not `{s}`", range::LARGEST_SIDE)),
    };
    let (w, h) = (side(w)?, side(h)?);
    let pixels = w as u64 * h as u64;
    if pixels > range::MOST_PIXELS {
        return Err(format!("that is {pixels} pixels; {} are the most", range::MOST_PIXELS));
    }
    Ok((w, h))
}

/// `off`, `grid:3` or `adaptive:16`.
pub fn anti_aliasing(s: &str) -> Result<AntiAliasing, String> {
    if s == "off" {
        return Ok(AntiAliasing::Off);
    }
    let (way, n) = s.split_once(':').unwrap_or((s, ""));
    let (is, least, most, make): (_, _, _, fn(u32) -> AntiAliasing) = match way {
        "grid" => ("the grid is", 1, AntiAliasing::LARGEST_GRID, AntiAliasing::Grid),
        "adaptive" => ("the most further rays of a pixel are", 2, AntiAliasing::MOST_RAYS, AntiAliasing::Adaptive),
        _ => return Err("write `off`, `grid:N` as in `grid:2`, or `adaptive:N` as in `adaptive:16`".into()),
    };
    match n.parse() {
        Ok(n) if (least..=most).contains(&n) => Ok(make(n)),
        _ => Err(format!("{is} a whole number from {least} to {most}, not `{n}`")),
    }
}

/// `box`, `mitchell` or `gauss`.
pub fn filter(s: &str) -> Result<PixelFilter, String> {
    PixelFilter::named(s).ok_or_else(|| "write `box`, `mitchell` (sharp) or `gauss` (soft)".into())
}

/// `2/255` or `0.01`.
pub fn max_error(s: &str) -> Result<f64, String> {
    let number = |s: &str| s.trim().parse::<f64>().ok();
    let value = match s.split_once('/') {
        Some((a, b)) => number(a).zip(number(b)).map(|(a, b)| a / b),
        None => number(s),
    };
    let (least, most) = (Accuracy::LEAST_ERROR, Accuracy::LARGEST_ERROR);
    match value {
        Some(x) if (least..=most).contains(&x) => Ok(x),
        Some(x) if x > most && s.parse::<f64>().is_ok() => {
            Err(format!("an error is a share of white, {most} at most: two codes of 8 bits are `2/255`"))
        }
        Some(_) => Err(format!("an error is from {least} to {most}, as in `2/255`")),
        None => Err("write the largest error as a share of white, as in `2/255`".into()),
    }
}

/// `0.999`.
pub fn confidence(s: &str) -> Result<f64, String> {
    match s.parse::<f64>() {
        // Beyond, the random numbers themselves aren't random enough; and half is no confidence.
        Ok(p) if (0.5..=0.999_999_999).contains(&p) => Ok(p),
        _ => Err("write a probability from 0.5 to 0.999999999, as in `0.999`".into()),
    }
}

/// `2s`, `500ms`, `1.5`, `3min`.
pub fn seconds(s: &str) -> Result<f64, String> {
    let (number, unit) = match s.find(|c: char| c.is_ascii_alphabetic()) {
        // `1e3` is a number.
        Some(i) if s.parse::<f64>().is_err() => (&s[..i], &s[i..]),
        _ => (s, "s"),
    };
    let factor = match unit {
        "ms" => 0.001,
        "s" => 1.0,
        "min" => 60.0,
        "h" => 3600.0,
        _ => return Err(format!("`{unit}` is no unit of time here: write `ms`, `s`, `min` or `h`, as in `2s`")),
    };
    match number.trim().parse::<f64>().map(|x| x * factor) {
        Ok(x) if (Accuracy::LEAST_TIME..=Accuracy::LONGEST_TIME).contains(&x) => Ok(x),
        Ok(_) => Err("a time is from `1ms` to a week".into()),
        Err(_) => Err("write a number and its unit, as in `2s`, `500ms` or `3min`".into()),
    }
}

/// `f64` or `f32`.
pub fn precision(s: &str) -> Result<Precision, String> {
    match s {
        "f64" => Ok(Precision::F64),
        "f32" => Ok(Precision::F32),
        _ => Err("write `f64` or `f32`".into()),
    }
}

/// `8000`, `127.0.0.1`, `[::1]:8000`, `localhost:8000`.
pub fn address(s: &str) -> Result<SocketAddr, String> {
    let here = std::net::Ipv4Addr::LOCALHOST;
    let s = s.replace("localhost", "127.0.0.1");
    if let Ok(port) = s.parse::<u16>() {
        return Ok((here, port).into());
    }
    if let Ok(ip) = s.parse::<std::net::IpAddr>() {
        return Ok((ip, 0).into());
    }
    s.parse().map_err(|_| "write an address and a port, as in `127.0.0.1:8000`, or one of them".into())
}

/// Seconds.
pub fn poll_interval(s: &str) -> Result<Duration, String> {
    match s.parse::<f64>() {
        // A tenth of a second is as fast as anyone saves; a day is a typing mistake.
        Ok(x) if (0.1..=86_400.0).contains(&x) => Ok(Duration::from_secs_f64(x)),
        _ => Err("write seconds from 0.1 up, as in `2`".into()),
    }
}

/// `chess*`.
pub fn glob_pattern(s: &str) -> Result<glob::Pattern, String> {
    glob::Pattern::new(s).map_err(|e| e.msg.to_string())
}

/// `8` or `16`.
pub fn bits(s: &str) -> Result<Depth, String> {
    match s {
        "8" => Ok(Depth::Eight),
        "16" => Ok(Depth::Sixteen),
        _ => Err("a PNG has 8 or 16 bits a channel".into()),
    }
}

/// `fast` or `small`.
pub fn compression(s: &str) -> Result<Compression, String> {
    match s {
        "fast" => Ok(Compression::Fast),
        "small" => Ok(Compression::Small),
        _ => Err("write `fast`, or `small` for a file that takes longer to make".into()),
    }
}

/// `100,50,320,200`.
pub fn crop(s: &str) -> Result<Crop, String> {
    let [x, y, width, height] =
        whole_numbers(s).ok_or("write four whole numbers: left, top, width, height, as in `100,50,320,200`")?;
    if width == 0 || height == 0 {
        return Err("a part of no pixels can't be made".into());
    }
    Ok(Crop { x, y, width, height })
}

/// `640,360`.
pub fn pixel(s: &str) -> Result<(u32, u32), String> {
    let [x, y] = whole_numbers(s).ok_or("write two whole numbers: column and row, as in `640,360`")?;
    Ok((x, y))
}

/// So many whole numbers between commas.
fn whole_numbers<const N: usize>(s: &str) -> Option<[u32; N]> {
    let numbers: Option<Vec<u32>> = s.split(',').map(|n| n.trim().parse().ok()).collect();
    numbers?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values() {
        assert_eq!(size("1280x720"), Ok((1280, 720)));
        for wrong in ["0x5", "5", "-1x4", "1000000000x1", "65536x65536", "5x", "1.5x2", ""] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
        assert_eq!(anti_aliasing("grid:32"), Ok(AntiAliasing::Grid(32)));
        assert_eq!(anti_aliasing("adaptive:1024"), Ok(AntiAliasing::Adaptive(1024)));
        for wrong in ["grid:0", "grid:33", "grid", "on", "grid:-1", "adaptive:1", "adaptive:1025", "adaptive", "off:2"]
        {
            assert!(anti_aliasing(wrong).is_err(), "{wrong}");
        }
        assert_eq!(["box", "mitchell", "gauss"].map(filter), PixelFilter::ALL.map(Ok));
        assert!(filter("Box").is_err() && filter("").is_err());
        assert_eq!((max_error("2/255"), max_error("0.01")), (Ok(2.0 / 255.0), Ok(0.01)));
        for wrong in ["2", "0", "1/0", "-1/255", "2/", "x", "nan", "", "1e-9"] {
            assert!(max_error(wrong).is_err(), "{wrong}");
        }
        let times = ["2s", "500ms", "1.5", "3min", "1e1", "0.5h"].map(|t| seconds(t).unwrap());
        assert_eq!(times, [2.0, 0.5, 1.5, 180.0, 10.0, 1800.0]);
        for wrong in ["0", "2days", "s", "", "-1s", "nan", "inf", "8000h", "2 2s", "é"] {
            assert!(seconds(wrong).is_err(), "{wrong}");
        }
        assert!(confidence("0.999").is_ok() && confidence("1").is_err() && confidence("99%").is_err());
        assert_eq!(crop("1, 2,3,4"), Ok(Crop { x: 1, y: 2, width: 3, height: 4 }));
        assert!(crop("1,2,0,4").is_err() && crop("1,2,3").is_err() && crop("-1,2,3,4").is_err());
        assert_eq!(pixel("640,360"), Ok((640, 360)));
        assert_eq!(assignment("a = b=c"), Ok(("a".into(), "b=c".into())));
        let at = |s| address(s).map(|a| a.to_string()).ok();
        assert_eq!(at("8000").as_deref(), Some("127.0.0.1:8000"));
        assert_eq!(at("localhost:80").as_deref(), Some("127.0.0.1:80"));
        assert_eq!(at("::1").as_deref(), Some("[::1]:0"));
        assert_eq!((at("a.scene"), at("70000"), at("")), (None, None, None));
        assert!(poll_interval("0").is_err() && poll_interval("NaN").is_err() && poll_interval("0.5").is_ok());
        assert!(assignment("=1").is_err() && assignment("a").is_err());
    }
}
