/** STOP: the button and the space bar.  It needs no control, and says what came of it. */

import { ask } from "./api.js";
import { byId, show, write } from "./element.js";

/** s to wait for an answer before saying that there is none. */
const PATIENCE = 3;
/** ms after a finger or mouse went down within which a click is the end of that press. */
const A_PRESS = 2000;
const TYPED_INTO = "input, textarea";

export class Stop {
  /** What is wrong with the last STOP; empty where it was carried out. */
  fault = "";

  #touch = -Infinity;

  constructor() {
    const button = byId("stop");
    show(button, true);
    button.onpointerdown = () => this.#touched();
    button.onclick = () => performance.now() - this.#touch > A_PRESS && this.press("STOP of the page");
    addEventListener("keydown", (event) => this.#key(event), { capture: true });
    addEventListener("keyup", (event) => isSpace(event) && event.preventDefault(), { capture: true });
  }

  /** A finger stops when it comes down, and not when it is lifted. */
  #touched() {
    this.#touch = performance.now();
    this.press("STOP of the page");
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
