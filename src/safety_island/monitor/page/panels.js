// SPDX-License-Identifier: Apache-2.0
// States, inputs, counters, outputs and events, in words.

import { clock, number, say } from "./look.js";

const GOOD = new Set(["ACTIVE", "READY", "DRIVE", "STOPPING", "STOPPED"]);
const WARN = new Set(["INIT", "HOLD"]);
const MOST_EVENTS = 200;

const $ = (id) => document.getElementById(id);

export function kindOf(name) {
  return GOOD.has(name) ? "good" : WARN.has(name) ? "warn" : "bad";
}

export class Panels {
  constructor(press, mayAct) {
    this.press = press;
    this.mayAct = mayAct;
    this.lamps = { island: null, controller: null };
  }

  hello(hello) {
    say($("where"), hello.where);
    say($("about"), `safety island ${hello.version}`);
    document.title = `safety island — ${hello.where}`;
    this.lamps.island = lampsOf($("lamps-island"), hello.states);
    this.lamps.controller = lampsOf($("lamps-controller"), hello.longitudinal_states);
    $("events").replaceChildren(none());
  }

  summary(found) {
    light(this.lamps.island, found.state);
    light(this.lamps.controller, found.longitudinal_state);
    this.verdict(judge(found), found.state, [found.longitudinal_state, mode(found)], found.why);
    list($("facts"), [
      ["reason", found.reason === "NONE" ? "none" : words(found.reason) + (found.subject ? `: ${found.subject}` : "")],
      ["operation mode", `${found.operation_mode}${found.engaged ? ", engaged" : ""}`],
      ["MPC", words(found.mpc_status ?? "not run yet")],
      ["limits that act", found.controller_limits.map(words).join(", ") || "none"],
      ["guard", guard(found)],
    ]);
    list($("output"), [
      ["goes to", words(found.output_mode)],
      ["commands", `${found.commands} sent`],
      [found.control.topic.split("/").at(-1), found.control.rate_hz ? `${number(found.control.rate_hz, 1)} Hz on the domain` : "nothing comes on the domain"],
      ["period", found.period_s ? `${number(found.period_s * 1e3, 1)} ms` : "–"],
      ["memory", `${number(found.memory_bytes / 1e6, 0)} MB`],
    ]);
    this.inputs(found.inputs);
    this.counters(found);
  }

  silence(found) {
    light(this.lamps.island, null);
    light(this.lamps.controller, null);
    this.verdict("bad", "not heard", [], found.why);
  }

  verdict(kind, state, more, why) {
    $("verdict").dataset.is = kind;
    say($("state"), state);
    say($("controller"), more.filter(Boolean).join(" · "));
    say($("why"), why);
  }

  inputs(rows) {
    const table = $("inputs");
    if (table.children.length !== rows.length + 1) {
      table.replaceChildren(heading(), ...rows.map(inputRow));
    }
    rows.forEach((row, i) => fillInput(table.children[i + 1], row));
  }

  counters(found) {
    const rows = Object.entries(found.counters).map(([text, count]) => [text, count, ""]);
    for (const input of found.inputs) {
      const refused = Object.entries(input.refused);
      const total = refused.reduce((sum, [, count]) => sum + count, 0);
      rows.push([`samples of ${input.name} refused`, total, ""]);
      for (const [reason, count] of refused) rows.push([words(reason), count, "sub"]);
    }
    counts($("counters"), rows);
  }

  can(found) {
    const frames = found.can.frames ?? [];
    const values = Object.entries(found.can).filter(([, value]) => value?.unit !== undefined);
    const table = document.createElement("table");
    table.className = "frames";
    for (const frame of frames) { // as candump writes them: identifier#data
      const [id, data] = frame.split("#");
      cells(table, [`frame 0x${id}`, code(data.replace(/..(?=.)/g, "$& ")), ""]);
    }
    for (const [name, value] of values) {
      cells(table, [words(name), value.defined ? `${value.value} ${value.unit}` : "not defined", ""]);
    }
    if (found.can.sequence !== undefined) cells(table, ["sequence", `#${found.can.sequence}`, found.can.mode ?? ""]);
    if (found.can.fault) cells(table, ["fault", found.can.fault, ""]);
    $("can").replaceChildren(table);
  }

  event(mark) {
    const events = $("events");
    events.querySelector(".none")?.remove();
    const item = document.createElement("li");
    item.dataset.of = mark.of;
    const time = document.createElement("time");
    time.textContent = clock(mark.t, 1);
    const text = document.createElement("span");
    text.textContent = mark.text;
    item.append(time, text);
    events.prepend(item);
    while (events.children.length > MOST_EVENTS) events.lastChild.remove();
  }

  buttons(buttons) {
    const place = $("buttons");
    $("faults").hidden = buttons.length === 0;
    if (place.children.length !== buttons.length) place.replaceChildren(...buttons.map((b) => this.button(b)));
    buttons.forEach((button, i) => {
      const made = place.children[i];
      made.setAttribute("aria-pressed", String(Boolean(button.active)));
      made.disabled = !this.mayAct;
    });
    if (!this.mayAct) {
      say($("faults-hint"), "To press these, open the address as the demo printed it: it holds a token.");
    }
  }

