//! Which requests may come in. The page shows files of this machine and changes parameters, so another site that is open in
//! the same browser must neither read nor ask: not by its own address (`Origin`, `Sec-Fetch-Site`), and not by a name of its
//! own that it lets point at this machine (DNS rebinding), which `Host` gives away.

use axum::http::{HeaderMap, Method, StatusCode, Uri, header};
use std::net::{IpAddr, SocketAddr};

/// Bytes of the longest body: parameters' values are short.
pub const LONGEST_BODY: usize = 64 << 10;

/// Bytes of the longest address: `/explain?x=…&y=…` is the longest of our own.
const LONGEST_URI: usize = 1024;

/// A request that is refused: the status, and a sentence that says why.
pub type Refusal = (StatusCode, String);

/// Whether a request for what is served at `bound` may come in.
///
/// # Errors
/// It may not.
pub fn admit(bound: SocketAddr, method: &Method, uri: &Uri, headers: &HeaderMap) -> Result<(), Refusal> {
    if uri.path().len() + uri.query().map_or(0, str::len) > LONGEST_URI {
        return Err((StatusCode::URI_TOO_LONG, format!("the address is longer than {LONGEST_URI} bytes")));
    }
    let host = known_host(bound, headers)?;
    match text(headers, header::ORIGIN.as_str())? {
        Some(origin) if !origin.eq_ignore_ascii_case(&format!("http://{host}")) => {
            return Err(forbidden(format!("a page of `{origin}` may not ask here")));
        }
        _ => {}
    }
    match text(headers, "sec-fetch-site")? {
        None | Some("same-origin" | "none") => {}
        // A link to the page, followed: nothing that the other site could read, and no frame either.
        Some(_) if uri.path() == "/" && method == Method::GET && is_followed_link(headers) => {}
        Some(_) => return Err(forbidden("another site may not ask here".into())),
    }
    let length = text(headers, header::CONTENT_LENGTH.as_str())?.and_then(|n| n.parse::<u64>().ok());
    if length.is_some_and(|n| n > LONGEST_BODY as u64) {
        return Err(too_large());
    }
    Ok(())
}

/// What is said of a body that is too long.
pub fn too_large() -> Refusal {
    (StatusCode::PAYLOAD_TOO_LARGE, format!("the request is longer than {LONGEST_BODY} bytes"))
}

fn forbidden(why: String) -> Refusal {
    (StatusCode::FORBIDDEN, why)
}

fn is_followed_link(headers: &HeaderMap) -> bool {
    let is = |name: &str, value: &str| headers.get(name).is_some_and(|v| v == value);
    is("sec-fetch-mode", "navigate") && is("sec-fetch-dest", "document")
}

/// The header's value; one that is there twice means different things to different readers.
fn text<'h>(headers: &'h HeaderMap, name: &str) -> Result<Option<&'h str>, Refusal> {
    let mut values = headers.get_all(name).iter();
    match (values.next(), values.next()) {
        (None, _) => Ok(None),
        (Some(value), None) => match value.to_str() {
            Ok(value) => Ok(Some(value)),
            Err(_) => Err(forbidden(format!("the header `{name}` is no plain text"))),
        },
        _ => Err(forbidden(format!("the header `{name}` is there twice"))),
    }
}

/// The `Host` of a request if it is an address (not a name, which anyone may point anywhere) that belongs to `bound`.
fn known_host(bound: SocketAddr, headers: &HeaderMap) -> Result<&str, Refusal> {
    let Some(host) = text(headers, header::HOST.as_str())? else {
        return Err(forbidden("the request doesn't say which host it means".into()));
    };
    let ip = match host_and_port(host) {
        Some((name, port)) if port == bound.port() => address(name),
        Some(_) => return Err(forbidden(format!("this is port {}, not `{host}`", bound.port()))),
        None => None,
    };
    match ip {
        Some(ip) if ip.is_loopback() || !bound.ip().to_canonical().is_loopback() => Ok(host),
        _ => Err(forbidden(format!("`{host}` isn't the address of this page; open it as `{}`", url(bound)))),
    }
}

/// `name:port`; without a port it is HTTP's 80.
fn host_and_port(host: &str) -> Option<(&str, u16)> {
    match host.rsplit_once(':') {
        Some((name, port)) if !port.contains(']') => Some((name, port.parse().ok()?)),
        _ => Some((host, 80)),
    }
}

fn address(name: &str) -> Option<IpAddr> {
    if name.eq_ignore_ascii_case("localhost") {
        return Some(std::net::Ipv4Addr::LOCALHOST.into());
    }
    let ip: IpAddr = match name.strip_prefix('[').and_then(|n| n.strip_suffix(']')) {
        Some(v6) => IpAddr::V6(v6.parse().ok()?),
        None => IpAddr::V4(name.parse().ok()?),
    };
    Some(ip.to_canonical())
}

/// Where a browser on this machine finds what is served at `bound`.
pub fn url(bound: SocketAddr) -> String {
    let mut at = bound;
    if at.ip().is_unspecified() {
        // "Every address" is none that can be opened.
        at.set_ip(match bound.ip() {
            IpAddr::V4(_) => std::net::Ipv4Addr::LOCALHOST.into(),
            IpAddr::V6(_) => std::net::Ipv6Addr::LOCALHOST.into(),
        });
    }
    format!("http://{at}/")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn admitted(bound: &str, host: &str) -> bool {
        let headers = HeaderMap::from_iter([(header::HOST, host.parse().unwrap())]);
        admit(bound.parse().unwrap(), &Method::GET, &Uri::from_static("/"), &headers).is_ok()
    }

    #[test]
    fn hosts() {
        let ours = ["127.0.0.1:80", "127.0.0.1", "localhost", "LOCALHOST:80", "[::1]:80", "[::1]", "127.9.9.9"];
        for host in ours {
            assert!(admitted("127.0.0.1:80", host), "{host}");
            assert!(admitted("0.0.0.0:80", host), "{host}");
        }
        let foreign = [
            "example.com",
            "localhost.example.com",
            "127.0.0.1.example.com:80",
            "localhost:81",
            "127.0.0.1:8080",
            "",
            ":80",
            "127.0.0.1:",
            "127.0.0.1:80:80",
            "127.1",
            "2130706433",
            "[::1",
            "::1",
            "[127.0.0.1]",
            "localhost:99999",
            "a@127.0.0.1",
            "localhost.",
        ];
        for host in foreign {
            assert!(!admitted("127.0.0.1:80", host), "{host}");
            assert!(!admitted("0.0.0.0:80", host), "{host}");
        }
        // An address of the network is ours only if the network was asked for.
        assert!(!admitted("127.0.0.1:80", "192.168.1.2") && admitted("0.0.0.0:80", "192.168.1.2"));
        assert!(!admitted("[::1]:80", "192.168.1.2") && admitted("[::]:80", "[fe80::1]:80"));
        assert!(admitted("[::ffff:127.0.0.1]:80", "localhost") && !admitted("[::ffff:127.0.0.1]:80", "10.0.0.1"));
    }

    #[test]
    fn urls_can_be_opened() {
        let url = |a: &str| url(a.parse().unwrap());
        assert_eq!(url("0.0.0.0:80"), "http://127.0.0.1:80/");
        assert_eq!(url("[::]:8000"), "http://[::1]:8000/");
        assert_eq!(url("10.1.2.3:8000"), "http://10.1.2.3:8000/");
    }
}
