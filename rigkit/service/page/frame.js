/** The frame of a plot: axes with round ticks, titles with units, and where the data goes. */

import { scaled, tick, titled } from "./numbers.js";
import { scale } from "./scale.js";

const FONT = '12px system-ui, "Liberation Sans", sans-serif';

/** Return the page's colours, as they are in light or in dark. */
export function colours() {
  const style = getComputedStyle(document.documentElement);
  const named = (name) => style.getPropertyValue(`--${name}`).trim();
  return {
    text: named("text"), soft: named("soft"), line: named("line"), card: named("card"), over: named("over"),
    series: [1, 2, 3, 4, 5, 6].map((n) => named(`series-${n}`)),
  };
}

/** Draw axes and return {x, y, box}: functions from values to pixels, and the rectangle of the data. */
export function drawFrame(pen, width, height, axes, ranges, right = 12) {
  const { text, soft, line } = colours();
  pen.font = FONT;
  const units = [axes.x, axes.y].map((axis, n) => factorOf(axis, ranges[n]));
  const tall = Math.max(2, Math.floor((height - 54) / 34));
  const y = scale(ranges[1], axes.y.scale === "log", tall);
  const labels = y.ticks.map((value) => tick(value / units[1].factor));
  const left = 26 + Math.max(20, ...labels.map((label) => pen.measureText(label).width));
  const box = { left, top: 8, right: width - right, bottom: height - 42 };
  const x = scale(ranges[0], axes.x.scale === "log", Math.max(2, Math.floor((box.right - left) / 70)));
  const marks = axes.x.unit === "1" ? x.ticks.filter(Number.isInteger) : x.ticks; // there is no trial 0.5
  const across = (value) => left + x.place(value) * (box.right - left);
  const up = (value) => box.bottom - y.place(value) * (box.bottom - box.top);
  pen.strokeStyle = line;
  pen.lineWidth = 1;
  pen.beginPath();
  for (const value of y.ticks) rule(pen, left, up(value), box.right, up(value));
  for (const value of marks) rule(pen, across(value), box.top, across(value), box.bottom);
  pen.stroke();
  pen.fillStyle = soft;
  [pen.textAlign, pen.textBaseline] = ["right", "middle"];
  y.ticks.forEach((value, n) => pen.fillText(labels[n], left - 6, up(value)));
  [pen.textAlign, pen.textBaseline] = ["center", "top"];
  for (const value of marks) {
    const label = tick(value / units[0].factor);
    const last = width - 1 - pen.measureText(label).width / 2; // whole, at the edge of the panel too
    pen.fillText(label, Math.min(across(value), last), box.bottom + 6);
  }
  pen.fillStyle = text;
  pen.fillText(titled(axes.x.title, units[0].unit), (left + box.right) / 2, box.bottom + 24);
  sideways(pen, titled(axes.y.title, units[1].unit), 8, (box.top + box.bottom) / 2, box.bottom - box.top + 2 * box.top);
  return { x: across, y: up, box };
}

/** Write text that is read from below upwards, centred on a point, narrower where there is no room for it. */
export function sideways(pen, words, x, y, room) {
  pen.save();
  pen.translate(x, y);
  pen.rotate(-Math.PI / 2);
  [pen.textAlign, pen.textBaseline] = ["center", "middle"];
  pen.fillText(words, 0, 0, room);
  pen.restore();
}

function factorOf(axis, [low, high]) {
  const unscaled = axis.scale === "log" || axis.unit === "Hz";
  return scaled(unscaled ? 1 : Math.max(Math.abs(low), Math.abs(high)), axis.unit);
}

function rule(pen, x1, y1, x2, y2) {
  const half = (value) => Math.round(value) + 0.5;
  pen.moveTo(half(x1), half(y1));
  pen.lineTo(half(x2), half(y2));
}
