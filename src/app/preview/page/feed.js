// Follows what the server posts, for as long as the page is open.

/** Pause before a connection that the browser has given up is opened anew, in milliseconds. */
const AGAIN_AFTER = 1000;

/** A connection that is back within this time, in milliseconds, was never missed. */
const PATIENCE = 400;

/**
 * Calls `onPosted` with everything that is posted, and `onConnected` with whether the server can be reached.
 * The browser itself tries again after a broken connection; after a refusal it gives up, and this begins anew.
 */
export function follow(onPosted, onConnected) {
  let missed = null;
  const source = new EventSource("/events");
  source.onopen = () => {
    clearTimeout(missed);
    missed = null;
    onConnected(true);
  };
  source.onmessage = (event) => onPosted(JSON.parse(event.data));
  source.onerror = () => {
    missed ??= setTimeout(() => onConnected(false), PATIENCE);
    if (source.readyState === EventSource.CLOSED) {
      setTimeout(() => {
        clearTimeout(missed);
        follow(onPosted, onConnected);
      }, AGAIN_AFTER);
    }
  };
}
