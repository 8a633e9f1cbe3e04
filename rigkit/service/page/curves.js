/** A panel of curves, bars or points over one abscissa, with limits and bands; what is over a limit is filled. */

import { made } from "./element.js";
import { colours, drawFrame } from "./frame.js";
import { quantity } from "./numbers.js";
import { extent } from "./scale.js";

/** So many points make a trace whose deepest hundredth the axis need not show. */
const MANY = 100;
const ROOM = 0.06;
/** Units of an abscissa that goes on: shots and trials, time. Over another the last value of a line says nothing. */
const COUNTED = new Set(["1", "s"]);

/** Draw the panel; return the elements of its legend. */
export function drawCurves(pen, width, height, panel) {
  const ranges = [xRange(panel), yRange(panel)];
  const frame = drawFrame(pen, width, height, panel, ranges);
  const paint = colours();
  const { left, top, right, bottom } = frame.box;
  pen.save();
  pen.beginPath();
  pen.rect(left, top, right - left, bottom - top);
  pen.clip();
  const limits = panel.traces.filter((trace) => trace.role === "limit");
  const looks = lookOf(panel.traces, paint);
  panel.traces.forEach((trace, n) => {
    if (trace.low && trace.high) drawBand(pen, frame, trace, looks[n].colour);
  });
  panel.traces.forEach((trace, n) => {
    if (trace.role === "measured" && panel.drawn === "lines") {
      for (const limit of limits) fillOver(pen, frame, trace, limit, paint.over);
    }
    if (panel.drawn === "bars" && trace.role === "measured") drawBars(pen, frame, trace, looks[n].colour);
    else if (panel.drawn === "points" && trace.role === "measured") drawPoints(pen, frame, trace, looks[n].colour);
    else drawLine(pen, frame, trace, looks[n]);
  });
  pen.restore();
  const hasLast = panel.drawn === "lines" && COUNTED.has(panel.x.unit);
  return looks.map(({ colour, dash }, n) => legendOf(panel.traces[n], colour, dash.length > 0, hasLast, panel.y.unit));
}

/** Say what a person would see: each trace's last value and largest value. */
export function sayCurves(panel) {
  const { title, x, y, traces } = panel;
  const told = traces.map((trace) => {
    const found = extent([trace.y]);
    if (!found) return `${trace.name}: nothing yet`;
    const last = trace.y.findLast((value) => value !== null);
    return `${trace.name}: last ${quantity(last, y.unit)}, from ${quantity(found[0], y.unit)} to ${quantity(found[1], y.unit)}`;
  });
  return `${title}: ${y.title} over ${x.title}. ${told.join("; ")}`;
}

function xRange({ traces, x, drawn }) {
  const found = extent(traces.map((trace) => trace.x), x.scale === "log") ?? [0, 1];
  const room = { bars: stepOf(traces[0]?.x ?? []) / 2, points: 0.03 * (found[1] - found[0]), lines: 0 }[drawn];
  return [found[0] - room, found[1] + room];
}

function yRange({ traces, y, drawn }) {
  const isLog = y.scale === "log";
  const lists = traces.flatMap((trace) => [shallow(trace.y, isLog), trace.low ?? [], trace.high ?? []]);
  let [low, high] = extent(lists, isLog) ?? (isLog ? [0.1, 1] : [0, 1]);
  if (drawn === "bars") low = Math.min(0, low);
  if (isLog) return [low / 1.3, high * 1.3];
  const room = ROOM * (high - low || Math.abs(high) || 1);
  return [drawn === "bars" && low === 0 ? 0 : low - room, high + room];
}

/** Leave out the deepest hundredth of many values: narrow notches must not squeeze the rest. */
function shallow(values, isLog) {
  if (values.length < MANY) return values;
  const sorted = values.filter((value) => value !== null && !(isLog && value <= 0)).sort((a, b) => a - b);
  return sorted.slice(Math.floor(sorted.length / 100));
}

