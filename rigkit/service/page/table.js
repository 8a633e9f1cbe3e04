/** A table: a head, and rows of text and numbers. */

import { made } from "./element.js";

/** Put a panel's table into a box. */
export function fillTable(box, { head, rows }) {
  const heads = head.map((text) => made("th", { scope: "col" }, text));
  const places = head.map((_, column) => Math.max(0, ...rows.map((row) => placesOf(row[column]))));
  const body = rows.map((row) => made("tr", {}, ...row.map((value, column) => made("td", {}, written(value, places[column])))));
  box.replaceChildren(made("table", {}, made("thead", {}, made("tr", {}, ...heads)), made("tbody", {}, ...body)));
}

/** Decimal places of a number as it came, at most four. */
const placesOf = (value) => (typeof value === "number" ? Math.min(4, String(value).split(".")[1]?.length ?? 0) : 0);

function written(value, places) {
  return typeof value === "number" ? value.toFixed(places).replace("-", "−") : value ?? "-";
}
