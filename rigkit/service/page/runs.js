/** Runs: their folders, the newest on top, and in one that is opened its files, each of which can be fetched. */

import { ask, download } from "./api.js";
import { byId, made, show, write } from "./element.js";
import { day, quantity } from "./numbers.js";

const SHOWN = 20;

export class Runs {
  #rows = new Map();
  #runs = [];
  #most = SHOWN;
  #under = null;
  #isRecording = false;
  #asked = 0;

  constructor() {
    byId("more-runs").onclick = () => {
      this.#most += 5 * SHOWN;
      this.#draw();
    };
  }

  /** Look for runs at first, and whenever a procedure has begun, records, or has ended: its folder is made in between. */
  show({ procedure, recording }) {
    const under = procedure?.name ?? "";
    const isNews = under !== this.#under || (recording && !this.#isRecording);
    [this.#under, this.#isRecording] = [under, recording];
    if (isNews) this.#fetch();
  }

  async #fetch() {
    const asked = (this.#asked += 1);
    try {
      const runs = await ask("GET", "/api/runs");
      if (asked !== this.#asked) return; // it has been asked again meanwhile
      this.#runs = runs;
      this.#draw();
    } catch (refused) {
      write(byId("runs-told"), refused.message);
      setTimeout(() => (this.#under = null), 2000); // the next snapshot asks again
    }
  }

  #draw() {
    const rows = this.#runs.slice(0, this.#most).map((run) => this.#row(run));
    const list = byId("run-list");
    if (rows.length !== list.children.length || rows.some((row, place) => row !== list.children[place])) list.replaceChildren(...rows);
    write(byId("runs-told"), rows.length ? "" : "Nothing has been recorded yet.");
    show(byId("more-runs"), this.#runs.length > rows.length);
  }

  #row(run) {
    if (!this.#rows.has(run.name)) this.#rows.set(run.name, new Row(run.name));
    return this.#rows.get(run.name).show(run);
  }
}

class Row {
  #name;
  #time = made("time", { className: "soft" });
  #files = made("ul");
  #element;

  constructor(name) {
    this.#name = name;
    const summary = made("summary", {}, made("span", {}, name), this.#time);
    this.#element = made("details", {}, summary, this.#files);
    this.#element.ontoggle = () => this.#element.open && this.#fetch();
  }

  show({ time }) {
    const isNews = this.#time.dateTime !== time;
    this.#time.dateTime = time;
    write(this.#time, day(time));
    if (isNews && this.#element.open) this.#fetch();
    return this.#element;
  }

  async #fetch() {
    try {
      const files = await ask("GET", pathOf(this.#name));
      this.#files.replaceChildren(...(files.length ? files.map((file) => this.#line(file)) : [made("li", {}, "no files")]));
    } catch (refused) {
      this.#files.replaceChildren(made("li", { className: "alarming" }, refused.message));
    }
  }

  #line({ path, size }) {
    const button = made("button", { type: "button", className: "plain", title: `Fetch ${path}` }, path);
    button.onclick = () => fetched(button, pathOf(this.#name, path), path.split("/").at(-1));
    return made("li", {}, button, made("span", { className: "soft" }, quantity(size, "byte")));
  }
}

/** Fetch a file; the button cannot be pressed again until it is there. */
async function fetched(button, path, name) {
  button.disabled = true;
  write(byId("runs-told"), `Fetching ${name} …`);
  try {
    await download(path, name);
    write(byId("runs-told"), "");
  } catch (refused) {
    write(byId("runs-told"), `${name}: ${refused.message}`);
  }
  button.disabled = false;
}

const pathOf = (run, path = "") => ["/api/runs", run, ...path.split("/").filter(Boolean)].map((part, place) => (place ? encodeURIComponent(part) : part)).join("/");
