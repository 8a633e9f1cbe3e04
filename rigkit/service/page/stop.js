/** STOP: the button and the space bar.  It needs no control, and says what came of it. */

import { ask } from "./api.js";
import { byId, show, write } from "./element.js";

/** s to wait for an answer before saying that there is none. */
const PATIENCE = 3;
const TYPED_INTO = "input, textarea";

export class Stop {
  /** What is wrong with the last STOP; empty where it was carried out. */
  fault = "";

  constructor() {
    const button = byId("stop");
    show(button, true);
    button.onclick = () => this.press("STOP of the page");
    addEventListener("keydown", (event) => this.#key(event), { capture: true });
    addEventListener("keyup", (event) => isSpace(event) && event.preventDefault(), { capture: true });
  }

  async press(why) {
    write(byId("stop-told"), "STOP sent");
    try {
      const told = await ask("POST", "/api/stop", { who: byId("who").value.trim() || "page", why }, PATIENCE);
      this.fault = "";
      write(byId("stop-told"), `STOP: ${told.before} → ${told.state}`);
    } catch (refused) {
      this.fault = `STOP was not carried out: ${refused.message}. Use the switch.`;
      write(byId("stop-told"), "STOP was not carried out");
    }
  }

  /** The space bar stops wherever no text is typed; a button is pressed with Enter. */
  #key(event) {
    if (!isSpace(event)) return;
    event.preventDefault();
    if (!event.repeat) this.press("space bar");
  }
}

function isSpace(event) {
  return event.code === "Space" && !event.target.closest?.(TYPED_INTO);
}
