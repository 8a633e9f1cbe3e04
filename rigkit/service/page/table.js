/** A table: a head, and rows of text and numbers. */

import { made } from "./element.js";
import { digits } from "./numbers.js";

/** Put a panel's table into a box. */
export function fillTable(box, { head, rows }) {
  const heads = head.map((text) => made("th", { scope: "col" }, text));
  const body = rows.map((row) => made("tr", {}, ...row.map(cell)));
  box.replaceChildren(made("table", {}, made("thead", {}, made("tr", {}, ...heads)), made("tbody", {}, ...body)));
}

function cell(value) {
  return made("td", {}, typeof value === "number" ? digits(value) : value ?? "-");
}
