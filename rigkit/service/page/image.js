/** A panel of colours over a plane, with its colour scale. */

import { colours, drawFrame, sideways } from "./frame.js";
import { digits, quantity, tick, titled, scaled } from "./numbers.js";
import { scale } from "./scale.js";

/** Nine colours of matplotlib's viridis, CC0, from the lowest value to the highest. */
const VIRIDIS = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"];
const TABLE = table(256);
const BAR = 74;

/** Draw the panel. */
export function drawImage(pen, width, height, panel) {
  const [rows, columns] = [panel.values.length, panel.values[0]?.length ?? 0];
  if (!columns) return;
  const ranges = [edges(panel.x_range, columns), edges(panel.y_range, rows)];
  const { box } = drawFrame(pen, width, height, panel, ranges, BAR);
  pen.imageSmoothingEnabled = false;
  pen.drawImage(picture(panel, rows, columns), box.left, box.top, box.right - box.left, box.bottom - box.top);
  drawScale(pen, box, width, panel);
}

/** Say what the picture is of. */
export function sayImage({ title, x, y, z, z_range, values }) {
  const largest = values.reduce((found, row) => row.reduce((most, value) => Math.max(most, value ?? most), found), -Infinity);
  const colour = `${z.title} from ${digits(z_range[0])} to ${quantity(z_range[1], z.unit)}`;
  return `${title}: ${colour} over ${x.title} and ${y.title}; the largest is ${quantity(largest, z.unit)}`;
}

/** Outer edges of cells whose first and last centres are given. */
function edges([first, last], count) {
  const half = count > 1 ? (last - first) / (count - 1) / 2 : 0.5;
  return [first - half, last + half];
}

function picture({ values, z_range: [low, high] }, rows, columns) {
  const canvas = new OffscreenCanvas(columns, rows);
  const pen = canvas.getContext("2d");
  const pixels = pen.createImageData(columns, rows);
  values.forEach((row, n) => {
    let at = 4 * columns * (rows - 1 - n);
    for (const value of row) {
      const part = value === null ? 0 : Math.min(1, Math.max(0, (value - low) / (high - low)));
      pixels.data.set(TABLE[Math.round(255 * part)], at);
      if (value === null) pixels.data[at + 3] = 0;
      at += 4;
    }
  });
  pen.putImageData(pixels, 0, 0);
  return canvas;
}

function drawScale(pen, { top, bottom, right }, width, { z, z_range }) {
  const paint = colours();
  const [left, wide, tall] = [right + 10, 12, bottom - top];
  for (let n = 0; n < tall; n += 1) {
    pen.fillStyle = `rgb(${TABLE[Math.round((255 * n) / (tall - 1 || 1))].slice(0, 3).join()})`;
    pen.fillRect(left, bottom - 1 - n, wide, 1);
  }
  const { ticks, place } = scale(z_range, false, Math.max(2, Math.floor(tall / 40)));
  const unit = scaled(Math.max(...z_range.map(Math.abs)), z.unit);
  pen.fillStyle = paint.soft;
  [pen.textAlign, pen.textBaseline] = ["left", "middle"];
  for (const value of ticks) pen.fillText(tick(value / unit.factor), left + wide + 4, bottom - place(value) * tall);
  pen.fillStyle = paint.text;
  sideways(pen, titled(z.title, unit.unit), width - 8, (top + bottom) / 2, tall + 2 * top);
}

function table(size) {
  const stops = VIRIDIS.map((text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16)));
  return Array.from({ length: size }, (_, n) => {
    const at = (n / (size - 1)) * (stops.length - 1);
    const [before, part] = [Math.min(Math.floor(at), stops.length - 2), at - Math.min(Math.floor(at), stops.length - 2)];
    return [...stops[before].map((value, k) => Math.round(value + part * (stops[before + 1][k] - value))), 255];
  });
}
