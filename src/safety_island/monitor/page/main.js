// SPDX-License-Identifier: Apache-2.0
// Puts the page together: messages in, view, plots and panels out.

import { Link } from "./link.js";
import { Theme, clock, number, say } from "./look.js";
import { TopView } from "./map.js";
import { Panels } from "./panels.js";
import { Plots } from "./plots.js";
import { csv, download, png } from "./save.js";
import { Store } from "./store.js";

const $ = (id) => document.getElementById(id);
// A plot moves by so many pixels at a time, but in steps of at least and at most so long.
const PLOT_STEP_PX = 1.4, PLOT_MS = [90, 300];
const REST_MS = 26; // between two frames: some 30 a second
const READ_EVERY_MS = 200; // numbers that are to be read
const TOAST_MS = 6000;

const page = { store: null, view: null, plots: null, marks: [], facts: null, isLive: false };
const axis = { seconds: 60, end: null, offset: null }; // end: null while it is live
let drawnAt = 0, drawnSpan = "", readAt = 0;

const link = new Link(take, connection);
const panels = new Panels((key) => link.press(key), Boolean(link.token));
const theme = new Theme($("theme"), recolour);

const takers = {
  hello(hello) {
    page.store = new Store(hello.fields, hello.seconds);
    page.marks.length = 0;
    page.facts ??= { period: 0.15, limits: [0.9, 0.5, 0.5, 0.5] };
    page.facts.steer = hello.vehicle.max_steer_angle;
    page.view ??= makeView(hello.vehicle);
    if (page.plots) page.plots.store = page.store;
    else page.plots = new Plots($("plots"), page.store, page.facts, page.marks, cursor);
    panels.hello(hello);
  },
  rows({ rows }) {
    for (const row of rows) page.store.add(row);
    tick(rows.at(-1)?.[0]);
  },
  mark(mark) {
    page.marks.push(mark);
    panels.event(mark);
  },
  pose(pose) {
    tick(pose.t);
    if (axis.end === null) page.view.setPose(pose);
  },
  path(path) {
    page.view.path = path;
    page.view.isStale = true;
  },
  predicted(path) {
    page.view.predicted = path;
    page.view.isStale = true;
  },
  summary(found) {
    tick(found.t);
    page.facts.period = found.period_s ?? page.facts.period;
    found.inputs.forEach(({ age_limit_s: limit }, i) => {
      if (limit !== null && i < page.facts.limits.length) page.facts.limits[i] = limit;
    });
    page.view.stopDist = found.stop_dist ?? NaN;
    say($("now-stop"), number(found.stop_dist, 1));
    panels.summary(found);
  },
  silence(found) {
    tick(found.t);
    panels.silence(found);
  },
  can: (found) => panels.can(found),
  buttons: ({ buttons }) => panels.buttons(buttons),
  refused: () => toast("The monitor refused that: open the address as the demo printed it, with its token."),
};

function take(message) {
  if (message.kind === "hello") connection("live", "live");
  takers[message.kind]?.(message);
}

function connection(state, text) {
  page.isLive = state === "live";
  const element = $("link");
  element.dataset.is = axis.end !== null && page.isLive ? "paused" : state;
  say(element, axis.end !== null && page.isLive ? "paused" : text);
}

// Learn how far this clock is from the monitor's: the quickest message shows it best.
function tick(t) {
  if (t === undefined) return;
  const offset = performance.now() / 1000 - t;
  axis.offset = axis.offset === null || offset < axis.offset ? offset : axis.offset + 0.002 * (offset - axis.offset);
}

function makeView(vehicle) {
  const view = new TopView($("map"), vehicle);
  view.onFollow = (follows) => $("follow").setAttribute("aria-pressed", String(follows));
  return view;
}

function now() {
  const { store } = page, last = store.count - 1;
  say($("now-speed"), number(store.value("speed", last), 2));
  say($("now-target"), number(store.value("target_speed", last), 2));
  say($("now-lateral"), number(store.value("lateral_error", last), 3));
  say($("now-steering"), number(store.value("steering", last), 3));
  say($("now-tick"), number(store.value("tick_time", last) * 1e3, 2));
}

