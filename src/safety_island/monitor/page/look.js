// SPDX-License-Identifier: Apache-2.0
// Colours of the theme in use, and how times and numbers are written.

const NEXT = { system: "light", light: "dark", dark: "system" };
const known = new Map();

export function colour(name) {
  if (!known.has(name)) {
    known.set(name, getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
  }
  return known.get(name);
}

export class Theme {
  // changed() is called when the colours are others.
  constructor(button, changed) {
    this.button = button;
    this.changed = changed;
    this.set(localStorage.getItem("theme") ?? "system");
    button.onclick = () => this.next();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.set(this.name));
  }

  next() {
    this.set(NEXT[this.name]);
  }

  set(name) {
    this.name = name in NEXT ? name : "system";
    localStorage.setItem("theme", this.name);
    if (this.name === "system") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = this.name;
    this.button.textContent = `Theme: ${this.name}`;
    known.clear();
    this.changed();
  }
}

// A time of day, with so many digits of a second.
export function clock(t, digits) {
  const date = new Date(t * 1000);
  const two = (value) => String(value).padStart(2, "0");
  const seconds = (date.getSeconds() + (digits ? (t % 1) : 0)).toFixed(digits).padStart(digits ? 3 + digits : 2, "0");
  return `${two(date.getHours())}:${two(date.getMinutes())}:${seconds}`;
}

export function number(value, digits) {
  if (!Number.isFinite(value)) return "–";
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}

// Change a text only when it is another one: a page that stands still costs nothing.
export function say(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
