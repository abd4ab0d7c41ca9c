// Values of parameters on their way: between the text of the language and what controls show, and to the server.

/** Least positions of a slider are half of these: twice the pixels of its track, so that the mouse reaches no fewer values than
 * it has places, and yet no digits that it couldn't set. */
const POSITIONS = 500;

/** Digits of a number that a person would write. */
const DIGITS = 12;

/** A number without the noise of its last bits. */
export function short(number) {
  return String(Number(number.toPrecision(DIGITS)));
}

/** The slider position `number` as a short number: a multiple of 1, 2 or 5 and a power of ten, or an end of the range. */
export function neat(number, [low, high], whole) {
  if (number <= low) return low;
  if (number >= high) return high;
  if (whole) return Math.round(number);
  const fine = (high - low) / POSITIONS;
  const power = 10 ** Math.floor(Math.log10(fine));
  const step = power * ([1, 2, 5].find((m) => m * power >= fine) ?? 10);
  return Math.min(Math.max(Number(short(Math.round(number / step) * step)), low), high);
}

/** The text that a text value has, as in `"glass"`. */
export function unquoted(value) {
  return /^".*"$/s.test(value) ? value.slice(1, -1) : value;
}

/** What a typed text is sent as. As it is, but for one that would be taken for a text of the language. */
export function asText(typed) {
  return typed.trimStart().startsWith('"') ? `"${typed.replace(/[\\"{}]/g, "\\$&")}"` : typed;
}

/** Sends values: one request at a time; what comes meanwhile waits, and of each parameter only the newest. */
export class Sender {
  /** When the last request was answered, in milliseconds of `performance.now()`. */
  answered = 0;

  #waiting = {};
  #flying = false;
  #onAnswer;

  /** `onAnswer` is called after each request, with what is wrong or null. */
  constructor(onAnswer) {
    this.#onAnswer = onAnswer;
  }

  /** Whether nothing is on its way. */
  get idle() {
    return !this.#flying && Object.keys(this.#waiting).length === 0;
  }

  /** Sends an object of names with texts of the language, or null for the scene's own value. */
  send(values) {
    Object.assign(this.#waiting, values);
    if (!this.#flying) this.#fly();
  }

  async #fly() {
    this.#flying = true;
    while (Object.keys(this.#waiting).length > 0) {
      const body = JSON.stringify(this.#waiting);
      this.#waiting = {};
      let fault = null;
      try {
        const response = await fetch("/set", { method: "POST", headers: { "Content-Type": "application/json" }, body });
        if (!response.ok) fault = (await response.text()).trim();
      } catch {
        fault = "the value didn’t reach the program";
      }
      this.answered = performance.now();
      this.#onAnswer(fault);
    }
    this.#flying = false;
  }
}
