/** Gauges: a value, a bar against its limits, and where it stands to them; the colour comes from the value. */

import { byId, made, mark, write } from "./element.js";
import { quantity, scaled, digits } from "./numbers.js";

/** Part of a bar beyond a limit. */
const BEYOND = 0.15;
/** Part of its limit below which a value is written as 0. */
const LEAST = 1e-4;
const WORDS = { unknown: "not known", free: "", good: "within limits", near: "near its limit", over: "over its limit" };

export class Gauges {
  #rows = new Map();

  show({ gauges }) {
    const names = gauges.map((gauge) => gauge.name);
    if (names.join() !== [...this.#rows.keys()].join()) this.#rebuild(names);
    for (const gauge of gauges) this.#rows.get(gauge.name).show(gauge);
  }

  #rebuild(names) {
    this.#rows = new Map(names.map((name) => [name, this.#rows.get(name) ?? new Row()]));
    byId("gauges").replaceChildren(...[...this.#rows.values()].map((row) => row.element));
  }
}

class Row {
  #title = made("span", { className: "title" });
  #value = made("output", { className: "value" });
  #limits = made("span", { className: "limits" });
  #fill = made("i", { className: "fill" });
  #band = made("i", { className: "band" });
  #marks = [made("i", { className: "limit" }), made("i", { className: "limit" })];
  #bar = made("div", { className: "bar" });
  #largest = 0;

  constructor() {
    this.#bar.append(this.#fill, this.#band, ...this.#marks);
    this.#bar.setAttribute("aria-hidden", "true");
    this.element = made("div", { className: "gauge" }, this.#title, this.#value, this.#bar, this.#limits);
  }

  show(gauge) {
    mark(this.element, "verdict", gauge.verdict);
    write(this.#title, gauge.title);
    const largest = Math.max(Math.abs(gauge.low ?? 0), Math.abs(gauge.high ?? 0));
    write(this.#value, quantity(gauge.value, gauge.unit, LEAST * largest, largest));
    write(this.#limits, this.#told(gauge));
    if (gauge.value !== null) this.#largest = Math.max(this.#largest, Math.abs(gauge.value), ...gauge.interval ?? []);
    const ends = this.#ends(gauge);
    this.#bar.hidden = ends === null;
    if (ends === null) return;
    const place = (value) => 100 * Math.min(1, Math.max(0, (value - ends[0]) / (ends[1] - ends[0])));
    const origin = place(Math.min(ends[1], Math.max(ends[0], 0)));
    const at = gauge.value === null ? origin : place(gauge.value);
    span(this.#fill, Math.min(origin, at), Math.max(origin, at));
    this.#band.hidden = gauge.interval === null;
    if (gauge.interval) span(this.#band, ...gauge.interval.map(place));
    [gauge.low, gauge.high].forEach((limit, n) => {
      this.#marks[n].hidden = limit === null;
      if (limit !== null) span(this.#marks[n], place(limit), place(limit));
    });
  }

  /** What stands under the bar: limits, interval, and how the value stands to them. */
  #told({ low, high, unit, interval, verdict }) {
    const size = Math.max(...[low, high, ...interval ?? []].map((value) => Math.abs(value ?? 0)));
    const scale = scaled(size, unit);
    const number = (value) => digits(value / scale.factor);
    const parts = [];
    if (low !== null && high !== null) parts.push(`${number(low)} to ${number(high)} ${scale.unit}`);
    else if (high !== null) parts.push(`at most ${number(high)} ${scale.unit}`);
    else if (low !== null) parts.push(`at least ${number(low)} ${scale.unit}`);
    if (interval) parts.push(`lies in ${number(interval[0])} to ${number(interval[1])} ${scale.unit}`);
    if (WORDS[verdict]) parts.push(WORDS[verdict]);
    return parts.map((part) => part.trim()).join(", ");
  }

  /** Ends of the bar, or null where a bar says nothing. */
  #ends({ low, high, value, interval }) {
    if (low !== null && high !== null) return [low - BEYOND * (high - low) / 2, high + BEYOND * (high - low) / 2];
    if (high !== null && high > 0) return [value < 0 ? -(1 + BEYOND) * high : 0, (1 + BEYOND) * high];
    if (low !== null && low > 0) return [0, Math.max(2 * low, 1.05 * this.#largest)];
    if (interval) return [interval[0] < 0 ? -1.2 * this.#largest : 0, 1.2 * this.#largest];
    return null;
  }
}

function span(element, from, to) {
  const [left, width] = [`${from.toFixed(2)}%`, `${(to - from).toFixed(2)}%`];
  if (element.style.left !== left) element.style.left = left;
  if (element.style.width !== width) element.style.width = width;
}
