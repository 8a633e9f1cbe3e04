/** The procedure under way: how much is done, time left, and what pausing and ending it mean. */

import { byId, show, write } from "./element.js";
import { digits, duration } from "./numbers.js";

export class Procedure {
  show({ procedure }) {
    show(byId("procedure"), procedure !== null);
    write(byId("summary"), procedure === null ? "" : summary(procedure));
    if (procedure === null) return;
    const { done, total, unit } = procedure;
    write(byId("procedure-title"), procedure.title);
    const bar = byId("procedure-bar");
    const part = total > 0 ? done / total : 0;
    if (bar.value !== part) bar.value = part;
    const left = procedure.seconds_left === null ? "" : `, ${duration(procedure.seconds_left)} left`;
    write(byId("procedure-done"), `${digits(done)} of ${digits(total)} ${unit}${left}`);
    const how = procedure.ending ? "ending; " : procedure.held ? "paused, or about to; " : "";
    write(byId("procedure-note"), how + procedure.note);
    write(byId("on-pause"), procedure.pausable ? procedure.on_pause : "It cannot be paused.");
    write(byId("on-abort"), procedure.on_abort);
    for (const name of ["hold", "resume"]) show(byId(name), procedure.pausable);
  }
}

/** The same in two lines, large, for those who stand far off. */
function summary({ done, total, unit, seconds_left }) {
  const left = seconds_left === null ? "" : `\n${duration(seconds_left)} left`;
  return `${digits(done)} of ${digits(total)} ${unit}${left}`;
}
