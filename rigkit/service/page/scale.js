/** Scales and ticks of a plot: from values to pixels, linear or logarithmic. */

const STEPS = [1, 2, 5, 10];

/** Return {low, high, ticks, place}: the ends, round numbers between them, and a value's part of the way, 0 to 1. */
export function scale([low, high], isLog, count) {
  return isLog ? logScale(low, high, count) : linearScale(low, high, count);
}

/** Return the smallest and largest of many numbers, nulls left out; null where there is none. */
export function extent(lists, isLog = false) {
  let [low, high] = [Infinity, -Infinity];
  for (const list of lists) {
    for (const value of list) {
      if (value === null || (isLog && value <= 0)) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return low <= high ? [low, high] : null;
}

function linearScale(low, high, count) {
  if (low === high) [low, high] = low === 0 ? [-1, 1] : [low - Math.abs(low) / 2, high + Math.abs(high) / 2];
  const raw = (high - low) / Math.max(1, count);
  const decade = 10 ** Math.floor(Math.log10(raw));
  const step = decade * STEPS.find((part) => part * decade >= raw * 0.999);
  const ticks = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n += 1) ticks.push(n * step);
  return { low, high, ticks, place: (value) => (value - low) / (high - low) };
}

function logScale(low, high, count) {
  let [first, last] = [Math.log10(low), Math.log10(high)];
  if (last - first < 0.5) [first, last] = [first - 0.3, last + 0.3];
  const decades = [];
  const every = Math.max(1, Math.ceil((last - first) / Math.max(1, count)));
  const parts = last - first < 2 ? [1, 2, 5] : [1];
  for (let n = Math.floor(first); n <= Math.ceil(last); n += 1) {
    for (const part of parts) {
      const at = n + Math.log10(part);
      if (at >= first - 1e-9 && at <= last + 1e-9 && n % every === 0) decades.push(part * 10 ** n);
    }
  }
  const place = (value) => (value > 0 ? (Math.log10(value) - first) / (last - first) : -1);
  return { low: 10 ** first, high: 10 ** last, ticks: decades, place };
}
