// What the parts of the page share: elements, values in words, the order of runs.

export const byId = (id) => document.getElementById(id);

// Text goes in as text: names come from recordings and files.
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value !== false) made.setAttribute(key, value === true ? "" : value);
  }
  made.append(...children);
  return made;
}

export function drawn(name, attributes = {}, text = "") {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else made.setAttribute(key, value);
  }
  made.textContent = text;
  return made;
}

export function words(value) {
  if (value === null || value === undefined) return "–";
  if (typeof value !== "number") return String(value);
  return Number.isInteger(value) ? String(value) : String(+value.toPrecision(4));
}

// How a run ended, as a class of the style sheet.
export const kind = (row) => (row.status === "ok" ? "ok" : row.status === "lost" ? "lost" : "bad");

// The best run first: those that held, by the figure; then the lost; then those without it.
export function ranked(rows, name, higher) {
  const sign = higher.includes(name) ? -1 : 1;
  const cost = (row) => (typeof row[name] === "number" ? sign * row[name] : Infinity);
  const group = (row) => ["ok", "lost"].indexOf(row.status) + (row.status === "ok" || row.status === "lost" ? 0 : 3);
  return [...rows].sort((a, b) => group(a) - group(b) || cost(a) - cost(b) || (a.key < b.key ? -1 : 1));
}

export async function details(key) {
  const reply = await fetch(`/run/${key}.json`);
  return reply.ok ? reply.json() : null;
}
