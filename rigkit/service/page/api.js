/** Requests to the daemon: with the token, and with the key of control where there is one. */

const TOKEN = "vibrostage.token";
const KEY = "vibrostage.key";

/** A refusal, with the daemon's one line. */
export class Refused extends Error {
  constructor(status, text) {
    super(text);
    this.status = status;
  }
}

export const token = () => sessionStorage.getItem(TOKEN) ?? localStorage.getItem(TOKEN) ?? "";

/** Keep a token for this tab, or in this browser. */
export function keepToken(text, forLong) {
  forgetToken();
  (forLong ? localStorage : sessionStorage).setItem(TOKEN, text);
}

export function forgetToken() {
  for (const store of [sessionStorage, localStorage]) store.removeItem(TOKEN);
  keepKey("");
}

/** Key of control, which outlives a reload of this tab. */
export const key = () => sessionStorage.getItem(KEY) ?? "";
export const keepKey = (text) => sessionStorage.setItem(KEY, text);

/** Take a token from the address, "#token=...", and clear it from there. */
export function takeTokenFromAddress() {
  const given = new URLSearchParams(location.hash.slice(1)).get("token");
  if (!given) return;
  keepToken(given, false);
  history.replaceState(null, "", location.pathname);
}

/** Ask; return what the answer holds, or throw Refused.  `seconds` is the longest wait. */
export async function ask(method, path, body, seconds = 12) {
  const headers = body === undefined ? {} : { "Content-Type": "application/json" };
  const signal = AbortSignal.timeout(seconds * 1000);
  const answer = await send(path, { method, headers, signal, body: body === undefined ? undefined : JSON.stringify(body) });
  return answer.json().catch(brokenOff);
}

/** Fetch a file, which a link could not, as it brings no token along; hand it to the browser to save under `name`. */
export async function download(path, name) {
  const answer = await send(path);
  const href = URL.createObjectURL(await answer.blob().catch(brokenOff));
  Object.assign(document.createElement("a"), { href, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(href), 60_000);
}

async function send(path, { headers, ...options } = {}) {
  const answer = await fetch(path, { ...options, headers: { ...headers, Authorization: `Bearer ${token()}`, "X-Control": key() } }).catch(() => {
    throw new Refused(0, "the daemon does not answer");
  });
  if (answer.ok) return answer;
  const { error } = await answer.json().catch(() => ({}));
  throw new Refused(answer.status, error ?? `status ${answer.status}`);
}

function brokenOff() {
  throw new Refused(0, "the daemon's answer broke off");
}
