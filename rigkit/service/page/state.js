/** The head of the page: state, and lights that shine by what is measured. */

import { byId, mark, show, write } from "./element.js";
import { clock, duration } from "./numbers.js";

const OUTPUT = { on: "Output on", zero: "Output zero", unknown: "Output not measured" };

/** Show state, since when, why, and the lights. */
export function showState(snapshot) {
  const { state, output } = snapshot;
  write(byId("rig-name"), `${snapshot.rig} · ${snapshot.program}`);
  const why = state.ending ? `${state.why} - the procedure is coming to its end` : state.why;
  for (const [place, text] of [["name", state.name], ["why", why]]) write(byId(`state-${place}`), text);
  for (const [place, text] of [["state", state.name], ["why", why], ["output", OUTPUT[output]]]) write(byId(`strip-${place}`), text);
  const age = (new Date(snapshot.time) - new Date(state.since)) / 1000;
  write(byId("state-since"), `${state.who}, since ${clock(state.since)} (${duration(age)})`);
  for (const place of ["state", "strip"]) mark(byId(place), "tone", tone(state.name, output, snapshot.procedure !== null));
  light("output", output === "unknown" ? output : output === "on", OUTPUT[output]);
  light("recording", snapshot.recording, snapshot.recording ? "Recording" : "Not recording");
  const faults = Object.entries(snapshot.faults).map(([sensor, kind]) => `${sensor} ${kind}`);
  show(byId("light-faults"), faults.length > 0);
  light("faults", true, `Fault on purpose: ${faults.join(", ")}`);
  light("control", snapshot.control !== null, snapshot.control ? `${snapshot.control.who} has control` : "Nobody has control");
}

/** The colour of the head: a fault, else what is measured at the output, else whether it may move. */
function tone(state, output, runs) {
  if (state === "FAULT") return "fault";
  if (output === "on") return state === "DISARMED" ? "fault" : "live";
  if (output === "unknown" && runs) return "live";
  return state === "DISARMED" ? "quiet" : "ready";
}

function light(name, shines, text) {
  const element = byId(`light-${name}`);
  mark(element, "on", String(shines));
  write(element, text);
}
