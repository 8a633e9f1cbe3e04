/** Numbers and times as people read them. */

const PREFIXES = [[1e12, "T"], [1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"]];
const PREFIXED = new Set(["m", "s", "V", "A", "N", "Pa", "W", "Hz", "N m", "byte", "K", "rad", "m/s", "rad/s", "m/√Hz"]);
const WRITTEN = { "m/s^2": "m/s²", "m/s^2 s": "m/s", byte: "B", 1: "", "N m": "N m" };

/** Return {factor, unit}: divide values up to `largest` by the factor, and they have that unit. */
export function scaled(largest, unit) {
  const written = WRITTEN[unit] ?? unit;
  if (!PREFIXED.has(unit) || !(largest > 0)) return { factor: 1, unit: written };
  const [factor, prefix] = PREFIXES.find(([size]) => largest >= size * 0.9995) ?? PREFIXES.at(-1);
  return { factor, unit: prefix + written };
}

/** Write a number with three digits, without an exponent where it needs none; a whole number as such. */
export function digits(value) {
  return Number.isInteger(value) && Math.abs(value) < 1e7 ? minus(String(value)) : three(value);
}

function three(value) {
  if (value === null || !Number.isFinite(value)) return "-";
  const size = Math.abs(value);
  if (size === 0) return "0";
  if (size >= 1e5 || size < 1e-3) return minus(value.toExponential(2));
  return minus(value.toFixed(size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : size >= 0.01 ? 3 : 5));
}

/** Write a number with the fewest digits that tell it from its neighbours on an axis. */
export function tick(value) {
  const size = Math.abs(value);
  if (size >= 1e5 || (size > 0 && size < 1e-3)) return minus(value.toExponential(0));
  return minus(String(Number(value.toPrecision(6))));
}

/** Write a quantity with its unit; one that is smaller than `least` is 0, and beside limits of 1 or more, "0.392 N m" is no "392 mN m". */
export function quantity(value, unit, least = 0, limit = 0) {
  if (value === null) return "-";
  if (Math.abs(value) < least) return quantity(0, unit);
  const scale = scaled(limit >= 1 ? Math.max(1, Math.abs(value)) : Math.abs(value), unit);
  const number = (PREFIXED.has(unit) ? three : digits)(value / scale.factor);
  return `${number} ${scale.unit}`.trim();
}

/** Write a length of time: "5 s", "3 min 05 s", "2 h 14 min". */
export function duration(seconds) {
  const whole = Math.max(0, Math.round(seconds));
  const [hours, minutes, rest] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  const two = (number) => String(number).padStart(2, "0");
  if (hours) return `${hours} h ${two(minutes)} min`;
  return minutes ? `${minutes} min ${two(rest)} s` : `${rest} s`;
}

/** Write a time of day, here. */
export const clock = (time) => new Date(time).toLocaleTimeString("en-GB");

/** Write a day and a time of day, here. */
export const day = (time) => new Date(time).toLocaleString("en-GB", { dateStyle: "medium", timeStyle: "short" });

/** Write an axis' title with its unit. */
export const titled = (title, unit) => (unit ? `${title} (${unit})` : title);

function minus(text) {
  return text.replace("-", "−").replace("e−", "e-").replace("e+", "e");
}
