// What is known of the text and of its picture: errors, warnings, progress, what it took.

const part = (selector) => document.querySelector(selector);

export class Status {
  #posted = null;
  #folded = false;
  #shownErrors = "";

  constructor() {
    part("#errors-fold").addEventListener("click", () => this.fold());
  }

  /** Shows all of it. */
  show(posted) {
    const errors = posted.messages.filter((m) => m.severity === "error");
    document.body.classList.toggle("busy", posted.busy);
    document.body.classList.toggle("broken", errors.length > 0);
    part("#progress").value = posted.progress;
    part("#file").textContent = baseName(posted.file);
    part("#file").title = posted.file;
    part("#state").textContent = state(posted, errors);
    document.title = `${errors.length ? "✗ " : ""}${baseName(posted.file)} – rtdsl`;
    this.#showErrors(errors);
    this.#showWarnings(posted.messages.filter((m) => m.severity !== "error"));
    this.#showReport(posted);
    const badge = part("#badge");
    badge.hidden = !(errors.length && posted.picture);
    if (!badge.hidden) {
      badge.textContent = `Picture of an earlier text, from ${posted.picture.made}`;
      badge.title = `The picture shows text ${posted.picture.text}; the newest is ${posted.text}.`;
    }
    this.#posted = posted;
  }

  /** Hides or shows the text of the errors. */
  fold() {
    this.#folded = !this.#folded;
    part("#errors-text").hidden = this.#folded;
    part("#errors-fold").textContent = this.#folded ? "Show" : "Hide";
    part("#errors-fold").setAttribute("aria-expanded", !this.#folded);
  }

  /** Tells whether the server can be reached. */
  connected(is) {
    if (part("#banner").hidden === is) return;
    part("#banner").hidden = is;
    say(is ? "Connected again." : "Connection lost. Trying again.");
  }

  #showErrors(errors) {
    const text = JSON.stringify(errors);
    if (text === this.#shownErrors) return;
    const had = this.#shownErrors.length > 2;
    this.#shownErrors = text;
    part("#errors").hidden = errors.length === 0;
    if (errors.length === 0) {
      if (had) say("The error is gone.");
      return;
    }
    const first = errors[0];
    const place = first.place && ` at ${first.place}`;
    part("#errors-title").textContent = errors.length === 1 ? `Error${place}` : `${errors.length} errors, the first${place}`;
    part("#errors-text").replaceChildren(...errors.map((m) => excerpt(m.text)));
    part("#errors-text").scrollTo(0, 0);
    say(`${errors.length === 1 ? "Error" : `${errors.length} errors`}: ${first.message}${place}`);
  }

  #showWarnings(warnings) {
    const box = part("#warnings");
    box.hidden = warnings.length === 0;
    box.querySelector("summary").textContent = warnings.length === 1 ? "1 warning" : `${warnings.length} warnings`;
    box.querySelector("pre").textContent = warnings.map((m) => m.text.trimEnd()).join("\n\n");
  }

  #showReport({ picture, report }) {
    part("#report").hidden = !picture || !report;
    if (!picture || !report) return;
    const { parse, evaluate, world, render } = report;
    const phases = Object.entries({ parse, evaluate, world, render }).map(([name, s]) => `${name} ${duration(s)}`);
    const rows = [
      ["size", `${picture.width} × ${picture.height} pixels`],
      ["made", picture.made],
      ["time", duration(parse + evaluate + world + render)],
      ["", phases.join(", ")],
      ["rays", `${many(report.rays)}${render > 0 ? `, ${many(report.rays / render)} a second` : ""}`],
      ["traced", `${report.tiles[0]} of ${report.tiles[1]} tiles`],
      ["file", bytes(report.bytes)],
    ];
    part("#report-rows").replaceChildren(
      ...rows.flatMap(([name, value]) => {
        const dd = Object.assign(document.createElement("dd"), { textContent: value });
        return name ? [Object.assign(document.createElement("dt"), { textContent: name }), dd] : [dd];
      }),
    );
  }
}

/** The last part of a path. */
export function baseName(path) {
  return path.split(/[\\/]/).at(-1);
}

/** One line for all of it. */
function state({ busy, progress, picture, report }, errors) {
  if (busy) return progress > 0 ? `rendering, ${Math.floor(progress * 100)} %` : "rendering";
  if (errors.length) return errors.length === 1 ? "1 error" : `${errors.length} errors`;
  if (!picture || !report) return "";
  const seconds = report.parse + report.evaluate + report.world + report.render;
  return `${picture.made}, ${picture.width} × ${picture.height}, ${duration(seconds)}`;
}

/** A message as `rtdsl check` prints it, its first line and its marks coloured. */
function excerpt(text) {
  const pre = document.createElement("pre");
  const span = (className, part) => {
    const made = document.createElement("span");
    made.className = className;
    made.textContent = part;
    return made;
  };
  text.trimEnd().split("\n").forEach((line, i) => {
    const [, margin, rest] = line.match(/^(\s*\d*\s*(?:[|╭│]|-->|:::|=)?)(.*)$/s);
    const isMark = /^[\s|_/]*[\^-]+/.test(rest) && margin.trim() === "|";
    if (i === 0) pre.append(span("message-head", line));
    else pre.append("\n", span("message-margin", margin), isMark ? span("message-mark", rest) : rest);
  });
  return pre;
}

/** Tells it to who doesn't see it. */
function say(text) {
  part("#live").textContent = text;
}

/** About three digits, as many as stay the same from one run to the next; milliseconds get by with fewer, for the eye. */
function duration(seconds) {
  if (seconds < 0.01) return `${(seconds * 1e3).toFixed(1)} ms`;
  if (seconds < 1) return `${Math.round(seconds * 1e3)} ms`;
  if (seconds < 60) return `${seconds.toFixed(seconds < 10 ? 2 : 1)} s`;
  return `${Math.floor(seconds / 60)} min ${Math.round(seconds % 60)} s`;
}

/** Two digits at least: whether it doubled shows. */
function many(n) {
  const [unit, by] = n >= 1e9 ? [" G", 1e9] : n >= 1e6 ? [" M", 1e6] : n >= 1e3 ? [" k", 1e3] : ["", 1];
  const scaled = n / by;
  return `${scaled < 10 && by > 1 ? scaled.toFixed(1) : Math.round(scaled)}${unit}`;
}

/** Up to a megabyte whole kilobytes, none being 0; then a tenth of a megabyte, as file managers show it. */
function bytes(n) {
  return n < 1e6 ? `${Math.ceil(n / 1e3)} kB` : `${(n / 1e6).toFixed(1)} MB`;
}