function lookOf(traces, paint) {
  let taken = 0;
  return traces.map(({ role }) => {
    if (role === "limit") return { colour: paint.text, dash: [6, 4], wide: 1.5 };
    if (role === "reference") return { colour: paint.soft, dash: [2, 3], wide: 1.5 };
    return { colour: paint.series[taken++ % paint.series.length], dash: [], wide: 1.75 };
  });
}

function drawLine(pen, { x, y }, trace, { colour, dash, wide }) {
  pen.strokeStyle = colour;
  pen.lineWidth = wide;
  pen.lineJoin = "round";
  pen.setLineDash(dash);
  pen.beginPath();
  let isDown = false;
  trace.y.forEach((value, n) => {
    if (value === null) isDown = false;
    else if (isDown) pen.lineTo(x(trace.x[n]), y(value));
    else [isDown] = [true, pen.moveTo(x(trace.x[n]), y(value))];
  });
  pen.stroke();
  pen.setLineDash([]);
  if (trace.role === "measured" && trace.y.length <= 40) drawPoints(pen, { x, y }, trace, colour);
}

function drawPoints(pen, { x, y }, trace, colour) {
  pen.fillStyle = colour;
  const size = trace.y.length > 500 ? 1.2 : 2.6;
  trace.y.forEach((value, n) => {
    if (value === null) return;
    pen.beginPath();
    pen.arc(x(trace.x[n]), y(value), size, 0, 7);
    pen.fill();
  });
}

function drawBars(pen, { x, y, box }, trace, colour) {
  pen.fillStyle = colour;
  const half = (0.45 * stepOf(trace.x) * (x(trace.x.at(-1)) - x(trace.x[0]))) / ((trace.x.at(-1) - trace.x[0]) || 1) || 8;
  const base = Math.min(box.bottom, y(0));
  trace.y.forEach((value, n) => {
    if (value) pen.fillRect(x(trace.x[n]) - half, y(value), 2 * half, base - y(value));
  });
}

function drawBand(pen, { x, y }, { x: at, low, high }, colour) {
  pen.globalAlpha = 0.2;
  pen.fillStyle = colour;
  pen.beginPath();
  at.forEach((value, n) => pen.lineTo(x(value), y(high[n])));
  [...at.keys()].reverse().forEach((n) => pen.lineTo(x(at[n]), y(low[n])));
  pen.fill();
  pen.globalAlpha = 1;
}

/** Fill between a limit and what is over it. */
function fillOver(pen, { x, y }, trace, limit, colour) {
  pen.globalAlpha = 0.18;
  pen.fillStyle = colour;
  pen.beginPath();
  const inside = [...trace.x.keys()].filter((n) => trace.y[n] !== null && limitAt(limit, trace.x[n]) !== null);
  for (const n of inside) pen.lineTo(x(trace.x[n]), y(Math.max(trace.y[n], limitAt(limit, trace.x[n]))));
  for (const n of inside.reverse()) pen.lineTo(x(trace.x[n]), y(limitAt(limit, trace.x[n])));
  pen.fill();
  pen.globalAlpha = 1;
}

/** The limit at an abscissa, along straight lines between its points; null outside. */
function limitAt({ x, y }, at) {
  const after = x.findIndex((value) => value >= at);
  if (after === -1) return null;
  if (x[after] === at) return y[after];
  if (after === 0) return null;
  const part = (at - x[after - 1]) / (x[after] - x[after - 1]);
  return y[after - 1] + part * (y[after] - y[after - 1]);
}

const stepOf = (x) => (x.length > 1 ? (x.at(-1) - x[0]) / (x.length - 1) : 1);

function legendOf({ name, y, role }, colour, isDashed, hasLast, unit) {
  const swatch = made("i", { className: isDashed ? "swatch dashed" : "swatch" });
  swatch.style.color = colour;
  const last = hasLast && role === "measured" && y.length <= 200 && y.length > 0 ? ` ${quantity(y.at(-1), unit)}` : "";
  return made("span", {}, swatch, `${name}${last}`);
}
