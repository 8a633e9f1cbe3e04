/** The stream of snapshots, and how old the last sign of life is. */

import { token } from "./api.js";

/** s without a snapshot after which what is shown is old. */
export const OLD = 1;
const AGAIN = 500;

export class Stream {
  #shown;
  #latest = -Infinity;
  #tick = -1;
  #count = 0;
  #since = performance.now();

  /** `shown` is called with each snapshot. */
  constructor(shown) {
    this.#shown = shown;
    this.#open();
  }

  /** s since the last snapshot that was a new one. */
  get age() {
    return (performance.now() - this.#latest) / 1000;
  }

  /** Snapshots a second since the last time this was asked. */
  rate() {
    const now = performance.now();
    const found = this.#count / ((now - this.#since) / 1000);
    [this.#count, this.#since] = [0, now];
    return found;
  }

  #open() {
    const address = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/api/stream`;
    const socket = new WebSocket(address, ["vibrostage.1", `token.${token()}`]);
    socket.onmessage = (message) => {
      const snapshot = JSON.parse(message.data);
      socket.send(String(snapshot.tick));
      if (snapshot.tick === this.#tick) return;
      [this.#tick, this.#latest] = [snapshot.tick, performance.now()];
      this.#count += 1;
      this.#shown(snapshot);
    };
    socket.onclose = () => setTimeout(() => this.#open(), AGAIN);
  }
}
