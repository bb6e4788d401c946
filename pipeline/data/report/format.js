"use strict";
/* Elements and numbers.  Every text of a job goes through textContent: no name is ever read as markup. */

function make(tag, options = {}, ...children) {
  const { text, on, ...attributes } = options;
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== undefined && value !== null && value !== false) element.setAttribute(name, value === true ? "" : value);
  }
  if (text !== undefined) element.textContent = text;
  for (const [event, listener] of Object.entries(on ?? {})) element.addEventListener(event, listener);
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

const byId = (id) => document.getElementById(id);

const DIGITS = 5; // shown; the full number is in the title of its cell

function shown(value, unit = "") {
  if (value === null || value === undefined) return "\u2013";
  if (typeof value === "boolean") return value ? "yes" : "no";
  const size = Math.abs(value);
  let text = String(value);
  if (!Number.isInteger(value) || size >= 1e7) {
    const plain = Number(value.toPrecision(DIGITS));
    text = size !== 0 && (size < 1e-4 || size >= 1e7) ? plain.toExponential() : String(plain);
  }
  return (unit ? `${text}\u00a0${unit}` : text).replaceAll("-", "\u2212").replace("mm2", "mm\u00b2").replace(/deg$/, "\u00b0");
}

function exact(value) {
  return value === null || value === undefined ? undefined : String(value);
}

/* A share with three digits; what is not all is not shown as all. */
function percent(share) {
  const told = Number((100 * share).toPrecision(3));
  return `${told === 100 && share < 1 ? 99.9 : told}\u00a0%`;
}

function facts(pairs) {
  const known = pairs.filter(([, value]) => value !== null && value !== undefined && value !== "");
  const items = known.map(([name, value]) => make("div", {}, make("dt", { text: name }), make("dd", { text: String(value) })));
  return make("dl", { class: "facts" }, ...items);
}
