/** Control and commands: what may be asked now can be pressed, and what came of it is said. */

import { ask, keepKey, key } from "./api.js";
import { byId, show, write } from "./element.js";
import { OptionsForm } from "./options.js";

const COMMANDS = ["arm", "disarm", "hold", "resume", "abort", "acknowledge"];
const WITH_REASON = new Set(["arm", "acknowledge"]);
const NAME = "vibrostage.who";

export class Command {
  #rig;
  #options;
  #holder = null;
  #mine = "";
  #renewing = 0;

  constructor(rig) {
    this.#rig = rig;
    this.#options = new OptionsForm(byId("which"), byId("options"), rig.procedures);
    byId("who").value = localStorage.getItem(NAME) ?? "";
    byId("take").onsubmit = (event) => this.#submitted(event, () => this.#take());
    byId("begin").onsubmit = (event) => this.#submitted(event, () => this.#begin());
    byId("reasoned").onsubmit = (event) => this.#submitted(event, () => {});
    byId("give-back").onclick = () => this.#do("control given back", () => this.#giveBack());
    for (const name of COMMANDS) byId(name).onclick = () => this.#do(name, () => this.#command(name));
    document.body.classList.toggle("viewer", rig.role !== "operate");
    if (key()) this.#renew();
    else write(byId("told"), "");
  }

  show({ control, allowed, procedure }) {
    this.#holder = control?.who ?? null;
    if (key()) this.#follow();
    const mine = key() !== "";
    const others = !mine && this.#holder !== null;
    write(byId("owner"), mine ? "You have control." : others ? `${this.#holder} has control.` : "Nobody has control.");
    show(byId("take"), !mine);
    write(byId("take-button"), others ? `Take over from ${this.#holder}` : "Take control");
    show(byId("reasoned"), mine);
    show(byId("give-back"), mine);
    for (const name of COMMANDS) byId(name).disabled = !(mine && allowed.includes(name));
    if (procedure?.ending) byId("abort").disabled = true;
    show(byId("arm"), !allowed.includes("disarm") && !allowed.includes("acknowledge"));
    show(byId("disarm"), allowed.includes("disarm"));
    show(byId("acknowledge"), allowed.includes("acknowledge"));
    show(byId("begin"), mine && (allowed.includes("run") || allowed.includes("calibrate")));
    byId("begin-button").disabled = !allowed.includes(this.#options.chosen?.kind);
  }

  /** Control that has run out, or that somebody with another name has taken over, is gone. */
  #follow() {
    if (this.#mine && this.#holder !== this.#mine) this.#lost(this.#holder ? `${this.#holder} has taken over control` : "");
    else if (this.#holder === byId("who").value.trim()) this.#mine = this.#holder;
  }

  async #take() {
    const who = byId("who").value.trim();
    localStorage.setItem(NAME, who);
    await this.#do("control", async () => {
      const told = await ask("POST", "/api/control", { who, over: this.#holder !== null });
      keepKey(told.key);
      this.#renewAfter(told.seconds / 3);
    });
  }

  async #giveBack() {
    await ask("DELETE", "/api/control");
    this.#lost();
  }

  async #command(name) {
    const why = byId("why").value.trim();
    if (WITH_REASON.has(name) && !why) {
      byId("why").focus();
      throw new Error(`say why, to ${name}`);
    }
    await ask("POST", `/api/${name}`, { why });
    byId("why").value = "";
  }

  async #begin() {
    const { name } = this.#options.chosen;
    await this.#do("begin", async () => {
      try {
        await ask("POST", "/api/begin", { procedure: name, options: this.#options.values(), why: byId("why").value.trim() }, 75);
      } catch (refused) {
        byId("more").open = true; // the way out is most often among the options
        throw refused;
      }
    });
  }

  /** Keep control for as long as this page is looked at. */
  async #renew() {
    if (!key()) return;
    if (document.hidden) return this.#renewAfter(1);
    try {
      const { seconds } = await ask("PUT", "/api/control");
      this.#renewAfter(seconds / 3);
    } catch (refused) {
      if (refused.status === 403) this.#lost(refused.message);
      else this.#renewAfter(2);
    }
  }

  #renewAfter(seconds) {
    clearTimeout(this.#renewing);
    this.#renewing = setTimeout(() => this.#renew(), seconds * 1000);
  }

  #lost(why = "") {
    keepKey("");
    this.#mine = "";
    clearTimeout(this.#renewing);
    if (why) write(byId("told"), why);
  }

  async #do(name, act) {
    write(byId("told"), "…");
    try {
      await act();
      write(byId("told"), "");
    } catch (refused) {
      if (refused.status === 403 && key()) await this.#renew();
      write(byId("told"), refused.message.replaceAll(/(?<!\S)--(?=[a-z])/g, "")); // here options are fields
    }
  }

  #submitted(event, act) {
    event.preventDefault();
    act();
  }
}
