/** The event log, the newest on top. */

import { ask } from "./api.js";
import { byId, made, show } from "./element.js";
import { clock, digits } from "./numbers.js";

const KEPT = 200;
const PAUSE = 300;
const ALARMING = new Set(["fault", "stop", "refused", "dropped", "failed", "discarded", "web process died"]);
const OWN = new Set(["number", "time", "event", "who", "why", "state", "before"]);

export class Log {
  #last = 0;
  #busy = false;
  #fault = made("li", { className: "alarming", hidden: true });

  constructor() {
    byId("events").append(this.#fault);
  }

  show({ events, journal_fault }) {
    show(this.#fault, journal_fault !== "");
    this.#fault.textContent = `Not all of it is on the disk: ${journal_fault}`;
    if (events < this.#last) this.#last = 0; // the daemon was started again
    if (events > this.#last && !this.#busy) this.#fetch(events);
  }

  async #fetch(upTo) {
    this.#busy = true;
    try {
      const entries = await ask("GET", `/api/events?after=${this.#last}&most=${KEPT}`);
      const lines = entries.reverse().map(line);
      for (const { dataset } of lines) if (dataset.series) for (const older of this.#ofSeries(dataset.series)) older.remove();
      this.#fault.after(...lines);
      this.#last = entries.length ? entries[0].number : upTo;
      const list = byId("events");
      while (list.children.length > KEPT) list.lastElementChild.remove();
    } catch {
      // the next snapshot asks again
    }
    setTimeout(() => (this.#busy = false), PAUSE);
  }

  /** Lines of a series of which a newer one tells all. */
  #ofSeries(series) {
    return [...byId("events").children].filter((item) => item.dataset.series === series);
  }
}

function line(entry) {
  const step = entry.before && entry.before !== entry.state ? `${entry.before} → ${entry.state}` : "";
  const rest = Object.entries(entry).filter(([name]) => !OWN.has(name)).map(([name, value]) => `${name.replaceAll("_", " ")} ${plain(value)}`);
  const text = [step, entry.why, ...rest].filter(Boolean).join(", ");
  const item = made("li", {}, made("time", { dateTime: entry.time }, clock(entry.time)), " ");
  item.append(made("b", {}, entry.event), " ", made("span", { className: "soft" }, entry.who), " ", text);
  if (ALARMING.has(entry.event)) item.className = "alarming";
  if (entry.times) item.dataset.series = `${entry.event} ${entry.asker} ${entry.since}`;
  return item;
}

function plain(value) {
  if (typeof value === "number") return digits(value);
  if (typeof value !== "object" || value === null) return String(value ?? "-");
  const parts = Array.isArray(value) ? value.map(plain) : Object.entries(value).map(([name, part]) => `${name} ${plain(part)}`);
  return parts.join(", ") || "none";
}
