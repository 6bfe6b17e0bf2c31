// SPDX-License-Identifier: Apache-2.0
// The top view: world in metres, x to the right, y up; the camera follows, pans and zooms.

import { colour } from "./look.js";

const TRAIL = 4000, TRAIL_M = 0.5; // places that are kept, and how far apart
const SCALES = [3, 120]; // pixels a metre
const PATH_S = 2, PREDICTED_S = 1; // ages at which they are old
const FOLLOW_AT = 0.42; // the vehicle's place when followed, from the left

export class TopView {
  constructor(canvas, vehicle) {
    this.canvas = canvas;
    this.vehicle = vehicle;
    this.path = this.predicted = null;
    this.pathIsOld = false;
    this.pose = null;
    this.trail = [];
    this.stopDist = NaN;
    this.cursorAt = null;
    this.scale = Math.min(24, Math.max(11, canvas.clientWidth / 45));
    this.centre = { x: 0, y: 0 };
    this.follows = true;
    this.isStale = true;
    this.listen();
    new ResizeObserver(() => (this.isStale = true)).observe(canvas);
  }

  listen() {
    const { canvas } = this;
    const held = new Map();
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      held.set(event.pointerId, event);
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = held.get(event.pointerId);
      if (!before) return;
      const others = [...held.values()].filter((one) => one.pointerId !== event.pointerId);
      if (others.length) {
        const far = (a, b) => Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
        this.zoom(far(event, others[0]) / Math.max(1, far(before, others[0])));
      } else {
        this.pan(event.clientX - before.clientX, event.clientY - before.clientY);
      }
      held.set(event.pointerId, event);
    });
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, (event) => held.delete(event.pointerId));
    }
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY * 0.0015));
    }, { passive: false });
  }

  pan(dx, dy) {
    if (Math.hypot(dx, dy) === 0) return;
    this.setFollow(false);
    this.centre.x -= dx / this.scale;
    this.centre.y += dy / this.scale;
    this.isStale = true;
  }

  zoom(factor) {
    this.scale = Math.min(SCALES[1], Math.max(SCALES[0], this.scale * factor));
    this.isStale = true;
  }

  setFollow(follows) {
    this.follows = follows;
    this.isStale = true;
    this.onFollow?.(follows);
  }

  setPose(pose) {
    const last = this.trail.at(-1);
    if (!last || Math.hypot(pose.x - last.x, pose.y - last.y) > TRAIL_M) {
      this.trail.push({ t: pose.t, x: pose.x, y: pose.y });
      if (this.trail.length > TRAIL) this.trail.splice(0, TRAIL / 4);
    }
    this.pose = pose;
    this.isStale = true;
  }

  // Draw if anything has changed.
  draw() {
    if (!this.isStale) return;
    this.isStale = false;
    const { canvas } = this;
    const ratio = devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    const ctx = (this.ctx = canvas.getContext("2d"));
    if (this.follows && this.pose) this.look(width);
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.fillStyle = colour("card");
    ctx.fillRect(0, 0, width, height);
    this.grid(width, height);
    ctx.translate(width / 2, height / 2);
    ctx.scale(this.scale, -this.scale);
    ctx.translate(-this.centre.x, -this.centre.y);
    ctx.lineCap = "round";
    this.drawPath();
    this.drawTrail();
    this.drawStop();
    this.drawPredicted();
    this.drawVehicle();
    this.drawCursor();
    this.scaleBar(width, height, ratio);
  }

  // The camera looks ahead of the vehicle.
  look(width) {
    const ahead = ((0.5 - FOLLOW_AT) * width) / this.scale;
    const wanted = {
      x: this.pose.x + ahead * Math.cos(this.pose.yaw) + this.vehicle.wheel_base / 2,
      y: this.pose.y + ahead * Math.sin(this.pose.yaw),
    };
    const far = Math.hypot(wanted.x - this.centre.x, wanted.y - this.centre.y);
    const share = far > 30 ? 1 : 0.25;
    this.centre.x += share * (wanted.x - this.centre.x);
    this.centre.y += share * (wanted.y - this.centre.y);
    if (far > 0.02) this.isStale = true;
  }

  grid(width, height) {
    const { ctx } = this;
    const step = [1, 2, 5, 10, 20, 50, 100].find((metres) => metres * this.scale >= 48) ?? 100;
    const left = this.centre.x - width / 2 / this.scale, bottom = this.centre.y - height / 2 / this.scale;
    ctx.strokeStyle = colour("grid");
    ctx.lineWidth = 1;
    ctx.beginPath();
    for (let x = Math.ceil(left / step) * step; (x - left) * this.scale < width; x += step) {
      const at = Math.round((x - left) * this.scale) + 0.5;
      ctx.moveTo(at, 0);
      ctx.lineTo(at, height);
    }
    for (let y = Math.ceil(bottom / step) * step; (y - bottom) * this.scale < height; y += step) {
      const at = Math.round(height - (y - bottom) * this.scale) + 0.5;
      ctx.moveTo(0, at);
      ctx.lineTo(width, at);
    }
    ctx.stroke();
    this.step = step;
  }

  trace({ x, y }) {
    this.ctx.beginPath();
    for (let i = 0; i < x.length; i++) this.ctx.lineTo(x[i], y[i]);
  }

  get width() {
    const { wheel_tread, left_overhang, right_overhang } = this.vehicle;
    return wheel_tread + left_overhang + right_overhang;
  }

  drawPath() {
    if (!this.path?.x.length) return;
    const { ctx } = this;
    ctx.globalAlpha = this.pathIsOld ? 0.35 : 1;
    this.trace(this.path);
    ctx.lineJoin = "bevel"; // round ones cost most of the time of a frame
    ctx.strokeStyle = colour("road");
    ctx.lineWidth = this.width + 1.2;
    ctx.stroke();
    ctx.strokeStyle = colour("sky");
    ctx.lineWidth = 2 / this.scale;
    ctx.setLineDash([8 / this.scale, 7 / this.scale]);
    ctx.stroke();
    ctx.setLineDash([]);
    ctx.globalAlpha = 1;
  }

  // What is no longer published must not look as if it were: the prediction goes, the path pales.
  expire(now) {
    const isOld = Boolean(this.path) && now - this.path.t > PATH_S;
    const isGone = Boolean(this.predicted) && now - this.predicted.t > PREDICTED_S;
    if (isOld === this.pathIsOld && !isGone) return;
    this.pathIsOld = isOld;
    if (isGone) this.predicted = null;
    this.isStale = true;
  }

  drawTrail() {
    const { ctx } = this;
    const reach = (this.canvas.clientWidth + this.canvas.clientHeight) / 2 / this.scale;
    const near = ({ x, y }) => Math.abs(x - this.centre.x) + Math.abs(y - this.centre.y) < 2 * reach;
    const trail = [...this.trail.filter(near), this.pose].filter(Boolean);
    if (trail.length < 2) return;
    ctx.strokeStyle = colour("purple");
    ctx.lineWidth = 2.5 / this.scale;
    ctx.lineJoin = "bevel";
    ctx.globalAlpha = 0.85;
    ctx.beginPath();
    trail.forEach(({ x, y }, i) => {
      const jumped = i && Math.hypot(x - trail[i - 1].x, y - trail[i - 1].y) > 5;
      if (i && !jumped) ctx.lineTo(x, y);
      else ctx.moveTo(x, y);
    });
    ctx.stroke();
    ctx.globalAlpha = 1;
  }

  drawPredicted() {
    if (!this.predicted?.x.length) return;
    const { ctx } = this;
    this.trace(this.predicted);
    ctx.strokeStyle = colour("orange");
    ctx.lineWidth = 3.5 / this.scale;
    ctx.stroke();
  }

  // The place so far along the path from the vehicle, with its direction.
  ahead(distance) {
    const { x, y } = this.path;
    let nearest = 0, least = Infinity;
    for (let i = 0; i < x.length; i++) {
      const far = Math.hypot(x[i] - this.pose.x, y[i] - this.pose.y);
      if (far < least) [least, nearest] = [far, i];
    }
    const towards = distance < 0 ? -1 : 1;
    let left = Math.abs(distance);
    for (let i = nearest; i + towards >= 0 && i + towards < x.length; i += towards) {
      const dx = x[i + towards] - x[i], dy = y[i + towards] - y[i], step = Math.hypot(dx, dy);
      if (step >= left && step > 0) {
        const share = left / step;
        return { x: x[i] + share * dx, y: y[i] + share * dy, yaw: Math.atan2(towards * dy, towards * dx) };
      }
      left -= step;
    }
    return left < 1 && x.length > 1 ? endOf(x, y, towards) : null;
  }

  drawStop() {
    if (!Number.isFinite(this.stopDist) || !this.pose || !(this.path?.x.length > 1)) return;
    const place = this.ahead(this.stopDist);
    if (!place) return;
    const { ctx } = this;
    const reach = this.width / 2 + 0.9;
    const across = { x: -Math.sin(place.yaw) * reach, y: Math.cos(place.yaw) * reach };
    ctx.strokeStyle = colour("red");
    ctx.lineWidth = Math.max(0.35, 5 / this.scale);
    ctx.lineCap = "butt";
    ctx.beginPath();
    ctx.moveTo(place.x - across.x, place.y - across.y);
    ctx.lineTo(place.x + across.x, place.y + across.y);
    ctx.stroke();
    ctx.lineCap = "round";
  }

  drawVehicle() {
    if (!this.pose) return;
    const { ctx, vehicle: v } = this;
    const half = this.width / 2, front = v.wheel_base + v.front_overhang, rear = -v.rear_overhang;
    const length = front - rear;
    ctx.save();
    ctx.translate(this.pose.x, this.pose.y);
    ctx.rotate(this.pose.yaw);
    ctx.fillStyle = colour("soft");
    for (const [x, angle] of [[0, 0], [v.wheel_base, this.pose.steering ?? 0]]) {
      for (const y of [v.wheel_tread / 2, -v.wheel_tread / 2]) this.wheel(x, y, angle);
    }
    ctx.beginPath();
    ctx.roundRect(rear, -half + 0.12, length, 2 * half - 0.24, Math.min(0.55, half / 2));
    ctx.fillStyle = colour("accent");
    ctx.globalAlpha = 0.34;
    ctx.fill();
    ctx.globalAlpha = 1;
    ctx.strokeStyle = colour("accent");
    ctx.lineWidth = Math.max(0.07, 2 / this.scale);
    ctx.stroke();
    ctx.fillStyle = colour("body");
    ctx.beginPath(); // which end is the front
    ctx.moveTo(front - 0.35, 0);
    ctx.lineTo(front - 0.35 - length * 0.16, half * 0.5);
    ctx.lineTo(front - 0.35 - length * 0.16, -half * 0.5);
    ctx.fill();
    ctx.beginPath(); // the rear axle: the point that is controlled
    ctx.arc(0, 0, Math.max(0.12, 3 / this.scale), 0, 7);
    ctx.fill();
    ctx.restore();
  }

  wheel(x, y, angle) {
    const { ctx, vehicle: v } = this;
    const width = Math.max(v.wheel_width, 0.28);
    ctx.save();
    ctx.translate(x, y);
    ctx.rotate(angle);
    ctx.fillStyle = colour("body");
    ctx.fillRect(-v.wheel_radius, -width / 2, 2 * v.wheel_radius, width);
    ctx.restore();
  }

  // Where the vehicle was at the time of the plots' cursor.
  drawCursor() {
    if (this.cursorAt === null) return;
    const place = this.trail.findLast(({ t }) => t <= this.cursorAt);
    if (!place) return;
    const { ctx } = this;
    ctx.strokeStyle = colour("ink");
    ctx.lineWidth = 2 / this.scale;
    ctx.beginPath();
    ctx.arc(place.x, place.y, 7 / this.scale, 0, 7);
    ctx.stroke();
  }

  scaleBar(width, height, ratio) {
    const { ctx } = this;
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    const length = this.step * this.scale, x = width - 16 - length, y = height - 14;
    ctx.strokeStyle = ctx.fillStyle = colour("soft");
    ctx.lineWidth = 1.5;
    ctx.lineCap = "butt";
    ctx.beginPath();
    ctx.moveTo(x, y - 4);
    ctx.lineTo(x, y);
    ctx.lineTo(x + length, y);
    ctx.lineTo(x + length, y - 4);
    ctx.stroke();
    ctx.font = "11px system-ui, sans-serif";
    ctx.textAlign = "center";
    ctx.fillText(`${this.step} m`, x + length / 2, y - 6);
  }
}

function endOf(x, y, towards) {
  const last = towards > 0 ? x.length - 1 : 0, inner = last - towards;
  const yaw = Math.atan2(towards * (y[last] - y[inner]), towards * (x[last] - x[inner]));
  return { x: x[last], y: y[last], yaw };
}
