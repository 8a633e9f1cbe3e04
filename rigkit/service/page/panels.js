/** Panels: each is fetched when its revision has moved on, and drawn by its kind. */

import { ask } from "./api.js";
import { drawCurves, sayCurves } from "./curves.js";
import { byId, made, write } from "./element.js";
import { drawImage, sayImage } from "./image.js";
import { fillTable } from "./table.js";

const PAUSE = 100;
const PAUSE_AFTER_REFUSAL = 2000;

export class Panels {
  #cards = new Map();
  #wanted = {};
  #busy = false;

  constructor() {
    const again = () => this.#cards.forEach((card) => card.draw());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", again);
  }

  show({ panels }) {
    this.#wanted = panels;
    for (const [name, card] of this.#cards) {
      if (name in panels) continue;
      card.element.remove(); // another procedure has begun
      this.#cards.delete(name);
    }
    if (!this.#busy) this.#fetch();
  }

  /** Fetch what is newer than what is shown, one at a time, the longest shown first. */
  async #fetch() {
    this.#busy = true;
    try {
      for (const [name, revision] of Object.entries(this.#wanted)) {
        if (!(name in this.#wanted) || this.#cards.get(name)?.revision === revision) continue;
        const panel = await ask("GET", `/api/panels/${encodeURIComponent(name)}`);
        if (name in this.#wanted) this.#put(name, panel);
        await new Promise((resume) => setTimeout(resume, PAUSE));
      }
    } catch {
      await new Promise((resume) => setTimeout(resume, PAUSE_AFTER_REFUSAL));
    }
    this.#busy = false;
  }

  #put(name, panel) {
    if (!this.#cards.has(name)) {
      const card = new Card();
      this.#cards.set(name, card);
      byId("panels").append(card.element);
    }
    this.#cards.get(name).show(panel);
  }
}

class Card {
  revision = 0;
  #panel = null;
  #title = made("h2");
  #canvas = made("canvas", { role: "img" });
  #legend = made("p", { className: "legend" });
  #table = made("div", { className: "wide", tabIndex: 0 });

  constructor() {
    this.element = made("section", { className: "panel" }, this.#title);
    new ResizeObserver(() => this.draw()).observe(this.#canvas);
  }

  show(panel) {
    [this.#panel, this.revision] = [panel, panel.revision];
    write(this.#title, panel.title);
    const isTable = panel.kind === "table";
    const parts = isTable ? [this.#title, this.#table] : [this.#title, this.#legend, this.#canvas];
    if (this.element.children.length !== parts.length) this.element.replaceChildren(...parts);
    if (isTable) {
      this.#table.setAttribute("aria-label", panel.title);
      fillTable(this.#table, panel);
      this.element.classList.remove("broad"); // a table that is wider than a panel has the place of all of a row
      this.element.classList.toggle("broad", this.#table.scrollWidth > this.#table.clientWidth);
      return;
    }
    this.#canvas.setAttribute("aria-label", panel.kind === "image" ? sayImage(panel) : sayCurves(panel));
    this.draw();
  }

  draw() {
    if (this.#panel === null || this.#panel.kind === "table") return;
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    if (width === 0 || height === 0) return;
    const dots = devicePixelRatio || 1;
    [this.#canvas.width, this.#canvas.height] = [Math.round(width * dots), Math.round(height * dots)];
    const pen = this.#canvas.getContext("2d");
    pen.scale(dots, dots);
    if (this.#panel.kind === "image") drawImage(pen, width, height, this.#panel);
    else this.#legend.replaceChildren(...drawCurves(pen, width, height, this.#panel));
  }
}
