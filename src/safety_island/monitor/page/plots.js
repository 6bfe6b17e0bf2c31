// SPDX-License-Identifier: Apache-2.0
// The plots: one time axis and one cursor for all, limits as lines, marks where something happened.

import { clock, colour, number } from "./look.js";

const MS = 1e3, PER_CENT = 100;
const RIGHT = 42; // room for a second axis, kept free where there is none: all share one time axis
const DECADES = [0.1, 1, 10, 100, 1000];

// Each: title, unit of the left axis, series. A series: field, label, colour, unit; `dash` for what
// was asked for, `right` for the second axis, `times` for the unit, `digits` of its value.
// `lines(facts)` are the limits: value, label.
export const PLOTS = [
  {
    title: "Path error", unit: "m", right: "rad", symmetric: 0.05, symmetricRight: 0.02,
    series: [
      { field: "lateral_error", label: "lateral", colour: "blue", unit: "m", digits: 3 },
      { field: "yaw_error", label: "yaw", colour: "orange", unit: "rad", digits: 3, right: true, dash: [2, 3] },
    ],
    lines: () => [{ at: 0 }],
  },
  {
    title: "Speed", unit: "m/s", least: 1,
    series: [
      { field: "target_speed", label: "target", colour: "orange", unit: "m/s", digits: 2, dash: [7, 4] },
      { field: "speed", label: "measured", colour: "blue", unit: "m/s", digits: 2 },
    ],
  },
  {
    title: "Steering", unit: "rad", symmetric: 0.05,
    series: [
      { field: "command_angle", label: "command", colour: "orange", unit: "rad", digits: 3, dash: [7, 4] },
      { field: "steering", label: "measured", colour: "blue", unit: "rad", digits: 3 },
    ],
    lines: (facts) => [
      { at: facts.steer, label: `limit ${facts.steer.toFixed(2)} rad` },
      { at: -facts.steer, label: `limit −${facts.steer.toFixed(2)} rad` }, { at: 0 },
    ],
  },
  {
    title: "Acceleration", unit: "m/s²", right: "m/s³", symmetric: 0.5, symmetricRight: 1,
    series: [
      { field: "jerk", label: "jerk", colour: "purple", unit: "m/s³", digits: 2, right: true, dash: [2, 3] },
      { field: "command_acceleration", label: "command", colour: "orange", unit: "m/s²", digits: 2, dash: [7, 4] },
      { field: "acceleration", label: "measured", colour: "blue", unit: "m/s²", digits: 2 },
    ],
    lines: () => [{ at: 0 }],
  },
  {
    title: "Tick", unit: "ms", log: true,
    series: [
      { field: "tick_time", label: "takes", colour: "blue", unit: "ms", digits: 2, times: MS },
      { field: "lateness", label: "starts late by", colour: "purple", unit: "ms", digits: 2, times: MS, dash: [2, 3] },
    ],
    lines: (facts) => [{ at: facts.period * MS, label: `period ${(facts.period * MS).toFixed(0)} ms` }],
  },
  {
    title: "Age of the inputs, of their limit", unit: "%", least: 110, most: 200,
    series: [
      { field: "trajectory_age", label: "trajectory", colour: "blue", unit: "ms", digits: 0, times: MS, limit: 0 },
      { field: "odometry_age", label: "odometry", colour: "orange", unit: "ms", digits: 0, times: MS, limit: 1, dash: [7, 4] },
      { field: "steering_age", label: "steering", colour: "green", unit: "ms", digits: 0, times: MS, limit: 2, dash: [2, 3] },
      { field: "acceleration_age", label: "acceleration", colour: "purple", unit: "ms", digits: 0, times: MS, limit: 3, dash: [9, 3, 2, 3] },
    ],
    lines: () => [{ at: PER_CENT, label: "limit: the output ends" }],
  },
];

export class Plots {
  // facts: steer [rad], period [s], limits [s] of the inputs; marks: [{t, text, of}].
  constructor(place, store, facts, marks, onCursor) {
    this.store = store;
    this.facts = facts;
    this.marks = marks;
    this.onCursor = onCursor;
    this.cursorAt = null;
    this.waiting = [];
    this.place = place;
    this.observer = new ResizeObserver(() => this.resize());
    this.build();
  }