  button({ key, label, clears }) {
    const made = document.createElement("button");
    made.textContent = label;
    made.dataset.key = key;
    if (clears) made.className = "clear";
    made.onclick = () => this.press(key);
    return made;
  }
}

function judge(found) {
  if (!found.flows) return kindOf(found.state) === "bad" ? "bad" : "warn";
  if (found.longitudinal_state === "EMERGENCY") return "bad";
  return found.free ? "good" : "warn";
}

function mode(found) {
  return found.engaged ? "engaged" : words(found.operation_mode).toLowerCase();
}

function guard(found) {
  const limits = found.guard_limits.map(words).join(", ");
  return `${words(found.guard_verdict ?? "not asked")}${limits ? `: ${limits}` : ""}`;
}

// NAMES_OF_THE_CODE as words.
function words(name) {
  return String(name).toLowerCase().replaceAll("_", " ").replace(/\b(mpc|can|dds)\b/g, (w) => w.toUpperCase());
}

function lampsOf(list, names) {
  list.replaceChildren(...names.map((name) => {
    const lamp = document.createElement("li");
    lamp.textContent = name;
    lamp.dataset.is = kindOf(name);
    return lamp;
  }));
  return [...list.children];
}

function light(lamps, name) {
  for (const lamp of lamps ?? []) {
    const is = String(lamp.textContent === name);
    if (lamp.getAttribute("aria-current") !== is) lamp.setAttribute("aria-current", is);
  }
}

function list(place, rows) {
  if (place.children.length !== 2 * rows.length) {
    place.replaceChildren(...rows.flatMap(() => [document.createElement("dt"), document.createElement("dd")]));
  }
  rows.forEach(([name, value], i) => {
    say(place.children[2 * i], name);
    say(place.children[2 * i + 1], value);
  });
}

function counts(place, rows) {
  list(place, rows.map(([name, count]) => [name, String(count)]));
  rows.forEach(([, count, kind], i) => {
    place.children[2 * i].className = kind;
    place.children[2 * i + 1].className = count ? "some" : "";
  });
}

function heading() {
  return row(["input", "rate", "age against its limit"], "columnheader");
}

function row(texts, role) {
  const made = document.createElement("div");
  made.setAttribute("role", "row");
  for (const text of texts) {
    const cell = document.createElement("span");
    cell.setAttribute("role", role);
    cell.textContent = text;
    made.append(cell);
  }
  if (texts[1] === "rate") made.children[1].className = "rate";
  return made;
}

function inputRow(input) {
  const made = row([input.name, "", ""], "cell");
  const [name, rate, age] = made.children;
  name.className = "name";
  name.title = input.topic;
  rate.className = "rate";
  age.className = "meter";
  const text = document.createElement("span");
  const bar = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  const track = document.createElement("i");
  bar.setAttribute("preserveAspectRatio", "none");
  bar.setAttribute("viewBox", "0 0 100 6");
  const fill = document.createElementNS("http://www.w3.org/2000/svg", "rect");
  fill.setAttribute("height", "6");
  bar.append(fill);
  track.append(bar);
  age.replaceChildren(text, track);
  const more = document.createElement("span");
  more.setAttribute("role", "cell");
  more.className = "more";
  made.append(more);
  return made;
}

function fillInput(made, input) {
  const [, rate, meter, more] = made.children;
  say(rate, input.expected_hz === null ? "on change" : `${number(input.rate_hz, 1)} Hz`);
  const share = input.age_limit_s ? input.age_s / input.age_limit_s : 0;
  const never = input.age_s === null;
  meter.dataset.is = never || share >= 1 ? "bad" : input.warnings.length ? "warn" : "good";
  meter.children[1].hidden = input.age_limit_s === null;
  const limit = input.age_limit_s === null ? "" : ` of ${number(input.age_limit_s, 2)} s`;
  say(meter.children[0], never ? "never accepted" : `${number(input.age_s, 2)}${limit || " s, no limit"}`);
  const width = String(never ? 100 : Math.min(100, Math.round(100 * share)));
  const fill = meter.querySelector("rect");
  if (fill.getAttribute("width") !== width) fill.setAttribute("width", width);
  const notes = [input.publisher ?? "no publisher yet"];
  if (input.other_writers) notes.push(`${input.other_writers} other publishers`);
  if (input.warnings.length) notes.push(`warning: ${input.warnings.map(words).join(", ")}`);
  if (input.refused_in_a_row) notes.push(`last ${input.refused_in_a_row} refused: ${words(input.last_refusal)}`);
  say(more, notes.join(" · "));
}

function cells(table, texts) {
  const made = table.insertRow();
  texts.forEach((text) => made.insertCell().append(text));
}

function code(text) {
  const made = document.createElement("code");
  made.textContent = text;
  return made;
}

function none() {
  const made = document.createElement("li");
  made.className = "none";
  made.textContent = "nothing yet";
  return made;
}
