/** The head of the page: state, and lights that shine by what is measured. */

import { byId, mark, show, write } from "./element.js";
import { clock, duration } from "./numbers.js";

/** Show state, since when, why, and the lights. */
export function showState(snapshot) {
  const { state } = snapshot;
  const output = measuredOutput(snapshot.gauges);
  write(byId("rig-name"), `${snapshot.rig} · ${snapshot.program}`);
  write(byId("state-name"), state.name);
  write(byId("state-why"), state.ending ? `${state.why} - the procedure is coming to its end` : state.why);
  const age = (new Date(snapshot.time) - new Date(state.since)) / 1000;
  write(byId("state-since"), `${state.who}, since ${clock(state.since)} (${duration(age)})`);
  mark(byId("state"), "tone", tone(state.name, output));
  light("output", output === "on", { on: "Output on", zero: "Output zero", closed: "Output closed" }[output]);
  light("recording", snapshot.recording, snapshot.recording ? "Recording" : "Not recording");
  const faults = Object.entries(snapshot.faults).map(([sensor, kind]) => `${sensor} ${kind}`);
  show(byId("light-faults"), faults.length > 0);
  light("faults", true, `Fault on purpose: ${faults.join(", ")}`);
  light("control", snapshot.control !== null, snapshot.control ? `${snapshot.control.who} has control` : "Nobody has control");
}

/** What the gauges of the output measure: "on", "zero", or "closed" where there is none to measure. */
function measuredOutput(gauges) {
  const values = gauges.filter((gauge) => gauge.is_output && gauge.value !== null).map((gauge) => gauge.value);
  if (values.length === 0) return "closed";
  return values.some((value) => value !== 0) ? "on" : "zero";
}

/** The colour of the head: a fault, else what is measured at the output, else whether it may move. */
function tone(state, output) {
  if (state === "FAULT") return "fault";
  if (output === "on") return state === "DISARMED" ? "fault" : "live";
  return state === "DISARMED" ? "quiet" : "ready";
}

function light(name, shines, text) {
  const element = byId(`light-${name}`);
  mark(element, "on", String(shines));
  write(element, text);
}
