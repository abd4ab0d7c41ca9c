// Controls for the scene's parameters: made from what is posted, kept in step with it, and never pulled out of the hand that
// moves them.

import { Sender, asText, neat, short, unquoted } from "./values.js";

/** Choices up to this many letters are shown side by side. */
const SIDE_BY_SIDE = 26;

/** After an answer, the loop may need this long, in milliseconds, to say that it is at work. */
const SETTLED_AFTER = 400;

export class Controls {
  #root;
  #all = new Map();
  #posted = null;
  #sender;

  constructor(root) {
    this.#root = root;
    this.#sender = new Sender((fault) => this.#answered(fault));
    part(root, "#reset-all").addEventListener("click", () => this.#resetAll());
    part(root, "#set-copy").addEventListener("click", () => this.#copy());
  }

  /** Makes and updates the controls. */
  show(posted) {
    if (this.#posted && this.#posted.run !== posted.run) {
      // What the last run was told is forgotten.
      this.#all.forEach((control) => control.forget());
      part(this.#root, "#set-fault").hidden = true;
    }
    this.#posted = posted;
    this.#arrange(posted.params);
    posted.params.forEach((setting) => this.#all.get(setting.name).update(setting, this.#settled()));
    this.#root.hidden = posted.params.length === 0;
    part(this.#root, "#set-line").textContent = posted.set_line;
    part(this.#root, "#set-copy").disabled = posted.set_line === "";
    part(this.#root, "#reset-all").disabled = ![...this.#all.values()].some((c) => c.isChanged);
  }

  /** Makes controls for these settings, and takes away what is no longer there. */
  #arrange(settings) {
    const list = part(this.#root, "#params-list");
    const old = this.#all;
    this.#all = new Map(settings.map((setting) => {
      const control = old.get(setting.name);
      return [setting.name, control?.form === formOf(setting) ? control : this.#make(setting)];
    }));
    old.forEach((control, name) => this.#all.get(name) === control || control.element.remove());
    // Moved only where needed: an element that moves loses the focus.
    [...this.#all.values()].forEach(({ element }, i) => {
      if (list.children[i] !== element) list.insertBefore(element, list.children[i] ?? null);
    });
  }

  #make(setting) {
    const send = (text) => this.#sender.send({ [setting.name]: text });
    // Not at once: a field that is left because it is taken away is no cause to begin anew.
    return new Control(setting, send, () => setTimeout(() => this.show(this.#posted)));
  }

  /** Whether what is posted is the answer to all that was sent. */
  #settled() {
    return this.#sender.idle && !this.#posted.busy && performance.now() - this.#sender.answered >= SETTLED_AFTER;
  }

  #answered(fault) {
    const line = part(this.#root, "#set-fault");
    line.hidden = fault === null;
    line.textContent = fault ?? "";
    setTimeout(() => this.show(this.#posted), SETTLED_AFTER + 10);
  }

  #resetAll() {
    const changed = [...this.#all.values()].filter((c) => c.isChanged);
    changed.forEach((c) => c.release());
    this.#sender.send(Object.fromEntries(changed.map((c) => [c.name, null])));
  }

  async #copy() {
    const button = part(this.#root, "#set-copy");
    const done = await copy(this.#posted.set_line, part(this.#root, "#set-line"));
    button.textContent = done ? "Copied" : "Press Ctrl+C";
    setTimeout(() => (button.textContent = "Copy"), 1500);
  }
}

/** One parameter's control. */
class Control {
  element = make("div", "param");
  #setting;
  #reset = make("button", "param-reset", "Reset");
  #input;
  /** The value that was last shown, and the text that was last sent and not yet answered. */
  #shown = null;
  #sent = null;
  #held = false;

  constructor(setting, send, onReleased) {
    this.form = formOf(setting);
    this.#setting = setting;
    const id = `param-${setting.name}`;
    const head = make("div", "param-head");
    const label = make("label", "param-name", setting.name);
    label.htmlFor = id;
    label.id = `${id}-name`;
    this.#reset.type = "button";
    this.#reset.setAttribute("aria-label", `Reset ${setting.name}`);
    this.#reset.addEventListener("click", () => {
      this.release();
      send(null);
    });
    head.append(label, this.#reset);
    this.#input = INPUTS[setting.kind](setting, id, (text) => {
      this.#sent = text;
      this.#mark();
      send(text);
    });
    const row = make("div", "param-row");
    row.append(...this.#input.elements);
    this.element.append(head, row);
    if (setting.description) {
      const help = make("p", "param-help", setting.description);
      help.id = `${id}-help`;
      this.element.append(help);
      row.querySelectorAll("input, select, [role=radiogroup]").forEach((e) => e.setAttribute("aria-describedby", help.id));
    }
    row.addEventListener("pointerdown", () => (this.#held = true));
    for (const end of ["pointerup", "pointercancel"]) {
      row.addEventListener(end, () => {
        this.#held = false;
        onReleased();
      });
    }
    row.addEventListener("focusout", onReleased);
  }

  get name() {
    return this.#setting.name;
  }

  /** Whether the value isn't the scene's own, or a text stands in the field that the scene refused. */
  get isChanged() {
    return this.#setting.value !== this.#setting.default || this.#sent !== null;
  }

  /** Lets the next update change it, whatever the user did. */
  release() {
    this.#sent = null;
    this.#shown = null;
    this.#input.write(this.#setting);
  }

  /** Forgets what was sent and shown. */
  forget() {
    this.#sent = null;
    this.#shown = null;
  }

  /** Shows the value that is posted, unless the user is at it or an answer is still to come. */
  update(setting, settled) {
    this.#setting = setting;
    const answer = this.#sent !== null && this.#input.matches(setting, this.#sent);
    const mine = this.#held || this.#input.isTypedIn() || (this.#sent !== null && !settled && !answer);
    if (answer) this.#sent = null;
    if (setting.value !== this.#shown && !mine) {
      this.#input.write(setting);
      this.#shown = setting.value;
      this.#sent = null;
    }
    this.#mark();
  }

  #mark() {
    this.#reset.classList.toggle("changed", this.isChanged);
    this.#reset.title = `Back to ${this.#setting.default}`;
  }
}

/** What a control is made for: all of a setting but its values. */
function formOf({ name, description, kind, range, whole, unit, choices }) {
  return JSON.stringify([name, description, kind, range, whole, unit, choices]);
}

/**
 * For each kind, what makes its elements: `{ elements, write(setting), matches(setting, sent), isTypedIn() }`. `send` takes
 * the text of the language.
 */
const INPUTS = {
  number(setting, id, send) {
    const { range, whole, unit } = setting;
    const field = make("input");
    Object.assign(field, { id, type: "number", step: whole ? "1" : "any", inputMode: "decimal" });
    const slider = range && range[0] < range[1] ? make("input") : null;
    const isNumber = () => !Number.isNaN(field.valueAsNumber) && field.checkValidity();
    let last = "";
    if (range) [field.min, field.max] = range;
    if (slider) {
      Object.assign(slider, { type: "range", min: range[0], max: range[1], step: whole ? "1" : "any" });
      slider.setAttribute("aria-labelledby", `${id}-name`);
      slider.addEventListener("input", () => {
        field.value = last = short(neat(slider.valueAsNumber, range, whole));
        send(last + unit);
      });
    }
    field.addEventListener("input", () => {
      if (!isNumber()) return;
      last = short(field.valueAsNumber);
      if (slider) slider.value = last;
      send(last + unit);
    });
    // What can't be the value doesn't stay as if it were.
    field.addEventListener("blur", () => isNumber() || (field.value = last));
    const unitText = unit ? [make("span", "param-unit", unit === "deg" ? "°" : unit)] : [];
    return {
      elements: [...(slider ? [slider] : []), field, ...unitText],
      write({ number }) {
        field.value = last = short(number);
        if (slider) slider.value = last;
      },
      matches: ({ number }, sent) => number === parseFloat(sent),
      isTypedIn: () => document.activeElement === field,
    };
  },

  choice(setting, id, send) {
    const { choices } = setting;
    const matches = ({ value }, sent) => unquoted(value) === sent;
    const letters = choices.reduce((n, choice) => n + choice.length + 2, 0);
    if (letters > SIDE_BY_SIDE) {
      const select = make("select");
      select.id = id;
      select.append(...choices.map((choice) => new Option(choice)));
      select.addEventListener("change", () => send(select.value));
      return { elements: [select], write: ({ value }) => (select.value = unquoted(value)), matches, isTypedIn: () => false };
    }
    const group = make("div", "choices");
    group.id = id;
    group.setAttribute("role", "radiogroup");
    group.setAttribute("aria-labelledby", `${id}-name`);
    const radios = choices.map((choice) => {
      const radio = make("input");
      Object.assign(radio, { type: "radio", name: id, value: choice });
      radio.addEventListener("change", () => send(choice));
      const label = make("label");
      label.append(radio, make("span", "", choice));
      group.append(label);
      return radio;
    });
    const write = ({ value }) => radios.forEach((radio) => (radio.checked = radio.value === unquoted(value)));
    return { elements: [group], write, matches, isTypedIn: () => false };
  },

  switch(setting, id, send) {
    const box = make("input");
    Object.assign(box, { id, type: "checkbox" });
    box.addEventListener("change", () => send(String(box.checked)));
    return {
      elements: [box],
      write: ({ value }) => (box.checked = value === "true"),
      matches: ({ value }, sent) => value === sent,
      isTypedIn: () => false,
    };
  },

  color(setting, id, send) {
    const field = make("input");
    const code = make("output");
    Object.assign(field, { id, type: "color" });
    field.addEventListener("input", () => {
      code.value = field.value;
      send(field.value);
    });
    return {
      elements: [field, code],
      write({ color }) {
        field.value = color;
        code.value = color;
      },
      matches: ({ color }, sent) => color === sent,
      isTypedIn: () => false,
    };
  },

  text(setting, id, send) {
    return typed(id, "", unquoted, (text) => send(asText(text)));
  },

  other(setting, id, send) {
    return typed(id, "code", (value) => value, send);
  },
};

/** A field whose text is sent when it is left or Enter is pressed: half a word is seldom right. */
function typed(id, className, shown, send) {
  const field = make("input", className);
  Object.assign(field, { id, type: "text", spellcheck: false, autocomplete: "off" });
  let sent = null;
  field.addEventListener("input", () => (sent = null));
  field.addEventListener("change", () => send((sent = field.value)));
  return {
    elements: [field],
    write: ({ value }) => (field.value = shown(value)),
    matches: ({ value }, text) => value === text || shown(value) === text,
    isTypedIn: () => document.activeElement === field && sent !== field.value,
  };
}

/** Puts `text` on the clipboard; where the browser refuses (a page that isn't this machine's), selects it instead. */
async function copy(text, element) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    getSelection().selectAllChildren(element);
    // Old, but the only way without https.
    return document.execCommand("copy");
  }
}

function make(tag, className = "", text = "") {
  const element = document.createElement(tag);
  if (className) element.className = className;
  if (text) element.textContent = text;
  return element;
}

function part(root, selector) {
  return root.querySelector(selector);
}