function cursor(at) {
  page.view.cursorAt = at;
  page.view.isStale = true;
}

function recolour() {
  if (page.view) page.view.isStale = true;
  drawnSpan = "";
  for (const { chart } of page.plots?.charts ?? []) chart.redraw(false, true);
}

function liveEnd() {
  return axis.offset === null ? page.store.newest : performance.now() / 1000 - axis.offset;
}

// Show the time up to `end` [s]; null is now, and on from there.
function show(end) {
  const { store } = page;
  if (!store?.count) return;
  axis.end = end === null ? null : Math.min(Math.max(end, store.oldest), liveEnd());
  const back = axis.end === null ? 0 : liveEnd() - axis.end;
  $("back").value = String(store.seconds - back);
  say($("back-said"), axis.end === null ? "live" : clock(axis.end, 0));
  $("pause").setAttribute("aria-pressed", String(axis.end !== null));
  say($("pause"), axis.end === null ? "Pause" : "Go on");
  connection(page.isLive ? "live" : "lost", page.isLive ? "live" : $("link").textContent);
}

// Asked for some 30 times a second: more often would show nothing more.
function frame(at) {
  setTimeout(() => requestAnimationFrame(frame), REST_MS);
  if (!page.view || document.hidden) return;
  if (axis.offset !== null) page.view.expire(liveEnd());
  page.view.draw();
  if (at - readAt >= READ_EVERY_MS) {
    readAt = at;
    now();
    page.plots.showValues();
  }
  if (page.plots.drawNext()) return; // one plot a frame: no frame takes long
  const pixel = (1000 * axis.seconds) / page.plots.width;
  if (at - drawnAt < Math.min(PLOT_MS[1], Math.max(PLOT_MS[0], PLOT_STEP_PX * pixel))) return;
  const end = axis.end ?? (page.isLive ? liveEnd() : page.store.newest);
  const span = `${end}/${axis.seconds}/${page.store.count}/${page.marks.length}`;
  if (!Number.isFinite(end) || span === drawnSpan) return;
  drawnAt = at;
  drawnSpan = span;
  page.plots.draw(end - axis.seconds, end);
}

function toast(text) {
  const element = $("toast");
  element.textContent = text;
  element.hidden = false;
  clearTimeout(toast.timer);
  toast.timer = setTimeout(() => (element.hidden = true), TOAST_MS);
}

function span() {
  const end = axis.end ?? page.store.newest + 1e-3;
  return [end - axis.seconds, end];
}

function name(ending) {
  return `safety-island-${clock(span()[1], 0).replaceAll(":", "")}.${ending}`;
}

const pause = () => show(axis.end === null ? liveEnd() : null);
const step = (share) => show((axis.end ?? liveEnd()) + share * axis.seconds);
const follow = () => page.view?.setFollow(!page.view.follows);

$("pause").onclick = pause;
$("window").onchange = () => (axis.seconds = Number($("window").value));
$("back").oninput = () => {
  const back = Number($("back").max) - Number($("back").value);
  show(back < 1 ? null : liveEnd() - back);
};
$("save-csv").onclick = () => download(csv(page.store, ...span()), name("csv"));
$("save-png").onclick = () => png($("map"), page.plots.charts, (blob) => download(blob, name("png")));
$("zoom-in").onclick = () => page.view?.zoom(1.3);
$("zoom-out").onclick = () => page.view?.zoom(1 / 1.3);
$("follow").onclick = follow;

const KEYS = {
  " ": pause, ArrowLeft: () => step(-0.2), ArrowRight: () => step(0.2), End: () => show(null),
  "+": () => page.view?.zoom(1.3), "-": () => page.view?.zoom(1 / 1.3), f: follow, t: () => theme.next(),
};

document.addEventListener("keydown", (event) => {
  const inside = event.target.closest("button, select, input");
  if (event.ctrlKey || event.altKey || event.metaKey || (inside && event.key !== "End")) return;
  const act = KEYS[event.key] ?? KEYS[event.key.toLowerCase()];
  if (!act) return;
  event.preventDefault();
  act();
});

requestAnimationFrame(frame);