  build() {
    this.observer.disconnect();
    this.place.replaceChildren();
    this.charts = PLOTS.map((plot) => this.chart(plot));
    this.observer.observe(this.place);
  }

  chart(plot) {
    const figure = document.createElement("figure");
    figure.className = "card plot";
    const caption = document.createElement("figcaption");
    const title = document.createElement("h2");
    title.textContent = plot.title;
    const keys = document.createElement("ul");
    keys.className = "keys";
    const values = plot.series.map((series) => key(keys, series));
    caption.append(title, keys);
    const box = document.createElement("div");
    box.className = "chart";
    figure.append(caption, box);
    this.place.append(figure);
    const chart = new uPlot(this.options(plot, box), [[], ...plot.series.map(() => [])], box);
    return { plot, box, values, chart };
  }

  options(plot, box) {
    const axis = (extra) => ({
      stroke: () => colour("soft"), grid: { stroke: () => colour("grid"), width: 1 },
      ticks: { show: false }, font: "11px system-ui, sans-serif", gap: 4, ...extra,
    });
    const scales = {
      x: { time: true, auto: false },
      y: plot.log ? { distr: 3, range: () => [0.02, 1000] } : { range: (u, low, high) => range(low, high, plot) },
    };
    const axes = [
      axis({ size: 24, space: 70, values: times }),
      axis({ size: 46, space: 26, ...(plot.log && { splits: () => DECADES, filter: (u, splits) => splits, values: (u, ticks) => ticks.map(String) }) }),
    ];
    if (!plot.right) {
      axes.push(axis({ side: 1, size: RIGHT, values: (u, ticks) => ticks.map(() => ""), grid: { show: false } }));
    } else {
      scales.right = { range: (u, low, high) => range(low, high, { symmetric: plot.symmetricRight }) };
      axes.push(axis({ scale: "right", side: 1, size: RIGHT, space: 26, grid: { show: false } }));
    }
    return {
      width: Math.max(box.clientWidth, 100), height: Math.max(box.clientHeight, 60),
      padding: [6, 0, 0, 0], legend: { show: false }, scales, axes,
      cursor: { sync: { key: "time", setSeries: false }, drag: { x: false, y: false }, points: { size: 6 }, y: false },
      series: [{}, ...plot.series.map((s) => ({
        scale: s.right ? "right" : "y", stroke: () => colour(s.colour), width: s.dash ? 1.6 : 2,
        dash: s.dash, points: { show: false }, spanGaps: false,
      }))],
      hooks: {
        drawClear: [(u) => this.drawMarks(u)],
        draw: [(u) => this.drawLines(u, plot)],
        setCursor: [(u) => this.moved(u)],
      },
    };
  }

  resize() {
    for (const { chart, box } of this.charts) {
      const width = Math.max(box.clientWidth, 100), height = Math.max(box.clientHeight, 60);
      if (chart.width !== width || chart.height !== height) chart.setSize({ width, height });
    }
  }

  moved(u) {
    if (!u.cursor.event && u.cursor.left >= 0) return; // another plot's cursor, told by that one
    const at = u.cursor.left >= 0 ? u.posToVal(u.cursor.left, "x") : null;
    if (at === this.cursorAt) return;
    this.cursorAt = at;
    this.onCursor(at);
    this.showValues();
  }

  get width() {
    return this.charts[0].chart.width;
  }

  // Draw the time from..to [s]: one plot now, the others as `drawNext` is called.
  draw(from, to) {
    this.span = [from, to];
    this.waiting = [...this.charts];
    this.drawNext();
  }

  // Draw the next plot that waits; whether there was one.
  drawNext() {
    const next = this.waiting.shift();
    if (next) this.drawOne(next);
    return Boolean(next);
  }

  drawOne({ plot, chart }) {
    const [from, to] = this.span;
    const names = plot.series.map((series) => series.field);
    const gap = Math.max(1, 4 * this.facts.period);
    const data = this.store.span(names, from, to, chart.width, gap);
    plot.series.forEach((series, k) => scaled(data[k + 1], this.scale(series)));
    chart.batch(() => {
      chart.setData(data, false);
      chart.setScale("x", { min: from, max: to });
    });
  }

