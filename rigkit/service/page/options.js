/** The form of a procedure's options, made from their JSON schema. */

import { made, write } from "./element.js";

export class OptionsForm {
  #choice;
  #box;
  #procedures;
  #inputs = new Map();

  /** A select for procedures, and a box for the options of the one chosen. */
  constructor(choice, box, procedures) {
    [this.#choice, this.#box, this.#procedures] = [choice, box, procedures];
    choice.replaceChildren(...procedures.map(({ name, title }) => made("option", { value: name }, title)));
    choice.onchange = () => this.#fill();
    this.#fill();
  }

  /** The procedure chosen, or undefined where there is none at all. */
  get chosen() {
    return this.#procedures.find(({ name }) => name === this.#choice.value);
  }

  /** The options that differ from their defaults. */
  values() {
    const found = {};
    for (const [name, { input, schema }] of this.#inputs) {
      const value = read(input.value, schema);
      if (value !== schema.default) found[name] = value;
    }
    return found;
  }

  #fill() {
    this.#inputs.clear();
    const fields = Object.entries(this.chosen?.options.properties ?? {}).map(([name, schema]) => {
      const input = inputOf(schema);
      input.id = `option-${name}`;
      this.#inputs.set(name, { input, schema });
      const help = made("span", { className: "soft", id: `${input.id}-help` });
      const several = schema.type === "array" && "- several with spaces between them";
      write(help, [schema.description, schema.unit && `(${schema.unit})`, several].filter(Boolean).join(" "));
      input.setAttribute("aria-describedby", help.id);
      return made("div", {}, made("label", { htmlFor: input.id }, name.replaceAll("_", " ")), input, help);
    });
    this.#box.replaceChildren(...fields);
  }
}

function inputOf(schema) {
  const words = schema.type === "boolean" ? ["false", "true"] : schema.enum;
  if (words) {
    const select = made("select", {}, ...words.map((word) => made("option", { value: word }, wordOf(word))));
    select.value = String(schema.default);
    return select;
  }
  const isNumber = ["integer", "number"].includes(schema.type);
  const input = made("input", { type: isNumber ? "number" : "text", value: textOf(schema) });
  if (isNumber) {
    input.step = schema.type === "integer" ? "1" : "any";
    for (const [limit, name] of [["minimum", "min"], ["maximum", "max"]]) if (limit in schema) input[name] = schema[limit];
  }
  return input;
}

const wordOf = (word) => ({ true: "yes", false: "no" })[word] ?? String(word);

/** The default as a text: items of a list with spaces between them. */
const textOf = (schema) => (schema.type === "array" ? (schema.default ?? []).join(" ") : String(schema.default ?? ""));

/** Read an input as its schema has it; the daemon checks it. */
function read(text, schema) {
  if (schema.type === "array") return text.trim() === textOf(schema) ? schema.default : itemsOf(text, schema);
  if (schema.type === "boolean") return text === "true";
  if (["integer", "number"].includes(schema.type) && text.trim() !== "") return Number(text);
  return text;
}

/** The items of a list, with spaces or commas between them. */
function itemsOf(text, schema) {
  const words = text.split(/[\s,[\]"]+/).filter(Boolean);
  return words.map((word) => (schema.items?.type === "number" && isFinite(word) ? Number(word) : word));
}
