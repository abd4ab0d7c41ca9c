//! The server of the live page: a thread of its own with a runtime of its own, so that the watching loop needn't know of
//! either.

use super::board::Board;
use super::listener::Limited;
use super::{guard, route};
use std::io;
use std::net::{SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;
use tokio::sync::oneshot;

/// Most connections at once: a browser holds six at most, so this is ten of them; systems allow 256 files at least.
const MOST_CONNECTIONS: usize = 64;

/// After so long a connection over which nothing goes is closed: twice the 15 s after which a page that follows gets a sign
/// of life.
const IDLE: Duration = Duration::from_secs(30);

/// A running server. Dropped, it ends, and every connection with it.
pub struct Server {
    bound: SocketAddr,
    stop: Option<oneshot::Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

/// Serves the page of `board` at `address`; port 0 is any that is free. Requests are answered from now on.
///
/// # Errors
/// The address isn't this machine's or is taken, or the system gives no thread.
pub fn serve(board: Arc<Board>, address: SocketAddr) -> io::Result<Server> {
    let listener = TcpListener::bind(address)?;
    listener.set_nonblocking(true)?;
    let bound = listener.local_addr()?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let listener = {
        let _inside = runtime.enter();
        Limited::new(tokio::net::TcpListener::from_std(listener)?, MOST_CONNECTIONS, IDLE)
    };
    let (stop, stopped) = oneshot::channel();
    let routes = route::routes(board, bound);
    let thread = thread::Builder::new().name("live page".into()).spawn(move || {
        runtime.block_on(async {
            tokio::select! {
                // Accepts until the end; faults of single connections are its own affair.
                _ = axum::serve(listener, routes) => {}
                _ = stopped => {}
            }
        });
        // Pages follow for as long as they are open: nobody waits for them.
        runtime.shutdown_background();
    })?;
    Ok(Server { bound, stop: Some(stop), thread: Some(thread) })
}

impl Server {
    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.bound
    }

    /// The page's address in a browser on this machine.
    pub fn url(&self) -> String {
        guard::url(self.bound)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        if let Some(stop) = self.stop.take() {
            // The thread has ended already if nobody listens.
            let _ = stop.send(());
        }
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