  scale(series) {
    if (series.limit === undefined) return series.times ?? 1;
    return PER_CENT / this.facts.limits[series.limit];
  }

  // The values at the cursor, or the newest.
  showValues() {
    const index = this.cursorAt === null ? this.store.count - 1 : this.store.first(this.cursorAt);
    for (const { plot, values } of this.charts) {
      plot.series.forEach((series, k) => {
        const value = this.store.value(series.field, index) * (series.times ?? 1);
        const text = number(value, series.digits);
        if (values[k].textContent !== text) values[k].textContent = text;
      });
    }
  }

  drawMarks(u) {
    const { ctx, bbox } = u;
    ctx.save();
    for (const mark of this.marks) {
      if (mark.t < u.scales.x.min || mark.t > u.scales.x.max) continue;
      const x = Math.round(u.valToPos(mark.t, "x", true)) + 0.5;
      ctx.strokeStyle = colour({ fault: "red", reaction: "green" }[mark.of] ?? "soft");
      ctx.lineWidth = devicePixelRatio * (mark.of === "fault" ? 2 : 1);
      ctx.setLineDash(mark.of === "fault" ? [] : [3 * devicePixelRatio, 3 * devicePixelRatio]);
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
    }
    ctx.restore();
  }

  drawLines(u, plot) {
    const { ctx, bbox } = u;
    const scale = u.scales.y;
    ctx.save();
    ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.textAlign = "left";
    for (const line of plot.lines?.(this.facts) ?? []) {
      if (!(line.at >= scale.min && line.at <= scale.max)) continue;
      const y = Math.round(u.valToPos(line.at, "y", true)) + 0.5;
      ctx.strokeStyle = ctx.fillStyle = colour(line.label ? "red" : "soft");
      ctx.globalAlpha = line.label ? 0.9 : 0.4;
      ctx.lineWidth = devicePixelRatio;
      ctx.setLineDash(line.label ? [5 * devicePixelRatio, 4 * devicePixelRatio] : []);
      ctx.beginPath();
      ctx.moveTo(bbox.left, y);
      ctx.lineTo(bbox.left + bbox.width, y);
      ctx.stroke();
      if (line.label) ctx.fillText(line.label, bbox.left + 6 * devicePixelRatio, y - 4 * devicePixelRatio);
    }
    ctx.restore();
  }
}

// A key of the legend: how the line looks, its label, its value; returns the place of the value.
function key(list, series) {
  const item = document.createElement("li");
  const swatch = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  swatch.setAttribute("viewBox", "0 0 22 8");
  swatch.setAttribute("aria-hidden", "true");
  const line = document.createElementNS("http://www.w3.org/2000/svg", "path");
  line.setAttribute("d", "M0 4H22");
  line.setAttribute("fill", "none");
  line.setAttribute("stroke", `var(--${series.colour})`);
  line.setAttribute("stroke-width", "2.5");
  if (series.dash) line.setAttribute("stroke-dasharray", series.dash.join(" "));
  swatch.append(line);
  const value = document.createElement("b");
  value.textContent = "–";
  value.dataset.field = series.field;
  item.append(swatch, `${series.label} `, value, ` ${series.unit}`);
  list.append(item);
  return value;
}

function scaled(values, factor) {
  if (factor === 1) return;
  for (let i = 0; i < values.length; i++) if (values[i] !== null) values[i] *= factor;
}

// The range of an axis: about zero where it is symmetric, never less than `symmetric` or `least`.
function range(low, high, { symmetric, least, most }) {
  if (symmetric) {
    const most = Math.max(symmetric, Math.abs(low ?? 0), Math.abs(high ?? 0)) * 1.12;
    return [-most, most];
  }
  const top = Math.min(most ?? Infinity, Math.max(least ?? 1, high ?? 0));
  return [Math.min(0, low ?? 0), top * 1.08];
}

// Times of day, but none that the edge would cut.
function times(u, ticks) {
  const { min, max } = u.scales.x, edge = ((max - min) * 28 * devicePixelRatio) / u.bbox.width;
  return ticks.map((t) => (t < min + edge || t > max - edge ? "" : clock(t, 0)));
}
