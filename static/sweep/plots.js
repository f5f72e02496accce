// Scatter and parallel coordinates of the runs, as SVG.
import { byId, drawn, kind, words } from "./page.js";

const [WIDTH, HEIGHT, LEFT, BOTTOM, TOP, RIGHT] = [560, 300, 58, 34, 14, 14];
const MOST = 4000; // runs that are drawn

// Where the values of a column lie, 0 to 1: numbers by size, by decades if they span several; words in order.
export function scale(rows, name) {
  const values = rows.map((row) => row[name]).filter((value) => value !== null && value !== undefined);
  if (!values.every((value) => typeof value === "number")) {
    const known = [...new Set(values.map(String))].sort();
    return { at: (value) => (value === null ? null : (known.indexOf(String(value)) + 0.5) / known.length), ends: [known[0] ?? "", known.at(-1) ?? ""] };
  }
  const [low, high] = values.reduce(([a, b], value) => [Math.min(a, value), Math.max(b, value)], [Infinity, -Infinity]);
  const log = low > 0 && high / low > 30;
  const place = log ? (value) => Math.log(value / low) / Math.log(high / low) : (value) => (high > low ? (value - low) / (high - low) : 0.5);
  return { at: (value) => (typeof value === "number" ? place(value) : null), ends: values.length ? [words(low), words(high)] : ["", ""], log };
}

function prepared(id) {
  const svg = byId(id);
  svg.setAttribute("viewBox", `0 0 ${WIDTH} ${HEIGHT}`);
  svg.replaceChildren();
  return svg;
}

const named = (row, names) => `${row.recording}, ${names.map((name) => `${name} ${words(row[name])}`).join(", ")}: ${row.status}`;
const marked = (row, chosen) => `${kind(row)}${kind(row) === "ok" ? "" : " lost"}${chosen.includes(row.key) ? " chosen" : ""}`;

export function scatter(rows, [xName, yName], chosen, onchoose) {
  const svg = prepared("scatter");
  const [x, y] = [scale(rows, xName), scale(rows, yName)];
  const [right, low] = [WIDTH - RIGHT, HEIGHT - BOTTOM];
  svg.append(drawn("path", { class: "axis", fill: "none", d: `M${LEFT} ${TOP}V${low}H${right}` }));
  const labels = [[LEFT, low + 14, "start", x.ends[0]], [right, low + 14, "end", x.ends[1]], [(LEFT + right) / 2, low + 28, "middle", `${xName}${x.log ? " (log)" : ""}`],
    [LEFT - 5, low, "end", y.ends[0]], [LEFT - 5, TOP + 8, "end", y.ends[1]], [LEFT + 5, TOP + 8, "start", `${yName}${y.log ? " (log)" : ""}`]];
  for (const [left, top, anchor, text] of labels) svg.append(drawn("text", { x: left, y: top, "text-anchor": anchor }, text));
  for (const row of rows.slice(0, MOST)) {
    const [u, v] = [x.at(row[xName]), y.at(row[yName])];
    if (u === null || v === null) continue;
    const point = drawn("circle", { class: `point ${marked(row, chosen)}`, r: 5, cx: LEFT + u * (right - LEFT), cy: low - v * (low - TOP), "data-key": row.key, onclick: () => onchoose(row.key) });
    point.append(drawn("title", {}, named(row, [xName, yName])));
    svg.append(point);
  }
}

export function parallel(rows, names, chosen, onchoose) {
  const svg = prepared("parallel");
  const [top, low] = [TOP + 26, HEIGHT - 22];
  const across = (k) => 40 + (names.length > 1 ? k / (names.length - 1) : 0.5) * (WIDTH - 80);
  const scales = names.map((name) => scale(rows, name));
  for (const row of rows.slice(0, MOST)) {
    const places = names.map((name, k) => [across(k), scales[k].at(row[name])]).filter(([, at]) => at !== null);
    const line = drawn("path", { class: `line ${marked(row, chosen)}`, d: places.map(([x, at], k) => `${k ? "L" : "M"}${x} ${low - at * (low - top)}`).join(""), "data-key": row.key, onclick: () => onchoose(row.key) });
    line.append(drawn("title", {}, named(row, names)));
    svg.append(line);
  }
  names.forEach((name, k) => {
    const x = across(k);
    svg.append(drawn("path", { class: "axis", d: `M${x} ${top}V${low}` }));
    const texts = [[12 + 13 * (k % 2), name + (scales[k].log ? " (log)" : "")], [top - 3, scales[k].ends[1]], [low + 14, scales[k].ends[0]]];
    for (const [y, text] of texts) svg.append(drawn("text", { x, y, "text-anchor": k === 0 && y < 30 ? "start" : k === names.length - 1 && y < 30 ? "end" : "middle" }, text));
  });
}
