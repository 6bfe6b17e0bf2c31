// SPDX-License-Identifier: Apache-2.0
// What is shown, as a table or as a picture.

import { colour } from "./look.js";

const UNITS = {
  t: "s", lateral_error: "m", yaw_error: "rad", speed: "m/s", target_speed: "m/s", steering: "rad",
  command_angle: "rad", acceleration: "m/s^2", command_acceleration: "m/s^2", jerk: "m/s^3",
  tick_time: "s", lateness: "s", trajectory_age: "s", odometry_age: "s", steering_age: "s",
  acceleration_age: "s", state: "number", longitudinal_state: "number",
};

// The rows from..to [s], as CSV with units in the header.
export function csv(store, from, to) {
  const lines = [store.fields.map((name) => `${name} [${UNITS[name] ?? ""}]`).join(",")];
  for (let i = store.first(from); i < store.first(to); i++) {
    lines.push(store.fields.map((name) => text(store.columns[name][i])).join(","));
  }
  return new Blob([lines.join("\n") + "\n"], { type: "text/csv" });
}

// View and plots below each other, as PNG; hand it to `done`.
export function png(view, charts, done) {
  const parts = [{ title: "Top view", canvas: view }];
  for (const { plot, chart } of charts) parts.push({ title: title(plot), canvas: chart.ctx.canvas });
  const head = 30 * devicePixelRatio, gap = 10 * devicePixelRatio;
  const sheet = document.createElement("canvas");
  sheet.width = Math.max(...parts.map(({ canvas }) => canvas.width)) + 2 * gap;
  sheet.height = parts.reduce((sum, { canvas }) => sum + canvas.height + head, gap);
  const ctx = sheet.getContext("2d");
  ctx.fillStyle = colour("card");
  ctx.fillRect(0, 0, sheet.width, sheet.height);
  ctx.font = `600 ${13 * devicePixelRatio}px system-ui, sans-serif`;
  let y = 0;
  for (const part of parts) {
    ctx.fillStyle = colour("ink");
    ctx.fillText(part.title, gap, y + head * 0.68);
    ctx.drawImage(part.canvas, gap, y + head);
    y += part.canvas.height + head;
  }
  sheet.toBlob(done, "image/png");
}

export function download(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

function title(plot) {
  return `${plot.title} [${plot.unit}]: ${plot.series.map(({ label }) => label).join(", ")}`;
}

function text(value) {
  return Number.isFinite(value) ? String(value) : "";
}
