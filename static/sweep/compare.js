// Pictures of the best and worst maps, and two runs side by side.
import { byId, details, drawn, element, kind, ranked, words } from "./page.js";

const EACH = 4; // best, and as many worst

export function maps(rows, { names, higher }, target, onopen) {
  const order = ranked(rows, target, higher);
  const shown = order.length > 2 * EACH ? [...order.slice(0, EACH), ...order.slice(-EACH)] : order;
  byId("maps").replaceChildren(...shown.map((row, k) => {
    const picture = element("span", {}, "no map");
    details(row.key).then((found) => found?.picture && picture.replaceChildren(element("img", { alt: `map of ${row.recording}`, src: `data:image/png;base64,${found.picture}` })));
    const place = shown.length < order.length && k >= EACH ? "worst" : k === 0 ? "best" : "";
    const values = names.map((name) => `${name} ${words(row[name])}`).join(", ");
    const caption = element("figcaption", {}, element("b", { class: kind(row) }, `${place} ${words(row[target])} `), `${row.recording} ${values}`);
    return element("figure", { "data-key": row.key }, element("button", { title: "open this run", onclick: () => onopen(row.key) }, picture), caption);
  }));
}

function table(pair, columns) {
  const body = columns.map((name) => {
    const values = pair.map((row) => words(row[name]));
    return element("tr", {}, element("th", { scope: "row" }, name), ...values.map((value) => element("td", { class: values[0] === values[1] ? "" : "differs" }, value)));
  });
  const heads = ["first", "second"].map((name) => element("th", { scope: "col", class: `key ${name}` }, name));
  return element("div", { class: "wide" }, element("table", {}, element("thead", {}, element("tr", {}, element("td"), ...heads)), element("tbody", {}, ...body)));
}

// Maps and trajectories in the frame of the map, y up. map: whose pictures lie below.
function overlay(found, below, label) {
  const boxes = found.filter((each) => each?.extent.length).map((each) => each.extent);
  const points = found.flatMap((each) => each?.path ?? []);
  const [x0, y0] = [0, 1].map((k) => Math.min(...boxes.map((box) => box[k]), ...points.map((point) => point[k + 1])));
  const [x1, y1] = [0, 1].map((k) => Math.max(...boxes.map((box) => box[k + 2]), ...points.map((point) => point[k + 1])));
  const svg = drawn("svg", { viewBox: `${x0} ${-y1} ${x1 - x0} ${y1 - y0}`, role: "img", "aria-label": label });
  for (const each of below) {
    if (!each?.picture) continue;
    const [left, bottom, right, top] = each.extent;
    svg.append(drawn("image", { href: `data:image/png;base64,${each.picture}`, x: left, y: -top, width: right - left, height: top - bottom, preserveAspectRatio: "none" }));
  }
  found.forEach((each, k) => each?.path.length && svg.append(drawn("polyline", { class: k ? "second" : "first", points: each.path.map(([, x, y]) => `${x},${-y}`).join(" ") })));
  return svg;
}

const titled = (text, svg) => element("div", {}, element("p", { class: "choice" }, text), svg);

export async function compare(pair, columns) {
  byId("compared").hidden = pair.length !== 2;
  if (pair.length !== 2) return;
  const found = await Promise.all(pair.map((row) => details(row.key)));
  const alone = (k) => found.map((each, other) => (other === k ? each : null));
  byId("comparison").replaceChildren(
    table(pair, columns),
    titled("Both trajectories on the map of the first", overlay(found, [found[0]], "both trajectories")),
    titled("First", overlay(alone(0), [found[0]], "map of the first")),
    titled("Second", overlay(alone(1), [found[1]], "map of the second")),
  );
}
