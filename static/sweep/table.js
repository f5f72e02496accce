// The tables: all runs, sortable, and one row a recording.
import { byId, element, kind, ranked, words } from "./page.js";

const MOST = 500; // rows that are drawn

function heading(name, sort, onsort) {
  const arrow = sort.name === name ? (sort.down ? " ▼" : " ▲") : "";
  const order = arrow ? (sort.down ? "descending" : "ascending") : "none";
  return element("th", { scope: "col", "aria-sort": order }, element("button", { onclick: () => onsort(name) }, `${name}${arrow}`));
}

function compared(a, b) {
  if (typeof a === "number" && typeof b === "number") return a - b;
  return (a === null) - (b === null) || String(a).localeCompare(String(b));
}

export function sorted(rows, { name, down }) {
  const [some, none] = [rows.filter((row) => row[name] !== null), rows.filter((row) => row[name] === null)];
  some.sort((a, b) => (down ? -1 : 1) * compared(a[name], b[name]));
  return [...some, ...none]; // what has no value is last either way
}

export function runs(rows, columns, state, { onsort, onopen, onchoose }) {
  const head = element("tr", {}, element("th", { scope: "col" }, "compare"), ...columns.map((name) => heading(name, state.sort, onsort)));
  const body = sorted(rows, state.sort).slice(0, MOST).map((row) => {
    const tick = element("input", { type: "checkbox", "aria-label": `compare ${row.key}`, onclick: (event) => event.stopPropagation(), onchange: () => onchoose(row.key) });
    tick.checked = state.chosen.includes(row.key);
    const cells = columns.map((name) => cell(row, name, onopen));
    return element("tr", { class: tick.checked ? "chosen" : "", "data-key": row.key, title: row.reason, onclick: () => onopen(row.key) }, element("td", {}, tick), ...cells);
  });
  byId("runs").replaceChildren(element("thead", {}, head), element("tbody", {}, ...body));
  byId("more").textContent = rows.length > MOST ? `The first ${MOST} of ${rows.length} runs.` : "";
}

function cell(row, name, onopen) {
  const value = words(row[name]);
  if (name === "recording") {
    const open = (event) => { event.stopPropagation(); onopen(row.key); };
    return element("td", {}, element("button", { onclick: open }, value));
  }
  return element("td", { class: name === "status" ? kind(row) : typeof row[name] === "number" ? "number" : "" }, value);
}

const HEADS = ["recording", "runs", "held", "lost", "without figures", "best", "median", "worst", "best settings"];

export function breakdown(rows, { names, higher }, target, onfilter) {
  const body = [...new Set(rows.map((row) => row.recording))].map((recording) => {
    const own = ranked(rows.filter((row) => row.recording === recording), target, higher);
    const count = (wanted) => own.filter((row) => kind(row) === wanted).length;
    const held = own.filter((row) => row.status === "ok" && typeof row[target] === "number").map((row) => row[target]);
    const settings = held.length ? names.map((name) => `${name}=${words(own[0][name])}`).join(" ") : "none held";
    const figures = held.length ? [held[0], held[held.length >> 1], held.at(-1)] : [null, null, null];
    const cells = [own.length, count("ok"), count("lost"), count("bad"), ...figures].map((value) => element("td", { class: "number" }, words(value)));
    const choose = element("button", { onclick: (event) => { event.stopPropagation(); onfilter(recording); } }, recording);
    return element("tr", { onclick: () => onfilter(recording) }, element("td", {}, choose), ...cells, element("td", {}, settings));
  });
  const head = element("tr", {}, ...HEADS.map((name) => element("th", { scope: "col" }, name)));
  byId("breakdown").replaceChildren(element("thead", {}, head), element("tbody", {}, ...body));
}
