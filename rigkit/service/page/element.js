/** Finding and making elements, and writing to them only what has changed. */

/** Return the element of that id. */
export const byId = (id) => document.getElementById(id);

/** Make an element with properties, and with children or text in it. */
export function made(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

/** Write text, if it is another one. */
export function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Show an element, or not. */
export function show(element, yes) {
  if (element.hidden === yes) element.hidden = !yes;
}

/** Set a data attribute, if it is another one. */
export function mark(element, name, value) {
  if (element.dataset[name] !== value) element.dataset[name] = value;
}
