//! What is served where. The addresses are fixed: no part of one is ever a path of a file.

use super::asset::ASSETS;
use super::board::{Ask, Board, Posted};
use super::guard::{self, LONGEST_BODY, Refusal};
use crate::app::sight::Sight;
use axum::body::Bytes;
use axum::extract::rejection::{BytesRejection, QueryRejection};
use axum::extract::{DefaultBodyLimit, Path, Query, Request, State};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio_stream::wrappers::WatchStream;
use tokio_stream::{Stream, StreamExt};

/// How soon a page that lost the connection tries again: at once for a person, seldom enough for a machine.
const RETRY: Duration = Duration::from_millis(500);

/// Headers of every answer: the page runs its own scripts alone, shows its own pictures alone, in no one else's frame.
const HEADERS: [(HeaderName, &str); 6] = [
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; object-src 'none'",
    ),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
];

/// All routes, guarded.
pub fn routes(board: Arc<Board>, bound: SocketAddr) -> Router {
    let mut router = Router::new();
    for asset in &ASSETS {
        router = router.route(asset.path, get(|| async { ([(header::CONTENT_TYPE, asset.media)], asset.text) }));
    }
    router
        .route("/events", get(events))
        .route("/picture/{file}", get(picture))
        .route("/explain", get(explain))
        .route("/set", post(set))
        .fallback(|| async { (StatusCode::NOT_FOUND, "there is nothing here\n") })
        .method_not_allowed_fallback(|| async {
            (StatusCode::METHOD_NOT_ALLOWED, "this isn't done with what is here\n")
        })
        .layer(DefaultBodyLimit::max(LONGEST_BODY))
        .layer(middleware::from_fn_with_state(bound, guarded))
        .with_state(board)
}

/// Lets in what may come in, and gives every answer its headers.
async fn guarded(State(bound): State<SocketAddr>, request: Request, next: Next) -> Response {
    let mut response = match guard::admit(bound, request.method(), request.uri(), request.headers()) {
        Ok(()) => next.run(request).await,
        Err((status, why)) => (status, why + "\n").into_response(),
    };
    let headers = response.headers_mut();
    for (name, value) in HEADERS {
        headers.insert(name, HeaderValue::from_static(value));
    }
    // What isn't marked otherwise belongs to this run of the program alone.
    headers.entry(header::CACHE_CONTROL).or_insert(HeaderValue::from_static("no-store"));
    response
}

/// All that is posted, now and after each change; a page that is slow gets the newest only.
async fn events(State(board): State<Arc<Board>>) -> Sse<impl Stream<Item = Result<Event, Infallible>>> {
    // Numbers, texts and lists always have a JSON form.
    let json = |posted: &Posted| serde_json::to_string(posted).unwrap_or_default();
    let event = move |posted: Arc<Posted>| Ok(Event::default().retry(RETRY).data(json(&posted)));
    Sse::new(WatchStream::new(board.follow()).map(event)).keep_alive(KeepAlive::default())
}

/// Whose picture is meant: numbers begin anew with each run of the program, what browsers keep doesn't.
#[derive(Deserialize)]
struct OfRun {
    run: Option<String>,
}

async fn picture(
    State(board): State<Arc<Board>>,
    Path(file): Path<String>,
    Query(of): Query<OfRun>,
) -> Result<Response, Refusal> {
    let of_now = of.run.is_none_or(|run| run == board.now().run);
    let id = file.strip_suffix(".png").and_then(|id| id.parse().ok()).filter(|_| of_now);
    let Some(png) = id.and_then(|id| board.picture(id)) else {
        return Err((StatusCode::NOT_FOUND, "there is no such picture, or no longer\n".into()));
    };
    let headers = [(header::CONTENT_TYPE, "image/png"), (header::CACHE_CONTROL, "private, max-age=86400, immutable")];
    Ok((headers, Bytes::from_owner(png)).into_response())
}

/// A pixel, from the top left corner.
#[derive(Deserialize)]
struct Pixel {
    x: u32,
    y: u32,
}

/// What a pixel sees.
#[derive(Serialize)]
struct Explained {
    /// The picture that the answer belongs to.
    picture: u64,
    x: u32,
    y: u32,
    /// What is there; `None` for the background.
    sight: Option<Sight>,
}

async fn explain(
    State(board): State<Arc<Board>>,
    pixel: Result<Query<Pixel>, QueryRejection>,
) -> Result<Json<Explained>, Refusal> {
    let Ok(Query(Pixel { x, y })) = pixel else {
        return Err((StatusCode::BAD_REQUEST, "write a pixel as `?x=0&y=0`\n".into()));
    };
    let Some(shown) = board.shown() else {
        return Err((StatusCode::NOT_FOUND, "there is no finished picture yet\n".into()));
    };
    if x >= shown.options.width || y >= shown.options.height {
        return Err((StatusCode::NOT_FOUND, "the pixel lies outside the picture\n".into()));
    }
    // A large scene takes its time; pages that follow don't wait for it.
    let see = move || Explained {
        picture: shown.picture,
        x,
        y,
        sight: shown.probe(x, y).map(|probe| Sight::new(&probe, &shown.evaluated)),
    };
    let explained = tokio::task::spawn_blocking(see).await;
    explained.map(Json).map_err(|_| (StatusCode::INTERNAL_SERVER_ERROR, "the pixel can't be explained\n".into()))
}

/// Gives parameters values: a JSON object of names with texts of the language, or null for the scene's own.
async fn set(
    State(board): State<Arc<Board>>,
    headers: HeaderMap,
    body: Result<Bytes, BytesRejection>,
) -> Result<StatusCode, Refusal> {
    let refuse = |status, why: String| Err((status, why + "\n"));
    let media = headers.get(header::CONTENT_TYPE).and_then(|v| v.to_str().ok()).unwrap_or_default();
    if media.split(';').next().unwrap_or_default().trim() != "application/json" {
        return refuse(StatusCode::UNSUPPORTED_MEDIA_TYPE, "values come as application/json".into());
    }
    let body = match body {
        Ok(body) => body,
        Err(r) if r.status() == StatusCode::PAYLOAD_TOO_LARGE => {
            let (status, why) = guard::too_large();
            return refuse(status, why);
        }
        Err(r) => return refuse(r.status(), r.body_text()),
    };
    let values: BTreeMap<String, Option<String>> = match serde_json::from_slice(&body) {
        Ok(values) => values,
        Err(e) => return refuse(StatusCode::BAD_REQUEST, format!("write an object of names with texts or null: {e}")),
    };
    let now = board.now();
    if let Some(name) = values.keys().find(|name| now.params.iter().all(|p| p.name != **name)) {
        return refuse(StatusCode::BAD_REQUEST, format!("the scene has no parameter `{name}`"));
    }
    match board.ask(Ask::Set(values.into_iter().collect())) {
        true => Ok(StatusCode::NO_CONTENT),
        false => refuse(StatusCode::SERVICE_UNAVAILABLE, "the scene is no longer watched".into()),
    }
}
