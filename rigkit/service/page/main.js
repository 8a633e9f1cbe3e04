/** The page of a rig under its daemon: what the stream tells, drawn; what a person asks, sent. */

import { ask, forgetToken, keepToken, takeTokenFromAddress, token } from "./api.js";
import { Command } from "./command.js";
import { byId, show, write } from "./element.js";
import { Gauges } from "./gauges.js";
import { Log } from "./log.js";
import { duration } from "./numbers.js";
import { Panels } from "./panels.js";
import { Procedure } from "./procedure.js";
import { Runs } from "./runs.js";
import { showState } from "./state.js";
import { Stop } from "./stop.js";
import { OLD, Stream } from "./stream.js";

async function open() {
  let rig;
  try {
    rig = await ask("GET", "/api/rig");
  } catch (refused) {
    if (refused.status === 401) return login(token() ? refused.message : "");
    showAlarm(`${refused.message}; this page tries again`);
    setTimeout(open, 1000);
    return;
  }
  show(byId("login"), false);
  show(byId("rig"), true);
  watch(rig);
}

function login(fault) {
  forgetToken();
  show(byId("login"), true);
  write(byId("login-fault"), fault);
  byId("token").focus();
}

function watch(rig) {
  document.title = rig.rig || rig.program;
  const stop = new Stop();
  const parts = [new Command(rig), new Procedure(), new Gauges(), new Panels(), new Log(), new Runs()];
  let late = "";
  const stream = new Stream((snapshot) => {
    showState(snapshot);
    late = `${snapshot.late_ticks} of ${snapshot.tick} were late at the rig`;
    for (const part of parts) part.show(snapshot);
  });
  byId("forget").onclick = () => {
    forgetToken();
    location.reload();
  };
  const began = performance.now();
  setInterval(() => lookAtPulse(Math.min(stream.age, (performance.now() - began) / 1000), stop), 100);
  setInterval(() => write(byId("pulse"), `${stream.rate().toFixed(0)} snapshots a second; ${late}`), 2000);
}

/** Grey the page out when nothing has been heard for too long. */
function lookAtPulse(age, stop) {
  const old = age > OLD;
  document.body.classList.toggle("old", old);
  if (old) {
    showAlarm("No sign of life. What is shown is old, and STOP may not get through: use the switch.", `(${duration(age)})`);
  } else {
    showAlarm(stop.fault);
  }
}

/** Show an alarm; what changes all the time stands apart, so that it is not read out each time. */
function showAlarm(text, age = "") {
  write(byId("alarm-text"), text);
  write(byId("alarm-age"), age);
  show(byId("alarm"), text !== "");
}

byId("login").onsubmit = (event) => {
  event.preventDefault();
  keepToken(byId("token").value.trim(), byId("keep").checked);
  byId("token").value = "";
  open();
};

/** As soon as the state's name is not whole to be seen, the strip says it. */
function lookAtPlace() {
  document.body.classList.toggle("scrolled", byId("state-name").getBoundingClientRect().top < 0);
}

for (const moved of ["scroll", "resize"]) addEventListener(moved, lookAtPlace, { passive: true });
takeTokenFromAddress();
if (token()) open();
else login("");
